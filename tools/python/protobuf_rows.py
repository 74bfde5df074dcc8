"""Messages of one channel as Protobuf, all at once: every field has a fixed size on the wire (double, sfixed64, sfixed32,
bool, packed arrays), so that a numpy type with the tags between the values is the encoding."""

import numpy as np
from google.protobuf import descriptor_pb2

FIXED_64, BYTES, FIXED_32, VARINT = 1, 2, 5, 0  # Protobuf's wire types
Field = descriptor_pb2.FieldDescriptorProto
# numpy's kind and size: Protobuf's type, its wire type and numpy's of the value there.
KINDS = {
    "f8": (Field.TYPE_DOUBLE, FIXED_64, "<f8"),
    "i8": (Field.TYPE_SFIXED64, FIXED_64, "<i8"),
    "i4": (Field.TYPE_SFIXED32, FIXED_32, "<i4"),
    "i1": (Field.TYPE_SFIXED32, FIXED_32, "<i4"),
    "b1": (Field.TYPE_BOOL, VARINT, "?"),
}
OF_THE_MESSAGE = (descriptor_pb2.FileDescriptorProto.MESSAGE_TYPE_FIELD_NUMBER, 0, descriptor_pb2.DescriptorProto.FIELD_FIELD_NUMBER)  # path of its fields


def varint(value):
    encoded = bytearray()
    while value > 0x7F:
        encoded.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes(encoded + bytes([value]))


class ProtobufRows:
    def __init__(self, name, dtype, units):
        """`name` is package.Message; field numbers count from 1 in the order of `dtype`; {field: unit}."""
        self.name, self.dtype, self.units = name, dtype, units
        parts, heads = [], {}
        for number, field in enumerate(dtype.names, 1):
            kind, shape = dtype[field].base, dtype[field].shape
            _, wire, value = KINDS[f"{kind.kind}{kind.itemsize}"]
            if shape == (0,):
                continue
            head = varint(number << 3 | (BYTES if shape else wire))
            if shape:
                head += varint(shape[0] * np.dtype(value).itemsize)
            heads[f"head of {field}"] = np.frombuffer(head, np.uint8)
            parts += [(f"head of {field}", np.uint8, (len(head),)), (field, value, shape)]
        self.layout, self.heads = np.dtype(parts), heads

    def descriptor(self):
        """The schema: a FileDescriptorSet, in which a field's unit is the comment behind it."""
        package, message = self.name.rsplit(".", 1)
        file = descriptor_pb2.FileDescriptorProto(name=f"{self.name}.proto", package=package, syntax="proto3")
        described = file.message_type.add(name=message)
        for number, field in enumerate(self.dtype.names, 1):
            kind = self.dtype[field].base
            described.field.add(name=field, number=number, type=KINDS[f"{kind.kind}{kind.itemsize}"][0],
                                label=Field.LABEL_REPEATED if self.dtype[field].shape else Field.LABEL_OPTIONAL)
            if unit := self.units.get(field):
                file.source_code_info.location.add(path=[*OF_THE_MESSAGE, number - 1], span=[number, 0, 0], trailing_comments=f" [{unit}]\n")
        return descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString()

    def encoded(self, messages):
        """A structured array, a message per row."""
        rows = np.empty(len(messages), self.layout)
        for head, value in self.heads.items():
            rows[head] = value
        for field in self.layout.names:
            if field not in self.heads:
                rows[field] = messages[field]
        return rows
