"""Files that appear complete or not at all. Until then they are temporaries in the same folder, with random names of
the same form as the program's: .NAME.polyrecon-HEX"""

import contextlib
import errno
import fcntl
import os
import pathlib
import re
import secrets
import stat
import time

from .errors import DriverError, ExitCode

LONGEST_STEM = 200  # Bytes of NAME, so that a temporary's name is valid wherever NAME is.
STALE_SECONDS = 60  # A younger temporary may belong to a process that runs.
_TEMPORARY = re.compile(r"\.(?P<name>.+)\.polyrecon-[0-9a-f]{16}", re.DOTALL)


def open_regular(path):
    """Opens a regular file to read its bytes. Raises OSError for anything else, such as a pipe, which may never end."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "is not a regular file", os.fspath(path))
    return open(descriptor, "rb")


@contextlib.contextmanager
def replacing(path):
    """A context with the path of a new file, which replaces `path` at its end. A link at `path` is replaced itself, and
    its target is not touched. After an error `path` is what it was. Missing folders are made."""
    path = pathlib.Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_stale(path)
        temporary = path.with_name(f".{_stem(path.name)}.polyrecon-{secrets.token_hex(8)}")
        lock = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666)
    except (OSError, ValueError) as error:
        raise _cannot_write(path, error) from error
    try:
        _try_lock(lock)
        yield temporary
        os.replace(temporary, path)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise _cannot_write(path, error) from error
        raise
    finally:
        os.close(lock)


def write_text(path, text):
    """Replaces the file by `text` in UTF-8."""
    with replacing(path) as temporary, open(temporary, "w", encoding="utf-8", errors="backslashreplace") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())


def remove_temporaries(folder, is_target):
    """Removes the temporaries, of drivers and of the program, of the files in a folder with is_target(name). None of
    them may be in use."""
    for entry in _temporaries(folder):
        if is_target(_TEMPORARY.fullmatch(entry.name)["name"]):
            os.unlink(entry)


def _remove_stale(path):
    """Removes temporaries of `path` that killed processes left."""
    for entry in _temporaries(path.parent):
        if _TEMPORARY.fullmatch(entry.name)["name"] == _stem(path.name) and _is_stale(entry):
            os.unlink(entry)


def _temporaries(folder):
    return [e for e in os.scandir(folder) if _TEMPORARY.fullmatch(e.name) and e.is_file(follow_symlinks=False)]


def _is_stale(entry):
    if time.time() - entry.stat(follow_symlinks=False).st_mtime < STALE_SECONDS:
        return False
    with contextlib.suppress(OSError):
        descriptor = os.open(entry, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        try:
            return _try_lock(descriptor)
        finally:
            os.close(descriptor)
    return False


def _try_lock(descriptor):
    """Locks an open file; returns whether that succeeded. The lock ends with the process."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return True
    except OSError:
        return False


def _stem(name):
    return os.fsdecode(os.fsencode(name)[:LONGEST_STEM])


def _cannot_write(path, error):
    return DriverError(ExitCode.OUTPUT, f"{path}: {getattr(error, 'strerror', None) or error}")
