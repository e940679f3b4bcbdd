"""Runs adaptive.py with both Blenders, on files and paths of many kinds."""

import hashlib
import json
import os
import pathlib
import re
import stat
import subprocess
import sys
import time
import unittest

import numpy as np
import OpenImageIO as oiio

from pipelines.common import exr
from tests.long_test import long_test
from tests.pipelines.blender.support import BLENDER_3, NO_BLENDER_5_2, PYTHON_OF_BLENDER_5_2, ROOT, SceneTest

CRYPTOMATTE = {f"CryptoObject0{level}" for level in range(3)}  # layers of its pass


def executable(path, text):
    path.write_text(text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def journal_of(passes):
    return json.loads((passes / "journal.json").read_text())


def channel_types(path):
    """{channel: type} of the first part of an EXR file."""
    spec = oiio.ImageInput.open(str(path)).spec()
    formats = spec.channelformats or [spec.format] * spec.nchannels
    return dict(zip(spec.channelnames, map(str, formats)))


def running(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


class Adaptive(SceneTest):
    def check(self, scene, blender, method, others=()):
        before = hashlib.sha256(scene.read_bytes()).digest()
        out = self.folder / "out.exr"
        words = ["--budget-spp", 16, "--first-pass", 4, "--quality", "draft", "--keep-passes", "-v", *blender]
        done = self.driver("adaptive.py", scene, "-o", out, *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"extra samples: {method}", done.stdout)
        self.assertEqual(before, hashlib.sha256(scene.read_bytes()).digest())
        picture = exr.read(out)
        self.assertTrue(all(np.isfinite(picture[f"ViewLayer.Combined.{c}"]).all() for c in "RGB"))
        self.assertIn("; the samples are spent", done.stdout)
        taken = [part["samples"] for part in journal_of(out.with_suffix(".passes"))["parts"]]
        self.assertLess(sum(taken[:-1]), 16)  # case 31: no pass starts after the budget is spent
        counts = exr.read(out.with_suffix(".passes") / "merged.exr")["ViewLayer.Sample Count.X"]
        self.assertLessEqual(counts.mean(), 16 * 1.15)
        self.assertGreaterEqual(counts.min(), 4)
        self.assertEqual(
            sorted(p.name for p in self.folder.iterdir()), sorted([scene.name, "out.exr", "out.passes", *others])
        )
        return out

    def test_blender_5_with_masks(self):
        out = self.check(self.scene("lens"), ["--bpy"], "masks by a camera shader")
        counts = exr.read(out.with_suffix(".passes") / "merged.exr")["ViewLayer.Sample Count.X"]
        self.assertGreater(counts.max(), 2 * counts.min())
        page = (out.with_suffix(".passes") / "report.html").read_text()
        shown = json.loads(re.search('<script type="application/json" id="scene">(.*)</script>', page)[1])
        self.assertEqual([image["name"] for image in shown["images"][:3]], ["input", "result", "estimated error"])
        self.assertNotRegex(page, "https?:")

    @long_test
    @unittest.skipUnless(PYTHON_OF_BLENDER_5_2, NO_BLENDER_5_2)
    def test_blender_5_2_with_masks(self):
        blender = self.blender_5_2()
        self.check(self.scene("lens"), ["--blender", blender], "masks by a camera shader", others=[blender.name])

    def test_blender_3_with_rectangles(self):
        self.check(self.scene(blender=BLENDER_3), ["--blender", BLENDER_3], "rectangles, because Blender before 5.0")

    def test_case33_awkward_paths_and_frames(self):
        scene = self.scene("moving", "-a 'b' \"{c}\" #ä日.blend")
        folder = self.folder / "out {x} #1"
        folder.mkdir()
        done = self.driver(
            "adaptive.py",
            "--bpy",
            "--budget-spp",
            4,
            "--first-pass",
            4,
            "--frames",
            "1-3x2",
            "--quality",
            "draft",
            "--keep-passes",
            "-o",
            folder / "<i>ä_##.exr",
            "--",
            scene.name,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(p.name for p in folder.iterdir()), ["<i>ä.passes", "<i>ä_01.exr", "<i>ä_03.exr"])
        first, second = (exr.read(folder / f"<i>ä_0{n}.exr")["ViewLayer.Combined.R"] for n in (1, 3))
        self.assertGreater(np.abs(first - second).max(), 0.05)
        self.assertIn("&lt;i&gt;ä_01.exr", (folder / "<i>ä.passes" / "0001" / "report.html").read_text())

    def test_case31_case32_killed_outright_it_goes_on_within_its_seconds(self):
        out, passes = self.folder / "out.exr", self.folder / "out.passes"
        words = [
            self.scene(),
            "-o",
            out,
            "--budget-seconds",
            8,
            "--first-pass",
            4,
            "--quality",
            "draft",
            "--max-rounds",
            99,
            "--keep-passes",
            "--bpy",
        ]
        killed = subprocess.Popen(
            [sys.executable, ROOT / "pipelines" / "blender" / "adaptive.py", *map(str, words)],
            stderr=subprocess.DEVNULL,
        )
        while not (
            passes / "part_0a1.exr"
        ).exists():  # There is a journal, and two passes are missing; Blender is the only child.
            self.assertIsNone(killed.poll())
            time.sleep(0.005)
        blender = pathlib.Path(f"/proc/{killed.pid}/task/{killed.pid}/children").read_text().split()
        killed.kill()
        killed.wait()
        self.assertEqual(len(blender), 1)
        patience = time.monotonic() + 60
        while running(blender[0]):  # Blender ends, since its driver is gone.
            self.assertLess(time.monotonic(), patience)
            time.sleep(0.02)

        before = journal_of(passes)
        done = self.driver("adaptive.py", *words, "--resume")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the seconds are spent", done.stdout)
        after = journal_of(passes)
        parts = after["parts"]
        self.assertEqual(parts[: len(before["parts"])], before["parts"])
        self.assertEqual(len({part["first_sample"] for part in parts}), len(parts))
        counts = exr.read(passes / "merged.exr")["ViewLayer.Sample Count.X"]
        self.assertAlmostEqual(counts.mean(), sum(part["samples"] for part in parts), delta=1e-3 * counts.mean())
        # The seconds count both runs. No round starts after them, however busy the machine is.
        self.assertGreater(after["seconds"], before["seconds"])
        self.assertTrue(all(entry["seconds"] < 8 for entry in after["rounds"] if entry["next_samples"]))

    def test_the_result_is_lean_and_nothing_else_stays(self):
        """The scene asks for depth, ids and a colour; features, variance, halves and counts serve the loop alone."""
        scene, words = self.scene("user_passes"), ["--budget-spp", 12, "--first-pass", 4, "--quality", "draft", "--bpy"]
        before = sorted(path.name for path in self.folder.iterdir())
        done = self.driver("adaptive.py", scene, "-o", "new/lean.exr", *words, "--error-map", "maps/error.exr")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), 3, done.stdout)
        self.assertRegex(done.stdout.splitlines()[0], "new/lean.exr: .*12 samples per pixel.*albedo, normal, depth")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), sorted([*before, "new", "maps"]))
        self.assertEqual(os.listdir(self.folder / "new"), ["lean.exr"])
        self.assertIn("relmse.Y", exr.names(self.folder / "maps" / "error.exr"))
        types = channel_types(self.folder / "new" / "lean.exr")
        layers = {name.rpartition(".")[0].partition(".")[2] for name in types}
        self.assertEqual(layers, {"Combined", "Depth", "Object Index", "Diffuse Color", *CRYPTOMATTE})
        for layer, kind in (("Combined.R", "half"), ("Diffuse Color.G", "half"), ("Depth.Z", "float")):
            self.assertEqual(types[f"ViewLayer.{layer}"], kind)
        self.assertEqual(types["ViewLayer.Object Index.X"], "float")
        spec = oiio.ImageInput.open(str(self.folder / "new" / "lean.exr")).spec()
        self.assertEqual(spec.getattribute("compression"), "piz")  # as the file says

        again = self.driver("adaptive.py", scene, "-o", "new/lean.exr", *words, "--resume")
        self.assertEqual((again.returncode, again.stdout), (0, "new/lean.exr: finished already: skipped\n"))
        more = self.driver("adaptive.py", scene, "-o", "new/lean.exr", *words, "--resume", "--quality", "standard")
        self.assertEqual(more.returncode, 2, more.stderr)
        self.assertIn("add --overwrite to render it again", more.stderr)
        added = ["--outputs", "input,noisy,error,order"]
        kept = self.driver("adaptive.py", scene, "-o", "new/lean.exr", *words, "--overwrite", "--keep-passes", *added)
        self.assertEqual(kept.returncode, 0, kept.stderr)
        last = kept.stdout.splitlines()[-1]
        self.assertRegex(
            last, r"passes in new/lean.passes \(.* MB\): --resume continues .* `rm -r new/lean.passes` removes"
        )
        types = channel_types(self.folder / "new" / "lean.exr")
        for layer in ("Combined A.R", "Combined Variance.R", "Denoising Albedo.R", "Sample Count.X"):
            self.assertEqual(types[f"ViewLayer.{layer}"], "float")
        self.assertEqual(types["ViewLayer.Combined Noisy.R"], "half")
        for layer in ("Error", "Order"):
            self.assertEqual(types[f"ViewLayer.Combined {layer}.X"], "float")
        pictures = exr.read(self.folder / "new" / "lean.exr")
        merged = exr.read(self.folder / "new" / "lean.passes" / "merged.exr")["ViewLayer.Combined.R"]
        np.testing.assert_allclose(pictures["ViewLayer.Combined Noisy.R"], merged, rtol=2**-10, atol=1e-6)
        layers = self.driver("adaptive.py", scene, "-o", "a.exr", *words, "--outputs", "layers,error", "--keep-passes")
        self.assertEqual(layers.returncode, 0, layers.stderr)
        names = {name.rpartition(".")[0].partition(".")[2] for name in channel_types(self.folder / "a.exr")}
        self.assertEqual(names, {"Combined", "Combined Error", "Depth", "Object Index", "Diffuse Color", *CRYPTOMATTE})

    def test_own_passes_have_all_samples_on_request(self):
        scene, words = self.scene("user_passes"), ["--budget-spp", 8, "--first-pass", 4, "--quality", "draft", "--bpy"]
        # The first part has half of these samples.
        done = self.driver("render_passes.py", scene, "-o", "many.exr", "--spp", 512, "--parts", 2, "--bpy")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = {"many": exr.read(self.folder / "many.exr")}
        for samples in ("first", "full"):
            done = self.driver("adaptive.py", scene, "-o", f"{samples}.exr", *words, "--own-passes", samples)
            self.assertEqual(done.returncode, 0, done.stderr)
            found[samples] = exr.read(self.folder / f"{samples}.exr")
        np.testing.assert_array_equal(*(found[samples]["ViewLayer.Combined.R"] for samples in ("full", "first")))
        self.assertEqual(set(found["full"]), set(found["first"]))
        color = {samples: channels["ViewLayer.Diffuse Color.R"] for samples, channels in found.items()}
        error = {samples: np.abs(color[samples] - color["many"]).mean() for samples in ("first", "full")}
        self.assertLess(error["full"], error["first"] / 2)
        # Compositors find a Cryptomatte by its attributes.
        for samples in found:
            attributes = exr.metadata(self.folder / f"{samples}.exr")
            told = {name.rpartition("/")[2]: value for name, value in attributes.items() if "cryptomatte/" in name}
            self.assertEqual(told["name"], "ViewLayer.CryptoObject", samples)
            self.assertIn('"Sphere":', told["manifest"], samples)

    def test_what_is_missed_is_said_and_fails_only_on_request(self):
        scene = self.scene("user_passes")
        words = ["-o", "new/a.exr", "--outputs", "beauty", "--first-pass", 4, "--quality", "draft", "--bpy", "-q"]
        impossible = ["--target", 1e-9, "--max-rounds", 1]
        for limit, said in (
            (["--budget-seconds", 0.5], r"took \d+\.\d s, so --budget-seconds 0.5 was missed"),
            (impossible, r"estimated relMSE .*, so --target 1e-09 was missed: --max-rounds 1 is reached"),
            ([*impossible, "--on-miss", "fail"], "estimated relMSE .*, so --target 1e-09 was missed"),
        ):
            done = self.driver("adaptive.py", scene, *words, *limit, "--overwrite")
            self.assertEqual((done.returncode, done.stdout), (8 if "fail" in limit else 0, ""), done.stderr)
            self.assertRegex(done.stderr, f"^polyrecon-blender: new/a.exr: {said}.*\n$")
        types = channel_types(self.folder / "new" / "a.exr")
        self.assertEqual(set(types), {f"ViewLayer.Combined.{c}" for c in "RGBA"})
        # A code other than 0 leaves the passes for --resume; a run that ends with 0 removes them.
        self.assertRegex(done.stderr, r"; passes in new/a.passes \(.*\): --resume continues with them, `rm -r ")
        self.assertEqual(sorted(os.listdir(self.folder / "new")), ["a.exr", "a.passes"])
        done = self.driver("adaptive.py", scene, *words, "--target", 1000, "--on-miss", "fail", "--resume")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(os.listdir(self.folder / "new"), ["a.exr"])
        wrong = ["--budget-spp", 8, "--overwrite", "--outputs", "beaty"]
        done = self.driver("adaptive.py", scene, *words, *wrong)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "^polyrecon-blender: --outputs: beaty is none of .*; did you mean beauty\\?\n$")

    def test_view_layers_and_transparent_film(self):
        scene, words = self.scene("view_layers"), ["--budget-spp", 16, "--first-pass", 4, "--quality", "draft", "--bpy"]
        pictures = {}
        for name, *more in (("near",), ("far", "--view-layer", "far")):
            done = self.driver("adaptive.py", scene, "-o", f"{name}.exr", *words, *more)
            self.assertEqual(done.returncode, 0, done.stderr)
            said = done.stdout.splitlines()
            note = "note: view layer far off: near is rendered; --view-layer renders another"
            self.assertEqual(note in said, name == "near")
            self.assertLess(
                said.index(next(line for line in said if "path guiding learns anew" in line)), len(said) - 3
            )
            pictures[name] = exr.read(self.folder / f"{name}.exr")
        self.assertEqual(set(pictures["near"]), {f"near.Combined.{c}" for c in "RGBA"})
        self.assertGreater(np.abs(pictures["near"]["near.Combined.R"] - pictures["far"]["far.Combined.R"]).max(), 0.05)
        # Alpha is that of an ordinary render, whatever samples the pixels got.
        done = self.driver("render_passes.py", scene, "-o", "even.exr", "--spp", 64, "--bpy")
        self.assertEqual(done.returncode, 0, done.stderr)
        even, alpha = (found["near.Combined.A"] for found in (exr.read(self.folder / "even.exr"), pictures["near"]))
        self.assertEqual((alpha.min(), alpha.max()), (0, 1))
        self.assertLess(np.abs(even - alpha).mean(), 0.01)
        done = self.driver("adaptive.py", scene, "-o", "no.exr", *words, "--view-layer", "nowhere")
        self.assertEqual(done.returncode, 7, done.stderr)
        self.assertIn("no view layer 'nowhere'; it has 'near', 'far'", done.stderr)

    def test_a_frame_that_fails_keeps_its_passes_and_says_so(self):
        command = [sys.executable, ROOT / "pipelines" / "blender" / "adaptive.py", self.scene(), "-o", "o.exr", "--bpy"]
        command += ["--budget-spp", "4000", "--first-pass", "8", "--quality", "draft"]
        child = subprocess.Popen(
            [*map(str, command)], cwd=self.folder, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        while not (self.folder / "o.passes" / "part_0a1.exr").exists():
            self.assertIsNone(child.poll())
            time.sleep(0.01)
        child.terminate()
        _, errors = child.communicate(timeout=60)
        self.assertEqual((child.returncode, len(errors.splitlines())), (143, 1), errors)
        self.assertRegex(errors, r"terminated; passes in o.passes \(.*--resume continues with them, `rm -r o.passes`")

    def test_a_file_of_a_newer_blender_is_told(self):
        for compress, kind in ((False, "plain"), (True, "compressed")):
            scene = self.scene(kind)
            done = self.driver(
                "render_passes.py", scene, "-o", f"{compress}.exr", "--spp", 4, "--parts", 2, "--blender", BLENDER_3
            )
            self.assertEqual(done.returncode, 7, done.stderr)
            self.assertRegex(done.stderr, f"{kind}.*\\.blend was saved by Blender 5.0, this is 3.4: .* with --blender")

    def test_wrong_use_is_an_error_before_any_work(self):
        scene = self.folder / "none.blend"
        for words, code, line in (
            ([scene, "-o", "o.exr", "--budget-spp", 16], 4, "none.blend: no such file"),
            ([scene, "-o", "o.exr"], 2, "required"),
            ([scene, "-o", "o.exr", "--budget-spp", 4], 2, "less than --first-pass"),
            ([scene, "-o", "o.exr", "--budget-spp", -4], 2, "must be a number above 0"),
        ):
            done = self.driver("adaptive.py", *words)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(line, done.stderr)


class RenderPasses(SceneTest):
    def test_the_subsets_are_the_ordinary_render(self):
        scene = self.scene()
        for parts, name in ((8, "many.exr"), (2, "few.exr")):
            done = self.driver(
                "render_passes.py", scene, "-o", self.folder / name, "--spp", 8, "--parts", parts, "--bpy"
            )
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["few.exr", "many.exr", "plain.blend"])
        many, few = (exr.read(self.folder / name) for name in ("many.exr", "few.exr"))
        np.testing.assert_allclose(many["ViewLayer.Combined.R"], few["ViewLayer.Combined.R"], rtol=1e-4, atol=1e-5)
        self.assertEqual(set(many["ViewLayer.Sample Count.X"].flat), {8})
        self.assertGreater(many["ViewLayer.Combined Variance.R"].mean(), 0)

    @unittest.skipUnless(PYTHON_OF_BLENDER_5_2, NO_BLENDER_5_2)
    def test_blender_5_2(self):
        scene, out, report = self.scene(), self.folder / "merged.exr", self.folder / "report.json"
        done = self.driver(
            "render_passes.py", scene, "-o", out, "--spp", 8, "--parts", 4, "--blender", self.blender_5_2()
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        merged = exr.read(out)
        self.assertTrue(all(np.isfinite(plane).all() for plane in merged.values()))
        self.assertEqual(merged["ViewLayer.Denoising Depth.Z"].max(), 1e10)  # the sky above the horizon
        clean = self.folder / "clean.exr"
        subprocess.run(
            [os.environ["POLYRECON"], "denoise", "-i", out, "-o", clean, "--report", report, "-q"], check=True
        )
        self.assertEqual(json.loads(report.read_text())["repaired_pixels"], 0)

    def test_uneven_parts_are_refused(self):
        self.assertEqual(self.driver("render_passes.py", "s.blend", "-o", "o.exr", "--spp", 9).returncode, 2)


class Hostile(SceneTest):
    def test_case29_no_code_of_the_file_runs(self):
        for blender in ("bpy", BLENDER_3):
            scene = self.scene("hostile", blender=blender)
            for mark in self.folder.glob("ran_*"):  # from the build of the file
                mark.unlink()
            out = self.folder / "out.exr"
            done = self.driver(
                "adaptive.py",
                scene,
                "-o",
                out,
                "--overwrite",
                "--budget-spp",
                8,
                "--first-pass",
                4,
                "--blender",
                blender,
                "--quality",
                "draft",
                "--passes-dir",
                self.folder / f"passes_{blender == 'bpy'}",
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("Freestyle off", done.stdout)
            self.assertIn("Python drivers of the file are not run", done.stdout)
            self.assertEqual(list(self.folder.glob("ran_*")), [], blender)

    @long_test
    def test_the_file_would_run_it_if_it_were_let(self):
        """The test above can fail: a Blender that trusts the file runs all of it."""
        trust = (
            "import sys, bpy; bpy.ops.wm.open_mainfile(filepath=sys.argv[1], use_scripts=True); bpy.ops.render.render()"
        )
        for blender in ("bpy", BLENDER_3):
            scene = self.scene("hostile", blender=blender)
            command = [sys.executable, "-c", trust, scene]
            if blender != "bpy":
                command = [blender, "-b", "-y", "--factory-startup", scene, "-f", "1", "-o", self.folder / "x"]
            for mark in self.folder.glob("ran_*"):
                mark.unlink()
            subprocess.run(command, capture_output=True)
            ran = {mark.name for mark in self.folder.glob("ran_*")}
            self.assertEqual(ran, {"ran_text", "ran_handler", "ran_driver", "ran_freestyle"}, blender)


class BadRenderers(SceneTest):
    """Case 30: a renderer dies, hangs, or writes no file. The exit code is 7, there is one line, no process is left,
    and the frame can be resumed."""

    def failing(self, body, *words):
        """Runs the loop with a Blender that does `body` in its second pass, then resumes it with a good one."""
        scene = self.scene(blender=BLENDER_3)
        passes = self.folder / "p"
        session = self.folder / "blender"
        executable(
            session,
            f"""#!/usr/bin/env python3
import subprocess, sys
child = subprocess.Popen([{BLENDER_3!r}, *sys.argv[1:]], stdin=subprocess.PIPE, text=True)
passes = 0
for line in sys.stdin:
    passes += '"render"' in line
    if passes == 2:
{body}
    child.stdin.write(line)
    child.stdin.flush()
""",
        )
        arguments = [
            scene,
            "-o",
            self.folder / "o.exr",
            "--passes-dir",
            passes,
            "--budget-spp",
            8,
            "--first-pass",
            4,
            "--quality",
            "draft",
        ]
        done = self.driver("adaptive.py", *arguments, "--blender", session, *words)
        self.assertEqual(done.returncode, 7, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1)
        self.assertFalse((self.folder / "o.exr").exists())
        self.assertEqual(len(journal_of(passes)["parts"]), 1)
        again = self.driver("adaptive.py", *arguments, "--blender", BLENDER_3, "--resume")
        self.assertEqual(again.returncode, 0, again.stderr)
        return done.stderr

    def test_case30_it_dies(self):
        self.assertIn("Blender ended with code", self.failing("        child.kill(); child.wait(); sys.exit(11)"))

    def test_case30_it_hangs(self):
        begin = time.monotonic()
        mark = f"{self.folder}/pid"
        line = self.failing(
            f"        open({mark!r}, 'w').write(str(child.pid)); import time; time.sleep(1000)", "--pass-timeout", 15
        )
        self.assertIn("did not answer within 15 s", line)
        self.assertLess(time.monotonic() - begin, 200)
        with self.assertRaises(ProcessLookupError):
            os.kill(int(pathlib.Path(mark).read_text()), 0)

    @long_test
    def test_case30_it_writes_no_file(self):
        body = """        print('\\n@polyrecon {"seconds": 1}', flush=True); continue"""
        self.assertIn("wrote no file", self.failing(body))


if __name__ == "__main__":
    unittest.main()
