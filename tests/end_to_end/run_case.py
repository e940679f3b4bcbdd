#!/usr/bin/env python3
"""Runs CASE/run in an empty folder and compares what it prints with CASE/expected.

usage: run_case.py CASE PROGRAM SAMPLES WORK
"""

import difflib
import os
import pathlib
import shutil
import subprocess
import sys


def main():
    case, program, samples, work = (pathlib.Path(word).resolve() for word in sys.argv[1:])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    environment = dict(
        os.environ,
        POLYRECON=str(program),
        POLYRECON_SAMPLES=str(samples),
        PYTHONPATH=str(case.parent),
        PYTHONDONTWRITEBYTECODE="1",
    )
    done = subprocess.run(
        [sys.executable, str(case / "run")], cwd=work, env=environment, capture_output=True, text=True
    )
    expected = (case / "expected").read_text()
    difference = list(
        difflib.unified_diff(expected.splitlines(), done.stdout.splitlines(), "expected", "found", lineterm="")
    )
    print("\n".join(difference) if difference else done.stdout, end="\n")
    print(done.stderr, end="")
    if done.returncode or difference:
        return 1
    shutil.rmtree(work)
    return 0


sys.exit(main())
