import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np

from pipelines.common import process
from pipelines.common.errors import DriverError, ExitCode
from pipelines.povray.scene import Crop, Scene, Shot

from .scenes import BALL, CAMERA, HEAD, LAMP, SIZE, InFolder

FLAT = HEAD % 1 + CAMERA + "plane { -z, -2 hollow pigment { rgb <0.5,0.25,0.125> } finish { ambient 1 diffuse 0 } }\n"
SLOW = FLAT + "#declare I = 0; #while (I < 1e9) #declare I = I + 1; #end\n"


def work_folders(pid):
    """The work folders of this process in /tmp, where other drivers may have some too."""
    return list(pathlib.Path("/tmp").glob(f"polyrecon-povray-{pid}-*"))


class Scenes(InFolder):
    def fails(self, code, *words, **options):
        with self.assertRaises(DriverError) as caught, Scene(*words, **options) as scene:
            scene.render()
        self.assertEqual(caught.exception.code, code)
        self.assertNotIn("\n", str(caught.exception))
        self.assertEqual(work_folders(os.getpid()), [])
        return str(caught.exception)

    def test_size_crop_and_subpixels(self):
        with Scene(self.scene(HEAD % 1 + CAMERA + BALL + LAMP), SIZE) as scene:
            self.assertEqual((scene.width, scene.height), (64, 48))
            crop = Crop(10, 7, 31, 40)
            whole, part, fine = scene.render_all([Shot(), Shot(crop=crop), Shot(scale=3, crop=crop)])
        np.testing.assert_array_equal(part, whole[7:40, 10:31])
        self.assertEqual(fine.shape, (3 * 33, 3 * 21, 3))
        self.assertLess(abs(fine.mean() / part.mean() - 1), 0.02)

    def test_awkward_names_includes_and_options_from_elsewhere(self):
        # HARD has a blank, quotes, a leading '-', '#', braces and UTF-8. It is in the names of the scene, its folder,
        # an .ini file and a library.
        folder = pathlib.Path("-d'i r\"#{}$(x) ünï")
        (folder / "sub").mkdir(parents=True)
        (folder / "sub" / "flat.inc").write_text(FLAT)
        scene = self.scene(
            '#include "sub/flat.inc"\n#include "from_library.inc"\n#include "from_here.inc"\n', folder / "-s c'e\"n.pov"
        )
        library = pathlib.Path("li b'\"rary")
        library.mkdir()
        (library / "from_library.inc").write_text("#declare A = 1;\n")
        pathlib.Path("from_here.inc").write_text("#declare B = 1;\n")
        ini = pathlib.Path("o pt'ions.ini")
        ini.write_text("[small]\nWidth=20\nHeight=10\n")
        before = sorted(pathlib.Path().rglob("*"))
        with Scene(scene, [f"{ini}[small]", f"+L{library}"]) as opened:
            self.assertEqual((opened.width, opened.height), (20, 10))
            np.testing.assert_allclose(opened.render()[5, 10], [0.5, 0.25, 0.125], rtol=1e-3)
        self.assertEqual(sorted(pathlib.Path().rglob("*")), before)

    def test_a_frame_of_an_animation(self):
        moving = FLAT.replace("ambient 1", "ambient clock")
        scene = self.scene(moving)
        with Scene(scene, [*SIZE, "+KFF3", "+SF2", "+EF2"]) as opened:
            np.testing.assert_allclose(opened.render()[5, 10], [0.25, 0.125, 0.0625], rtol=1e-3)
        self.assertIn("+SFn", self.fails(ExitCode.USAGE, scene, [*SIZE, "+KFF3"]))

    def test_failures_are_one_line_with_their_code(self):
        self.assertIn("none.pov", self.fails(ExitCode.MISSING, "none.pov"))
        flat = self.scene(FLAT)
        self.assertIn("nopovray", self.fails(ExitCode.MISSING, flat, povray="nopovray"))
        self.assertIn("none.ini", self.fails(ExitCode.MISSING, flat, ["none.ini"]))
        broken = self.scene("sphere { 0, 1 pigmint { rgb 1 } }", "broken.pov")
        said = self.fails(ExitCode.RENDERER, broken)
        self.assertRegex(said, "broken.pov.*line 1.*pigmint")
        self.assertIn("option", self.fails(ExitCode.RENDERER, flat, ["Nonsense=1"]))

    def test_a_program_that_writes_nothing(self):
        self.assertIn(
            "ended with code 7", self.fails(ExitCode.RENDERER, self.scene(FLAT), povray=self.program("exit 7"))
        )
        self.assertIn("no image", self.fails(ExitCode.RENDERER, self.scene(FLAT), povray=self.program("exit 0")))

    def program(self, text):
        path = pathlib.Path("program").absolute()
        path.write_text(f"#!/bin/sh\necho 'POV-Ray here'\n{text}\n")
        path.chmod(0o755)
        return str(path)

    def test_what_a_killed_driver_left_is_removed(self):
        ended = subprocess.Popen(["true"])
        ended.wait()
        stale = pathlib.Path(f"/tmp/polyrecon-povray-{ended.pid}-test")
        alive = pathlib.Path(f"/tmp/polyrecon-povray-{os.getpid()}-test")
        for folder in (stale, alive):
            folder.mkdir()
            self.addCleanup(lambda folder=folder: folder.exists() and folder.rmdir())
        with Scene(self.scene(FLAT), SIZE):
            self.assertEqual((stale.exists(), alive.exists()), (False, True))

    def test_time_limit(self):
        grace, process.GRACE_SECONDS = process.GRACE_SECONDS, 0.5
        self.addCleanup(setattr, process, "GRACE_SECONDS", grace)
        self.assertIn("--pass-timeout", self.fails(ExitCode.RENDERER, self.scene(SLOW), SIZE, timeout=1))

    def test_an_interrupt_leaves_no_renderer_and_no_file(self):
        command = [
            sys.executable,
            "-B",
            pathlib.Path(__file__).parents[3] / "pipelines" / "povray" / "render_passes.py",
        ]
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            driver = subprocess.Popen([*command, self.scene(SLOW), "-o", "out.exr"], stderr=subprocess.PIPE, text=True)
            while not (
                children := subprocess.run(
                    ["pgrep", "-P", str(driver.pid)], capture_output=True, text=True
                ).stdout.split()
            ):
                time.sleep(0.05)
            driver.send_signal(number)
            said = driver.communicate(timeout=20)[1]
            self.assertEqual((driver.returncode, len(said.splitlines())), (code, 1), said)
            self.assertFalse(any(os.path.exists(f"/proc/{child}") for child in children))
            self.assertEqual(os.listdir(), ["scene.pov"])
            self.assertEqual(work_folders(driver.pid), [])
