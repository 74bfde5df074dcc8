"""The soft PLC's Modbus server: coils, discrete inputs, holding and input registers, each area of its own."""

from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from plc.modbus import blocks_of, fill, take

AREAS = {1: "coil", 5: "coil", 15: "coil", 2: "discrete", 3: "holding", 6: "holding", 16: "holding", 4: "input"}  # by function
BITS_PER_REGISTER = 16
SPARE = 64  # registers behind the last that the map names


class ModbusServer:
    def __init__(self, plc_map, cycle):
        host, _, port = plc_map.address.rpartition(":")
        self.cycle, self.high_word_first = cycle, plc_map.high_word_first
        self.areas = {}
        for area in ("coil", "discrete", "holding", "input"):
            of_area = [signal for signal in plc_map.signals if signal.area == area]
            self.areas[area] = [blocks_of([signal for signal in of_area if signal.to_plc == to_plc]) for to_plc in (True, False)]

        def memory(area):
            ends = [block.first + block.count for blocks in self.areas[area] for block in blocks]
            is_of_bits = area in ("coil", "discrete")
            size = max(ends, default=0) // (BITS_PER_REGISTER if is_of_bits else 1) + SPARE
            return [SimData(0, count=size, values=0, datatype=DataType.BITS if is_of_bits else DataType.REGISTERS)]

        device = SimDevice(plc_map.modbus_unit, simdata=tuple(memory(area) for area in ("coil", "discrete", "holding", "input")),
                           action=self.access)
        self.server = ModbusTcpServer(device, address=(host, int(port)))

    def _content(self, registers, block):
        if block.is_of_bits:
            return [bool(registers[bit // BITS_PER_REGISTER] >> bit % BITS_PER_REGISTER & 1) for bit in range(block.first, block.first + block.count)]
        return registers[block.first:block.first + block.count]

    def _put(self, registers, block, content):
        if not block.is_of_bits:
            registers[block.first:block.first + block.count] = content
            return
        for bit, value in enumerate(content, block.first):
            mask = 1 << bit % BITS_PER_REGISTER
            registers[bit // BITS_PER_REGISTER] = registers[bit // BITS_PER_REGISTER] & ~mask | (mask if value else 0)

    async def access(self, function, _start, address, _count, registers, written):
        area = AREAS[function]
        inputs, outputs = self.areas[area]
        if written is None:
            for block in outputs:
                self._put(registers, block, fill(block, self.cycle.outputs, self.high_word_first))
            return
        if area == "coil":
            for bit, value in enumerate(written, address):
                mask = 1 << bit % BITS_PER_REGISTER
                registers[bit // BITS_PER_REGISTER] = registers[bit // BITS_PER_REGISTER] & ~mask | (mask if value else 0)
        else:
            registers[address:address + len(written)] = written
        values = {}
        for block in inputs:
            if block.first < address + len(written) and address < block.first + block.count:
                values |= take(block, self._content(registers, block), self.high_word_first)
        self.cycle.receive(values)

    async def serve(self):
        await self.server.serve_forever(background=True)
