#!/usr/bin/env python3
"""Damages the folder of a farm job in random ways, then runs a task and the report: job_attacks.py COUNT [SEED]

Each time the description of the job or the record of a task is edited, cut or replaced, a file becomes another kind of
entry, or a frame is damaged. Commands for Open Job Description get names and ranges of the same kind. Every command
must end with a documented exit code, and with one line if it fails; no line may look like one of the farm's."""

import argparse
import collections
import contextlib
import io
import json
import os
import pathlib
import random
import re
import shutil
import signal
import sys
import tempfile

if __name__ == "__main__":
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[3])

from pipelines.farm import report, task
from pipelines.farm.job import JOB_FILE, RECORDS, Job
from tests.pipelines.farm.shot import make_shot
from tests.pipelines.loop.journal_attacks import REFUSALS, damage_json, edited

POLYRECON = os.path.abspath(os.environ["POLYRECON"])
SECONDS = 120  # after which a command counts as hanging
FRAMES = [1, 2, 3]
TEXTS = (
    "",
    "a\0b",
    "no_place.exr",
    "####/####.exr",
    "/dev/null",
    "%d%d####.exr",
    "-o",
    "x" * 5000,
    "a\nopenjd_fail: forged",
    "\x1b[2J####.exr",
    "\udcff####.exr",
    "1-3",
    "1-9999999",
    "9" * 5000,
    "1-2x0",
    "3-1",
    "-5--1",
    "\uff11-\uff12",
    "1,,2",
)
FORGED = re.compile(rb"^openjd_(env|unset_env|redacted_env|fail: forged|status: forged)|[\x00-\x09\x0b-\x1f\x7f]", re.M)


def with_texts(document, rng):
    """A copy of the document in which one text, or one number, is a hostile text."""
    document = json.loads(json.dumps(document))
    owner = rng.choice([document, *(value for value in document.values() if value and isinstance(value, (list, dict)))])
    owner[rng.choice(list(owner) if isinstance(owner, dict) else range(len(owner)))] = rng.choice(TEXTS)
    return document


def damage_entry(path, rng):
    """Makes a file or folder an entry of another kind, or other bytes."""
    if path.is_dir():
        shutil.rmtree(path)
    elif path.exists():
        path.unlink()
    kind = rng.randrange(6)
    if kind == 0:
        path.mkdir()
    elif kind == 1:
        path.symlink_to("nothing")
    elif kind == 2:
        os.mkfifo(path)
    elif kind == 3:
        path.write_bytes(rng.randbytes(100))
    elif kind == 4:
        path.symlink_to("/dev/full")


def run_command(main, words):
    """Runs the main function of a command; returns what is wrong with its end, or what it ended with."""
    sys.stdout.flush()
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        child = os.fork()
        if child == 0:
            os.dup2(out.fileno(), 1)
            os.dup2(err.fileno(), 2)
            signal.alarm(SECONDS)
            sys.stdout, sys.stderr = (
                io.TextIOWrapper(os.fdopen(number, "wb", closefd=False), "utf-8", "backslashreplace")
                for number in (1, 2)
            )
            code = 125
            try:
                code = main(words)
            except SystemExit as end:  # argparse
                code = end.code
            finally:
                with contextlib.suppress(OSError, ValueError):
                    sys.stdout.flush()
                    sys.stderr.flush()
                os._exit(code)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = []
        for file in (out, err):
            file.seek(0)
            texts.append(file.read())
    lines = [line for line in texts[1].split(b"\n") if line.startswith(b"polyrecon-farm")]
    if code not in REFUSALS | {0} or len(lines) != bool(code) or any(map(FORGED.search, texts)):
        return f"wrong: code {code}, {texts[1][:500]!r}"
    return f"ended with {code}"


def attack(whole, folder, rng):
    """Runs a task and the report on a damaged copy of the job `whole`; yields what happened, and what was done."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(whole, folder, symlinks=True)
    job = folder / "job"
    records = sorted((job / RECORDS).iterdir())
    target = rng.choice((job / JOB_FILE, job / JOB_FILE, *records))
    if rng.random() < 0.75:
        damage_json(target, rng, edited if rng.random() < 0.5 else with_texts)
    else:
        target = rng.choice((job / JOB_FILE, *records, job / RECORDS, job / "report.json", folder / "shot.0002.exr"))
        damage_entry(target, rng)
    what = target.name
    if target.name == JOB_FILE and target.is_file() and not target.is_symlink():
        what = target.read_bytes()[:400]
    yield run_command(report.main, [str(job), "--progress", "openjd"]), f"report {what}"
    index = rng.choice((["0"], ["1"], ["-1"], ["9" * 30], ["x"], []))
    yield run_command(task.main, [str(job), *index]), f"task {index} {what}"
    words = [
        "-i",
        rng.choice((*TEXTS, str(folder / "shot.####.exr"))),
        "-o",
        rng.choice((*TEXTS, str(folder / "o.####.exr"))),
    ]
    words += ["--frames", rng.choice((*TEXTS, "1-3")), "--polyrecon", POLYRECON, "--progress", "openjd"]
    words = [word.replace("\0", "") for word in words]
    yield run_command(report.main, words), f"report {[word[:80] for word in words]}"


def make_job(folder):
    """A shot, its job, and the records of its tasks; one frame is not denoised yet."""
    folder.mkdir()
    make_shot(folder, FRAMES, 8, 12)
    options = ["--quality", "draft", "--frame-radius", "0"]
    job = Job(
        str(folder / "shot.####.exr"), str(folder / "out.####.exr"), FRAMES, POLYRECON, options, 2, 1, 2**29, 2**29
    )
    (folder / "job").mkdir()
    job.save(folder / "job")
    task.run_chunk(folder / "job", 0)
    begun = {"chunk": 1, "frames": "3", "node": "node2", "begun": 5.0}
    (folder / "job" / RECORDS / "1.2.0.json").write_text(json.dumps(begun))


def run(count, seed):
    """Makes so many attacks; returns {what happened: how often}, and the attacks that got through."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        shot = folder / "shot"
        make_job(shot)
        shot.rename(folder / "whole")  # The description names absolute paths, so that copies stand in the same place.
        found, through, rng = collections.Counter(), [], random.Random(seed)
        for _ in range(count):
            for outcome, what in attack(folder / "whole", shot, rng):
                wrong = outcome.startswith("wrong")
                found["wrong" if wrong else outcome] += 1
                through += [f"{outcome} {what}"] if wrong else []
        return found, through


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    options = parser.parse_args()
    found, through = run(options.count, options.seed)
    for what, often in sorted(found.items()):
        print(f"{often:6} {what}")
    print(*through, sep="\n")


if __name__ == "__main__":
    main()
