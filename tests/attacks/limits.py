"""Limits of the system: size of files, open files, address space, threads, processor time; small --max-memory."""

import os
import random
import resource

from tests.attacks import exr_bytes, seeds
from tests.attacks.program import MEGABYTE

NAME = "limits"
NOBODY = 64998  # A user without processes, whom the limit of processes binds.
DENOISE = ["denoise", "-i", "plain.exr", "-o", "o.exr", "--quality", "draft"]
COMMANDS = {
    "denoise": [*DENOISE, "--error-map", "e.exr", "--report", "r.json"],
    "maps": [*DENOISE, "--sample-map", "s.exr", "--budget", "4", "-t", "3"],
    "inspect": ["inspect", "plain.exr"],
    "merge": ["merge", "plain.exr", "second.exr", "-o", "o.exr"],
    "compare": ["compare", "plain.exr", "second.exr", "--html", "o.html"],
    "preview": ["preview", "plain.exr", "-o", "o.png"],
    "view": ["view", "plain.exr", "-o", "o.html"],
    "sweep": ["sweep", "-i", "plain.exr", "--reference", "second.exr", "-o", "o.html", "--vary", "quality"],
    "sequence": ["denoise", "-i", "s.####.exr", "-o", "o.####.exr", "--quality", "draft"],
}


def _as_nobody():
    if os.getuid() == 0:
        os.setgid(NOBODY)
        os.setuid(NOBODY)


def attack(program, tally, count, more):
    rng = random.Random(tally.seed)
    plain = exr_bytes.build([(None, seeds.planes(seeds.scene(24, 16)), None)]).packed()
    tries = [
        ("file size", [(resource.RLIMIT_FSIZE, value)], None, {0, 5})
        for value in (0, 1, 100, 1000, 4096, 10000, 30000, 60000)
    ]
    tries += [
        ("open files", [(resource.RLIMIT_NOFILE, value)], None, {0, 33, 127})
        for value in (3, 4, 5, 6, 8, 12, 16, 24, 31, 32, 40)
    ]
    tries += [
        ("address space", [(resource.RLIMIT_AS, value * MEGABYTE)], None, {0, 33, 127})
        for value in (20, 60, 100, 150, 200, 300, 400, 500, 700, 1000)
    ]
    tries += [("processes", [(resource.RLIMIT_NPROC, value)], _as_nobody, {0, 33}) for value in (0, 1, 2, 3, 5)]
    tries += [("stack", [(resource.RLIMIT_STACK, value * 1024)], None, {0, 33, 127}) for value in (64, 128, 256, 1024)]
    tries += [
        ("data", [(resource.RLIMIT_DATA, value * MEGABYTE)], None, {0, 33, 127}) for value in (1, 5, 10, 20, 40, 100)
    ]
    tries += [
        ("locked", [(resource.RLIMIT_MEMLOCK, 0)], None, {0}),
        ("no signals", [(resource.RLIMIT_SIGPENDING, 0)], None, {0}),
    ]
    tries += [
        ("--max-memory", value, None, {0, 33, 2})
        for value in ("0", "1", "1K", "100K", "1M", "2M", "5M", "10M", "50M", "1e30G")
    ]
    for what, limits, before, codes in tries:
        tally.inputs += 1
        for name, arguments in rng.sample(sorted(COMMANDS.items()), tally.commands):
            if tally.is_over():
                return
            program.clear()
            program.folder.chmod(0o777)
            for file in ("plain.exr", "second.exr", "s.0001.exr", "s.0002.exr"):
                (program.folder / file).write_bytes(plain)
            files = set(os.listdir(program.folder))
            if what == "--max-memory":
                outcome = program.run([*arguments, what, limits], before)
            else:
                outcome = program.run(arguments, before, limits=limits)
            allowed = codes | ({4} if name == "sequence" else set())
            if outcome.code == 127:
                continue  # The program itself could not be loaded.
            wrong = [] if what == "file size" else outcome.faults(tally.memory)
            if outcome.code not in allowed:
                wrong.append(f"exit code {outcome.code}: {outcome.err[:200]!r}")
            left = set(os.listdir(program.folder)) - files
            if outcome.code and left and name != "sequence":
                wrong.append(f"left {sorted(left)}")
            wrong += [f"left {path}" for path in program.left_over()]
            tally.count(outcome, wrong, f"{what} {limits} {name}")
