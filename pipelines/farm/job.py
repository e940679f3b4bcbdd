"""The description of a job that all its tasks read: one JSON file in the job's folder."""

import dataclasses
import json
import os
import pathlib
import re
import tempfile
from dataclasses import dataclass, field

from ..common.errors import DriverError, ExitCode
from ..common.frame_names import ranges_text

JOB_FILE = "job.json"
RECORDS = "records"
REPORT_FILE = "report.json"
COMPLAINT = re.compile(r"polyrecon: frame (-?\d+): (.*)")  # of one frame, by the program


def chunks(frames, size):
    """The frames in groups of `size`, in order."""
    return [frames[k : k + size] for k in range(0, len(frames), size)]


@dataclass
class Job:
    input: str  # pattern, absolute
    output: str  # pattern, absolute
    frames: list
    polyrecon: str  # the program
    options: list = field(default_factory=list)  # further words of `polyrecon denoise`
    chunk: int = 1  # frames of a task
    threads: int = 0
    memory: int = 0  # the program's --max-memory, bytes; 0: its own default
    request: int = 0  # bytes that each task was given

    @property
    def chunks(self):
        return chunks(self.frames, self.chunk)

    def words(self, frames, *more):
        """The command that denoises these frames, those that are finished already left out."""
        words = [self.polyrecon, "denoise", "-i", self.input, "-o", self.output]
        words += ["--frames", ranges_text(frames), "--skip-existing"]
        if self.threads:
            words += ["--threads", str(self.threads)]
        if self.memory:
            words += ["--max-memory", str(self.memory)]
        return [*words, *self.options, *more]

    def save(self, folder):
        write_json(pathlib.Path(folder) / JOB_FILE, dataclasses.asdict(self))

    @classmethod
    def load(cls, folder):
        path = pathlib.Path(folder) / JOB_FILE
        try:
            return cls(**json.loads(path.read_text()))
        except OSError as error:
            raise DriverError(ExitCode.MISSING, f"{path}: {error.strerror}") from error
        except (ValueError, TypeError) as error:
            raise DriverError(ExitCode.BAD_INPUT, f"{path}: not the file of a job ({error})") from error


def write_json(path, value):
    """The file appears whole or not at all."""
    path = pathlib.Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        with os.fdopen(handle, "w") as file:
            json.dump(value, file, indent=1)
        os.replace(temporary, path)
    except OSError as error:
        raise DriverError(ExitCode.OUTPUT, f"{path}: {error.strerror}") from error
