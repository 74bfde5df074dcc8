"""The soft PLC's OPC UA server: a variable per signal of the map, without encryption, on loopback."""

import logging

from asyncua import Server, ua
from asyncua.common.callback import CallbackType

from plc.opcua import data_value
from plc.values import decode


class OpcuaServer:
    def __init__(self, plc_map, cycle):
        logging.getLogger("asyncua").setLevel(logging.ERROR)
        self.map, self.cycle = plc_map, cycle
        self.inputs = {}

    async def serve(self):
        self.server = Server()
        await self.server.init()
        self.server.set_endpoint(self.map.address)
        self.server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        folder = await self.server.nodes.objects.add_object(2, "Slewing")
        for signal in self.map.signals:
            node_id = ua.NodeId.from_string(signal.at)
            values = self.cycle.inputs if signal.to_plc else self.cycle.outputs
            node = await folder.add_variable(node_id, ua.QualifiedName(signal.at.rpartition("=")[2], 2),
                                             data_value(signal, values[signal.name, signal.group]).Value)
            if signal.to_plc:
                await node.set_writable()
                self.inputs[node.nodeid] = signal
            else:
                self.server.iserver.aspace.set_attribute_value_callback(node.nodeid, ua.AttributeIds.Value, self._reader(signal))
        self.server.subscribe_server_callback(CallbackType.PostWrite, self.written)
        await self.server.start()

    def _reader(self, signal):
        return lambda *_: data_value(signal, self.cycle.outputs[signal.name, signal.group])

    async def written(self, event, _):
        """Behind a write of however many nodes."""
        values = {}
        for item in event.request_params.NodesToWrite:
            signal = self.inputs.get(item.NodeId)
            if signal is not None and item.AttributeId == ua.AttributeIds.Value:
                values[signal.name, signal.group] = decode(signal, item.Value.Value.Value)
        self.cycle.receive(values)
