"""Two rounds of LuxCore against even samples at equal samples: the second round follows polyrecon's sample map. Prints
the relMSE of both and their ratio for each seed:

    python3 -m tests.pipelines.real_files.sampling_luxcore [--seeds N]
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from pipelines.common import exr
from pipelines.common.polyrecon_cli import Polyrecon

from ...bench.relmse import relative_squares

SCRIPT = Path(__file__).with_name("render_luxcore.py")
SIZE = "64x48"
FIRST, SECOND = 8, 16  # Samples per pixel of a half in each round
REFERENCE = 16384


class Films:
    def __init__(self, folder):
        self.folder, self.polyrecon = Path(folder), Polyrecon()

    def film(self, name, seed, spp, importance=None):
        """Renders; returns the file of the picture, next to which its passes are."""
        words = [self.folder / f"{name}_", seed, "--size", SIZE, "--spp", spp, "--lamp"]
        if importance is not None:
            np.save(self.folder / f"{name}.npy", importance)
            words += ["--importance", self.folder / f"{name}.npy"]
        subprocess.run([sys.executable, "-B", SCRIPT, *map(str, words)], check=True, capture_output=True)
        return self.folder / f"{name}_RGB_IMAGEPIPELINE.exr"

    def samples(self, film):
        return exr.read(film.with_name(film.name.replace("RGB_IMAGEPIPELINE", "SAMPLECOUNT")))["R"]

    def denoised(self, name, halves, *words):
        """The picture that is made of these renders, a list for each half."""
        merged, clean = self.folder / f"{name}_merged.exr", self.folder / f"{name}_clean.exr"
        self.polyrecon.run("merge", *halves[0], "--half-b", *halves[1], "-o", merged, "--quiet")
        self.polyrecon.run("denoise", "-i", merged, "-o", clean, "--quiet", *words)
        channels = exr.read(clean)
        return np.stack([channels[f"RGB_IMAGEPIPELINE.{c}"] for c in "RGB"], -1)

    def two_rounds(self, seed):
        """Pictures (by the map, even), and the samples of both, each a mean per pixel."""
        seeds = range(10 * seed + 1, 10 * seed + 7)
        first = [[self.film(f"first{half}", seeds[half], FIRST)] for half in (0, 1)]
        error_map, sample_map = self.folder / "error.exr", self.folder / "map.exr"
        self.denoised("first", first, "--error-map", error_map)
        words = ["--error-map", error_map, "--budget", 2 * SECOND, "--export", "luxcore"]
        self.polyrecon.run("samplemap", *words, "-o", sample_map, "--quiet")
        importance = exr.read(sample_map)["Y"]
        placed = [[self.film(f"placed{half}", seeds[2 + half], SECOND, importance)] for half in (0, 1)]
        even = [[self.film(f"even{half}", seeds[4 + half], SECOND)] for half in (0, 1)]
        pictures = [
            self.denoised(name, [a + b for a, b in zip(first, second)])
            for name, second in (("placed", placed), ("even", even))
        ]
        counts = [[self.samples(film) for (film,) in second] for second in (placed, even)]
        return pictures, counts, importance

    def reference(self, spp):
        channels = exr.read(self.film("reference", 999, spp))
        return np.stack([channels[c] for c in "RGB"], -1)


def relmse(picture, reference):
    return float(np.mean(relative_squares(picture, reference)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=8)
    seeds = parser.parse_args().seeds
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        films = Films(folder)
        reference = films.reference(REFERENCE)
        for seed in range(seeds):
            pictures, counts, _ = films.two_rounds(seed)
            placed, even = (relmse(picture, reference) for picture in pictures)
            spent = [np.mean(one) for one in counts]
            ratios.append(placed / even)
            print(
                f"{seed}: map {placed:.2e} ({spent[0]:.1f} spp), even {even:.2e} ({spent[1]:.1f} spp): {ratios[-1]:.3f}"
            )
    print(f"geometric mean {np.exp(np.mean(np.log(ratios))):.3f}")


if __name__ == "__main__":
    main()
