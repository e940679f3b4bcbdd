#!/usr/bin/env python3
"""Compares the adaptive loop with other methods on the same scenes, in the same seconds, on one machine.

(a) uniform        the same number of samples in every pixel, then `polyrecon denoise`
(b) adaptive       pipelines/blender/adaptive.py
(c) cycles         Cycles' adaptive sampling, then Open Image Denoise; the noise threshold is tuned to the seconds
(d) oidn           uniform samples, then Open Image Denoise (albedo, normal, accurate prefilter, as in (c))
(e) prior          (b) --with-prior: Open Image Denoise gives a second opinion
(f) uniform_prior  (a) with such a prior

The seconds are those of the whole command: start-up, rendering, merging, reconstruction. (b) and (e) get them as their
budget; the others are tuned until they take as long as (b) took. On a machine that is busy with other work, --clock cpu
counts the processor seconds of all processes instead; then all methods are tuned to the budget, (b) by its samples.

References are rendered once, with other seeds, and kept. So are all results: run the bench again to continue it, or
with another budget to add rows to the table. With --draws every cell is made with so many seeds of Cycles, and its
error is their geometric mean.

  bench.py                                           everything; hours the first time, nearly all for the references
  bench.py glass fan --seconds 10,30 --size 320x180
  bench.py --methods adaptive,uniform --draws 3      how much depends on the seed
  bench.py shot.blend --size 320x180                 any file, rendered by Cycles whatever engine it is set to
  bench.py --references                              only the references
  bench.py --stop-after 90                           some of the runs; the next call continues
"""

import argparse
import json
import math
import pathlib
import resource
import shutil
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3]))
from pipelines.common import process
from pipelines.common.errors import DriverError, ExitCode, run_main
from pipelines.common.polyrecon_cli import Polyrecon
from tests.bench.blender import report

ROOT = pathlib.Path(__file__).resolve().parents[3]
DRIVERS = ROOT / "pipelines" / "blender"
RENDER = pathlib.Path(__file__).resolve().with_name("render.py")
SCENES = ("gallery", "glass", "meadow", "fan")
LOOPS = ("adaptive", "prior")  # these get a budget; the others are tuned to it
PARTS = 8  # subsets of samples that (a) renders
# A reference is the mean of renders with so many samples, each with its own seed.
REFERENCE_STEP, FIRST_REFERENCE_SEED = 64, 1001
DRAW_SEEDS = 10000  # distance of two draws' seeds; the loop takes a new seed every 256 samples
MAX_SAMPLES = 1 << 12  # samples of one pixel in (c): Blender's default
TOLERANCE, TRIES = 0.08, 4  # a run is tuned when its seconds are as near as this, or after so many tries


def arguments(words):
    parser = argparse.ArgumentParser(
        prog="bench.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{', '.join(SCENES)} (all), or a .blend file")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--seconds", default="15,45", help="budgets, with commas between (%(default)s)")
    parser.add_argument(
        "--clock", choices=("wall", "cpu"), default="wall", help="wall clock or processor seconds (wall)"
    )
    parser.add_argument("--methods", default=",".join(METHODS), help="(%(default)s)")
    parser.add_argument("--reference-spp", type=int, default=1024, help=f"a multiple of {REFERENCE_STEP} (%(default)s)")
    parser.add_argument(
        "--draws", type=int, default=1, help="seeds for each cell (%(default)s; the first is the file's)"
    )
    parser.add_argument("--references", action="store_true", help="render the references and nothing else")
    parser.add_argument("--stop-after", type=float, default=math.inf, metavar="SECONDS", help="start no run after this")
    parser.add_argument(
        "--work", type=pathlib.Path, default=ROOT / "out" / "bench", help="folder of all files (%(default)s)"
    )
    parser.add_argument(
        "--docs",
        type=pathlib.Path,
        help="write the table into this page and the plot next to it (docs/results/adaptive.md)",
    )
    parser.add_argument("--python", default=sys.executable, help="a Python that has the module bpy 5 (this one)")
    parser.add_argument("--polyrecon", help="the program")
    options = parser.parse_args(words)
    options.scenes = options.scenes or list(SCENES)
    options.methods = options.methods.split(",")
    first = "adaptive" if options.clock == "wall" else "uniform"  # the others are tuned by its results
    options.methods.sort(key=lambda method: method != first)
    files = [scene for scene in options.scenes if scene.endswith(".blend")]
    scenes = [scene for scene in options.scenes if scene not in files]
    for given, known in ((scenes, SCENES), (options.methods, METHODS)):
        if unknown := sorted(set(given) - set(known)):
            parser.error(f"{', '.join(unknown)}: not one of {', '.join(known)}")
    names = [pathlib.Path(scene).stem for scene in options.scenes]
    if len(set(names)) < len(names) or {pathlib.Path(file).stem for file in files} & set(SCENES):
        parser.error("two scenes have the same name: copy the .blend file to another name")
    if options.reference_spp < 2 * REFERENCE_STEP or options.reference_spp % REFERENCE_STEP:
        least = 2 * REFERENCE_STEP
        parser.error(
            f"--reference-spp {options.reference_spp}: must be a multiple of {REFERENCE_STEP}, {least} at least"
        )
    if options.draws < 1:
        parser.error(f"--draws {options.draws}: must be at least 1")
    try:
        options.seconds = sorted(float(word) for word in options.seconds.split(","))
    except ValueError:
        parser.error(f"--seconds {options.seconds}: write numbers with commas between them")
    return options


class DeadlinePassedError(Exception):
    """The seconds of --stop-after have passed; the next call does the remaining runs."""


class Deadline:
    def __init__(self, seconds):
        self.end, self.begun = time.monotonic() + seconds, False

    def check(self):
        """Is called before each run. A call always makes its first run, so that repeated calls finish."""
        if self.begun and time.monotonic() > self.end:
            raise DeadlinePassedError
        self.begun = True


class Scene:
    """The files of one scene, rendered with the seed of one draw. Draw 1 has the seed of the scene file."""

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
        """Makes the .blend file. The first draw must be built before the others of the same scene."""
        if self.blend.exists():
            return
        print(f"{self.name}: building the scene", flush=True)
        first, made = self.folder / "first.exr", self.folder / "making.blend"
        words = [first, "--spp=1", f"--size={self.options.size}", "--save-blend", made]
        if self.draw > 1:
            words = [RENDER, self.first_blend, *words, f"--seed={self.draw * DRAW_SEEDS}"]
        elif self.source:
            words = [RENDER, self.source, *words]
        else:
            words = [ROOT / "samples" / "scenes" / "render.py", self.name, *words]
        run([self.options.python, *words])
        first.unlink()
        made.replace(self.blend)

    def picture_of(self, method, budget):
        return f"{method}_{budget:g}" + (f"_draw_{self.draw}" if self.draw > 1 else "") + ".exr"

    def render_reference(self, deadline):
        """Merges renders with different seeds: their mean, and the variance of the mean. Finished renders are kept."""
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
        """Runs render.py; returns the seconds that rendering itself took, {"wall", "cpu"}."""
        timing = self.folder / "timing.json"
        words = []
        for name, value in settings.items():
            words += ["--" + name] if value is True else [f"--{name}", str(value)]
        run([self.options.python, RENDER, self.blend, target, "--timing", timing, *words])
        return json.loads(timing.read_text())

    def score(self, image):
        """The figures of an image by `polyrecon compare`: relMSE and others."""
        result = json.loads(self.polyrecon.run("compare", image, self.reference, "--json"))["results"][0]
        return {key: result[key] for key in ("relMSE", "trimmed", "energy", "bad")}


def run(words):
    code, output, errors = process.run(words)
    if code != 0:
        lines = [line for line in (errors or output).splitlines() if line.strip()] or [f"ended with code {code}"]
        raise DriverError(ExitCode.RENDERER, f"{pathlib.Path(words[1]).name}: {lines[-1]}")
    return output


# Each method makes the image of a scene for a value of its knob. It returns the seconds that depend on the knob, for
# the tuning (None: all seconds), and further figures for the row of results.


def uniform(scene, image, samples, *words):
    parts = [scene.folder / f"part_{i}.exr" for i in range(PARTS)]
    merged = scene.folder / "merged.exr"
    rendering = scene.render(scene.folder / "part.exr", spp=samples, parts=PARTS, features=True)
    scene.polyrecon.run(
        "merge", *parts, "-o", merged, "--samples", str(samples // PARTS), "--compression", "none", "--quiet"
    )
    scene.polyrecon.run("denoise", "-i", merged, "-o", image, "--quiet", *words)
    return rendering, {"spp": samples}


def oidn(scene, image, samples):
    return scene.render(image, spp=samples, denoise=True), {"spp": samples}


def cycles(scene, image, threshold):
    return scene.render(image, spp=MAX_SAMPLES, threshold=threshold, denoise=True), {"threshold": threshold}


def uniform_prior(scene, image, samples):
    return uniform(scene, image, samples, "--prior", "oidn")


def prior(scene, image, amount):
    return adaptive(scene, image, amount, "--with-prior")


def adaptive(scene, image, amount, *words):
    """amount: seconds, or samples per pixel with --clock cpu."""
    passes = scene.folder / "passes"
    shutil.rmtree(passes, ignore_errors=True)
    budget = "--budget-seconds" if scene.options.clock == "wall" else "--budget-spp"
    words = [budget, f"{amount:g}", "--passes-dir", passes, "--polyrecon", scene.polyrecon.program, *words]
    words += ["--keep-passes", "--overwrite"]
    run([scene.options.python, DRIVERS / "adaptive.py", scene.blend, "-o", image, "--bpy", *words])
    journal = json.loads((passes / "journal.json").read_text())
    rendering = sum(part["seconds"] for part in journal["parts"])
    return None, {"spp": sum(part["samples"] for part in journal["parts"]), "passes_seconds": rendering}


METHODS = {
    "uniform": uniform,
    "adaptive": adaptive,
    "cycles": cycles,
    "oidn": oidn,
    "prior": prior,
    "uniform_prior": uniform_prior,
}


def measure(scene, method, budget, knob):
    """Makes one run; returns its row of results."""
    trial = scene.folder / "trial.exr"
    wall, cpu = time.perf_counter(), children_seconds()
    governed, details = METHODS[method](scene, trial, knob)
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
    """Processor seconds of all child processes that have ended, and of their children."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def next_samples(tries, target):
    """Seconds grow linearly with samples, from a fixed part on."""
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
    """Rendering takes ~ threshold^-slope seconds; slope = 2 where the noise falls with the root of the samples.

    The slope is that of the last two tries, within limits, since it is low as long as the threshold is coarse. The
    first threshold is coarse because such renders are short."""
    if not tries:
        return 0.1
    last, slope = tries[-1], 2.0
    if len(tries) > 1 and last["knob"] != tries[-2]["knob"]:
        change = math.log(last["rendering"] / tries[-2]["rendering"]) / math.log(last["knob"] / tries[-2]["knob"])
        slope = min(max(-change, 1.0), 4.0)
    wanted = max(target - (last["seconds"] - last["rendering"]), 0.1)
    return last["knob"] * (last["rendering"] / wanted) ** (1 / slope)


NEXT_KNOB = dict.fromkeys(METHODS, next_samples) | {"cycles": next_threshold}


class Results:
    """The rows of all runs, in a file that is complete at any moment."""

    def __init__(self, path):
        self.path = path
        kept = json.loads(path.read_text()) if path.exists() else []
        self.rows = [{"draw": 1} | row for row in kept]  # older files have no such key

    def add(self, row):
        self.rows.append(row)
        making = self.path.with_suffix(".making")
        making.write_text(json.dumps(self.rows, indent=1))
        making.replace(self.path)

    def of_all(self, scene, method):
        """Runs of all budgets and draws. They show what a sample costs."""
        return [row for row in self.rows if (row["scene"], row["method"]) == (scene.name, method)]

    def of(self, scene, method, budget):
        return [row for row in self.of_all(scene, method) if (row["draw"], row["budget"]) == (scene.draw, budget)]

    def best(self, scene, method, budget):
        """The run that came nearest to the seconds; None without runs."""
        target = seconds_of(self, scene, budget)
        return min(self.of(scene, method, budget), key=lambda row: abs(row["seconds"] - target), default=None)


def next_run(results, scene, method, budget):
    """The knob of the next run of a cell; None if the cell is done."""
    runs = results.of(scene, method, budget)
    if method in LOOPS and scene.options.clock == "wall":
        return None if runs else budget
    target = seconds_of(results, scene, budget)
    if runs and (len(runs) >= TRIES or any(abs(row["seconds"] / target - 1) < TOLERANCE for row in runs)):
        return None
    # The first try at a budget starts from the runs of other budgets and draws.
    known = runs or results.of_all(scene, method)
    if method in LOOPS:
        known = with_rate_of_uniform(known, results.of_all(scene, "uniform"), target)
    knob = NEXT_KNOB[method](known, target)
    return None if any(row["knob"] == knob for row in runs) else knob


def with_rate_of_uniform(runs, uniform_runs, target):
    """A sample costs (b) about as much as (a). Before any run of (b), half of its seconds are assumed to be samples."""
    if not uniform_runs:
        return runs
    rate = uniform_runs[-1]["rendering"] / uniform_runs[-1]["knob"]
    guess = {"knob": target / 2 / rate, "seconds": target}
    return [row | {"rendering": rate * row["knob"]} for row in runs or [guess]]


def seconds_of(results, scene, budget):
    """The seconds at which the methods are compared: by the wall clock, those that (b) took."""
    runs = results.of(scene, "adaptive", budget) if scene.options.clock == "wall" else []
    return runs[0]["seconds"] if runs else budget


def bench(words):
    options = arguments(words)
    polyrecon = Polyrecon(options.polyrecon)
    try:
        draws = range(1, options.draws + 1)
        scenes = [Scene(name, options, polyrecon, draw) for name in options.scenes for draw in draws]
        rows = work(options, scenes, Deadline(options.stop_after))
    except DeadlinePassedError:
        print("stopped; the next call continues")
        return
    if rows:
        print(report.table(rows))
        if options.docs:
            report.write(options.docs, rows, options)


def work(options, scenes, deadline):
    """Makes the runs that are missing; returns the rows of the table."""
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
    """Adds a run. Its picture is kept if no other run of the cell came nearer to the seconds."""
    results.add(row)
    if results.best(scene, row["method"], row["budget"]) is row:
        (scene.folder / "trial.exr").replace(scene.folder / row["image"])


def main(words=None):
    return run_main("bench.py", bench, words)


if __name__ == "__main__":
    sys.exit(main())
