"""Columns of numbers on disk, written once and read a stretch at a time: data may be larger than memory."""

import contextlib
import os
import tempfile

import numpy as np

STRETCH = 100_000  # [rows] that are worked on together


class NoRoom(Exception):
    """Columns cannot be kept; the text is the system's reason."""


class Shelf(contextlib.ExitStack):
    """Where columns are kept: files in `folder` without a name, so that nothing of them stays, whatever happens."""

    def __init__(self, folder):
        super().__init__()
        self.folder = folder

    def column(self, kind=float):
        try:
            return Column(self.enter_context(tempfile.TemporaryFile(dir=self.folder, buffering=0)), kind)
        except OSError as error:
            raise NoRoom(error.strerror) from error


class Column:
    """Appended to first, read then."""

    def __init__(self, file, kind):
        self.file, self.kind, self.rows = file, np.dtype(kind), 0

    def append(self, values):
        rest = np.ascontiguousarray(values, self.kind).view(np.uint8)
        self.rows += len(values)
        try:
            while len(rest):
                rest = rest[self.file.write(rest):]
        except OSError as error:
            raise NoRoom(error.strerror) from error

    def __len__(self):
        return self.rows

    def read(self, begin=0, end=None):
        """The rows from `begin` to `end`, those of them that there are."""
        begin, end = max(begin, 0), self.rows if end is None else min(end, self.rows)
        values = np.empty(max(end - begin, 0), self.kind)
        rest, place = values.view(np.uint8), begin * self.kind.itemsize
        while len(rest):
            got = os.preadv(self.file.fileno(), [rest], place)
            if got == 0:
                raise OSError("a column on disk became shorter")
            rest, place = rest[got:], place + got
        return values

    def __getitem__(self, row):
        """One number; as in a list, so that bisect searches in it."""
        if not -self.rows <= row < self.rows:
            raise IndexError(row)
        row %= self.rows
        return self.read(row, row + 1)[0]

    def stretches(self, before=0):
        """(first row, rows): all of them, each stretch with up to `before` rows of the one in front of it."""
        for begin in range(0, self.rows, STRETCH):
            yield begin, self.read(begin - before, begin + STRETCH)


def median_of_steps(column):
    """The median of the distances from row to row, which must be positive: by their bits, which rise as such numbers do, sixteen
    at a time."""
    count = len(column) - 1

    def ranked(rank):
        known = 0
        for shift in (48, 32, 16, 0):
            counts = np.zeros(1 << 16, np.int64)
            for _, rows in column.stretches(before=1):
                bits = np.diff(rows).view(np.uint64)
                if shift < 48:
                    bits = bits[bits >> np.uint64(shift + 16) == known]
                counts += np.bincount((bits >> np.uint64(shift) & np.uint64(0xFFFF)).astype(np.intp), minlength=1 << 16)
            up_to = np.cumsum(counts)
            digit = int(np.searchsorted(up_to, rank, side="right"))
            rank -= int(up_to[digit] - counts[digit])
            known = known << 16 | digit
        return np.uint64(known).view(float)

    return float(np.mean([ranked((count - 1) // 2), ranked(count // 2)]))
