"""Blender 5 builds, checks, installs and uses the extension, without a window."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

_resources = tempfile.TemporaryDirectory(prefix="polyrecon_resources_")
# bpy reads this when it is imported; the user's settings do not change.
os.environ["BLENDER_USER_RESOURCES"] = _resources.name

import bpy  # noqa: E402
import numpy as np  # noqa: E402

from pipelines.common import exr  # noqa: E402
from pipelines.common.polyrecon_cli import find_polyrecon  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]
SOURCE = ROOT / "pipelines" / "blender" / "extension"
MODULE = "bl_ext.user_default.polyrecon"
JOB_SECONDS = 240  # limit of a job, on a busy machine


def extension_tool(*words):
    """Runs the tool of Blender behind `blender --command extension`."""
    tool = (
        pathlib.Path(bpy.utils.resource_path("LOCAL")) / "scripts" / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    )
    return subprocess.run([sys.executable, str(tool), *map(str, words)], capture_output=True, text=True)


class Extension(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        package = pathlib.Path(_resources.name) / "polyrecon.zip"
        built = extension_tool("build", "--source-dir", SOURCE, "--output-filepath", package)
        if built.returncode != 0:
            raise AssertionError(built.stdout + built.stderr)
        bpy.ops.extensions.package_install_files(repo="user_default", filepath=str(package), enable_on_install=True)
        cls.addon = sys.modules[MODULE]
        cls.jobs = sys.modules[MODULE + ".jobs"]
        cls.preferences = bpy.context.preferences.addons[MODULE].preferences
        cls.preferences.program = str(find_polyrecon())
        cls.preferences.drivers = str(SOURCE.parent)
        cls.preferences.python = sys.executable

    @classmethod
    def tearDownClass(cls):
        bpy.ops.preferences.addon_disable(module=MODULE)
        assert not hasattr(bpy.types.Scene, "polyrecon")

    def setUp(self):
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=False)
        if MODULE not in bpy.context.preferences.addons:
            self.fail("the extension does not survive a new file")
        folder = tempfile.TemporaryDirectory(prefix="polyrecon ü ")  # a path with a space and an umlaut
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.scene = bpy.context.scene
        self.scene.render.engine = "CYCLES"
        self.scene.cycles.device = "CPU"
        self.scene.cycles.samples = 4
        self.scene.render.resolution_x, self.scene.render.resolution_y = 64, 36
        self.scene.polyrecon.output = str(self.folder / "clean_####.exr")

    def finish(self, job):
        """Polls like the timer, which needs a window; returns the longest time of a poll."""
        longest, end = 0.0, time.monotonic() + JOB_SECONDS
        while True:
            begin = time.monotonic()
            running = job.poll()
            longest = max(longest, time.monotonic() - begin)
            if not running:
                return longest
            self.assertLess(time.monotonic(), end, list(job.lines))
            time.sleep(0.05)

    def combined(self, name):
        found = exr.read(self.folder / name, lambda channel: channel.startswith("ViewLayer.Combined."))
        return np.stack([found[f"ViewLayer.Combined.{c}"] for c in "RGB"], axis=-1)

    def drawn(self, draw):
        """The layout that draw(popup) makes, as text. A popup has a layout without a window."""
        popup = bpy.context.window_manager.popmenu_begin__internal("test", icon="NONE")
        draw(popup)
        return str(popup.layout.introspect())

    def shown_text(self):
        """The labels of the panel, with their lines joined."""
        return " ".join(re.findall(r"'draw_string': '([^']*)'", self.panel()))

    def panel(self):
        return self.drawn(lambda popup: bpy.types.POLYRECON_PT_render.draw(popup, bpy.context))

    def test_manifest_passes_blenders_checks(self):
        checked = extension_tool("validate", SOURCE)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.assertNotIn("warning", (checked.stdout + checked.stderr).lower())

    def test_frame_names_are_those_of_the_drivers(self):
        """The names are in the table that the tests of the drivers read."""
        frame_path = sys.modules[MODULE + ".settings"].frame_path
        table = json.loads((ROOT / "tests" / "inputs" / "frame_names.json").read_text(encoding="utf-8"))
        for row in table["names"]:
            self.assertEqual(frame_path(row["pattern"], row["frame"]), row["name"])
        for name in table["no_patterns"]:
            self.assertEqual(frame_path(name, 7), name)

    def test_panel_is_in_render_properties(self):
        panel = bpy.types.POLYRECON_PT_render
        self.assertEqual((panel.bl_space_type, panel.bl_context), ("PROPERTIES", "render"))
        self.assertTrue(panel.poll(bpy.context))
        for button in ("set_up_passes", "denoise", "adaptive"):
            self.assertIn(f"bpy.ops.polyrecon.{button}()", self.panel())
        self.scene.render.engine = "BLENDER_WORKBENCH"
        self.assertFalse(panel.poll(bpy.context))

    def test_sets_up_passes_once(self):
        self.scene.cycles.use_denoising = self.scene.cycles.use_adaptive_sampling = True
        set_up = sys.modules[MODULE + ".operators"].set_up_passes
        self.assertEqual(bpy.ops.polyrecon.set_up_passes(), {"FINISHED"})
        layer = bpy.context.view_layer.cycles
        self.assertTrue(layer.denoising_store_passes and layer.pass_debug_sample_count)
        self.assertFalse(self.scene.cycles.use_denoising or self.scene.cycles.use_adaptive_sampling)
        self.assertEqual(set_up(self.scene, bpy.context.view_layer), [])

    def test_denoises_the_last_render_in_the_background(self):
        bpy.ops.polyrecon.set_up_passes()
        bpy.ops.render.render()
        before = self.scene.render.image_settings.file_format
        self.assertEqual(bpy.ops.polyrecon.denoise(), {"FINISHED"})
        job = self.jobs.current
        self.assertTrue(job.running)  # The operator does not wait for the program.
        self.assertFalse(bpy.ops.polyrecon.denoise.poll())  # There is one job at a time.
        self.assertIn("bpy.ops.polyrecon.cancel()", self.panel())
        self.assertLess(self.finish(job), 0.5)
        self.assertEqual((job.state, job.error), ("done", ""))
        self.assertEqual(self.scene.render.image_settings.file_format, before)
        self.assertNotIn("bpy.ops.polyrecon.cancel()", shown := self.panel())
        self.assertIn("Denoise: done", shown)
        self.assertIn("bpy.ops.polyrecon.show(which='ERROR')", shown)
        noisy, clean = self.combined("clean_0001_noisy.exr"), self.combined("clean_0001.exr")
        self.assertGreater(np.abs(clean - noisy).max(), 1e-3)
        self.assertAlmostEqual(clean.mean() / noisy.mean(), 1, delta=1e-3)
        for which, name, kind in (
            ("CLEAN", "clean_0001.exr", "MULTILAYER"),
            ("ERROR", "clean_0001_error.png", "IMAGE"),
        ):
            self.assertEqual(bpy.ops.polyrecon.show(which=which), {"FINISHED"})
            len(bpy.data.images[name].pixels)  # This makes Blender read the file.
            self.assertEqual(bpy.data.images[name].type, kind)
        self.assertGreater(bpy.data.images["clean_0001_error.png"].size[0], 0)

    def test_the_panel_says_which_passes_are_missing(self):
        bpy.context.view_layer.cycles.denoising_store_passes = False
        bpy.ops.render.render()
        bpy.ops.polyrecon.denoise()
        self.finish(self.jobs.current)
        self.assertEqual((self.jobs.current.state, self.jobs.current.error), ("done", ""))
        self.assertRegex(self.shown_text(), "Could be better: no albedo .*no normal .*Data > Denoising Data")
        bpy.ops.polyrecon.set_up_passes()
        bpy.ops.render.render()
        bpy.ops.polyrecon.denoise()
        self.finish(self.jobs.current)
        self.assertNotIn("albedo", self.shown_text())

    def test_renders_adaptively_and_goes_on(self):
        self.scene.polyrecon.limit, self.scene.polyrecon.spp = "SPP", 12
        self.assertEqual(bpy.ops.polyrecon.adaptive(), {"FINISHED"})
        job, phases = self.jobs.current, set()
        while job.poll():
            phases.add(job.phase)
            self.assertTrue(0 <= job.fraction <= 1)
            time.sleep(0.05)
        self.assertEqual((job.state, job.error), ("done", ""))
        self.assertTrue(any("spp" in phase for phase in phases), phases)
        self.assertFalse([name for name, path in job.results.items() if not path.exists()])
        self.assertEqual(self.combined("clean_0001.exr").shape, (36, 64, 3))
        self.assertEqual(bpy.ops.polyrecon.show(which="NOISY"), {"FINISHED"})

        def passes():
            return {path: path.stat().st_mtime_ns for path in (self.folder / "clean_0001.passes").glob("part_*.exr")}

        before = passes()
        self.scene.polyrecon.spp, self.scene.polyrecon.resume = 16, True
        bpy.ops.polyrecon.adaptive()
        self.finish(self.jobs.current)
        self.assertEqual((self.jobs.current.state, self.jobs.current.error), ("done", ""))
        after = passes()
        self.assertEqual(before, {path: after[path] for path in before})  # Nothing is rendered again.
        self.assertGreater(len(after), len(before))

    def test_cancel_stops_the_loop_and_its_blender(self):
        self.scene.polyrecon.seconds = 600
        self.scene.cycles.samples = 4
        bpy.ops.polyrecon.adaptive()
        job = self.jobs.current
        while job.poll() and job.fraction == 0:
            time.sleep(0.05)
        self.assertTrue(job.running, list(job.lines))
        begin = time.monotonic()
        bpy.ops.polyrecon.cancel()
        self.assertLess(time.monotonic() - begin, 0.5)
        self.finish(job)
        self.assertEqual(job.state, "cancelled")
        with self.assertRaises(ProcessLookupError):
            os.killpg(job._child.pid, 0)
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                words = (process / "cmdline").read_bytes()
            except OSError:
                continue
            self.assertNotIn(os.fsencode(self.folder), words)

    def test_says_what_is_missing(self):
        for message, prepare in (
            ("render the frame first", lambda: None),
            ("relative to the .blend", lambda: setattr(self.scene.polyrecon, "output", "//clean.exr")),
            ("must be an .exr file", lambda: setattr(self.scene.polyrecon, "output", str(self.folder / "clean.png"))),
            ("no such program", lambda: setattr(self.preferences, "program", "/nowhere/polyrecon")),
        ):
            with self.subTest(message):
                program = self.preferences.program
                self.scene.polyrecon.output = str(self.folder / "clean_####.exr")
                prepare()
                with self.assertRaisesRegex(RuntimeError, message):
                    bpy.ops.polyrecon.denoise()
                self.preferences.program = program

    def test_a_failing_program_is_told(self):
        job = self.jobs.start("Denoise", [[str(find_polyrecon()), "denoise", "-i", "no.exr", "-o", "o.exr"]], {})
        self.finish(job)
        self.assertEqual(job.state, "failed")
        self.assertIn("no.exr", job.error)
        self.assertIn(job.error, self.shown_text())

    def test_preferences_tell_what_they_find(self):
        draw = sys.modules[MODULE + ".preferences"].draw
        shown = self.drawn(lambda popup: draw(popup.layout, self.preferences))
        self.assertIn(str(find_polyrecon()), shown)
        self.assertIn("PolyreconPreferences.python", shown)

    def test_command_line(self):
        """`blender -c polyrecon` calls this function. Blender as a module has no such option."""
        run = sys.modules[MODULE + ".command_line"].run
        self.assertEqual(run(["--help"]), 0)
        self.assertEqual(run(["inspect", str(ROOT / "samples" / "study_small_0.exr")]), 0)
        self.assertEqual(run(["inspect", "no.exr"]), 4)
        self.assertEqual(run(["nonsense"]), 2)


if __name__ == "__main__":
    unittest.main()
