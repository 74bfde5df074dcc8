"""Files and folders that appear when they are complete, or not at all."""

import contextlib
import errno
import itertools
import os
import shutil
from pathlib import Path


def _remove(path):
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def is_free(path, beginning):
    """Whether a file may be written there: there is none, an empty one, or one that begins as an earlier one of its kind does."""
    path = Path(path)
    if not path.is_file() or path.stat().st_size == 0:
        return True
    with path.open("rb") as stream:
        return stream.read(len(beginning)) == beginning


def next_folder(out, stem=""):
    """The first of OUT/STEM1, STEM2, ... that is not there yet."""
    return next(folder for number in itertools.count(1) if not (folder := Path(out) / f"{stem}{number}").exists())


@contextlib.contextmanager
def growing(path):
    """The name under which to write what shall be called `path`: a file, or a folder, in place of an older one. It gets
    its own name at the end (a folder's is no file's); after an exception nothing of it is left. An OSError (a full disk) names `path`."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    _remove(partial)
    try:
        yield partial
        if path.is_dir() and not partial.is_dir():  # a user's folder does not go for a file
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if path.is_dir():
            shutil.rmtree(path)
        os.replace(partial, path)
    except OSError as error:
        _remove(partial)
        raise OSError(f"cannot write {path}: {error.strerror or error}") from error
    except BaseException:
        _remove(partial)
        raise
