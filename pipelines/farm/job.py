"""The description of a job, which all its tasks read: a JSON file in the job's folder."""

import dataclasses
import errno
import json
import os
import pathlib
import re
from dataclasses import dataclass, field

from ..common.decode import InvalidFileError, decode, read_json
from ..common.errors import DriverError, ExitCode
from ..common.files import write_text
from ..common.frame_names import is_pattern, ranges_text

JOB_FILE = "job.json"
RECORDS = "records"
REPORT_FILE = "report.json"
FRAME_ERROR = re.compile(r"polyrecon: frame (-?\d+): (.*)")  # the program's line about one frame


def chunks(frames, size):
    """The frames in groups of `size`, in order."""
    return [frames[k : k + size] for k in range(0, len(frames), size)]


@dataclass
class Job:
    input: str  # absolute pattern of the renders
    output: str  # absolute pattern of the results
    frames: list[int]
    polyrecon: str  # path of the program
    options: list[str] = field(default_factory=list)  # further options of `polyrecon denoise`
    chunk: int = 1  # frames of a task
    threads: int = 0  # of a task; 0: the program's default
    memory: int = 0  # --max-memory in bytes; 0: the program's default
    request: int = 0  # bytes that the engine reserves for a task

    @property
    def chunks(self):
        return chunks(self.frames, self.chunk)

    def words(self, frames, *more):
        """The command that denoises those of these frames that are not finished."""
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
        if not path.exists():
            raise DriverError(ExitCode.MISSING, f"{path}: {os.strerror(errno.ENOENT)}")
        try:
            job = decode(cls, read_json(path), lowest=-(2**31))
            if not is_pattern(job.input) or not is_pattern(job.output):
                raise InvalidFileError("a name has no place for the frame's number")
            if not job.frames or job.chunk < 1 or min(job.threads, job.memory, job.request) < 0:
                raise InvalidFileError("a number is out of range")
        except InvalidFileError as error:
            raise DriverError(ExitCode.BAD_INPUT, f"{path}: is not the description of a job ({error})") from error
        return job


def write_json(path, value):
    """Writes a JSON file, and its folder if that is missing. The file appears complete or not at all."""
    path = pathlib.Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DriverError(ExitCode.OUTPUT, f"{path.parent}: {error.strerror}") from error
    write_text(path, json.dumps(value, indent=1))
