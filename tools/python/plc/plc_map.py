"""The map of a PLC's variables (tools/plc/plc_map.h), read by the core."""

from types import SimpleNamespace

from core_module import core


def load_plc_map(path):
    """core.InputError with every problem found."""
    told = core.load_plc_map(path)
    return SimpleNamespace(**told | {"signals": [SimpleNamespace(**signal) for signal in told["signals"]]})
