#!/usr/bin/env python3
"""Damages the folders of passes of a loop in random ways and resumes it: journal_attacks.py COUNT [SEED] [--shot]

Each time a journal is edited, cut or replaced, or a file that it names is swapped, cut, removed, or another kind of
entry. The loop must end with a documented exit code and one line, or finish with the samples that its journal lists.
With --shot it is the loop of three frames that share a budget."""

import argparse
import collections
import contextlib
import copy
import io
import json
import os
import pathlib
import random
import shutil
import sys
import tempfile

import numpy as np

if __name__ == "__main__":
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[3])

from pipelines.common import exr
from pipelines.common.errors import run_main
from pipelines.loop.budget import Budget
from tests.pipelines.loop import synthetic, test_shot

BUDGET, SIZE = Budget(samples=12), {"width": 24, "height": 16}
REFUSALS = {2, 3, 4, 5, 6, 7, 33}
VALUES = (
    None,
    True,
    "",
    "x",
    "../x",
    "a\nb",
    -1,
    0,
    1,
    2,
    3,
    0.5,
    1e9,
    1e300,
    2**62,
    2**70,
    float("nan"),
    [],
    {},
    [[]],
)


def places(value, place=()):
    """Places of all values in a JSON document."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield (*place, key)
        yield from places(item, (*place, key))


def edited(document, rng):
    """A copy of the document with one to three edits."""
    document = copy.deepcopy(document)
    for _ in range(rng.choice((1, 1, 2, 3))):
        *parents, key = rng.choice(list(places(document)))
        owner = document
        for parent in parents:
            owner = owner[parent]
        kind = rng.randrange(5)
        if kind == 0:
            del owner[key]
        elif kind == 1 and isinstance(owner, list):
            owner.insert(rng.randrange(len(owner) + 1), copy.deepcopy(rng.choice(owner)))
        elif kind == 2 and isinstance(owner[key], (int, float)):
            owner[key] = type(owner[key])(owner[key] * rng.choice((-1, 0, 0.5, 2, 1000)) + rng.choice((0, 1, -1)))
        elif kind == 3:
            owner[key] = copy.deepcopy(rng.choice(list(owner.values()) if isinstance(owner, dict) else owner))
        else:
            owner[key] = copy.deepcopy(rng.choice(VALUES))
    return document


def damage_journal(passes, rng):
    damage_json(passes / "journal.json", rng, edited)


def damage_json(path, rng, change):
    """Cuts a JSON file, writes wrong bytes into it, or, mostly, changes what it says by change(document, rng)."""
    content = path.read_bytes()
    kind = rng.randrange(10)
    if kind == 0:
        path.write_bytes(content[: rng.randrange(len(content))])
    elif kind == 1:
        at = rng.randrange(len(content))
        path.write_bytes(content[:at] + rng.randbytes(rng.randrange(1, 9)) + content[at + 1 :])
    else:
        path.write_text(json.dumps(change(json.loads(content), rng)))


def damage_file(passes, rng):
    """Changes a file of the journal, or an entry of the folder that a driver would write."""
    files = sorted(path for path in passes.rglob("*") if path.is_file() and path.suffix == ".exr")
    path, other = rng.choice(files), rng.choice(files)
    kind = rng.randrange(8)
    if kind == 0:
        path.write_bytes(other.read_bytes())
    elif kind == 1:
        os.truncate(path, rng.randrange(path.stat().st_size))
    elif kind == 2:
        content = bytearray(path.read_bytes())
        content[rng.randrange(len(content))] ^= rng.randrange(1, 256)
        path.write_bytes(content)
    elif kind == 3:
        exr.write(path, {name: np.zeros((4, 4)) for name in exr.read(path)})
    else:
        path.unlink()
        if kind == 4:
            path.mkdir()
        elif kind == 5:
            path.symlink_to(other)
        elif kind == 6:
            os.mkfifo(path)


def run_frame(folder, resume=False):
    synthetic.loop(folder, BUDGET, resume=resume, **SIZE)


def run_shot(folder, resume=False):
    test_shot.run(folder, BUDGET, resume=resume)


def attack(loop, whole, folder, rng):
    """Resumes a damaged copy of the folder `whole`; returns what happened."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(whole, folder)
    journals = sorted(folder.glob("*/journal.json"))
    rng.choice((damage_journal, damage_journal, damage_file))(rng.choice(journals).parent, rng)
    with contextlib.redirect_stderr(io.StringIO()) as stderr:
        code = run_main("loop", lambda _: loop(folder, resume=True))
    lines = stderr.getvalue().splitlines()
    if code in REFUSALS and len(lines) == 1:
        return f"refused with {int(code)}"
    if code or lines:
        return f"wrong: code {code}, {lines}"
    for journal in journals:
        parts = json.loads(journal.read_text())["parts"]
        counts = exr.read(journal.with_name("merged.exr"))["L.Sample Count.X"]
        if not np.isclose(counts.mean(), sum(part["samples"] for part in parts), rtol=1e-3) or len(parts) < 8:
            return f"wrong: {counts.mean()} samples of {len(parts)} parts"
    return "finished"


def run(count, seed, loop=run_frame):
    """Makes so many attacks; returns {what happened: how often}."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        loop(folder / "whole")
        found, rng = collections.Counter(), random.Random(seed)
        for _ in range(count):
            found[attack(loop, folder / "whole", folder / "damaged", rng)] += 1
        return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("--shot", action="store_true")
    options = parser.parse_args()
    for what, often in sorted(run(options.count, options.seed, run_shot if options.shot else run_frame).items()):
        print(f"{often:6} {what}")


if __name__ == "__main__":
    main()
