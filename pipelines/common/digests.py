"""SHA-256 of files, by which a resumed run recognises its inputs and its own passes."""

import concurrent.futures
import hashlib
import os

from .errors import DriverError, ExitCode
from .files import open_regular

CHUNK = 1 << 20
THREADS = 4
# Bytes of a frame's inputs that are read. Of the largest files beyond it, such as the caches of long simulations, the
# times of their last changes stand for the content.
CONTENT_LIMIT = 4 << 30


def digest(path):
    """The SHA-256 of a file's content, in hexadecimal. Raises OSError."""
    found = hashlib.sha256()
    with open_regular(path) as file:
        left = os.fstat(file.fileno()).st_size  # Files of the kernel may have no end.
        while left > 0 and (chunk := file.read(min(left, CHUNK))):
            found.update(chunk)
            left -= len(chunk)
    return found.hexdigest()


def check(path, expected):
    """Raises DriverError where the file is gone or is not the one with this SHA-256."""
    try:
        found = digest(path)
    except FileNotFoundError as error:
        raise DriverError(
            ExitCode.MISSING, f"{path}: the journal names it, but it is gone: start again with another --passes-dir"
        ) from error
    except OSError as error:
        found = error.strerror
    if found != expected:
        raise DriverError(
            ExitCode.BAD_INPUT, f"{path}: is not the file that the journal names: start again with another --passes-dir"
        )


class InputDigests:
    """Digests of inputs. A file is read again only if the system says that it has changed."""

    def __init__(self):
        self._known = {}  # (file, status, whether its content is read): digest

    def of(self, inputs):
        """{name: digest} of {name: files and folders}. What cannot be read has a digest too, which says why."""
        files = {name: [file for path in paths for file in _files(path)] for name, paths in inputs.items()}
        statuses = {file: _status(file) for found in files.values() for file in found}
        wanted, left = [], CONTENT_LIMIT
        for file, status in sorted(statuses.items(), key=lambda item: (item[1][0], item[0])):
            left -= status[0]
            wanted.append((file, status, left >= 0))
        with concurrent.futures.ThreadPoolExecutor(THREADS) as pool:
            digests = dict(pool.map(self._digest, wanted))
        return {name: _joined(name, found, digests) for name, found in files.items()}

    def _digest(self, key):
        file, status, whole = key
        if key not in self._known:
            try:
                self._known[key] = digest(file) if whole else " ".join(map(str, status))
            except OSError as error:
                self._known[key] = error.strerror
        return file, self._known[key]


def changed_at(path):
    """When the file was last changed, in nanoseconds; 0 if there is none. No program can set this time back."""
    return _status(path)[-1]


def _files(path):
    """The file itself, or the files in a folder."""
    if not os.path.isdir(path):
        return [path]
    return [entry.path for entry in os.scandir(path) if entry.is_file()]


def _status(path):
    """Size, inode and times of a file. Zeros if there is none."""
    try:
        status = os.stat(path)
    except OSError:
        return (0, 0, 0, 0)
    return (status.st_size, status.st_ino, status.st_mtime_ns, status.st_ctime_ns)


def _joined(name, files, digests):
    """The digest of one file, or of the names and digests of several."""
    if files == [name]:
        return digests[name]
    lines = "".join(f"{os.path.relpath(file, name)}\0{digests[file]}\n" for file in sorted(files))
    return hashlib.sha256(lines.encode("utf-8", "surrogateescape")).hexdigest()
