"""A stand-in for TwinCAT: it speaks the frames of ADS over TCP that a client of symbols needs (Beckhoff, "TwinCAT AMS/ADS
specification": AMS/TCP header, AMS header, commands 1 to 4 and 9, sum commands 0xF080 and 0xF081) and has the map's symbols."""

import asyncio
import struct

from plc.values import BITS, FORMATS, decode, encode

TCP_PORT = 48898
TCP_HEADER = struct.Struct("<HI")                # reserved, length of what follows
AMS_HEADER = struct.Struct("<6sH6sHHHIII")       # target, source, command, state flags, length, error, invoke id
RESPONSE = 0x0005                                # state flags: ADS command, response
REQUEST = struct.Struct("<III")                  # index group, index offset, length
SYMBOL = struct.Struct("<IIIIIIHHH")             # entry length, group, offset, size, type, flags, lengths of name, type and comment
GROUP = 0x4040                                   # PLC data area
HANDLE_BY_NAME, VALUE_BY_HANDLE, RELEASE_HANDLE, SYMBOL_INFO = 0xF003, 0xF005, 0xF006, 0xF009
SUM_READ, SUM_WRITE = 0xF080, 0xF081
NO_SERVICE, NO_GROUP, NO_OFFSET, WRONG_SIZE, NO_SYMBOL = 0x701, 0x702, 0x703, 0x705, 0x710
RUNNING = 5                                      # ADS state
TYPES = {"bool": (33, "BOOL"), "int16": (2, "INT"), "uint16": (18, "UINT"), "int32": (3, "DINT"), "uint32": (19, "UDINT"),
         "int64": (20, "LINT"), "uint64": (21, "ULINT"), "float32": (4, "REAL"), "float64": (5, "LREAL")}
SPACING = 8                                      # [bytes] between symbols in the data area


class AdsServer:
    def __init__(self, plc_map, cycle):
        self.map, self.cycle = plc_map, cycle
        self.symbols = {SPACING * place: signal for place, signal in enumerate(plc_map.signals)}
        self.places = {signal.at.upper(): place for place, signal in self.symbols.items()}

    async def serve(self):
        self.server = await asyncio.start_server(self.talk, self.map.address, TCP_PORT)

    async def talk(self, reader, writer):
        try:
            while True:
                _, length = TCP_HEADER.unpack(await reader.readexactly(TCP_HEADER.size))
                packet = await reader.readexactly(length)
                target, target_port, source, source_port, command, _, _, _, invoke = AMS_HEADER.unpack_from(packet)
                answer = self.answer(command, packet[AMS_HEADER.size:])
                header = AMS_HEADER.pack(source, source_port, target, target_port, command, RESPONSE, len(answer), 0, invoke)
                writer.write(TCP_HEADER.pack(0, len(header) + len(answer)) + header + answer)
                await writer.drain()
        except (asyncio.IncompleteReadError, ConnectionError, struct.error):
            pass  # the client went away, or speaks something else
        finally:
            writer.close()

    def answer(self, command, data):
        if command == 1:  # device information
            return struct.pack("<IBBH16s", 0, 3, 1, 0, b"slewlab soft-plc")
        if command == 4:  # state
            return struct.pack("<IHH", 0, RUNNING, 0)
        if command == 2:
            error, content = self.read(*REQUEST.unpack(data))
            return struct.pack("<II", error, len(content)) + content
        if command == 3:
            group, offset, length = REQUEST.unpack_from(data)
            return struct.pack("<I", self.write([(group, offset, data[REQUEST.size:REQUEST.size + length])])[0])
        if command == 9:
            group, offset, _, length = struct.unpack_from("<IIII", data)
            error, content = self.read_write(group, offset, data[16:16 + length])
            return struct.pack("<II", error, len(content)) + content
        return struct.pack("<I", NO_SERVICE)

    def place_of(self, group, offset):
        if group not in (GROUP, VALUE_BY_HANDLE):
            return NO_GROUP, None
        return (0, self.symbols[offset]) if offset in self.symbols else (NO_OFFSET, None)

    @staticmethod
    def form(signal):
        return struct.Struct("<" + ("?" if signal.type == "bool" else FORMATS[signal.type]))

    def read(self, group, offset, length):
        error, signal = self.place_of(group, offset)
        if error:
            return error, b""
        if length < self.form(signal).size:
            return WRONG_SIZE, b""
        values = self.cycle.inputs if signal.to_plc else self.cycle.outputs
        return 0, self.form(signal).pack(encode(signal, values[signal.name, signal.group]))

    def write(self, parts):
        """The errors, one per part; the cycle hears of all parts at once."""
        errors, values = [], {}
        for group, offset, content in parts:
            error, signal = (0, None) if group == RELEASE_HANDLE else self.place_of(group, offset)
            if signal is not None and len(content) != self.form(signal).size:
                error = WRONG_SIZE
            elif signal is not None and signal.to_plc:
                values[signal.name, signal.group] = decode(signal, self.form(signal).unpack(content)[0])
            errors.append(error)
        self.cycle.receive(values)
        return errors

    def read_write(self, group, offset, data):
        if group in (HANDLE_BY_NAME, SYMBOL_INFO):
            place = self.places.get(data.split(b"\0")[0].decode("latin-1").upper())
            if place is None:
                return NO_SYMBOL, b""
            return 0, struct.pack("<I", place) if group == HANDLE_BY_NAME else self.information(place)
        if group == SUM_READ:  # offset: how many
            answers = [self.read(*REQUEST.unpack_from(data, REQUEST.size * number)) for number in range(offset)]
            return 0, b"".join(struct.pack("<I", error) for error, _ in answers) + b"".join(content for _, content in answers)
        if group == SUM_WRITE:
            parts, begin = [], REQUEST.size * offset
            for number in range(offset):
                part_group, part_offset, length = REQUEST.unpack_from(data, REQUEST.size * number)
                parts.append((part_group, part_offset, data[begin:begin + length]))
                begin += length
            return 0, b"".join(struct.pack("<I", error) for error in self.write(parts))
        return NO_GROUP, b""

    def information(self, place):
        signal = self.symbols[place]
        number, name = TYPES[signal.type]
        texts = [signal.at.encode(), name.encode(), b""]
        body = b"".join(text + b"\0" for text in texts)
        size = 1 if signal.type == "bool" else BITS[signal.type] // 8
        return SYMBOL.pack(SYMBOL.size + len(body), GROUP, place, size, number, 0, *(len(text) for text in texts)) + body
