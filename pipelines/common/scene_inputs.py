"""The files that the pictures of a scene depend on."""

from .digests import InputDigests, changed_at
from .errors import DriverError, ExitCode


class SceneInputs:
    """Raises DriverError where a file changes so that samples of two scenes would be averaged.

    What a process of a renderer reads once, when it opens the scene, may change later, until a new process opens it.
    The rest is read at any time."""

    def __init__(self):
        self._digests = InputDigests()
        self._opened, self._used, self._used_files = {}, {}, {}

    def opened(self, files, begin):
        """Takes the files that a new process has opened since `begin`, in nanoseconds of the system's clock."""
        found = self._digests.of({path: [path] for path in files})
        _compare(self._opened or found, found)
        for path in files:
            if changed_at(path) > begin:
                raise _changed(path)
        self._opened = found

    def begin_frame(self, used):
        """Takes {name: files and folders} that a frame reads; returns the digests of all its inputs."""
        self._used_files, self._used = used, self._digests.of(used)
        return {**self._opened, **self._used}

    def check(self):
        """Checks that what the frame reads is still what it was at its beginning."""
        _compare(self._used, self._digests.of(self._used_files))


def _compare(before, now):
    for path in sorted(before.keys() | now.keys()):
        if before.get(path) != now.get(path):
            raise _changed(path)


def _changed(path):
    return DriverError(
        ExitCode.RENDERER, f"{path}: changed while it was rendered: restore it and add --resume, or start again"
    )
