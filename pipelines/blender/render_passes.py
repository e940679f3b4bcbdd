#!/usr/bin/env python3
"""Renders a .blend file with Cycles in several subsets of one sample sequence and merges them for `polyrecon denoise`.

The file has the noisy picture and its features, and mean, variance and half buffers of each.

examples:
  %(prog)s shot.blend -o noisy.exr --spp 64 && polyrecon denoise -i noisy.exr -o clean.exr --outputs layers
  %(prog)s shot.blend -o 'out/noisy_####.exr' --frames 1-100 --spp 32 --bpy

The mean of the subsets is the ordinary render of all samples. The scene file is not changed and none of its scripts is
run."""

import os
import pathlib
import re
import shlex
import sys
import time

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    sys.dont_write_bytecode = True  # A checkout stays as it is.
    __package__ = "pipelines.blender"

from ..common.modules import RENDERING, required

with required("polyrecon-blender-passes", RENDERING):
    from ..common import folder_lock, process
    from ..common.arguments import Parser
    from ..common.command import Notes, each_frame
    from ..common.errors import run_main
    from ..common.files import remove_temporaries
    from ..common.terminal import print_lines, size_text
    from .options import add_common, renderer_of


def arguments(words):
    parser = Parser("polyrecon-blender-passes", description=__doc__)
    add_common(parser)
    parser.add_argument("--spp", type=int, required=True, metavar="N", help="samples per pixel, of all subsets")
    parser.add_argument(
        "--parts", type=int, default=8, metavar="K", help="number of subsets; more subsets give a better variance"
    )
    parser.add_argument("--keep-parts", action="store_true", help="keep the subsets in --passes-dir")
    options = parser.parse_args(words)
    if options.parts < 2 or options.spp < options.parts or options.spp % options.parts:
        parser.error(f"--spp {options.spp}: must be a multiple of --parts {options.parts}, which must be 2 or more")
    return options


def work(words):
    options = arguments(words)
    renderer = renderer_of(options)
    notes = Notes(options.quiet)
    each_frame(options, renderer, lambda *frame: one_frame(options, renderer, notes, *frame))


def one_frame(options, renderer, notes, frame, polyrecon, progress):
    passes = frame.passes
    with folder_lock.claimed(passes):
        remove_temporaries(passes, re.compile(r"part_[0-9]+\.exr").fullmatch)
        render_parts(options, renderer, notes, frame, polyrecon, progress)
    if not options.keep_parts and os.listdir(passes) == [folder_lock.LOCK]:
        (passes / folder_lock.LOCK).unlink()
        frame.remove_empty_folders()


def render_parts(options, renderer, notes, frame, polyrecon, progress):
    begin = time.monotonic()
    audit = renderer.begin(frame.number)
    notes.tell(audit.notes)
    each = options.spp // options.parts
    parts = [frame.passes / f"part_{k}.exr" for k in range(options.parts)]
    for k, part in enumerate(parts):
        progress.update("rendering", frame=frame.number, samples=k * each, done=k / options.parts)
        renderer.uniform(k * each, each, part)
    progress.update("merging", frame=frame.number, samples=options.spp, done=1.0)
    summary = polyrecon.run("merge", *parts, "-o", frame.output)
    if not options.keep_parts:
        for part in parts:
            part.unlink()
    if options.quiet:
        return
    number = "" if frame.number is None else f"frame {frame.number}, "
    print_lines(
        f"{frame.output}: {number}{audit.width} x {audit.height}, {renderer.name}, {options.spp} samples per pixel in "
        f"{options.parts} parts",
        f"  {size_text(frame.output.stat().st_size)}, {time.monotonic() - begin:.1f} s",
        f"  next: polyrecon denoise -i {shlex.quote(str(frame.output))} --outputs layers",
    )
    if options.verbose:
        print_lines(*(f"  {line}" for line in [*audit.lines(), *process.lines_of(summary)]))


def main(words=None):
    return run_main("polyrecon-blender-passes", work, words)


if __name__ == "__main__":
    sys.exit(main())
