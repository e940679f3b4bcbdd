#!/usr/bin/env python3
"""Denoises renders that have references with every quality, and compares the results with the references by what a
person sees, too: false edges are steps between neighbouring pixels that the reference does not have, per 10,000 pixels
(tests/bench/false_edges.py). The other figures are those of `polyrecon compare`.

    tests/bench/pictures.py                              # the samples; --write puts the table into docs/results
    tests/bench/pictures.py FOLDER --peer oidn           # renders of your own, next to another denoiser's pictures

A folder holds renders NAME_SAMPLES.exr and references NAME_ref.exr (or of the part of NAME before a "_"), and pictures
of other denoisers NAME_SAMPLES_PEER.exr. Needs numpy and OpenImageIO's Python module; build the release preset first.
"""

import argparse
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from accuracy import table, write_between  # noqa: E402
from false_edges import false_edges  # noqa: E402

from pipelines.common import exr  # noqa: E402
from pipelines.common.denoise_defaults import QUALITIES  # noqa: E402
from pipelines.common.layer_names import HALF_A_SUFFIX, HALF_B_SUFFIX, VARIANCE_SUFFIX  # noqa: E402

FIGURES = ("relMSE", "trimmed", "FLIP", "energy", "false edges")
# Channels that a single render does not have.
MEASURED = re.compile(rf"({HALF_A_SUFFIX}|{HALF_B_SUFFIX}|{VARIANCE_SUFFIX})(\.\w+)?$")


def size_of(path):
    with exr.opened(path) as file:
        return file.spec().width, file.spec().height


def renders_of(folder):
    """[(render, its reference)] by name. A render of another size than the reference has none."""
    found = []
    for render in sorted(folder.glob("*.exr")):
        name = re.fullmatch(r"(.+)_\d+", render.stem)
        words = name[1].split("_") if name else []
        known = [folder / f"{'_'.join(words[:count])}_ref.exr" for count in range(len(words), 0, -1)]
        references = [reference for reference in known if reference.is_file()][:1]
        found += [(render, reference) for reference in references if size_of(render) == size_of(reference)]
    return found


def single(render, folder):
    """The render without variance and half buffers, as a renderer writes it in one go; itself if it has neither."""
    channels = exr.read(render)
    kept = {name: pixels for name, pixels in channels.items() if not MEASURED.search(name)}
    if len(kept) == len(channels):
        return render
    exr.write(folder / render.name, kept)
    return folder / render.name


def colours(path, layer):
    channels = exr.read(path)
    prefix = f"{layer}." if f"{layer}.R" in channels else ""  # `compare` calls bare channels RGBA
    return np.stack([channels[prefix + c] for c in "RGB"], -1).astype(float)


def figures(program, pictures, reference):
    """{name: its FIGURES} of pictures {name: path}."""
    command = [program, "compare", *pictures.values(), reference, reference, "--json"]
    compared = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["results"]
    truth = colours(reference, compared.pop()["layer"])
    rows = {}
    for (name, path), row in zip(pictures.items(), compared):
        row["false edges"] = false_edges(colours(path, row["layer"]), truth)
        rows[name] = tuple(row[figure] for figure in FIGURES)
    return rows


def measure(options, render, reference):
    """{name: FIGURES} of the noisy render, the result of each quality, and each peer's picture."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        noisy = single(render, folder) if options.single else render
        pictures = {"noisy": noisy}
        for quality in options.quality:
            pictures[quality] = folder / f"{quality}.exr"
            command = [
                options.polyrecon,
                "denoise",
                "-i",
                noisy,
                "-o",
                pictures[quality],
                "--overwrite",
                "--quality",
                quality,
            ]
            subprocess.run([*command, "--quiet", *options.words], check=True)
        for peer in options.peer:
            picture = render.with_name(f"{render.stem}_{peer}.exr")
            if picture.is_file():
                pictures[peer] = picture
        return figures(options.polyrecon, pictures, reference)


def cells(row):
    error, trimmed, flip, energy, edges = row
    return [f"{error:.5f}", f"{trimmed:.5f}", f"{flip:.4f}", f"{100 * energy:+.2f} %", f"{edges:.1f}"]


def mean_ratios(rows, name, peer):
    """Geometric means of the ratio of each figure but the energy; an edge is added to the false ones, as there may be
    none."""
    both = [(row[name], row[peer]) for row in rows.values() if name in row and peer in row]
    ratios = []
    for k, figure in enumerate(FIGURES):
        if figure == "energy":
            continue
        more = 1 if figure == "false edges" else 0
        ratios.append(math.exp(sum(math.log((a[k] + more) / (b[k] + more)) for a, b in both) / len(both)))
    return [*(f"{r:.3f}" for r in ratios[:-1]), "", f"{ratios[-1]:.2f}"]


def markdown(rows, peers, qualities):
    lines = [[render, name, *cells(row)] for render, named in rows.items() for name, row in named.items()]
    for peer in peers:
        count = sum(peer in row for row in rows.values())
        for quality in qualities if count else ():
            lines.append([f"mean of {count}", f"{quality} / {peer}", *mean_ratios(rows, quality, peer)])
    return table(["render", "picture", *FIGURES], lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, nargs="*", help="of renders and references (samples)")
    parser.add_argument("--polyrecon", default=ROOT / "build" / "release" / "src" / "polyrecon")
    parser.add_argument("--quality", nargs="*", choices=QUALITIES, default=QUALITIES)
    parser.add_argument("--peer", nargs="*", default=[], help="other denoisers whose pictures are there, as oidn")
    parser.add_argument("--single", action="store_true", help="renders without their variance and half buffers")
    parser.add_argument("--write", action="store_true", help="put the table into docs/results/pictures.md")
    parser.add_argument("--words", nargs=argparse.REMAINDER, default=[], help="further options of polyrecon denoise")
    options = parser.parse_args()
    rows = {}
    for folder in options.folder or [ROOT / "samples"]:
        for render, reference in renders_of(folder):
            rows[render.stem] = measure(options, render, reference)
            print(render.stem, file=sys.stderr)
    text = markdown(rows, options.peer, options.quality)
    if options.write:
        write_between(ROOT / "docs" / "results" / "pictures.md", "figures", text, "pictures.py")
    else:
        print(text)


if __name__ == "__main__":
    main()
