"""Where messages of a channel, or rows of a table, are missing: one rule for desk, report and import."""

import numpy as np

# Usual steps, chosen: a longer step is a hole. So four in a row that are lost are none, and half a step more is left to times that are not even.
LONGEST_STEP = 5.5
FEWEST_STEPS = 8   # that make one usual
LOOKED_BACK = 64   # [times] whose steps tell what is usual, besides those that come


def is_hole(steps, usual):
    return steps > LONGEST_STEP * usual


class Holes:
    """Of times [s] that come piece by piece: `found`, (last before, first behind) of each hole. Usual is the median of the steps, so that no
    hole makes another one usual. `least` [s]: what is shorter is not kept; `most`: so many are, the newest ones."""

    def __init__(self, least=0.0, most=None):
        self.least, self.most, self.found, self.before = least, most, [], np.zeros(0)

    def add(self, time):
        times = np.concatenate((self.before, time))
        steps = np.diff(times)
        forward = steps[steps > 0]
        if len(forward) >= FEWEST_STEPS:
            new = steps[max(0, len(self.before) - 1):]
            for place in np.flatnonzero(is_hole(new, np.median(forward)) & (new > self.least)) + len(steps) - len(new):
                self.found.append((float(times[place]), float(times[place + 1])))
            if self.most is not None:
                del self.found[:-self.most]
        self.before = times[-LOOKED_BACK:]
