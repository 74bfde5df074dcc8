"""Files and folders that appear when they are complete, or not at all."""

import contextlib
import os
import shutil
from pathlib import Path


def _remove(path):
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


@contextlib.contextmanager
def growing(path):
    """The name under which to write what shall be called `path`: a file, or a folder, in place of an older one. It gets
    its own name at the end; after an exception nothing of it is left. An OSError (a full disk) names `path`."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    _remove(partial)
    try:
        yield partial
        if path.is_dir():
            shutil.rmtree(path)
        os.replace(partial, path)
    except OSError as error:
        _remove(partial)
        raise OSError(f"cannot write {path}: {error.strerror or error}") from error
    except BaseException:
        _remove(partial)
        raise
