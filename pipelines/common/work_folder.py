"""Folders for what a driver needs while it runs. A killed driver's are removed when the next one starts or ends."""

import contextlib
import fcntl
import os
import pathlib
import re
import shutil
import stat
import tempfile

_NAME = re.compile(r"polyrecon-[a-z0-9_]+-([0-9]+)-.+")  # polyrecon-KIND-PROCESS-RANDOM


class WorkFolder:
    """A new folder for this user alone, which is locked as long as this process runs. Its name begins with
    polyrecon-KIND."""

    def __init__(self, kind, parent=None):
        self.parent = pathlib.Path(parent or tempfile.gettempdir())
        remove_stale(self.parent)
        self.path = pathlib.Path(tempfile.mkdtemp(prefix=f"polyrecon-{kind}-{os.getpid()}-", dir=self.parent))
        self._descriptor = os.open(self.path, os.O_RDONLY | os.O_DIRECTORY)
        with contextlib.suppress(OSError):  # A file system without locks
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def __enter__(self):
        return self.path

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Removes the folder, and those that a killed driver's renderer has written into since."""
        if self._descriptor is None:
            return
        shutil.rmtree(self.path, ignore_errors=True)
        os.close(self._descriptor)
        self._descriptor = None
        remove_stale(self.parent)


def remove_stale(parent):
    """Removes this user's work folders whose driver has ended."""
    with contextlib.suppress(OSError):
        for entry in os.scandir(parent):
            match = _NAME.fullmatch(entry.name)
            if match and _is_stale(entry, int(match[1])):
                shutil.rmtree(entry, ignore_errors=True)


def _is_stale(entry, process_number):
    """Whether no process has this number, and the folder is not locked by one of another process namespace."""
    try:
        status = entry.stat(follow_symlinks=False)
        if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid():
            return False
        with contextlib.suppress(ProcessLookupError, OverflowError):
            os.kill(process_number, 0)
            return False
        descriptor = os.open(entry, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        finally:
            os.close(descriptor)
        return True
    except OSError:
        return False
