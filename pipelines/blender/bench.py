#!/usr/bin/env python3
"""Measures the adaptive loop against its rivals: the same scenes, the same seconds, one machine.

(a) uniform   the same number of samples in every pixel, then `polyrecon denoise`
(b) adaptive  adaptive.py
(c) cycles    Cycles' adaptive sampling, its noise threshold tuned to the seconds, then Open Image Denoise
(d) oidn      uniform samples, then Open Image Denoise (albedo, normal, accurate prefilter, as in (c))
(e) prior     (b) --with-prior: Open Image Denoise's picture of each half goes into the reconstruction
(f) uniform_prior  (a) with that

Seconds are those of the whole command: start-up, rendering, merging, reconstruction. (b) and (e) get the budget, the others are
tuned until they take as long as (b) took. On a machine that is busy with other work --clock cpu counts the processor
seconds of all processes instead; all are then tuned to the budget, (b) by its samples. References are rendered once, with other seeds, and kept; so are all
results: run it again to go on, or with another budget to add to the table. With --draws every cell is made with so many
seeds of Cycles: its error is then their geometric mean.

  bench.py                                           all of it; hours the first time, nearly all for the references
  bench.py glass fan --seconds 10,30 --size 320x180
  bench.py --methods adaptive,uniform --draws 3      how much is the luck of one seed
  bench.py shot.blend --size 320x180                 a file of one's own, whatever engine it is set to, by Cycles
  bench.py --references                              only these
  bench.py --stop-after 90                           a slice; the next call goes on
"""

import argparse
import json
import math
import pathlib
import resource
import shutil
import sys
import time

if not __package__:  # run as a script from a checkout
    sys.path[0] = str(pathlib.Path(__file__).resolve().parents[2])
    __package__ = "pipelines.blender"

from ..common import process
from ..common.errors import DriverError, ExitCode, run_main
from ..common.polyrecon_cli import Polyrecon
from . import bench_report

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
SCENES = ("gallery", "glass", "meadow", "fan")
METHODS = ("uniform", "adaptive", "cycles", "oidn", "prior", "uniform_prior")
LOOPS = ("adaptive", "prior")  # given a budget; the others are tuned to it
PARTS = 8  # subsets of (a)
REFERENCE_STEP, FIRST_REFERENCE_SEED = 64, 1001  # samples of one render; each has a seed of its own
DRAW_SEEDS = 10000  # from one draw's seed to the next one's; the loop takes a new seed every 256 samples
MOST_SAMPLES = 1 << 12  # of one pixel by (c): what Blender sets unasked
TOLERANCE, TRIES = 0.08, 4  # how near the seconds have to come, and how often to try


def arguments(words):
    parser = argparse.ArgumentParser(
        prog="bench.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of: {', '.join(SCENES)} (all), or a .blend file")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--seconds", default="15,45", help="budgets (%(default)s)")
    parser.add_argument("--clock", choices=("wall", "cpu"), default="wall", help="what the seconds are (wall)")
    parser.add_argument("--methods", default=",".join(METHODS), help="(%(default)s)")
    parser.add_argument(
        "--reference-spp", type=int, default=1024, help="a multiple of %d (%%(default)s)" % REFERENCE_STEP
    )
    parser.add_argument("--draws", type=int, default=1, help="seeds for each cell (%(default)s: the file's own)")
    parser.add_argument("--references", action="store_true", help="render the references and nothing else")
    parser.add_argument("--stop-after", type=float, default=math.inf, metavar="SECONDS", help="begin no run after this")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out" / "bench", help="folder for all files")
    parser.add_argument("--docs", type=pathlib.Path, help="write table and plot here (docs/results/adaptive.md)")
    parser.add_argument("--python", default=sys.executable, help="a Python with bpy 5 (this one)")
    parser.add_argument("--polyrecon", help="the program")
    options = parser.parse_args(words)
    options.scenes = options.scenes or list(SCENES)
    options.methods = options.methods.split(",")
    first = "adaptive" if options.clock == "wall" else "uniform"  # the others are tuned by what these taught
    options.methods.sort(key=lambda method: method != first)
    ours = [scene for scene in options.scenes if not scene.endswith(".blend")]
    for given, known in ((ours, SCENES), (options.methods, METHODS)):
        if unknown := sorted(set(given) - set(known)):
            parser.error(f"{', '.join(unknown)}: not one of {', '.join(known)}")
    names = [pathlib.Path(scene).stem for scene in options.scenes]
    if len(set(names)) < len(names) or {pathlib.Path(s).stem for s in options.scenes if s.endswith(".blend")} & set(
        SCENES
    ):
        parser.error("a .blend file is known by its name, which another scene has: copy it to one of its own")
    if options.reference_spp < 2 * REFERENCE_STEP or options.reference_spp % REFERENCE_STEP:
        parser.error(
            f"--reference-spp {options.reference_spp}: a multiple of {REFERENCE_STEP}, {2 * REFERENCE_STEP} at least"
        )
    if options.draws < 1:
        parser.error(f"--draws {options.draws}: 1 at least")
    try:
        options.seconds = sorted(float(word) for word in options.seconds.split(","))
    except ValueError:
        parser.error(f"--seconds {options.seconds}: numbers with commas between them")
    return options


class Stopped(Exception):
    """--stop-after: what is still to do waits for the next call."""


class Deadline:
    def __init__(self, seconds):
        self.end, self.begun = time.monotonic() + seconds, False

    def check(self):
        """Before each run. The first one of a call is always made, so that every call gets on."""
        if self.begun and time.monotonic() > self.end:
            raise Stopped
        self.begun = True


class Scene:
    """The files of one scene, rendered with the seed of one draw (1: the file's own)."""

    def __init__(self, scene, options, polyrecon, draw=1):
        self.source = pathlib.Path(scene).resolve() if scene.endswith(".blend") else None
        self.name = self.source.stem if self.source else scene
        self.options, self.polyrecon, self.draw = options, polyrecon, draw
        self.folder = options.work.resolve() / options.size / self.name
        self.folder.mkdir(parents=True, exist_ok=True)
        self.first_blend = self.folder / "scene.blend"
        self.blend = self.first_blend if draw == 1 else self.folder / f"scene_draw_{draw}.blend"
        self.reference = self.folder / f"ref_{options.reference_spp}.exr"

    def build(self):
        """Of several draws of a scene the first one comes first."""
        if self.blend.exists():
            return
        print(f"{self.name}: building the scene", flush=True)
        first, made = self.folder / "first.exr", self.folder / "making.blend"
        words = [first, "--spp=1", f"--size={self.options.size}", "--save-blend", made]
        if self.draw > 1:
            words = [HERE / "bench_render.py", self.first_blend, *words, f"--seed={self.draw * DRAW_SEEDS}"]
        elif self.source:
            words = [HERE / "bench_render.py", self.source, *words]
        else:
            words = [ROOT / "samples" / "scenes" / "render.py", self.name, *words]
        run([self.options.python, *words])
        first.unlink()
        made.replace(self.blend)

    def picture_of(self, method, budget):
        return f"{method}_{budget:g}" + (f"_draw_{self.draw}" if self.draw > 1 else "") + ".exr"

    def render_reference(self, deadline):
        """Renders with seeds of their own, each kept as soon as it is there; their mean, and the variance of the mean."""
        if self.reference.exists():
            return
        files = []
        for seed in range(FIRST_REFERENCE_SEED, FIRST_REFERENCE_SEED + self.options.reference_spp // REFERENCE_STEP):
            files.append(self.folder / f"seed_{seed}.exr")
            if not files[-1].exists():
                deadline.check()
                print(f"{self.name}: reference, seed {seed}", flush=True)
                making = self.folder / "making.exr"
                self.render(making, spp=REFERENCE_STEP, seed=seed)
                making.replace(files[-1])
        making = self.folder / "making.exr"
        self.polyrecon.run("merge", *files, "-o", making, "--samples", str(REFERENCE_STEP), "--quiet")
        making.replace(self.reference)

    def render(self, target, **settings):
        """bench_render.py; returns the seconds that rendering itself took, {"wall", "cpu"}."""
        timing = self.folder / "timing.json"
        words = []
        for name, value in settings.items():
            words += ["--" + name] if value is True else [f"--{name}", str(value)]
        run([self.options.python, HERE / "bench_render.py", self.blend, target, "--timing", timing, *words])
        return json.loads(timing.read_text())

    def score(self, image):
        """relMSE and what else `polyrecon compare` tells of an image."""
        told = json.loads(self.polyrecon.run("compare", image, self.reference, "--json"))["results"][0]
        return {key: told[key] for key in ("relMSE", "trimmed", "energy", "bad")}


def run(words):
    code, output, errors = process.run(words)
    if code != 0:
        said = [line for line in (errors or output).splitlines() if line.strip()]
        raise DriverError(ExitCode.RENDERER, f"{pathlib.Path(words[1]).name}: {said[-1] if said else f'code {code}'}")
    return output


# Each method renders and reconstructs scene -> image, given its knob; returns the seconds that its knob governs, which
# the tuning needs, and whatever else it can tell.


def uniform(scene, image, samples):
    parts = [scene.folder / f"part_{i}.exr" for i in range(PARTS)]
    merged = scene.folder / "merged.exr"
    rendering = scene.render(scene.folder / "part.exr", spp=samples, parts=PARTS, features=True)
    scene.polyrecon.run(
        "merge", *parts, "-o", merged, "--samples", str(samples // PARTS), "--compression", "none", "--quiet"
    )
    scene.polyrecon.run("denoise", "-i", merged, "-o", image, "--quiet")
    return rendering, {"spp": samples}


def oidn(scene, image, samples):
    return scene.render(image, spp=samples, denoise=True), {"spp": samples}


def cycles(scene, image, threshold):
    return scene.render(image, spp=MOST_SAMPLES, threshold=threshold, denoise=True), {"threshold": threshold}


def uniform_prior(scene, image, samples):
    merged = scene.folder / "merged_prior.exr"
    words = ["-o", merged, "--spp", str(samples), "--parts", str(PARTS), "--bpy", "--with-prior", "--quiet"]
    run([scene.options.python, HERE / "render_passes.py", scene.blend, *words, "--polyrecon", scene.polyrecon.program])
    scene.polyrecon.run("denoise", "-i", merged, "-o", image, "--quiet")
    return None, {"spp": samples}


def prior(scene, image, amount):
    return adaptive(scene, image, amount, "--with-prior")


def adaptive(scene, image, amount, *words):
    """amount: seconds, or samples per pixel by --clock cpu."""
    passes = scene.folder / "passes"
    shutil.rmtree(passes, ignore_errors=True)
    budget = "--budget-seconds" if scene.options.clock == "wall" else "--budget-spp"
    run(
        [scene.options.python, HERE / "adaptive.py", scene.blend, "-o", image, budget, f"{amount:g}", "--bpy"]
        + ["--passes-dir", passes, "--polyrecon", scene.polyrecon.program, *words]
    )
    journal = json.loads((passes / "journal.json").read_text())
    rendering = sum(part["seconds"] for part in journal["parts"])
    return None, {"spp": sum(part["samples"] for part in journal["parts"]), "passes_seconds": rendering}


def measure(scene, method, budget, knob):
    """One run and its seconds, then its score."""
    trial = scene.folder / "trial.exr"
    wall, cpu = time.perf_counter(), children_seconds()
    governed, details = globals()[method](scene, trial, knob)
    spent = {"wall": time.perf_counter() - wall, "cpu": children_seconds() - cpu}
    seconds = spent[scene.options.clock]
    rendering = governed[scene.options.clock] if governed else seconds
    row = {
        "scene": scene.name,
        "draw": scene.draw,
        "budget": budget,
        "method": method,
        "knob": knob,
        "seconds": seconds,
    }
    row |= {"rendering": rendering, **spent, **details, **scene.score(trial), "image": scene.picture_of(method, budget)}
    draw = f" draw {scene.draw}" if scene.draw > 1 else ""
    print(
        f"{scene.name}{draw} {budget:g} s: {method} {knob:.4g}: {seconds:.1f} s, relMSE {row['relMSE']:.5f}", flush=True
    )
    return row


def children_seconds():
    """Processor seconds of all children and their children that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def next_samples(tries, target):
    """Seconds are linear in samples, beside what is fixed."""
    if not tries:
        return 2 * PARTS
    last = tries[-1]
    others = [row for row in tries if row["knob"] != last["knob"]]
    rate = last["rendering"] / last["knob"]
    if others:
        rate = max((last["seconds"] - others[-1]["seconds"]) / (last["knob"] - others[-1]["knob"]), rate / 2)
    wanted = last["knob"] + (target - last["seconds"]) / rate
    return PARTS * max(1, round(wanted / PARTS))


def next_threshold(tries, target):
    """Rendering takes ~ threshold^-slope seconds, 2 where the noise falls with the root of the samples; the slope is that of
    the last two tries. Tries begin at a coarse one, as those are cheap, and go down in steps that a flat start cannot stretch."""
    if not tries:
        return 0.1
    last, slope = tries[-1], 2.0
    if len(tries) > 1 and last["knob"] != tries[-2]["knob"]:
        change = math.log(last["rendering"] / tries[-2]["rendering"]) / math.log(last["knob"] / tries[-2]["knob"])
        slope = min(max(-change, 1.0), 4.0)
    wanted = max(target - (last["seconds"] - last["rendering"]), 0.1)
    return last["knob"] * (last["rendering"] / wanted) ** (1 / slope)


NEXT_KNOB = {method: next_samples for method in METHODS} | {"cycles": next_threshold}


class Results:
    """Every run that was made, in a file that is whole at any moment."""

    def __init__(self, path):
        self.path = path
        kept = json.loads(path.read_text()) if path.exists() else []
        self.rows = [{"draw": 1} | row for row in kept]  # files of before draws were told apart have none

    def add(self, row):
        self.rows.append(row)
        making = self.path.with_suffix(".making")
        making.write_text(json.dumps(self.rows, indent=1))
        making.replace(self.path)

    def of_all(self, scene, method):
        """Runs of all budgets and draws, which teach how dear a sample is."""
        return [row for row in self.rows if (row["scene"], row["method"]) == (scene.name, method)]

    def of(self, scene, method, budget):
        return [row for row in self.of_all(scene, method) if (row["draw"], row["budget"]) == (scene.draw, budget)]

    def best(self, scene, method, budget):
        """The run that came nearest to the seconds; None where there is none."""
        target = seconds_of(self, scene, budget)
        return min(self.of(scene, method, budget), key=lambda row: abs(row["seconds"] - target), default=None)


def next_run(results, scene, method, budget):
    """The knob of the next run of a cell, None when it is done."""
    runs = results.of(scene, method, budget)
    if method in LOOPS and scene.options.clock == "wall":
        return None if runs else budget
    target = seconds_of(results, scene, budget)
    if runs and (len(runs) >= TRIES or any(abs(row["seconds"] / target - 1) < TOLERANCE for row in runs)):
        return None
    # The first try at a budget starts from what the other budgets and draws taught.
    known = runs or results.of_all(scene, method)
    if method in LOOPS:
        known = with_rate_of_uniform(known, results.of_all(scene, "uniform"), target)
    knob = NEXT_KNOB[method](known, target)
    return None if any(row["knob"] == knob for row in runs) else knob


def with_rate_of_uniform(runs, uniform_runs, target):
    """A sample of (b) costs about what it costs (a); before any run of (b), half of the seconds are its samples."""
    if not uniform_runs:
        return runs
    rate = uniform_runs[-1]["rendering"] / uniform_runs[-1]["knob"]
    guess = {"knob": target / 2 / rate, "seconds": target}
    return [row | {"rendering": rate * row["knob"]} for row in runs or [guess]]


def seconds_of(results, scene, budget):
    """The seconds to compare at: by the clock on the wall, what (b) took."""
    runs = results.of(scene, "adaptive", budget) if scene.options.clock == "wall" else []
    return runs[0]["seconds"] if runs else budget


def bench(words):
    options = arguments(words)
    polyrecon = Polyrecon(options.polyrecon)
    try:
        draws = range(1, options.draws + 1)
        scenes = [Scene(name, options, polyrecon, draw) for name in options.scenes for draw in draws]
        rows = work(options, scenes, Deadline(options.stop_after))
    except Stopped:
        print("stopped; the next call goes on")
        return
    if rows:
        print(bench_report.table(rows))
        if options.docs:
            bench_report.write(options.docs, rows, options)


def work(options, scenes, deadline):
    """Does what is still to do; returns the rows of the table."""
    for scene in scenes:
        scene.build()
        scene.render_reference(deadline)
    if options.references:
        return []
    results = Results(options.work / options.size / f"results_{options.clock}.json")
    rows = []
    for budget in options.seconds:
        for scene in scenes:
            for method in options.methods:
                while (knob := next_run(results, scene, method, budget)) is not None:
                    deadline.check()
                    keep_nearest(results, scene, measure(scene, method, budget, knob))
                rows.append(results.best(scene, method, budget))
    return rows


def keep_nearest(results, scene, row):
    """Adds a run; its picture stays where no other run of the cell came nearer to the seconds."""
    results.add(row)
    if results.best(scene, row["method"], row["budget"]) is row:
        (scene.folder / "trial.exr").replace(scene.folder / row["image"])


def main(words=None):
    return run_main("bench.py", bench, words)


if __name__ == "__main__":
    sys.exit(main())
