"""Text files that appear complete or not at all."""

import os
import pathlib
import secrets

from .errors import DriverError, ExitCode


def write_text(path, text):
    """Replaces the file by `text` in UTF-8. A crash leaves either the old file or the new one, and may leave a hidden
    file .NAME.*.new next to it."""
    path = pathlib.Path(path)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.new")
    try:
        with open(temporary, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        raise DriverError(ExitCode.OUTPUT, f"{path}: {error.strerror}") from error
