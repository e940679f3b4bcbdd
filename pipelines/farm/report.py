#!/usr/bin/env python3
"""Checks every frame of a job: which are finished, and what they took."""

import collections
import concurrent.futures
import dataclasses
import html
import json
import math
import pathlib
import re
import shlex
import sys

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.farm"

from ..common import process
from ..common.arguments import Parser, add_program, add_verbosity
from ..common.decode import InvalidFileError, decode, read_json
from ..common.errors import DriverError, ExitCode, run_main
from ..common.files import write_text
from ..common.frame_names import frame_path, parse_ranges, ranges_text
from ..common.polyrecon_cli import Polyrecon, find_polyrecon
from ..common.terminal import print_lines, printable, quiet_or_print, size_text
from ..common.work_folder import WorkFolder
from .job import FRAME_ERROR, RECORDS, REPORT_FILE, Job, chunks, write_json
from .job_options import pattern
from .submission import counted

EXAMPLES = """\
examples:
  %(prog)s out/polyrecon_farm/shot                 # folder of a job, at any time
  %(prog)s -i shot.####.exr -o out/shot.####.exr --frames 1-100 -- --quality best
"""
PAGE_FRAMES = 24  # in a page: at half their size, input and result of as many HD frames stay below view's --max-size
FINISHED = re.compile(r"frame (-?\d+): .*, finished already: skipped")


@dataclasses.dataclass
class Attempt:
    """The record of a task that has begun."""

    chunk: int
    frames: str
    node: str
    begun: float


@dataclasses.dataclass
class EndedAttempt(Attempt):
    """The record of a task that has ended."""

    seconds: float
    cpu_seconds: float
    peak_bytes: int
    bytes_read: int
    bytes_written: int
    exit_code: int
    frame_errors: dict[str, str]
    written: str


def check(job, frames):
    """Checks frames with the program: a finished output decodes to its last byte, and comes from this input and these
    settings. Returns (finished frames, {frame: problem of its input})."""
    code, output, errors = process.run(job.words(frames, "--dry-run"))
    if code not in (ExitCode.DONE, ExitCode.MISSING):
        raise DriverError(ExitCode.CHECK, f"frames {ranges_text(frames)}: {errors.strip() or f'ended with {code}'}")
    finished = {int(match[1]) for line in process.lines_of(output) if (match := FINISHED.fullmatch(line))}
    return finished, {
        int(match[1]): match[2] for line in process.lines_of(errors) if (match := FRAME_ERROR.match(line))
    }


def check_all(job, processes, done):
    """Checks all frames of the job in several processes; calls done(frames checked so far)."""
    size = min(50, max(1, math.ceil(len(job.frames) / processes)))
    finished, problems, checked = set(), {}, 0
    with concurrent.futures.ThreadPoolExecutor(processes) as pool:
        groups = chunks(job.frames, size)
        for group, (some, their_problems) in zip(groups, pool.map(lambda group: check(job, group), groups)):
            finished |= some
            problems.update(their_problems)
            checked += len(group)
            done(checked)
    return finished, problems


def records_of(folder):
    """The records of the tasks, in order of time. The record of a task that runs or was killed has no end."""
    records = []
    for path in pathlib.Path(folder, RECORDS).glob("*.json"):
        try:
            records.append(checked_record(read_json(path)))
        except (InvalidFileError, DriverError, ValueError):
            continue
    return sorted(records, key=lambda record: record["begun"])


def checked_record(record):
    """The record, if it is one. Raises InvalidFileError, or the error of a text in it."""
    ended = isinstance(record, dict) and "exit_code" in record
    decode(EndedAttempt if ended else Attempt, record, lowest=-255)
    if ended:
        frames_in(record["written"])
        list(map(int, record["frame_errors"]))
    return record


def frames_in(text):
    return len(parse_ranges(text)) if text else 0


def nodes_of(ended):
    """{node: its tasks, their frames and seconds, and the frames per hour of one task}"""
    nodes = collections.defaultdict(lambda: {"tasks": 0, "frames": 0, "seconds": 0.0, "cpu_seconds": 0.0})
    for record in ended:
        node = nodes[record["node"]]
        node["tasks"] += 1
        node["frames"] += frames_in(record["written"])
        node["seconds"] += record["seconds"]
        node["cpu_seconds"] += record["cpu_seconds"]
    for node in nodes.values():
        node["frames_per_hour"] = 3600 * node["frames"] / node["seconds"] if node["seconds"] else 0.0
    return dict(nodes)


def summary(job, finished, problems, records):
    ended = [record for record in records if "exit_code" in record]
    unfinished = [frame for frame in job.frames if frame not in finished]
    for record in ended:  # Problems of the pixels are not known before a task reads them.
        problems = {**problems, **{int(frame): text for frame, text in record["frame_errors"].items()}}
    written = sum(frames_in(record["written"]) for record in ended)
    return {
        "frames": len(job.frames),
        "finished": len(job.frames) - len(unfinished),
        "unfinished": ranges_text(unfinished),
        "reasons": {str(frame): problems[frame] for frame in unfinished if frame in problems},
        "attempts": len(records),
        "attempts_without_end": [f"{r['node']}: {r['frames']}" for r in records if "exit_code" not in r],
        "failed_attempts": [f"{r['node']}: {r['frames']}: {r['exit_code']}" for r in ended if r["exit_code"]],
        "nodes": nodes_of(ended),
        "seconds": max((r["begun"] + r["seconds"] for r in ended), default=0)
        - min((r["begun"] for r in ended), default=0),
        "peak_bytes": max((r["peak_bytes"] for r in ended), default=0),
        "bytes_requested": job.request,
        "bytes_read_per_frame": sum(r["bytes_read"] for r in ended) / written if written else 0,
        "bytes_written_per_frame": sum(r["bytes_written"] for r in ended) / written if written else 0,
    }


def lines_of(found):
    """The report for the terminal. No line begins with a text of a file, which might be an openjd_ command."""
    lines = [f"{found['finished']} of {found['frames']} frames are finished"]
    if found["unfinished"]:
        lines.append(f"not finished: {found['unfinished']}; submitting again denoises what is missing")
    lines += [f"frame {frame}: {why}" for frame, why in found["reasons"].items()]
    for name, node in sorted(found["nodes"].items()):
        done = f"{counted(node['frames'], 'frame')} by {counted(node['tasks'], 'task')}"
        lines.append(
            f"node {name}: {done}, {node['seconds']:.0f} s ({node['cpu_seconds']:.0f} s of processors), "
            f"{node['frames_per_hour']:.0f} frames an hour and task"
        )
    lines += [f"no end, the node died or still works on it: {attempt}" for attempt in found["attempts_without_end"]]
    lines += [f"an attempt failed (node, frames, exit code): {attempt}" for attempt in found["failed_attempts"]]
    if found["peak_bytes"]:
        requested = f", of {size_text(found['bytes_requested'])} requested" if found["bytes_requested"] else ""
        lines.append(f"most memory of a task: {size_text(found['peak_bytes'])}{requested}")
        read, written = (size_text(found[f"bytes_{what}_per_frame"]) for what in ("read", "written"))
        lines.append(f"a frame read {read} and wrote {written}")
    return lines


def write_page(job, finished, found, page):
    """A page (docs/reference/view.md) with finished frames to look into, above the lines of the report."""
    frames = sorted(finished)
    if len(frames) > PAGE_FRAMES:
        frames = [frames[k * (len(frames) - 1) // (PAGE_FRAMES - 1)] for k in range(PAGE_FRAMES)]
    patterns = {"input": job.input, "result": job.output} if frames else {}
    lines = "".join(f"<li>{html.escape(printable(line))}</li>" for line in lines_of(found))
    description = {
        "title": f"{pathlib.Path(job.output).name}: {found['finished']} of {found['frames']} frames",
        "subtitle": f"{len(frames)} of them are in the page, at half their size",
        "frames": [str(frame) for frame in frames],
        "images": [
            {"name": name, "files": [str(frame_path(pattern, frame)) for frame in frames]}
            for name, pattern in patterns.items()
        ],
        "first_layers_only": True,
        "report": f"<h2>Report</h2><ul>{lines}</ul>",
    }
    with WorkFolder("report") as work:
        write_text(work / "page.json", json.dumps(description))
        Polyrecon(job.polyrecon).run("view", "--page", work / "page.json", "-o", page, "--scale", "2")


def make_report(job, folder, processes, openjd, page=None, say=print_lines, verbose=False):
    """say: prints lines about the frames; the lines of a session of Open Job Description are printed in any case."""

    def report_progress(checked):
        if openjd:
            print_lines(f"openjd_progress: {100 * checked / len(job.frames):.1f}")

    finished, problems = check_all(job, processes, report_progress)
    found = summary(job, finished, problems, records_of(folder) if folder else [])
    if folder:
        write_json(pathlib.Path(folder) / REPORT_FILE, found)
    say(*lines_of(found))
    if verbose:
        say(f"finished: {ranges_text(sorted(finished)) or 'none'}", f"checked by: {shlex.join(job.words(job.frames))}")
    if page:
        write_page(job, finished, found, page)
    if openjd:
        print_lines(f"openjd_status: {found['finished']} of {found['frames']} frames are finished")
    if found["unfinished"]:
        if openjd:
            print_lines(f"openjd_fail: not finished: {found['unfinished']}")
        raise DriverError(ExitCode.MISSING, f"not finished: {found['unfinished']}")


def arguments(words):
    parser = Parser("polyrecon-farm report", description=__doc__, epilog=EXAMPLES)
    parser.add_argument("folder", nargs="?", help="folder of a submitted job")
    parser.add_argument(
        "-i",
        "--input",
        type=pattern,
        metavar="PATTERN",
        help="the renders, such as shot.####.exr, if there is no folder of a job",
    )
    parser.add_argument("-o", "--output", type=pattern, metavar="PATTERN", help="the results")
    parser.add_argument("--frames", metavar="RANGES", help="frames, such as 1-10,20-40x2")
    parser.add_argument(
        "--processes", type=int, default=1, metavar="N", help="processes that check frames concurrently"
    )
    parser.add_argument(
        "--progress",
        choices=["none", "openjd"],
        default="none",
        help="openjd: lines for an Open Job Description session",
    )
    parser.add_argument(
        "--html", metavar="FILE", help=f"write a page too, in which to look at up to {PAGE_FRAMES} finished frames"
    )
    add_program(parser)
    add_verbosity(parser)
    parser.add_argument(
        "options", nargs="*", metavar="-- OPTION", help="further options that the frames were denoised with"
    )
    at = words.index("--") if "--" in words else len(words)
    options = parser.parse_args(words[:at])
    options.options = words[at + 1 :]
    if bool(options.folder) == bool(options.input):
        parser.error("give either the folder of a job, or -i, -o and --frames")
    if options.input and not (options.output and options.frames):
        parser.error("-i needs -o and --frames")
    return options


def main(words=None):
    def work(words):
        options = arguments(sys.argv[1:] if words is None else words)
        if options.folder:
            job = Job.load(options.folder)
        else:
            frames = parse_ranges(options.frames)
            program = str(find_polyrecon(options.polyrecon))
            job = Job(options.input, options.output, frames, program, options.options)
        processes, openjd = max(1, options.processes), options.progress == "openjd"
        say = quiet_or_print(options)
        make_report(job, options.folder, processes, openjd, options.html, say, options.verbose)

    return run_main("polyrecon-farm", work, words)


if __name__ == "__main__":
    sys.exit(main())
