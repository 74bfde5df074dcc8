"""Whether what an import reads can be the machine's that its map names: a slip of unit makes a signal a thousand times too large or too
small, and shows in nothing but its range."""

import math

from unit import SPELLINGS, factor_to_si, quantity_of

MOST = 5.0     # times what the machine can do, chosen: no machine does, and rpm for rad/s are 9.5 times
LEAST = 1e-3   # of that, chosen: a machine that moves at all, and what m for mm leaves
LEAST_TRAVEL = 3e-4  # of what it could travel, chosen: a small move in a long record is one
FITS = (1e-2, 1.2)   # of what it can do, chosen: where the numbers of a unit that fits lie
TRAVELS = ("shaft_position", "slew_angle")
REFERENCES = {"shaft_position": "travel at top speed all the time", "shaft_speed": "top speed", "motor_torque": "largest torque", "slew_angle": "travel at top speed all the time"}


def capability(name, machine, duration):
    """What the machine can do at most, in the signal's unit on the wire; None where its file does not say."""
    return {"shaft_position": machine.top_speed * abs(machine.gear) * duration, "shaft_speed": machine.top_speed * abs(machine.gear),
            "motor_torque": machine.largest_torque, "slew_angle": machine.top_speed * duration}.get(name)


def fitting(unit, share):
    """The units of the column's quantity in which its numbers would be the machine's, the smallest first. `share`: of what it can do."""
    quantity = quantity_of(unit)
    factor = factor_to_si(quantity, unit)
    # Of spellings of one factor the first: N m and Nm are one unit.
    shares = {other: share * each / factor for other, each in reversed(SPELLINGS[quantity].items())}
    by_share = {round(math.log10(each), 9): other for other, each in shares.items() if FITS[0] <= each <= FITS[1]}
    return [by_share[key] for key in sorted(by_share)]


def warnings(mapping, ranges, duration):
    """{signal's name: what is to be said of it} of those that this machine cannot have had. `ranges`: {(field, group): (low, high)},
    `duration` [s] of the data."""
    said = {}
    for name, entries in mapping.signals.items() if mapping.machine else ():
        most = capability(name, mapping.machine, duration)
        for group, entry in enumerate(entries):
            if not most or entry.column is None:
                continue
            low, high = ranges[name, group]
            size = high - low if name in TRAVELS else max(abs(low), abs(high))
            share = size / most
            if size == 0.0 or (LEAST_TRAVEL if name in TRAVELS else LEAST) < share <= MOST:
                continue
            units = fitting(entry.column_unit, share)
            fits = f"{' or '.join(units)} would fit" if units else "no other unit of it would fit: look at scale, ratio and the machine's file"
            how = f"{share:.3g} times" if share > MOST else f"only {share:.2g} of"
            said[entry.name] = (f"column '{entry.column}' in {entry.column_unit}: {size:.3g} {entry.unit}, {how} the machine's {REFERENCES[name]} "
                                f"({most:.3g} {entry.unit}); {fits}")
    return said
