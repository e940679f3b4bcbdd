#!/usr/bin/env python3
"""Uses the installed wheel with the Python that runs this, and nothing else of the checkout:
wheel_test.py SAMPLES [TEST ...]"""

import importlib.metadata
import importlib.util
import os
import pathlib
import subprocess
import sys
import sysconfig
import tempfile
import unittest

import numpy as np
import OpenImageIO as oiio
import polyrecon

SAMPLES = pathlib.Path(sys.argv[1])
COMMANDS = pathlib.Path(sysconfig.get_path("scripts"))
PACKAGE = pathlib.Path(polyrecon.__file__).parent


def run(*words, code=0):
    """Runs a command with an empty environment, but for the PATH; returns what it prints."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, env={"PATH": "/usr/bin:/bin"})
    if done.returncode != code:
        raise AssertionError(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout + done.stderr


def channels(path):
    image = oiio.ImageBuf(str(path))
    return image.get_pixels(oiio.FLOAT), image.spec().channelnames


class Wheel(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_it_is_the_installed_one(self):
        self.assertTrue(PACKAGE.is_relative_to(sysconfig.get_path("platlib")), PACKAGE)
        self.assertEqual(polyrecon.library_path(), str(PACKAGE / "lib" / "libpolyrecon.so.1"))

    def test_the_program_and_every_driver_start(self):
        version = importlib.metadata.version("polyrecon")
        self.assertEqual(run(COMMANDS / "polyrecon", "--version").split(), ["polyrecon", version])
        scripts = [e.name for e in importlib.metadata.distribution("polyrecon").entry_points]
        self.assertIn("polyrecon-blender", scripts)
        for script in scripts:
            self.assertIn("usage:", run(COMMANDS / script, "--help"))
            # The driver runs the program that was installed with it, though it is not on the PATH.
            self.assertIn(str(PACKAGE / "bin" / "polyrecon"), run(COMMANDS / script, "--version"))

    def test_blender_as_a_module_is_missing_in_one_line(self):
        scene = self.folder / "shot.blend"
        scene.touch()
        words = [scene, "-o", self.folder / "shot.exr", "--budget-spp", "8", "--bpy"]
        told = run(COMMANDS / "polyrecon-blender", *words, code=4)
        self.assertRegex(told, r"\A.* lacks the module bpy: .* -m pip install bpy \(for Python 3.11 or 3.13\)\n\Z")

    def test_no_library_is_the_system_s(self):
        """Only those that every Linux has (of the policy manylinux) come from elsewhere."""
        found = run("ldd", PACKAGE / "bin" / "polyrecon") + run("ldd", PACKAGE / "lib/polyrecon/polyrecon_pictures.so")
        paths = {line.split()[2] for line in found.splitlines() if "=>" in line}
        foreign = {os.path.basename(p).split(".so")[0] for p in paths if not p.startswith(str(PACKAGE.parent))}
        self.assertLessEqual(foreign, {"libc", "libm", "libdl", "libpthread", "libstdc++", "libgcc_s", "libz", "librt"})

    def test_the_samples(self):
        noisy, clean, error = SAMPLES / "study_small_0.exr", self.folder / "clean.exr", self.folder / "error.exr"
        run(COMMANDS / "polyrecon", "denoise", "-i", noisy, "-o", clean, "--error-map", error, "--quality", "draft")
        run(COMMANDS / "polyrecon", "preview", noisy, clean, error, "-o", picture := self.folder / "look.png")
        pixels, _ = channels(picture)
        # The caption's letters: a font is there, though none is installed.
        self.assertGreater(pixels[:20, :, :3].std(), 0.02)

    def test_arrays(self):
        render = polyrecon.read(SAMPLES / "study_small_0.exr")
        clean = polyrecon.denoise(render, quality="draft").image
        self.assertEqual(clean.shape, render["beauty"].shape)
        self.assertAlmostEqual(float(clean.mean() / render["beauty"].mean()), 1, delta=1e-3)
        self.assertLess(np.abs(np.diff(clean, axis=0)).mean(), np.abs(np.diff(render["beauty"], axis=0)).mean())

    def test_open_image_denoise(self):
        """Program and library use the package pyoidn where it is installed, else they say how to install it."""
        noisy, target = SAMPLES / "study_small_0.exr", self.folder / "both.exr"
        words = [COMMANDS / "polyrecon", "denoise", "-i", noisy, "--prior", "oidn", "--quality", "draft", "-o", target]
        render = polyrecon.read(noisy)
        if importlib.util.find_spec("pyoidn"):
            clean = polyrecon.denoise(render, quality="draft").image
            both = polyrecon.denoise(render, prior="oidn", quality="draft").image
            self.assertGreater(np.abs(both - clean).max(), 0.01)
            run(*words)
            self.assertTrue(target.exists())
            self.assertIn(f"{PACKAGE.parent}/pyoidn/", run(COMMANDS / "polyrecon", "inspect", noisy))
        else:
            with self.assertRaises(polyrecon.Error) as missing:
                polyrecon.denoise(render, prior="oidn", quality="draft")
            self.assertEqual(missing.exception.exit_code, 4)
            self.assertIn("pip install pyoidn", str(missing.exception))
            self.assertIn("pip install pyoidn", run(*words, code=4))

    def test_newer_compressions_are_read(self):
        """Files as OpenEXR 3.4 and 3.5 write them, without loss, give the same bits as ZIP."""
        source = oiio.ImageBuf(str(SAMPLES / "study_small_0.exr"))
        results = {}
        for compression, name in (("zip", "zip"), ("htj2k256", "htj2k"), ("zstd", "zstd")):
            path = self.folder / f"{compression}.exr"
            source.specmod().attribute("compression", compression)
            self.assertTrue(source.write(str(path)), source.geterror())
            self.assertIn(f"scanline {name},", run(COMMANDS / "polyrecon", "inspect", path))
            clean = self.folder / f"{compression}_clean.exr"
            run(COMMANDS / "polyrecon", "denoise", "-i", path, "-o", clean, "--quality", "draft")
            results[compression], _ = channels(clean)
        for compression in ("htj2k256", "zstd"):
            np.testing.assert_array_equal(results[compression], results["zip"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
