"""Names of files, folders, layers and options that a terminal, a pattern or a scheduler would act on."""

import os
import random

from tests.attacks import exr_bytes, seeds

NAME = "names"
PIECES = (
    "\x1b[2J",
    "\x1b]0;t\a",
    "\r",
    "\n",
    "\t",
    "\b",
    "\x7f",
    "\u009b7m",
    "\u202e",
    "\u2028",
    "\u200f",
    "\udcff\udcfe",
    "\udce9",
    '\n@polyrecon {"a": 1}',
    "\nopenjd_fail: forged",
    "\nopenjd_progress: 99",
    "\nopenjd_env: A=1",
    "openjd_status: forged",
    "#",
    "####",
    "%d",
    "%04d",
    "%s%n",
    "\\",
    "\\\\",
    "'",
    '"',
    "`id`",
    "$(id)",
    ";",
    "&",
    "|",
    "*",
    "?",
    "[a]",
    "{}",
    "{0}",
    " ",
    "  ",
    "-",
    "--",
    "-o",
    "--help",
    "~",
    ".",
    "..",
    "é",
    "日本",
    "e\u0301",
    "\U0001f600",
    "=",
    ",",
    ":",
    "<b>",
    "&lt;",
    "</script>",
    "@",
    "x" * 200,
)


def hostile(rng):
    """A name of one to four pieces with letters between them, of at most 240 bytes."""
    name = ""
    for _ in range(rng.choice((1, 1, 2, 3, 4))):
        name += rng.choice(PIECES) + rng.choice(("", "a", "b1"))
    name = name.replace("/", "")
    return os.fsencode(name)[:240].decode("utf-8", "surrogateescape").replace("\0", "")


def commands(path, folder, layer):
    return (
        ["inspect", path],
        ["inspect", path, "--json"],
        [
            "denoise",
            "-i",
            path,
            "-o",
            f"{folder}/out.exr",
            "--quality",
            "draft",
            "--report",
            f"{folder}/r.json",
            "--overwrite",
        ],
        ["denoise", "-i", path, "-o", folder, "--quality", "draft", "--overwrite", "--progress", "openjd"],
        [
            "denoise",
            "-i",
            path,
            "-o",
            "out.exr",
            "--quality",
            "draft",
            "--overwrite",
            "--aov",
            layer,
            "--progress",
            "json",
        ],
        ["denoise", "-i", path, "-o", "out.exr", "--quality", "draft", "--overwrite", "--map", f"albedo={layer}"],
        ["denoise", "-i", f"{folder}/s.####.exr", "-o", f"{folder}/o.####.exr", "--quality", "draft", "--overwrite"],
        ["denoise", "-i", path, "-o", "out.exr", "--overwrite", "--view-layer", layer, "--frames", layer],
        ["merge", path, "./" + path if not path.startswith("-") else path, "-o", "m.exr", "--overwrite"],
        ["compare", path, path, "--html", f"{folder}/c.html", "--overwrite"],
        ["compare", path, path, "--json"],
        ["preview", path, "-o", f"{folder}/p.png", "--layer", layer, "--overwrite"],
        ["samplemap", "-e", path, "-o", f"{folder}/s.exr", "--budget", "4", "--samples", "8", "--overwrite"],
        ["view", path, "-o", f"{folder}/v.html", "--overwrite"],
        [layer, path],
        ["denoise", "-i", path, "-o", "out.exr", "--quality", layer],
        [f"--{layer}"],
    )


def attack(program, tally, count, more):
    rng = random.Random(tally.seed)
    whole = seeds.planes(seeds.scene(16, 12))
    for number in range(count):
        if tally.is_over():
            break
        program.clear()
        path, folder, layer = (hostile(rng) for _ in range(3))
        if path in (".", "..") or folder in ("", ".", ".."):
            continue
        path += ".exr"
        evil = dict(whole)
        layer_name = layer.replace(".", "")[:200] or "x"
        evil.update({f"{layer_name}.{c}": whole[f"ViewLayer.Combined.{c}"] for c in "RGB"})
        part = exr_bytes.build(
            [(layer_name if number % 2 else None, evil, None)],
            extra=[
                ("polyrecon/sharedSamples", "string", os.fsencode(layer)),
                ("cycles.ViewLayer.samples", "string", os.fsencode(path)),
            ],
        )
        (program.folder / folder).mkdir(exist_ok=True)
        for where in (path, f"{folder}/s.0001.exr", f"{folder}/s.0002.exr"):
            (program.folder / where).write_bytes(part.packed())
        tally.inputs += 1
        before = set(os.listdir(program.folder))
        for arguments in rng.sample(commands(path, folder, layer), tally.commands):
            outcome = program.run(arguments)
            wrong = outcome.faults(tally.memory) + [f"left {name}" for name in program.left_over()]
            expected = {os.fsencode(name) for name in ("out.exr", "m.exr")}
            new = {os.fsencode(name) for name in set(os.listdir(program.folder)) - before} - expected
            if any(not name.endswith((b"_denoised.exr",)) for name in new) and outcome.code:
                wrong.append(f"new files {new}")
            tally.count(outcome, wrong, f"{number} {arguments[0]!r}", [program.folder / path])
