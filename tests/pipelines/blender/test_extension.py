"""Blender 5 checks, installs and uses the extension, without a window.

$POLYRECON_BLENDER_ZIP names the zip to test, with the program in its wheel. Without it a zip is made whose wheel has
the drivers alone; the program is then the drivers' ($POLYRECON)."""

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

ROOT = pathlib.Path(__file__).resolve().parents[3]
SOURCE = ROOT / "pipelines" / "blender" / "extension"
MODULE = "bl_ext.user_default.polyrecon"
JOB_SECONDS = 240  # limit of a job, on a busy machine


def make_zip(folder):
    """A zip with the wheel of the drivers, made by the command that makes the real one."""
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps"]
    subprocess.run([*pip, "--config-settings=wheel.cmake=false", "--wheel-dir", folder, ROOT], check=True)
    target = folder / "polyrecon.zip"
    subprocess.run(
        [sys.executable, ROOT / "src" / "package" / "blender_zip.py", *folder.glob("*.whl"), target],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return target


def extension_tool(*words):
    """Runs the tool of Blender behind `blender --command extension`."""
    tool = (
        pathlib.Path(bpy.utils.resource_path("LOCAL")) / "scripts" / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    )
    return subprocess.run([sys.executable, str(tool), *map(str, words)], capture_output=True, text=True)


class Extension(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        named = os.environ.get("POLYRECON_BLENDER_ZIP")
        cls.package = pathlib.Path(named) if named else make_zip(pathlib.Path(_resources.name))
        bpy.ops.extensions.package_install_files(repo="user_default", filepath=str(cls.package), enable_on_install=True)
        cls.addon = sys.modules[MODULE]
        cls.jobs = sys.modules[MODULE + ".jobs"]
        cls.preferences = bpy.context.preferences.addons[MODULE].preferences
        cls.program = sys.modules[MODULE + ".preferences"].program()

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
        self.scene.polyrecon.quality = "draft"

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

    def assert_done(self):
        self.finish(self.jobs.current)
        job = self.jobs.current
        self.assertEqual((job.state, job.error), ("done", ""), list(job.lines))

    def assert_result_is_loaded(self):
        """What the timer does at the end of a job: the image editor, where one is open, shows the result."""
        sys.modules[MODULE + ".operators"].show_result(self.jobs.current)
        image = bpy.data.images[self.jobs.current.results["CLEAN"].name]
        len(image.pixels)  # This makes Blender read the file.
        self.assertEqual(image.type, "MULTILAYER")

    def test_nothing_has_to_be_set(self):
        """Program and drivers are those of the wheel, where it has the program."""
        self.assertEqual((self.preferences.program, self.preferences.oidn), ("", ""))
        local = pathlib.Path(_resources.name) / "extensions" / ".local"
        if os.environ.get("POLYRECON_BLENDER_ZIP"):
            self.assertTrue(self.program.is_relative_to(local), self.program)
        words = sys.modules[MODULE + ".preferences"].driver_words("adaptive")
        environment = sys.modules[MODULE + ".preferences"].environment()
        done = subprocess.run([*words, "--version"], env=environment, capture_output=True, text=True)
        self.assertIn(str(self.program), done.stdout, done.stderr)

    def test_manifest_passes_blenders_checks(self):
        checked = extension_tool("validate", self.package)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.assertNotIn("warning", (checked.stdout + checked.stderr).lower())

    def test_panel_is_in_render_properties(self):
        panel = bpy.types.POLYRECON_PT_render
        self.assertEqual((panel.bl_space_type, panel.bl_context), ("PROPERTIES", "render"))
        self.assertTrue(panel.poll(bpy.context))
        for button in ("set_up_passes", "denoise", "render", "adaptive", "frames"):
            self.assertIn(f"bpy.ops.polyrecon.{button}()", self.panel())
        for choice in ("quality", "second_opinion", "light_passes", "limit", "seconds"):
            self.assertIn(f"PolyreconSettings.{choice}", self.panel())
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
        self.assertIn("Denoising: done", shown)
        self.assertIn("bpy.ops.polyrecon.show(which='ERROR')", shown)
        self.assert_result_is_loaded()
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

    def test_compares_the_result_with_the_noisy_picture(self):
        with self.assertRaisesRegex(RuntimeError, "there is no result yet"):
            self.jobs.current = None
            bpy.ops.polyrecon.compare()
        self.denoise_a_render()
        self.assertEqual(bpy.ops.polyrecon.compare(), {"FINISHED"})
        self.assert_done()
        page = self.jobs.current.results["COMPARE"].read_text(encoding="utf-8")
        for name in ("clean_0001_noisy", "clean_0001", "clean_0001_error"):
            self.assertIn(name, page)
        self.assertIn("bpy.ops.polyrecon.compare()", self.panel())  # It can be made again.

    def test_the_compositor_takes_the_clean_passes(self):
        bpy.context.view_layer.use_pass_diffuse_direct = True
        self.scene.polyrecon.light_passes = True
        self.denoise_a_render()
        self.assertEqual(bpy.ops.polyrecon.compositor(), {"FINISHED"})
        tree = self.scene.compositing_node_group
        (end,) = [node for node in tree.nodes if node.bl_idname == "NodeGroupOutput"]
        picture = end.inputs["Image"]
        group = picture.links[0].from_node
        self.assertEqual(group.node_tree.name, "polyrecon: Keep Noise")
        sources = {name: group.inputs[name].links[0].from_node for name in ("Clean", "Noisy")}
        self.assertEqual(
            [sources[name].image.filepath for name in ("Clean", "Noisy")],
            [str(self.folder / name) for name in ("clean_0001.exr", "clean_0001_noisy.exr")],
        )
        for kept, name in ((0, "clean_0001.exr"), (1, "clean_0001_noisy.exr")):
            group.inputs["Noise Kept"].default_value = kept
            self.assertLess(np.abs(self.composited() - self.combined(name)).max(), 2e-3)

        # A second result goes into the same nodes; a light pass comes from the clean file too.
        render = next(node for node in tree.nodes if node.bl_idname == "CompositorNodeRLayers")
        tree.links.new(render.outputs["Diffuse Direct"], picture)
        count = len(tree.nodes)
        self.assertEqual(bpy.ops.polyrecon.compositor(), {"FINISHED"})
        self.assertEqual(len(tree.nodes), count)
        self.assertEqual(picture.links[0].from_socket, sources["Clean"].outputs["Diffuse Direct"])

    def test_the_compositor_takes_a_sequence(self):
        self.scene.frame_end, self.scene.polyrecon.frames = 2, "RANGE"
        bpy.ops.polyrecon.render()
        self.assert_done()
        self.assertEqual(bpy.ops.polyrecon.compositor(), {"FINISHED"})
        for frame in (1, 2):
            self.scene.frame_set(frame)
            self.assertLess(np.abs(self.composited() - self.combined(f"clean_{frame:04d}.exr")).max(), 2e-3)

    def denoise_a_render(self):
        bpy.ops.polyrecon.set_up_passes()
        bpy.ops.render.render()
        bpy.ops.polyrecon.denoise()
        self.assert_done()

    def composited(self):
        """The picture that the compositor makes."""
        self.scene.render.use_compositing = True
        self.scene.render.image_settings.file_format = "OPEN_EXR"
        self.scene.render.image_settings.color_depth = "32"
        bpy.ops.render.render()
        bpy.data.images["Render Result"].save_render(str(self.folder / "composited.exr"), scene=self.scene)
        found = exr.read(self.folder / "composited.exr")
        return np.stack([found[c] for c in "RGB"], axis=-1)

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

    def test_renders_with_an_error_estimate(self):
        """The scene's samples in parts; a frame range is a sequence."""
        self.scene.cycles.samples = 9  # rounded up to whole parts
        self.scene.frame_end, self.scene.polyrecon.frames = 2, "RANGE"
        self.assertEqual(bpy.ops.polyrecon.render(), {"FINISHED"})
        self.assert_done()
        for frame in (1, 2):
            names = exr.names(self.folder / f"clean_{frame:04d}_noisy.exr")
            self.assertTrue([name for name in names if "ariance" in name], names)
            self.assertEqual(self.combined(f"clean_{frame:04d}.exr").shape, (36, 64, 3))
        words = [self.program, "inspect", self.folder / "clean_0002_noisy.exr"]
        self.assertIn("samples per pixel: 16", subprocess.run(words, capture_output=True, text=True).stdout)
        self.assert_result_is_loaded()

    def test_the_second_opinion_and_light_passes_are_asked_for(self):
        words = sys.modules[MODULE + ".operators"]._denoise_words
        chosen = self.scene.polyrecon
        found = sys.modules[MODULE + ".programs"].find_oidn()
        self.assertTrue(chosen.second_opinion)  # on by default
        self.assertEqual("oidn" in words(chosen), bool(found))
        self.assertNotIn("--aov", words(chosen))
        chosen.second_opinion, chosen.light_passes = False, True
        self.assertNotIn("oidn", words(chosen))
        self.assertIn("--aov", words(chosen))
        self.preferences.oidn = "/nowhere"
        self.addCleanup(setattr, self.preferences, "oidn", "")
        self.assertIn("Open Image Denoise was not found", self.shown_text())
        self.assertIn("bpy.ops.polyrecon.preferences()", self.panel())
        chosen.second_opinion = True
        self.assertNotIn("oidn", words(chosen))  # It would fail.

    def test_light_passes_are_denoised(self):
        bpy.ops.polyrecon.set_up_passes()
        bpy.context.view_layer.use_pass_diffuse_direct = True
        bpy.ops.render.render()
        results = {}
        for chosen in (False, True):
            self.scene.polyrecon.light_passes = chosen
            bpy.ops.polyrecon.denoise()
            self.assert_done()
            found = exr.read(self.folder / "clean_0001.exr", lambda name: "DiffDir" in name or "Diffuse Direct" in name)
            results[chosen] = np.stack(list(found.values()))
        self.assertGreater(np.abs(results[True] - results[False]).max(), 0)

    def test_denoises_frames_on_disk(self):
        with self.assertRaisesRegex(RuntimeError, "choose the folder"):
            bpy.ops.polyrecon.frames()
        bpy.ops.polyrecon.set_up_passes()
        save = sys.modules[MODULE + ".operators"]._save_render
        for name in ("a.exr", "b.exr"):
            bpy.ops.render.render()
            save(self.scene, self.folder / name)
        self.scene.polyrecon.folder = str(self.folder)
        self.assertEqual(bpy.ops.polyrecon.frames(), {"FINISHED"})
        self.assert_done()
        for name in ("a.exr", "b.exr"):
            self.assertGreater(np.abs(self.combined(f"denoised/{name}") - self.combined(name)).max(), 1e-3)

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
        job = self.jobs.start("Denoise", [[str(self.program), "denoise", "-i", "no.exr", "-o", "o.exr"]], {})
        self.finish(job)
        self.assertEqual(job.state, "failed")
        self.assertIn("no.exr", job.error)
        self.assertIn(job.error, self.shown_text())

    def test_preferences_tell_what_they_find(self):
        draw = sys.modules[MODULE + ".preferences"].draw
        shown = self.drawn(lambda popup: draw(popup.layout, self.preferences))
        self.assertIn(str(self.program), shown)
        self.assertIn("PolyreconPreferences.oidn", shown)

    def test_command_line(self):
        """`blender -c polyrecon` calls this function. Blender as a module has no such option."""
        run = sys.modules[MODULE + ".command_line"].run
        self.assertEqual(run(["--help"]), 0)
        self.assertEqual(run(["inspect", str(ROOT / "samples" / "study_small_0.exr")]), 0)
        self.assertEqual(run(["inspect", "no.exr"]), 4)
        self.assertEqual(run(["nonsense"]), 2)


if __name__ == "__main__":
    unittest.main()
