"""Inputs that are replaced, overwritten, cut or grown at a random moment of the run, with size and times as before."""

import os
import random
import time

from pipelines.common import exr
from tests.attacks import exr_bytes, seeds

NAME = "swaps"
WIDTH, HEIGHT = 120, 80


def replace(path, content, how, rng):
    """Changes a file in one of several ways."""
    status = path.stat()
    if how == "renamed over":
        new = path.with_name("new.tmp")
        new.write_bytes(content)
        os.utime(new, ns=(status.st_atime_ns, status.st_mtime_ns))
        new.rename(path)
    elif how == "written over":
        with path.open("r+b") as file:
            file.write(content)
    elif how == "cut":
        os.truncate(path, rng.randrange(status.st_size))
    elif how == "grown":
        with path.open("ab") as file:
            file.write(b"x")
    elif how == "removed":
        path.unlink()
    if path.exists() and how != "cut":
        os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


def later(delay, path, how, content, rng):
    time.sleep(delay)
    replace(path, content, how, rng)


def attack(program, tally, count, more):
    rng = random.Random(tally.seed)
    first, second = (
        exr_bytes.build([(None, seeds.planes(seeds.scene(WIDTH, HEIGHT, seed=seed), ("variance",)), None)]).packed()
        for seed in (1, 2)
    )
    size = max(len(first), len(second))
    first, second = (content + bytes(size - len(content)) for content in (first, second))

    def fresh():
        program.clear()
        for name in (
            "in.exr",
            "s.0001.exr",
            "s.0002.exr",
            "s.0003.exr",
            "shot_beauty.exr",
            "shot_albedo.exr",
            "prior.exr",
        ):
            (program.folder / name).write_bytes(first)

    works = {
        "input": (["denoise", "-i", "in.exr", "--quality", "draft", "-o", "o.exr"], "in.exr", "o.exr"),
        "neighbour": (
            ["denoise", "-i", "s.####.exr", "--quality", "draft", "-o", "o.####.exr", "--frame-radius", "1"],
            "s.0002.exr",
            None,
        ),
        "prior": (
            ["denoise", "-i", "in.exr", "--quality", "draft", "-o", "o.exr", "--prior", "prior.exr"],
            "prior.exr",
            "o.exr",
        ),
        "map": (
            ["denoise", "-i", "in.exr", "--quality", "draft", "-o", "o.exr", "--map", "albedo=prior.exr"],
            "prior.exr",
            "o.exr",
        ),
        "merged": (["merge", "in.exr", "prior.exr", "-o", "o.exr", "--samples", "8"], "prior.exr", "o.exr"),
        "compared": (["compare", "in.exr", "prior.exr", "--html", "o.html"], "prior.exr", None),
    }
    lengths = {}
    for what, (arguments, _, _) in works.items():
        fresh()
        begin = time.monotonic()
        program.run(arguments)
        lengths[what] = time.monotonic() - begin
    for number in range(count):
        if tally.is_over():
            break
        what = rng.choice(sorted(works))
        arguments, swapped, output = works[what]
        how = rng.choice(("renamed over", "written over", "cut", "grown", "removed"))
        fresh()
        path = program.folder / swapped
        delay = rng.random() * lengths[what] * 1.1

        outcome = program.run(arguments, meanwhile=lambda _, swap=(delay, path, how): later(*swap, second, rng))
        tally.inputs += 1
        wrong = outcome.faults(2 * tally.memory) + [f"left {name}" for name in program.left_over()]
        if outcome.code == 0 and output == "o.exr" and what != "merged" and path.exists():
            wrong += identity_faults(program, arguments)
        tally.count(outcome, wrong, f"{number} {what} {how} after {delay:.3f} of {lengths[what]:.3f} s")


def identity_faults(program, arguments):
    """A result is skipped by --skip-existing only if a run on the files as they are now gives the same pixels."""
    again = program.run([*arguments, "--skip-existing", "--report", "r.json"])
    if b"skip" not in again.out.lower():
        return []
    kept = exr.read(program.folder / "o.exr")
    fresh = program.run(["fresh.exr" if argument == "o.exr" else argument for argument in arguments])
    if fresh.code:
        return ["was skipped though its input is unreadable now"]
    made = exr.read(program.folder / "fresh.exr")
    same = all((kept[name] == made[name]).all() for name in made if "Combined.R" in name)
    return [] if same else ["a result of other pixels was skipped"]
