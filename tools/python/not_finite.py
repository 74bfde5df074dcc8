"""Numbers of a log that are none: infinite, or missing in some messages of a channel. A quantity that is missing in all of them is
not fitted, which is no fault."""

import numpy as np

UNBOUNDED = {("PLANT_STATUS", "bin_edge")}  # the last bin of a histogram has no upper edge


def places(log):
    """[(channel, field, how many messages hold such a number, of how many, time [s] of the first)], in the order of the log's fields."""
    columns = {}
    for stretch in log.stretches():
        for channel, messages in stretch.items():
            for field in messages.dtype.names:
                if messages.dtype[field].base.kind == "f" and (channel, field) not in UNBOUNDED:
                    found = columns.setdefault((channel, field), _Columns())
                    found.add(messages["simulated_time"], messages[field].reshape(len(messages), -1))
    result = []
    for (channel, field), found in columns.items():
        fitted = found.wrong[~found.missing]
        if fitted.any():
            result.append((channel, field, int(fitted.max()), log.tables[channel].rows, float(found.first[~found.missing].min()) / 1e9))
    return result


class _Columns:
    """Of the entries of a field: how often each is no number, since when [ns], and whether it is missing all the time."""

    def __init__(self):
        self.wrong, self.first, self.missing = 0, np.inf, True

    def add(self, stamps, values):
        wrong = ~np.isfinite(values)
        self.missing = self.missing & np.isnan(values).all(axis=0)
        self.wrong = self.wrong + wrong.sum(axis=0)
        self.first = np.minimum(self.first, np.where(wrong.any(axis=0), stamps[wrong.argmax(axis=0)], np.inf))
