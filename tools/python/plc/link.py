"""The way to a PLC. A link has connect(), exchange(values), read() and close(); what goes wrong on the way is a LinkDown."""


class LinkDown(Exception):
    """Nothing came back, or something else than was asked for."""


class WrongMap(Exception):
    """What the PLC itself says about the map: an address, a node or a symbol that it does not have, or that is of another type."""


REQUESTS = 2  # of an exchange: one that writes, one that reads


def request_timeout(plc_map):
    """[s] for one request, so that an exchange that fails ends within the map's time-out."""
    return plc_map.timeout / REQUESTS


def open_link(plc_map):
    """The client's side of a map's protocol. Its library is loaded here: the others are not needed."""
    if plc_map.protocol == "modbus":
        from plc.modbus import ModbusLink
        return ModbusLink(plc_map)
    if plc_map.protocol == "opcua":
        from plc.opcua import OpcuaLink
        return OpcuaLink(plc_map)
    from plc.ads import AdsLink
    return AdsLink(plc_map)
