#!/usr/bin/env python3
"""Renders the shipped samples again: scenes/ -> parts -> `polyrecon merge` -> the files next to this script.

This needs Blender 3.4 (Debian: apt-get install blender), a Python that has the Blender 5 module (pip install
bpy==5.0.1), oiiotool, and a build of polyrecon. It takes under an hour on two cores, nearly all of it for the
references."""

import argparse
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
RENDER = HERE / "scenes" / "render.py"
REFERENCE_RENDERS = 16  # with different seeds


class Tools:
    def __init__(self, options):
        self.work = pathlib.Path(options.work).resolve()
        self.polyrecon = options.polyrecon
        self.blender = {
            3: [options.blender3, "-b", "-Y", "--factory-startup", "--python-exit-code", "7", "-P", str(RENDER), "--"],
            5: [options.blender5, str(RENDER)],
        }
        self.work.mkdir(parents=True, exist_ok=True)

    def render(self, version, scene, name, parts=1, **options):
        """Renders the parts that are not in the work folder; returns all files."""
        files = [self.work / (f"{name}_{i}.exr" if parts > 1 else f"{name}.exr") for i in range(parts)]
        if not all(file.exists() for file in files):
            named = {"--" + key.replace("_", "-"): value for key, value in options.items()}
            words = [name if value is True else f"{name}={value}" for name, value in named.items()]
            run(self.blender[version] + [scene, str(self.work / f"{name}.exr"), f"--parts={parts}", *words], quiet=True)
        return files

    def merge(self, files, name, samples):
        target = self.work / name
        # Blender 5 writes the number of samples of the whole sequence into each subset.
        each = samples // len(files)
        run([self.polyrecon, "merge", *map(str, files), "-o", str(target), "--overwrite", "--samples", str(each)])
        return target


def run(command, quiet=False):
    print("+", " ".join(command), flush=True)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL if quiet else None)


def channels(file):
    info = subprocess.run(["oiiotool", "--info", "-v", str(file)], check=True, capture_output=True, text=True).stdout
    line = next(line for line in info.splitlines() if "channel list:" in line)
    names = line.split(":", 1)[1].split(",")
    return [name.strip().partition(" (")[0] for name in names]  # It is "NAME (half)" if types are mixed.


def ship_halves(merged, target):
    """Stores means and half buffers as half floats, whose rounding error, 5e-4, is far below the noise at 16 samples.
    Variances stay floats, since the smallest half float is 6e-8."""
    kinds = []
    for name in channels(merged):
        layer = name.rpartition(".")[0]
        if "Combined" in layer or "Denoising" in layer or "Shadow" in layer:
            kinds += ["-d", f"{name}={'float' if layer.endswith('Variance') else 'half'}"]
    run(["oiiotool", "--nosoftwareattrib", str(merged), *kinds, "--compression", "zip", "-o", str(target)])


def ship_reference(merged, target):
    """Stores the beauty and the variance of its mean as floats. Scores subtract that variance."""
    keep = [f"ViewLayer.Combined{kind}.{c}" for kind in ("", " Variance") for c in "RGB"]
    run(
        [
            "oiiotool",
            "--nosoftwareattrib",
            str(merged),
            "--ch",
            ",".join(keep),
            "--compression",
            "zip",
            "-o",
            str(target),
        ]
    )


def reference(tools, version, scene, spp):
    each = spp // REFERENCE_RENDERS
    parts = tools.render(version, scene, f"{scene}_ref", REFERENCE_RENDERS, spp=each, seeds=True, single_part=True)
    merged = tools.merge(parts, f"{scene}_ref.exr", spp)
    ship_reference(merged, HERE / f"{scene}_ref.exr")


def study(tools):
    """Blender 5: eight subsets, merged; four small subsets as Blender writes them; a render denoised by Blender."""
    parts = tools.render(5, "study", "study_part", 8, passes="denoising,samples")
    ship_halves(tools.merge(parts, "study_16.exr", 16), HERE / "study_16.exr")
    for part in tools.render(
        5, "study", "study_small", 4, size="160x90", passes="denoising,samples,light-groups", depth=16
    ):
        copy(part, HERE / part.name)
    for file in tools.render(5, "study", "study_denoised_16", passes="denoising", depth=16, denoise=True):
        copy(file, HERE / file.name)
    reference(tools, 5, "study", 2048)


def glass(tools):
    """Blender 3.4: eight subsets, merged, with Shadow and Cryptomatte."""
    parts = tools.render(3, "glass", "glass_part", 8, passes="denoising,samples,shadow,cryptomatte")
    ship_halves(tools.merge(parts, "glass_16.exr", 16), HERE / "glass_16.exr")
    reference(tools, 3, "glass", 4096)


def lighthouse(tools):
    """Blender 5: one ordinary render, without variance or half buffers."""
    for file in tools.render(
        5, "lighthouse", "lighthouse_16", passes="denoising,samples,cryptomatte,ao,depth", depth=16
    ):
        copy(file, HERE / file.name)
    reference(tools, 5, "lighthouse", 2048)


def copy(source, target):
    target.write_bytes(source.read_bytes())


def main():
    scenes = {"study": study, "glass": glass, "lighthouse": lighthouse}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="*", default=list(scenes), help="study, glass, lighthouse (all)")
    parser.add_argument("--work", default=str(HERE.parent / "out" / "samples"), help="folder for the parts")
    parser.add_argument("--blender3", default="blender", help="Blender 3.4")
    parser.add_argument("--blender5", default=sys.executable, help="Python with bpy 5.0.1")
    parser.add_argument("--polyrecon", default=str(HERE.parent / "build" / "release" / "src" / "polyrecon"))
    options = parser.parse_args()
    unknown = set(options.scene) - set(scenes)
    if unknown:
        parser.error(f"no such scene: {', '.join(sorted(unknown))}")
    tools = Tools(options)
    for scene in options.scene:
        scenes[scene](tools)


if __name__ == "__main__":
    main()
