"""Attacks on the Blender drivers by files, paths and folders; each of them once succeeded. Blender is the real one."""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from pipelines.blender.renderer import BlenderRenderer
from pipelines.common import exr
from pipelines.common.errors import DriverError, ExitCode
from pipelines.loop.renderer import SAMPLE_COUNT
from tests.pipelines.blender.support import BLENDER_3, ROOT, SceneTest

SMALL = ("--budget-spp", 8, "--first-pass", 4, "--quality", "draft", "--keep-passes")
CONTENT = (".blend", ".png", ".osl")


def swap(path):
    """Replaces a file by another one of the same size and the same time of modification."""
    status, content = path.stat(), bytearray(path.read_bytes())
    content[-1] ^= 1
    other = path.with_name("other")
    other.write_bytes(content)
    os.utime(other, ns=(status.st_atime_ns, status.st_mtime_ns))
    other.replace(path)


class Attacks(SceneTest):
    def setUp(self):
        super().setUp()
        self.temporary = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.temporary)

    def loop(self, scene, *words, output="o.exr", small=SMALL):
        words = [scene, "-o", self.folder / output, *small, *words]
        return self.driver("adaptive.py", *words, TMPDIR=str(self.temporary))

    def refused(self, done, code, text):
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(text, done.stderr)

    def test_passes_dir_deletes(self):
        mine = self.folder / "mine"
        (mine / "sub").mkdir(parents=True)
        for name in (".my_backup.exr", "sub/.my_backup.exr", "sub/.x.new"):
            (mine / name).write_text("precious")
        before = sorted(mine.rglob("*"))
        for script, words in (("adaptive.py", SMALL), ("render_passes.py", ("--spp", 4, "--parts", 2))):
            done = self.driver(script, self.scene(), "-o", "o.exr", *words, "--bpy", "--passes-dir", mine)
            self.refused(done, ExitCode.USAGE, "mine: is not empty and holds no passes of a driver")
        self.assertEqual(sorted(mine.rglob("*")), before)
        scene = self.folder / "plain.blend"
        done = self.loop(scene, "--bpy", "--passes-dir", mine / "new")
        self.assertEqual(done.returncode, 0, done.stderr)
        files = [mine / "new" / name for name in (".my_backup.exr", "round_0/.mine.exr", ".part_0a0.exr.old.exr")]
        unfinished = mine / "new" / ".part_0a9.exr.polyrecon-0123456789abcdef"
        for path in (*files, unfinished):
            path.write_text("precious")
        done = self.loop(scene, "--bpy", "--passes-dir", mine / "new", "--resume")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(all(path.exists() for path in files))
        self.assertFalse(unfinished.exists())

    def test_linked_library(self):
        """A killed run goes on with the same scene alone, whatever part of it was swapped."""
        scene, passes = self.scene("linking"), self.folder / "o.passes"
        words = [scene, "-o", self.folder / "o.exr", "--budget-spp", 8, "--first-pass", 4, "--bpy"]
        command = [sys.executable, ROOT / "pipelines/blender/adaptive.py", *map(str, words)]
        killed = subprocess.Popen(command, stderr=subprocess.DEVNULL, env={**os.environ, "TMPDIR": self.temporary})
        while not (passes / "part_0a1.exr").exists():
            self.assertIsNone(killed.poll())
            time.sleep(0.005)
        killed.kill()
        killed.wait()
        self.assertNotEqual(os.listdir(self.temporary), [])
        for name in ("library.blend", "lamp.png"):
            before = (self.folder / name).read_bytes()
            swap(self.folder / name)
            self.refused(self.loop(scene, "--bpy", "--resume"), ExitCode.USAGE, f"{name} is not what it was")
            (self.folder / name).write_bytes(before)
        done = self.loop(scene, "--bpy", "--resume")  # The same content, changed later
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(os.listdir(self.temporary), [])  # The killed driver's folder is gone, too.

    def test_every_file_that_the_scene_uses_is_compared(self):
        scene = self.scene("linking")
        renderer = BlenderRenderer(scene, "bpy")
        self.addCleanup(renderer.close)
        before = renderer.begin(None).inputs
        for path in sorted(self.folder.iterdir()):
            if path.suffix not in CONTENT or path == scene or path.name == "library.blend":
                continue
            content = path.read_bytes()
            swap(path)
            after = renderer.begin(None).inputs
            changed = [name for name in before.keys() | after.keys() if before.get(name) != after.get(name)]
            self.assertEqual(len(changed), 0 if path.name == "unused.png" else 1, path)
            path.write_bytes(content)
        self.assertEqual(renderer.begin(None).inputs, before)
        (self.folder / "gone.png").touch()
        self.assertNotEqual(renderer.begin(None).inputs, before)
        self.assertGreaterEqual(len(before), 8)

    def test_caches_in_folders_are_compared(self):
        """Caches of oceans and points are files in a folder; results next to them are none of the scene's."""
        renderer = BlenderRenderer(self.scene("caching"), "bpy")
        self.addCleanup(renderer.close)
        before = renderer.begin(None).inputs
        for name in ("ocean/disp_0001.exr", "points/cloth_000001_00.bphys"):
            content = (self.folder / name).read_bytes()
            swap(self.folder / name)
            after = renderer.begin(None).inputs
            changed = [path for path in before if before[path] != after.get(path)]
            self.assertEqual([Path(path).name for path in changed], [Path(name).parent.name], name)
            (self.folder / name).write_bytes(content)
        (self.folder / "points" / "o.exr").write_bytes(b"result")
        self.assertEqual(renderer.begin(None).inputs, before)

    def test_a_file_that_changes_while_it_is_rendered(self):
        scene, part = self.scene("linking"), self.folder / "part.exr"
        renderer = BlenderRenderer(scene, "bpy")
        self.addCleanup(renderer.close)
        renderer.begin(None)
        renderer.uniform(0, 1, part)
        part.unlink()
        swap(scene)  # It was read already, and may be saved at any time.
        renderer.uniform(1, 1, part)
        part.unlink()
        swap(self.folder / "frame_2.png")
        with self.assertRaisesRegex(DriverError, "frame_1.png: changed while it was rendered"):
            renderer.uniform(2, 1, part)
        self.assertFalse(part.exists())
        swap(self.folder / "frame_2.png")
        renderer.uniform(2, 1, part)
        renderer.session.stop()
        with self.assertRaisesRegex(DriverError, "linking.blend: changed while it was rendered"):
            renderer.uniform(3, 1, part)  # A new process would open another scene.

    def test_session_injection(self):
        for blender in ("bpy", BLENDER_3):
            with BlenderRendererOf(self.scene("forging", f"{len(blender)}.blend", blender), blender) as renderer:
                renderer.begin(None)
                self.assertTrue(any("forged" in line for line in renderer.session.log), list(renderer.session.log))
                renderer.uniform(0, 2, self.folder / "part.exr")
                counts = exr.read(self.folder / "part.exr")[f"ViewLayer.{SAMPLE_COUNT}"]
                np.testing.assert_array_equal(counts, 2)

    def test_a_broken_pipe_of_answers_ends_the_pass_at_once(self):
        for number, answer in enumerate(("garbage", "[1]", "{", "[" * 100000, "\\udc00", "9" * 5000)):
            fake = self.folder / f"blender{number}"
            fake.write_text(f"#!/bin/sh\nread job\necho '@polyrecon {answer}'\nexec sleep 1000\n")
            fake.chmod(0o755)
            begin = time.monotonic()
            done = self.loop(self.scene(), "--blender", fake, output=f"o{number}.exr")
            self.refused(done, ExitCode.RENDERER, "an answer that cannot be read")
            self.assertLess(time.monotonic() - begin, 60)

    def test_terminal_escapes(self):
        done = self.loop(self.scene("escapes"), "--bpy")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("view layer c\\x1b[2J\\nopenjd_env: D=E off", done.stdout)
        self.assertNotRegex(done.stdout + done.stderr, "[\x00-\x09\x0b-\x1f\x7f-\x9f]")
        self.assertNotRegex(done.stdout + done.stderr, "(?m)^openjd")

    def test_a_folder_that_is_not_utf8(self):
        folder = Path(os.fsdecode(os.fsencode(self.folder) + b"/\xe9\x1b"))
        folder.mkdir()
        scene = self.scene().rename(folder / "plain.blend")
        done = self.loop(scene, "--bpy", output=folder.name + "/o.exr")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("/\\xe9\\x1b/o.exr: ", done.stdout)
        self.assertIn("<title>o.exr</title>", (folder / "o.passes/report.html").read_text(encoding="utf-8"))
        done = self.loop(scene, "--bpy", "--overwrite", output=folder.name + "/o.exr")
        self.refused(done, ExitCode.USAGE, "/\\xe9\\x1b/o.passes/journal.json: passes of an earlier run")
        done = self.loop(scene, "--bpy", "--resume", output=folder.name + "/o.exr")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_simulations_write_into_the_folder_of_the_driver(self):
        for blender in ("bpy", BLENDER_3):
            scene = self.scene("simulating", f"{len(blender)}.blend", blender)
            for folder in ("elsewhere", f"blendcache_{scene.stem}"):
                shutil.rmtree(self.folder / folder, ignore_errors=True)
            words = [scene, "-o", "s_#.exr", "--overwrite", "--spp", 2, "--parts", 2, "--frames", "1-4"]
            words += ["--blender", blender]
            before = set(self.folder.iterdir())
            done = self.driver("render_passes.py", *words, TMPDIR=str(self.temporary))
            self.assertEqual(done.returncode, 0, done.stderr)
            written = {path.name for path in set(self.folder.iterdir()) - before}
            self.assertEqual(written | {f"s_{frame}.exr" for frame in range(1, 5)}, {f"s_{f}.exr" for f in range(1, 5)})
            first, last = (exr.read(self.folder / f"s_{n}.exr")["ViewLayer.Denoising Depth.Z"] for n in (1, 4))
            self.assertGreater(np.abs(first - last).max(), 0.01)  # The cloth falls.
        self.assertEqual(os.listdir(self.temporary), [])

    def test_few_descriptors(self):
        scene, words = self.scene(), [*SMALL, "--bpy"]
        command = [sys.executable, ROOT / "pipelines/blender/adaptive.py", scene, "-o", "o.exr", *words]
        for limit in (8, 12, 16, 20):
            shell = ["sh", "-c", f'ulimit -n {limit}; exec "$@"', "sh", *map(str, command)]
            done = subprocess.run(shell, capture_output=True, text=True, cwd=self.folder)
            if done.returncode:
                self.assertIn(done.returncode, (ExitCode.MEMORY, ExitCode.RENDERER), done.stderr)
                reason = "(Too many open files|no message|open files are allowed)"
                self.assertRegex(done.stderr, f"^polyrecon-blender: .*{reason}.*\n$")
            shutil.rmtree(self.folder / "o.passes", ignore_errors=True)
            (self.folder / "o.exr").unlink(missing_ok=True)


class BlenderRendererOf(BlenderRenderer):
    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
