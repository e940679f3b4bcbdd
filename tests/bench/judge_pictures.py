#!/usr/bin/env python3
"""Makes the pictures of docs/guide/judge.md: pages of view and compare in a real browser. Needs Chromium, its driver
and OpenImageIO's Python module. Under two minutes.

usage: judge_pictures.py [PROGRAM]
"""

import pathlib
import subprocess
import sys
import tempfile

import OpenImageIO as oiio

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "end_to_end"))
from browser import browser

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
PICTURES = ROOT / "docs" / "guide" / "pictures"
WIDTH, HEIGHT = 1440, 860


def save(page, name, folder):
    page.until("!drawRequested && document.documentElement.dataset.drawn")
    page.screenshot(folder / "shot.png")
    shot = oiio.ImageBuf(str(folder / "shot.png"))
    smaller = oiio.ImageBufAlgo.resize(shot, roi=oiio.ROI(0, WIDTH * 3 // 4, 0, HEIGHT * 3 // 4, 0, 1, 0, 3))
    smaller.specmod().attribute("CompressionQuality", 85)
    if not smaller.write(str(PICTURES / name)):
        raise SystemExit(smaller.geterror())


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build" / "release" / "src" / "polyrecon")
    noisy, reference = SAMPLES / "study_16.exr", SAMPLES / "study_ref.exr"
    with tempfile.TemporaryDirectory() as name, browser(WIDTH, HEIGHT) as page:
        folder = pathlib.Path(name)
        clean, error, look, judged = (folder / file for file in ("clean.exr", "error.exr", "look.html", "judged.html"))
        for words in (
            ["denoise", "-i", noisy, "-o", clean, "--error-map", error, "--overwrite", "-q"],
            ["view", noisy, clean, error, "--reference", reference, "-o", look, "--overwrite"],
            ["compare", noisy, clean, reference, "--html", judged, "--overwrite"],
        ):
            subprocess.run([program, *map(str, words)], check=True, stdout=subprocess.DEVNULL)
        page.open(look, "#a=0&b=1&mode=wipe&pixel=[152,58]")
        page.until("document.querySelectorAll('#maps [data-value]').length")
        save(page, "judge_view.jpg", folder)
        page.open(look, "#a=1&b=0&mode=difference&kind=relative")
        save(page, "judge_difference.jpg", folder)
        page.open(judged)
        page.until("document.documentElement.dataset.drawn")
        page.run("document.querySelector('.report').scrollIntoView()")
        save(page, "judge_compare.jpg", folder)


if __name__ == "__main__":
    main()
