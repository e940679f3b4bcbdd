#!/usr/bin/env python3
"""Runs a task of a farm job: denoises the frames of its chunk, and records what they took."""

import os
import pathlib
import re
import socket
import subprocess
import sys
import time

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.farm"

from ..common import process
from ..common.arguments import Parser
from ..common.errors import DriverError, ExitCode, run_main
from ..common.frame_names import frame_path, ranges_text
from ..common.terminal import print_lines
from .job import FRAME_ERROR, RECORDS, Job, write_json


def identities(job, frames):
    """{frame: inode and time of its output}, which change when it is written; None if there is no output."""
    found = {}
    for frame in frames:
        try:
            status = os.stat(frame_path(job.output, frame))
            found[frame] = (status.st_ino, status.st_mtime_ns)
        except OSError:
            found[frame] = None
    return found


def traffic(pid):
    """Bytes that a process has read and written, with those served by the page cache. A zombie process has them too."""
    try:
        lines = pathlib.Path(f"/proc/{pid}/io").read_text().splitlines()
    except OSError:
        return {"bytes_read": 0, "bytes_written": 0}
    counts = dict(line.split(": ") for line in lines)
    return {"bytes_read": int(counts["rchar"]), "bytes_written": int(counts["wchar"])}


def run_counted(words):
    """Runs a command to its end. Returns its exit code, and a dict of what it took and its errors of single frames."""
    begun = time.time()
    child = process.start(words, stderr=subprocess.PIPE)
    try:
        frame_errors = {}
        for line in map(process.decoded, child.stderr):
            line = line.removesuffix("\n")
            print_lines(line, file=sys.stderr)
            if match := FRAME_ERROR.match(line):
                frame_errors[match[1]] = match[2]
        os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
        counts = traffic(child.pid)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    except BaseException:
        process.stop(child)
        raise
    finally:
        child.stderr.close()
    counts.update(
        seconds=time.time() - begun,
        cpu_seconds=usage.ru_utime + usage.ru_stime,
        peak_bytes=usage.ru_maxrss * 1024,
        exit_code=child.returncode,
        frame_errors=frame_errors,
    )
    return child.returncode, counts


def attempt_name(index):
    """The file name of this run's record. A requeued task keeps the record of its first run."""
    job, restart = os.environ.get("SLURM_JOB_ID", str(os.getpid())), os.environ.get("SLURM_RESTART_COUNT", "0")
    return f"{index}.{job}.{restart}.json"


def run_chunk(folder, index):
    job = Job.load(folder)
    if not 0 <= index < len(job.chunks):
        raise DriverError(ExitCode.USAGE, f"{folder}: has no chunk {index}, only 0 to {len(job.chunks) - 1}")
    frames = job.chunks[index]
    path = pathlib.Path(folder) / RECORDS / attempt_name(index)
    node = os.environ.get("SLURMD_NODENAME") or socket.gethostname()
    record = {"chunk": index, "frames": ranges_text(frames), "node": node, "begun": time.time()}
    write_json(path, record)
    before = identities(job, frames)
    code, counts = run_counted(job.words(frames, "--progress", "none"))
    after = identities(job, frames)
    written = [frame for frame in frames if after[frame] and after[frame] != before[frame]]
    write_json(path, {**record, **counts, "written": ranges_text(written)})
    if code:
        known = code in ExitCode.__members__.values()
        raise DriverError(code if known else ExitCode.INTERNAL, f"frames {ranges_text(frames)}: ended with {code}")


def main(words=None):
    def work(words):
        parser = Parser("polyrecon-farm task", description=__doc__)
        parser.add_argument("folder", help="folder of the job")
        parser.add_argument("index", nargs="?", help="number of the chunk, from 0 (default: $SLURM_ARRAY_TASK_ID)")
        options = parser.parse_args(words)
        index = options.index if options.index is not None else os.environ.get("SLURM_ARRAY_TASK_ID", "")
        if not re.fullmatch("[0-9]{1,9}", str(index)):
            parser.error("the number of the chunk is missing, or is none")
        run_chunk(options.folder, int(index))

    return run_main("polyrecon-farm", work, words)


if __name__ == "__main__":
    sys.exit(main())
