"""A folder that belongs to the drivers: no file of anyone else is overwritten or removed in it, and one driver at a
time works in it."""

import contextlib
import errno
import fcntl
import json
import os
import pathlib
import resource
import socket
import stat

from .errors import DriverError, ExitCode

LOCK = "polyrecon.lock"  # Stays in the folder; empty while no driver works there.
OTHER_FILES = 256  # Open files that a driver needs in addition to locks


def allow_many(count):
    """Raises this process's limit of open files, so that it can hold so many folders; each has an open lock file."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    needed = count + OTHER_FILES
    if soft == resource.RLIM_INFINITY or needed <= soft:
        return
    if hard != resource.RLIM_INFINITY and needed > hard:
        raise DriverError(
            ExitCode.USAGE,
            f"{count} frames need {needed} open files and the limit (ulimit -Hn) is {hard}: give fewer --frames",
        )
    resource.setrlimit(resource.RLIMIT_NOFILE, (needed, hard))


@contextlib.contextmanager
def claimed(folder, sign=LOCK):
    """A context in which this process alone works in the folder, which is made if it is missing.

    A folder that has files but neither a lock nor the file `sign` is someone else's, and is refused."""
    folder = pathlib.Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        names = os.listdir(folder)
        if names and not {LOCK, sign} & set(names):
            raise DriverError(
                ExitCode.USAGE,
                f"{folder}: is not empty and holds no passes of a driver: choose another --passes-dir",
            )
        descriptor = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode) or status.st_nlink > 1:  # Locking empties the file, under all its names.
            os.close(descriptor)
            raise OSError(errno.EINVAL, "is not a regular file with one name", str(folder / LOCK))
    except OSError as error:
        raise DriverError(ExitCode.OUTPUT, f"{error.filename or folder}: {error.strerror}") from error
    try:
        _lock(folder, descriptor)
        try:
            _refuse_links(folder)
            yield
        finally:
            os.ftruncate(descriptor, 0)
    finally:
        os.close(descriptor)


def _lock(folder, descriptor):
    """Locks the open lock file. The kernel's lock ends with the process, so a killed driver's is taken over. Where the
    file system has none, and for drivers on other machines, the file says who holds it."""
    holder = _holder(descriptor)
    here = {"host": socket.gethostname(), "pid": os.getpid()}
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        held = holder.get("host", here["host"]) != here["host"]
    except BlockingIOError:
        raise _in_use(folder, holder) from None
    except OSError:
        held = holder and (holder.get("host") != here["host"] or _runs(holder.get("pid")))
    if held:
        raise _in_use(folder, holder, f", if that has ended remove {LOCK}")
    os.ftruncate(descriptor, 0)
    os.pwrite(descriptor, json.dumps(here).encode(), 0)


def _holder(descriptor):
    """Host and process in a lock file; {} where there are none."""
    try:
        content = json.loads(os.pread(descriptor, 4096, 0))
    except (ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def _in_use(folder, holder, advice=""):
    who = f"process {holder.get('pid')} on {holder.get('host')}" if holder else "another driver"
    return DriverError(
        ExitCode.USAGE, f"{folder}: {who} works in it: wait for its end{advice}, or choose another --passes-dir"
    )


def _runs(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, TypeError, OverflowError):
        return True
    return True


def _refuse_links(folder):
    """A file that is written under the name of a link would replace the link's target."""
    for parent in (folder, *(entry for entry in os.scandir(folder) if entry.is_dir(follow_symlinks=False))):
        for entry in list(os.scandir(parent)):
            if entry.is_symlink():
                raise DriverError(ExitCode.USAGE, f"{entry.path}: is a link: remove it, or choose another --passes-dir")
