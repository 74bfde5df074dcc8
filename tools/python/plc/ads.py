"""ADS: the map's symbols by pyads and Beckhoff's AdsLib, all in one sum command each way. The alive counter stands last in the write."""

import contextlib
import os
import sys

from pyads import ADSError, Connection

from plc.link import LinkDown, WrongMap, request_timeout
from plc.values import decode, encode

# IEC 61131-3 names of a type as TwinCAT gives them for a symbol.
NAMES = {"bool": ("BOOL",), "int16": ("INT",), "uint16": ("UINT", "WORD"), "int32": ("DINT",), "uint32": ("UDINT", "DWORD"),
         "int64": ("LINT",), "uint64": ("ULINT", "LWORD"), "float32": ("REAL",), "float64": ("LREAL",)}
STANDARD_ERROR = 2  # descriptor
NO_SYMBOL = 1808  # [ADS error code] symbol not found


@contextlib.contextmanager
def without_its_remarks():
    """AdsLib writes to standard error that the other side has hung up, at the end of a good run too."""
    sys.stderr.flush()
    kept, nothing = os.dup(STANDARD_ERROR), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, STANDARD_ERROR)
    os.close(nothing)
    try:
        yield
    finally:
        os.dup2(kept, STANDARD_ERROR)
        os.close(kept)


class AdsLink:
    def __init__(self, plc_map):
        self.plc = Connection(plc_map.ams_net_id, plc_map.ams_port, plc_map.address)
        self.where = f"{plc_map.ams_net_id}:{plc_map.ams_port} at {plc_map.address}"
        self.timeout = request_timeout(plc_map)
        self.written = sorted((signal for signal in plc_map.signals if signal.to_plc), key=lambda each: each.name == "alive_counter")
        self.heard = [signal for signal in plc_map.signals if not signal.to_plc]

    def connect(self):
        try:
            self.plc.open()
            self.plc.set_timeout(round(1e3 * self.timeout))
            self.plc.read_state()
        except ADSError as problem:
            self.close()
            raise LinkDown(f"ADS {self.where}: {problem}") from problem
        for signal in (*self.written, *self.heard):
            try:
                name = self.plc.get_symbol(signal.at).symbol_type
            except ADSError as problem:
                if problem.err_code == NO_SYMBOL:
                    raise WrongMap(f"the PLC {self.where} has no symbol {signal.at}, where the map has {signal.name}") from problem
                raise LinkDown(f"ADS {self.where}: {problem}") from problem
            if name not in NAMES[signal.type]:
                raise WrongMap(f"the symbol {signal.at} of {signal.name} is a {name}, the map says {signal.type} ({' or '.join(NAMES[signal.type])})")

    def write(self, values):
        content = {signal.at: encode(signal, values[signal.name, signal.group]) for signal in self.written}
        try:
            results = self.plc.write_list_by_name(content)
        except ADSError as problem:
            raise LinkDown(f"ADS {self.where}: {problem}") from problem
        for symbol, result in results.items():
            if result != "no error":
                raise WrongMap(f"the PLC {self.where} does not take {symbol}: {result}")

    def read(self):
        try:
            numbers = self.plc.read_list_by_name([signal.at for signal in self.heard])
        except ADSError as problem:
            raise LinkDown(f"ADS {self.where}: {problem}") from problem
        for signal in self.heard:
            if isinstance(numbers[signal.at], str):  # pyads gives an error's text in place of the value
                raise WrongMap(f"the PLC {self.where} does not give {signal.at}: {numbers[signal.at]}")
        return {(signal.name, signal.group): decode(signal, numbers[signal.at]) for signal in self.heard}

    def close(self):
        with without_its_remarks():
            self.plc.close()
