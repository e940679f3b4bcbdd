"""Attacks on the POV-Ray drivers by scenes and their files. POV-Ray is the real one."""

import os
import pathlib
import subprocess
import sys

import numpy as np

from pipelines.common import exr
from pipelines.common.errors import DriverError, ExitCode
from pipelines.povray import inputs
from pipelines.povray.renderer import PovrayRenderer
from pipelines.povray.scene import Scene

from .scenes import BALL, CAMERA, HEAD, LAMP, SIZE, InFolder

ROOT = pathlib.Path(__file__).resolve().parents[3]
WRITING = '#fopen F "{name}" write\n#write (F, "#declare Grey = 0.25;")\n#fclose F\n#include "{name}"\n'
GREY = HEAD % 1 + CAMERA + "plane { -z, -2 pigment { rgb Grey } finish { ambient 1 diffuse 0 } }\n"


class Attacks(InFolder):
    def render(self, text, options=SIZE):
        with Scene(self.scene(text), options) as scene:
            return scene.render()

    def test_pov_writes(self):
        """A scene may write files for itself, but none that anyone else sees."""
        pathlib.Path("outside").mkdir()
        pathlib.Path("mine.inc").write_text("precious")
        for name in (
            "outside/new.inc",
            "mine.inc",
            "../new.inc",
            f"{pathlib.Path.home()}/polyrecon_test.inc",
            "/tmp/n",
        ):
            with self.subTest(name), self.assertRaisesRegex(DriverError, "Cannot open user file") as caught:
                self.render(WRITING.format(name=name) + GREY)
            self.assertEqual(caught.exception.code, ExitCode.RENDERER)
            self.assertFalse(os.path.exists(name) and name != "mine.inc")
        np.testing.assert_allclose(self.render(WRITING.format(name="new.inc") + GREY), 0.25, rtol=1e-3)
        self.assertEqual(pathlib.Path("mine.inc").read_text(), "precious")
        self.assertEqual(sorted(os.listdir()), ["mine.inc", "outside", "scene.pov"])

    def test_names_in_the_folder_above(self):
        pathlib.Path("grey.inc").write_text("#declare Grey = 0.5;\n")
        pathlib.Path("sub").mkdir()
        with Scene(self.scene('#include "../grey.inc"\n' + GREY, pathlib.Path("sub/scene.pov")), SIZE) as scene:
            np.testing.assert_allclose(scene.render(), 0.5, rtol=1e-3)

    def test_povray_ini_beside_the_scene(self):
        """It is read, as POV-Ray does, and can neither choose the output nor end the driver with a traceback."""
        scene = self.scene(HEAD % 1 + CAMERA + BALL + LAMP)
        for line, size in (("+W24 +H16", (24, 16)), ("Output_File_Name=victim.exr\nWidth=24\nHeight=16", (24, 16))):
            pathlib.Path("povray.ini").write_text(line.replace(" ", "\n") + "\n")
            with Scene(scene) as opened:
                self.assertEqual((opened.width, opened.height), size)
                self.assertEqual(opened.render().shape, (16, 24, 3))
        for line in ("Width=0", "+W0\n+H0", "garbage $$", "All_Console=off", "Final_Frame=3", "+SC0\n+EC0"):
            pathlib.Path("povray.ini").write_text(line + "\n")
            command = [sys.executable, ROOT / "pipelines/povray/render_passes.py", scene, "-o", "out.exr", "-q"]
            done = subprocess.run([*command, "--timeout", "60"], capture_output=True, text=True)
            self.assertIn(done.returncode, (0, ExitCode.USAGE, ExitCode.RENDERER), f"{line}: {done.stderr}")
            self.assertEqual(len(done.stderr.splitlines()), 0 if done.returncode == 0 else 1, done.stderr)
        self.assertEqual(set(os.listdir()) - {"out.exr"}, {"povray.ini", "scene.pov"})

    def test_a_frame_without_pixels(self):
        program = pathlib.Path("program").absolute()
        picture = pathlib.Path("picture.exr").absolute()
        exr.write(picture, {channel: np.zeros((1, 1)) for channel in "RGB"})
        program.write_text(
            f"#!/bin/sh\nfor word; do case $word in +O*) cp {picture} ${{word#+O}};; esac; done\n"
            "echo 'Image resolution.. 0 by 0'\n"
        )
        program.chmod(0o755)
        with self.assertRaisesRegex(DriverError, "a size of 0 x 0 pixels") as caught:
            Scene(self.scene(BALL), povray=str(program))
        self.assertEqual(caught.exception.code, ExitCode.USAGE)

    def test_swapped_files_of_a_scene(self):
        """Each file that the scene names is an input: included, in a library, by an .ini file, a picture."""
        files = ["a.inc", "b.inc", "picture.png", "lib/c.inc", "povray.ini", "more.ini"]
        pathlib.Path("lib").mkdir()
        for name in files:
            pathlib.Path(name).touch()
        pathlib.Path("a.inc").write_text('#include "b.inc"\n#include "c.inc"\n#include "a.inc"\n#include "gone.inc"\n')
        pathlib.Path("more.ini").write_text("[one]\nLibrary_Path=lib\n")
        pathlib.Path("unused.inc").touch()
        scene = self.scene('#include "a.inc"\nsphere { 0, 1 pigment { image_map { png "picture.png" } } }\n')
        found = {os.path.relpath(path) for path in inputs.used(scene, ["+W8", "more.ini[one]"])}
        self.assertEqual({path for path in found if not path.startswith("..")}, {*files, "scene.pov"})

    def test_a_file_that_changes_while_it_is_rendered(self):
        pathlib.Path("grey.inc").write_text("#declare Grey = 0.5;\n")
        scene = self.scene('#include "grey.inc"\n' + GREY)
        renderer = PovrayRenderer(scene, list(SIZE), "povray", None, 4)
        self.addCleanup(renderer.close)
        renderer.begin(None)
        renderer.uniform(0, 2, pathlib.Path("part_0a0.exr"))
        pathlib.Path("grey.inc").write_text("#declare Grey = 0.6;\n")
        with self.assertRaisesRegex(DriverError, "grey.inc: changed while it was rendered"):
            renderer.extra(4, np.full((48, 64), 4), pathlib.Path("part_1a0.exr"))
        self.assertFalse(pathlib.Path("part_1a0.exr").exists())
