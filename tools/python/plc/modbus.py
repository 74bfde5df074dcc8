"""Modbus TCP: the map's registers and coils by pymodbus. Neighbouring ones go in one request; what holds the alive counter is written
last, so that the PLC has the whole of a cycle when the counter moves."""

import logging

from plc.link import LinkDown, WrongMap, request_timeout
from plc.values import decode, encode, number_in, word_count, words_of

MOST_REGISTERS = 120  # of one request; the protocol allows 123 to be written and 125 to be read
MOST_COILS = 1900
BITS_PER_REGISTER = 16
EXCEPTIONS = {1: "it does not know this function", 2: "it has no such address", 3: "it does not take this value"}


class Block:
    """Neighbouring registers or coils of one area."""

    def __init__(self, area, first, count):
        self.area, self.first, self.count = area, first, count
        self.signals = []

    @property
    def is_of_bits(self):
        return self.area in ("coil", "discrete")

    def __str__(self):
        return f"{self.area} {self.first}" + (f" to {self.first + self.count - 1}" if self.count > 1 else "")


def blocks_of(signals):
    blocks = []
    for signal in sorted(signals, key=lambda each: (each.area, each.number)):
        end = signal.number + (1 if signal.area in ("coil", "discrete") else word_count(signal))
        last = blocks[-1] if blocks else None
        most = MOST_COILS if signal.area in ("coil", "discrete") else MOST_REGISTERS
        if not last or last.area != signal.area or signal.number > last.first + last.count or end - last.first > most:
            last = Block(signal.area, signal.number, 0)
            blocks.append(last)
        last.count = max(last.count, end - last.first)
        last.signals.append(signal)
    return blocks


def fill(block, values, high_word_first):
    """The block's registers, or coils, for values by (name, group)."""
    content = [False if block.is_of_bits else 0] * block.count
    for signal in block.signals:
        number = encode(signal, values[signal.name, signal.group])
        at = signal.number - block.first
        if block.is_of_bits:
            content[at] = number
        elif signal.type == "bool":
            content[at] |= int(number) << max(0, signal.bit)
        else:
            content[at:at + word_count(signal)] = words_of(signal, number, high_word_first)
    return content


def take(block, content, high_word_first):
    """What fill() put into it."""
    values = {}
    for signal in block.signals:
        at = signal.number - block.first
        if block.is_of_bits:
            number = content[at]
        elif signal.type == "bool":
            number = content[at] >> max(0, signal.bit) & 1
        else:
            number = number_in(signal, content[at:at + word_count(signal)], high_word_first)
        values[signal.name, signal.group] = decode(signal, number)
    return values


def is_last(block):
    return any(signal.name == "alive_counter" for signal in block.signals)


class ModbusLink:
    def __init__(self, plc_map):
        from pymodbus.client import ModbusTcpClient
        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)  # what goes wrong is told by us
        host, _, port = plc_map.address.rpartition(":")
        self.client = ModbusTcpClient(host, port=int(port), timeout=request_timeout(plc_map), retries=0)
        self.unit, self.high_word_first, self.address = plc_map.modbus_unit, plc_map.high_word_first, plc_map.address
        self.writes = sorted(blocks_of([signal for signal in plc_map.signals if signal.to_plc]), key=is_last)
        self.reads = blocks_of([signal for signal in plc_map.signals if not signal.to_plc])

    def connect(self):
        if not self.client.connect():
            raise LinkDown(f"no Modbus server answers at {self.address}")
        self.read()  # an address that it does not have is told now

    def _ask(self, block, request, *arguments, **options):
        from pymodbus.exceptions import ModbusException
        try:
            answer = request(block.first, *arguments, device_id=self.unit, **options)
        except (ModbusException, OSError) as problem:
            raise LinkDown(f"{block}: {problem}") from problem
        if answer.isError():
            reason = EXCEPTIONS.get(getattr(answer, "exception_code", 0), f"exception {getattr(answer, 'exception_code', '?')}")
            raise WrongMap(f"the Modbus server at {self.address} refused {block} of unit {self.unit}: {reason}")
        return answer

    def write(self, values):
        for block in self.writes:
            content = fill(block, values, self.high_word_first)
            self._ask(block, self.client.write_coils if block.is_of_bits else self.client.write_registers, content)

    def read(self):
        functions = {"holding": self.client.read_holding_registers, "input": self.client.read_input_registers,
                     "coil": self.client.read_coils, "discrete": self.client.read_discrete_inputs}
        values = {}
        for block in self.reads:
            answer = self._ask(block, functions[block.area], count=block.count)
            values |= take(block, answer.bits if block.is_of_bits else answer.registers, self.high_word_first)
        return values

    def close(self):
        self.client.close()
