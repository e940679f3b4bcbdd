#!/usr/bin/env python3
"""Measures what each pass of the samples is worth: relMSE of the result without it, and over that with all. Writes the
table of docs/guide/passes.md. A minute."""

import argparse
import json
import pathlib
import subprocess
import tempfile

import OpenImageIO as oiio
from accuracy import ROOT, table, write_between

PAGE = ROOT / "docs" / "guide" / "passes.md"
SAMPLES = ("study", "glass")
# The layers that are taken out of the file: their names begin or end so.
CASES = {
    "all of them": (),
    "no albedo": ("Denoising Albedo",),
    "no normal": ("Denoising Normal",),
    "no depth": ("Denoising Depth",),
    "no feature at all": ("Denoising", "Shadow"),
    "no halves": (" A", " B"),
    "neither variance nor halves": (" A", " B", " Variance"),
    "the picture alone": ("Denoising", "Shadow", " A", " B", " Variance"),
}


def without(source, target, words):
    """Copies the file without the layers whose names begin with one of the words, or end with it."""
    image = oiio.ImageBuf(str(source))
    names = image.spec().channelnames
    layers = [name.partition(".")[2].rpartition(".")[0] for name in names]
    kept = [
        name
        for name, layer in zip(names, layers)
        if not any(layer.endswith(word) if word.startswith(" ") else layer.startswith(word) for word in words)
    ]
    oiio.ImageBufAlgo.channels(image, tuple(kept)).write(str(target))


def relmse(program, sample, words, folder):
    render, clean = folder / "render.exr", folder / "clean.exr"
    without(ROOT / "samples" / f"{sample}_16.exr", render, words)
    subprocess.run([program, "denoise", "-i", render, "-o", clean, "--overwrite", "--quiet"], check=True)
    command = [program, "compare", clean, ROOT / "samples" / f"{sample}_ref.exr", "--json"]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return found["results"][0]["relMSE"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--polyrecon", default=ROOT / "build/release/src/polyrecon", type=pathlib.Path)
    options = parser.parse_args()
    rows, best = [], {}
    with tempfile.TemporaryDirectory() as work:
        for name, words in CASES.items():
            cells = []
            for sample in SAMPLES:
                found = relmse(options.polyrecon, sample, words, pathlib.Path(work))
                best.setdefault(sample, found)
                cells.append(f"{found:.4f} ({found / best[sample]:.2f})")
            rows.append([name, *cells])
    head = ["passes", *(f"{sample}: relMSE (over that of all)" for sample in SAMPLES)]
    write_between(PAGE, "passes", table(head, rows), "passes.py")


if __name__ == "__main__":
    main()
