"""Messages packed at once against lcm-gen's classes, which make and read the same bytes field by field."""

import sys
import unittest

from message_layout import MessageLayout
from run_log import messages_folder

sys.path.insert(0, str(messages_folder()))
from slewlab_msgs import controller_state_t, encoder_t, operator_t, sensors_t, torque_t  # noqa: E402

GROUPS = 3


def filled(kind):
    """A message whose every field is a number of its own."""
    message, number = kind(), 0
    for name, spelling, dimensions in zip(kind.__slots__, kind.__typenames__, kind.__dimensions__, strict=True):
        values = []
        for _ in range(1 if dimensions is None else GROUPS):
            number += 1
            values.append(number / 8 if spelling == "double" else number % 2 if spelling == "boolean" else number)
        setattr(message, name, values[0] if dimensions is None else values)
    if "group_count" in kind.__slots__:
        message.group_count = GROUPS
    return message


def flat(message):
    for name in message.__slots__:
        value = getattr(message, name)
        yield from value if isinstance(value, (list, tuple)) else [value]


class MessageLayoutTest(unittest.TestCase):
    def test_the_bytes_are_those_of_the_classes_both_ways(self):
        for kind in (controller_state_t, encoder_t, operator_t, sensors_t, torque_t):
            with self.subTest(kind=kind.__name__):
                layout, message = MessageLayout(kind, GROUPS), filled(kind)
                self.assertEqual(layout.pack(*flat(message)), message.encode())
                self.assertEqual(list(layout.unpack(message.encode())[1:]), list(flat(kind.decode(message.encode()))))

    def test_fields_are_found_by_name(self):
        layout, message = MessageLayout(encoder_t, GROUPS), filled(encoder_t)
        found = layout.getter("shaft_speed", "sequence")(layout.unpack(message.encode()))
        self.assertEqual(found, (*message.shaft_speed, message.sequence))

    def test_another_message_and_another_length_are_none_of_it(self):
        layout, message = MessageLayout(encoder_t, GROUPS), filled(encoder_t)
        data = message.encode()
        self.assertIsNone(layout.unpack(data[:-1]))
        self.assertIsNone(layout.unpack(b"x" + data[1:]))
        self.assertIsNone(layout.unpack(filled(torque_t).encode()))
        self.assertIsNone(MessageLayout(encoder_t, GROUPS + 1).unpack(data))
        message.group_count = GROUPS - 1  # as flipped bits leave it, with the length as it was
        corrupt = bytearray(data)
        at = 8 + 5 * 8 + 3
        self.assertEqual(corrupt[at], GROUPS)
        corrupt[at] = GROUPS - 1
        self.assertIsNone(layout.unpack(bytes(corrupt)))


if __name__ == "__main__":
    unittest.main()
