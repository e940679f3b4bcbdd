"""SHA-256 of files, by which a resumed run recognises its inputs and its own passes."""

import hashlib

from .errors import DriverError, ExitCode
from .files import open_regular

CHUNK = 1 << 20


def digest(path):
    """The SHA-256 of a file's content, in hexadecimal. Raises OSError."""
    found = hashlib.sha256()
    with open_regular(path) as file:
        while chunk := file.read(CHUNK):
            found.update(chunk)
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
