"""Names of the files in a frame's folder of passes."""

import contextlib
import dataclasses
import pathlib
import re
import shutil

from ..common import folder_lock
from ..common.errors import DriverError, ExitCode
from ..common.files import remove_temporaries

_FILE = re.compile(r"part_[0-9]+[ab][0-9]+\.exr|(?:merged|clean|error)\.exr|journal\.json|report\.html")
_ROUND = re.compile(r"round_[0-9]+")


@dataclasses.dataclass(frozen=True)
class PassFolder:
    """README.md lists what each file holds."""

    path: pathlib.Path

    @property
    def journal(self):
        return self.path / "journal.json"

    @property
    def merged(self):
        return self.path / "merged.exr"

    @property
    def clean(self):
        """The result before it is delivered."""
        return self.path / "clean.exr"

    @property
    def error_map(self):
        return self.path / "error.exr"

    @property
    def report(self):
        return self.path / "report.html"

    def part(self, round_number, half, index):
        return self.path / f"part_{round_number}{half}{index}.exr"

    def in_round(self, number, name):
        """A file that belongs to one round. Writers call create_round before."""
        return self.path / f"round_{number}" / f"{name}.exr"

    @contextlib.contextmanager
    def claimed(self):
        """A context in which this process alone works in the folder. What a killed run was writing is removed first."""
        with folder_lock.claimed(self.path, sign=self.journal.name):
            remove_temporaries(self.path, _FILE.fullmatch)
            for entry in self.path.iterdir():
                if _ROUND.fullmatch(entry.name) and entry.is_dir():
                    remove_temporaries(entry, lambda name: name.endswith(".exr"))
            yield

    @property
    def size(self):
        """Bytes of all files in it."""
        return sum(path.stat().st_size for path in self.path.rglob("*") if path.is_file())

    def remove(self):
        """Removes the files of the loop, and the folder if nothing else is in it."""
        for entry in self.path.iterdir():
            if _ROUND.fullmatch(entry.name):
                shutil.rmtree(entry)
            elif _FILE.fullmatch(entry.name) or entry.name == folder_lock.LOCK:
                entry.unlink()
        with contextlib.suppress(OSError):
            self.path.rmdir()

    def create_round(self, number):
        folder = self.path / f"round_{number}"
        try:
            folder.mkdir(exist_ok=True)
        except OSError as error:
            raise DriverError(ExitCode.OUTPUT, f"{folder}: {error.strerror}") from error
