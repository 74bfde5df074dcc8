"""OPC UA: the map's nodes by asyncua, all in one write and one read. The alive counter stands last in the write."""

import asyncio
import logging

from asyncua import Client, ua

from plc.link import LinkDown, WrongMap, request_timeout
from plc.values import decode, encode

VARIANTS = {"bool": ua.VariantType.Boolean, "int16": ua.VariantType.Int16, "uint16": ua.VariantType.UInt16, "int32": ua.VariantType.Int32,
            "uint32": ua.VariantType.UInt32, "int64": ua.VariantType.Int64, "uint64": ua.VariantType.UInt64,
            "float32": ua.VariantType.Float, "float64": ua.VariantType.Double}
CONNECTING = 2.0  # [s] for each request of connecting at least: channel, session and the nodes' types take longer than a cycle's exchange
TYPES = {variant: kind for kind, variant in VARIANTS.items()}


def data_value(signal, value):
    return ua.DataValue(ua.Variant(encode(signal, value), VARIANTS[signal.type]))


class OpcuaLink:
    """asyncua's loop runs while something is asked, in whichever thread asks; two never do at once."""

    def __init__(self, plc_map):
        logging.getLogger("asyncua").setLevel(logging.CRITICAL)  # what goes wrong is told by us
        self.address, self.timeout = plc_map.address, request_timeout(plc_map)
        self.loop, self.client = asyncio.new_event_loop(), None
        self.written = sorted((signal for signal in plc_map.signals if signal.to_plc), key=lambda each: each.name == "alive_counter")
        self.heard = [signal for signal in plc_map.signals if not signal.to_plc]

    def _run(self, coroutine):
        try:
            return self.loop.run_until_complete(coroutine)
        except (OSError, asyncio.TimeoutError, ua.UaError) as problem:
            raise LinkDown(f"OPC UA at {self.address}: {str(problem) or type(problem).__name__}") from problem

    def _in_time(self, coroutine):
        return asyncio.wait_for(coroutine, self.timeout)

    async def _check(self, signal):
        node = self.client.get_node(signal.at)
        try:
            variant = await node.read_data_type_as_variant_type()
        except ua.UaStatusCodeError as problem:
            raise WrongMap(f"the OPC UA server at {self.address} does not know the node {signal.at} of {signal.name}: {problem}") from problem
        if variant != VARIANTS[signal.type]:
            raise WrongMap(f"the node {signal.at} of {signal.name} is a {TYPES.get(variant, variant.name)}, the map says {signal.type}")
        return node

    async def _connect(self):
        self.client = Client(self.address, timeout=max(CONNECTING, self.timeout))
        await self.client.connect()
        self.nodes_written = [await self._check(signal) for signal in self.written]
        self.nodes_heard = [await self._check(signal) for signal in self.heard]

    def connect(self):
        self._run(self._connect())

    def write(self, values):
        content = [data_value(signal, values[signal.name, signal.group]) for signal in self.written]
        results = self._run(self._in_time(self.client.write_values(self.nodes_written, content, raise_on_partial_error=False)))
        for signal, result in zip(self.written, results):
            if not result.is_good():
                raise WrongMap(f"the OPC UA server at {self.address} does not let {signal.name} be written to {signal.at}: {result.name}")

    def read(self):
        numbers = self._run(self._in_time(self.client.read_values(self.nodes_heard)))
        for signal, number in zip(self.heard, numbers):
            if number is None:
                raise LinkDown(f"OPC UA at {self.address}: {signal.at} has no value")
        return {(signal.name, signal.group): decode(signal, number) for signal, number in zip(self.heard, numbers)}

    def close(self):
        if self.client is None:
            return
        try:
            self.loop.run_until_complete(asyncio.wait_for(self.client.disconnect(), self.timeout))
        except (OSError, asyncio.TimeoutError, ua.UaError):
            pass  # it was gone already
        self.client = None
