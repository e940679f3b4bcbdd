"""Inputs and outputs that are no ordinary files: pipes, devices, folders, links in circles, empty and unreadable files,
files of the system."""

import os
import random
import socket

from tests.attacks import exr_bytes, seeds

NAME = "special_files"


def make(folder, plain):
    """{what it is: its path}"""
    os.mkfifo(folder / "pipe.exr")
    (folder / "folder.exr").mkdir()
    (folder / "empty.exr").write_bytes(b"")
    (folder / "zeros.exr").write_bytes(bytes(5000))
    (folder / "sparse.exr").touch()
    os.truncate(folder / "sparse.exr", 2**40)
    (folder / "a.exr").symlink_to("b.exr")
    (folder / "b.exr").symlink_to("a.exr")
    (folder / "gone.exr").symlink_to("nothing")
    (folder / "to_pipe.exr").symlink_to("pipe.exr")
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(str(folder / "socket.exr"))
    listener.close()
    (folder / "huge_head.exr").write_bytes(plain[:300] + bytes(100000))
    for name, target in (
        ("zero", "/dev/zero"),
        ("null", "/dev/null"),
        ("full", "/dev/full"),
        ("random", "/dev/urandom"),
        ("tty", "/dev/tty"),
        ("stdin", "/dev/stdin"),
        ("mem", "/proc/self/mem"),
        ("maps", "/proc/self/maps"),
        ("cmdline", "/proc/self/cmdline"),
        ("kmsg", "/proc/kmsg"),
        ("pagemap", "/proc/self/pagemap"),
        ("sys", "/sys/kernel/notes"),
        ("root", "/"),
        ("fd", "/proc/self/fd/0"),
    ):
        (folder / f"{name}.exr").symlink_to(target)
    return [*sorted(path.name for path in folder.iterdir()), "/dev/zero", "/proc/self/environ", "/dev/fd/0", "."]


def uses(path):
    """All ways to name a file to the program: (arguments, whether the file is written)."""
    inputs = (
        ["inspect", path],
        ["denoise", "-i", path, "-o", "o.exr"],
        ["denoise", "-i", "plain.exr", path, "-o", "out", "--overwrite"],
        ["denoise", "-i", "plain.exr", "-o", "o.exr", "--prior", path],
        ["denoise", "-i", "plain.exr", "-o", "o.exr", "--map", f"albedo={path}"],
        ["denoise", "-i", "plain.exr", "-o", "o.exr", "--sample-map", "s.exr", "--budget", "4", "--cost", path],
        ["denoise", "-i", path, "-o", "o.exr", "--wait", "0"],
        ["merge", "plain.exr", path, "-o", "o.exr"],
        ["merge", path, "plain.exr", "-o", "o.exr"],
        ["merge", "plain.exr", "-o", "o.exr", "--half-b", path],
        ["samplemap", "-e", path, "--budget", "4", "-o", "o.exr"],
        ["preview", path, "-o", "o.png"],
        ["preview", "plain.exr", "-o", "o.png", "--reference", path],
        ["compare", "plain.exr", path],
        ["compare", path, "plain.exr"],
        ["compare", "plain.exr", "plain.exr", "--html", "o.html", "--error-map", path],
        ["sweep", "-i", path, "--reference", "plain.exr", "-o", "o.html", "--vary", "quality"],
        ["sweep", "-i", "plain.exr", "--reference", path, "-o", "o.html", "--vary", "quality"],
        ["view", path, "-o", "o.html"],
        ["view", "plain.exr", "--reference", path, "-o", "o.html"],
        ["view", "--page", path, "-o", "o.html"],
        ["denoise", "-i", "plain.exr", "-o", "o.exr", "--prior", "oidn", "--oidn", path],
        ["inspect", "plain.exr", "--oidn", path],
    )
    outputs = (
        ["denoise", "-i", "plain.exr", "-o", path, "--overwrite"],
        ["denoise", "-i", "plain.exr", "-o", "o.exr", "--error-map", path, "--overwrite"],
        ["merge", "plain.exr", "plain.exr", "-o", path, "--overwrite"],
        ["denoise", "-i", "plain.exr", "-o", path],
    )
    return [(use, False) for use in inputs] + [(use, True) for use in outputs]


def attack(program, tally, count, more):
    rng = random.Random(tally.seed)
    plain = exr_bytes.build([(None, seeds.planes(seeds.scene(24, 16)), None)]).packed()
    program.clear()
    kinds = make(program.folder, plain)
    for kind in kinds:
        tally.inputs += 1
        for arguments, is_output in rng.sample(uses(kind), 3 * tally.commands):
            if tally.is_over():
                return
            program.clear()
            make(program.folder, plain)
            (program.folder / "plain.exr").write_bytes(plain)
            quality = ["--quality", "draft"] if arguments[0] == "denoise" else []
            outcome = program.run(arguments + quality)
            wrong = outcome.faults(tally.memory) + [f"left {name}" for name in program.left_over()]
            made = [name for name in ("o.exr", "o.png", "o.html") if (program.folder / name).exists()]
            if outcome.code and made and not is_output:
                wrong.append(f"made {made}")
            tally.count(outcome, wrong, f"{kind} {' '.join(arguments)}")
