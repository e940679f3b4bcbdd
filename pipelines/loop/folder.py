"""Names of the files in a frame's folder of passes."""

import dataclasses
import pathlib

from ..common.errors import DriverError, ExitCode


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

    def create(self):
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise DriverError(ExitCode.OUTPUT, f"{self.path}: {error.strerror}") from error

    def create_round(self, number):
        folder = self.path / f"round_{number}"
        try:
            folder.mkdir(exist_ok=True)
        except OSError as error:
            raise DriverError(ExitCode.OUTPUT, f"{folder}: {error.strerror}") from error

    def remove_unfinished_files(self):
        """Removes what a killed run was writing: a file is hidden until it is whole."""
        for pattern in (".*.exr", ".*.new"):
            for unfinished in self.path.rglob(pattern):
                unfinished.unlink()
