"""Units that a column of measured data may be in: those of the files, as common/unit.cpp has them."""

from core_module import core

# Quantity, as messages name it, and its SI unit.
SI = {"number": "-", "time": "s", "frequency": "Hz", "length": "m", "speed": "m/s", "acceleration": "m/s^2", "angle": "rad",
      "angular speed": "rad/s", "force": "N", "torque": "N m"}
# {quantity: {spelling: factor to SI}}, the SI one first.
SPELLINGS = {quantity: dict(core.spellings(unit)) for quantity, unit in SI.items()}


def factor_to_si(quantity, spelling):
    """None where the spelling is not one of the quantity's. Blanks and signs of multiplication do not matter."""
    try:
        return core.factor(spelling, SI[quantity])
    except ValueError:
        return None


def quantity_of(spelling):
    for quantity in SI:
        if factor_to_si(quantity, spelling) is not None:
            return quantity
    return None


def spellings_of(quantity):
    return ", ".join(SPELLINGS[quantity])
