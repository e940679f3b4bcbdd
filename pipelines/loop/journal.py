"""What a frame's loop has done, in a file that is whole at any moment: a killed loop goes on from it."""

import json
import os
import pathlib

from ..common.errors import DriverError, ExitCode

VERSION = 4


class Journal:
    """journal.json in a frame's folder of passes:
      identity  what the passes are of: another scene, frame or setting may not go on with them
      seconds   spent so far, over all runs
      first_parts  how many the first pass is cut into
      next      first number of the sequence that is free
      parts     [{file, half, round, first, spp, seconds}] whole files, in the order they were rendered
      rounds    [{round, spp, seconds, error, extra}] what was known after each round, and the samples per pixel that follow
      plan      {round, first: {a, b}, parts, before, worth} the round being rendered; its counts are in files
    A part is entered after its file has its name, so a part that is not here was never counted; its numbers of the sequence
    are drawn again, for the same part."""

    def __init__(self, folder, identity):
        self.path = pathlib.Path(folder) / "journal.json"
        self.data = {"version": VERSION, "identity": identity, "seconds": 0.0, "first_parts": 0, "next": 0}
        self.data |= {"parts": [], "rounds": [], "plan": None}

    @classmethod
    def open(cls, folder, identity, resume):
        """A new journal, or with `resume` the one that is there. Passes of an earlier run are never overwritten unasked."""
        journal = cls(folder, identity)
        if not journal.path.exists():
            return journal
        if not resume:
            raise DriverError(
                ExitCode.USAGE,
                f"{journal.path}: passes of an earlier run: --resume goes on with them, or choose another --passes-dir",
            )
        try:
            data = json.loads(journal.path.read_text(encoding="utf-8"))
            version, found = data["version"], data["identity"]
        except (ValueError, KeyError, TypeError) as error:
            raise DriverError(ExitCode.BAD_INPUT, f"{journal.path}: no journal: {error}") from error
        if version != VERSION:
            raise DriverError(ExitCode.BAD_INPUT, f"{journal.path}: of another version of this program")
        for key in sorted(identity.keys() | found.keys()):
            if found.get(key) != identity.get(key):
                raise DriverError(
                    ExitCode.USAGE, f"{journal.path}: cannot go on, {key} was {found.get(key)}, is {identity.get(key)}"
                )
        for part in data["parts"]:
            if not (journal.path.parent / part["file"]).exists():
                raise DriverError(ExitCode.MISSING, f"{journal.path.parent / part['file']}: the journal's part is gone")
        journal.data = data
        return journal

    def __getitem__(self, key):
        return self.data[key]

    def __setitem__(self, key, value):
        self.data[key] = value

    def save(self):
        temporary = self.path.with_suffix(".new")
        try:
            with open(temporary, "w", encoding="utf-8") as file:
                json.dump(self.data, file, indent=1)
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, self.path)
        except OSError as error:
            raise DriverError(ExitCode.OUTPUT, f"{self.path}: {error.strerror}") from error

    def files(self, half):
        return [self.path.parent / part["file"] for part in self["parts"] if part["half"] == half]

    def has(self, round_number, half, index=0):
        done = [p for p in self["parts"] if p["round"] == round_number and p["half"] == half]
        return len(done) > index
