"""Units that a file may give a value in, and their factors to SI: the same spellings as common/unit.cpp, as far as
measured signals need them (unit_test.py compares the two)."""

import math

# quantity: spellings with their factor to SI; the first is the SI one.
SPELLINGS = {
    "number": {"-": 1.0, "%": 1e-2},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0},
    "frequency": {"Hz": 1.0, "kHz": 1e3},
    "length": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3},
    "speed": {"m/s": 1.0, "mm/s": 1e-3, "km/h": 1.0 / 3.6},
    "acceleration": {"m/s^2": 1.0, "mm/s^2": 1e-3},
    "angle": {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0},
    "angular speed": {"rad/s": 1.0, "mrad/s": 1e-3, "deg/s": math.pi / 180.0, "rpm": 2.0 * math.pi / 60.0},
    "force": {"N": 1.0, "kN": 1e3, "MN": 1e6},
    "torque": {"N m": 1.0, "kN m": 1e3, "MN m": 1e6},
}


def squeezed(spelling):
    """Blanks, '*' and the middle dot do not matter; superscripts and the degree sign are spelled out."""
    for old, new in ((" ", ""), ("*", ""), ("\u00b7", ""), ("\u00b2", "^2"), ("\u00b3", "^3"), ("\u00b0", "deg")):
        spelling = spelling.replace(old, new)
    return spelling


def factor_to_si(quantity, spelling):
    """None where the spelling is not one of the quantity's."""
    wanted = squeezed(spelling)
    for known, factor in SPELLINGS[quantity].items():
        if squeezed(known) == wanted:
            return factor
    return None


def quantity_of(spelling):
    for quantity in SPELLINGS:
        if factor_to_si(quantity, spelling) is not None:
            return quantity
    return None


def spellings_of(quantity):
    return ", ".join(SPELLINGS[quantity])
