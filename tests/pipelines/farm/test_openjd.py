import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import unittest
from pathlib import Path

import yaml

from .shot import make_shot

ROOT = Path(__file__).resolve().parents[3]
FARM = ROOT / "pipelines/farm"
POLYRECON = os.path.abspath(os.environ["POLYRECON"])
OPENJD = Path(sysconfig.get_path("scripts")) / "openjd"


def run(*words, **environment):
    words, environment = [str(word) for word in words], {**os.environ, **environment}
    return subprocess.run(words, capture_output=True, text=True, env=environment)


class Template(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="-a 'b' \"{c}\" ä日;")  # case 33
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "in").mkdir()
        (self.folder / "out").mkdir()
        make_shot(self.folder / "in", [1, 2, 3, 4, 5, 8])

    def parameters(self, **more):
        values = {
            "InputFolder": self.folder / "in",
            "OutputFolder": self.folder / "out",
            "Frames": "1-5,8",
            "FramesPerTask": 2,
            "Quality": "draft",
            "Threads": 1,
            "Polyrecon": POLYRECON,
            "PolyreconFarm": FARM / "farm.py",
            **more,
        }
        return [word for name, value in values.items() for word in ("-p", f"{name}={value}")]

    def outputs(self):
        return sorted(path.name for path in (self.folder / "out").iterdir())

    def test_the_template_is_valid(self):
        done = run(OPENJD, "check", FARM / "template.yaml")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        done = run(OPENJD, "summary", FARM / "template.yaml", *self.parameters())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("Report", done.stdout)

    def test_its_texts_are_whole(self):
        parameters = yaml.safe_load((FARM / "template.yaml").read_text())["parameterDefinitions"]
        found = {parameter["name"]: parameter.get("description", "") for parameter in parameters}
        self.assertTrue(found["InputName"].endswith("in place of #### or %04d"), found["InputName"])

    def test_it_runs_chunks_and_the_report(self):
        done = run(OPENJD, "run", FARM / "template.yaml", "--step", "Report", "--run-dependencies", *self.parameters())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(self.outputs(), [f"shot.{frame:04d}.exr" for frame in (1, 2, 3, 4, 5, 8)])
        self.assertIn("6 of 6 frames are finished", done.stdout)
        # Chunks have at most two consecutive frames, for example 1-2, 3-4, 5, 8.
        self.assertGreaterEqual(done.stdout.count("openjd_progress: 100.0"), 4)
        percents = [float(text) for text in re.findall(r"openjd_progress: ([0-9.]+)", done.stdout)]
        self.assertTrue(all(0 <= percent <= 100 for percent in percents))
        self.assertIn("openjd_status: frame 1 (1 of 2)", done.stdout)

    def test_the_default_names_of_the_programs_are_found_on_the_path(self):
        """A worker has both commands on its PATH, and the folder of the results is made."""
        programs, outputs = self.folder / "bin", self.folder / "new" / "out"
        programs.mkdir()
        (programs / "polyrecon").symlink_to(POLYRECON)
        command = programs / "polyrecon-farm"
        command.write_text(f'#!/bin/sh\nexec {sys.executable} -B {FARM / "farm.py"} "$@"\n')
        command.chmod(0o755)
        values = {"InputFolder": self.folder / "in", "OutputFolder": outputs, "Frames": "1-3", "Quality": "draft"}
        words = [word for name, value in values.items() for word in ("-p", f"{name}={value}")]
        path = f"{programs}:{os.environ['PATH']}"
        run_words = [OPENJD, "run", FARM / "template.yaml", "--step", "Report", "--run-dependencies", *words]
        done = run(*run_words, PATH=path, POLYRECON="")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("3 of 3 frames are finished", done.stdout)
        self.assertEqual(sorted(os.listdir(outputs)), [f"shot.{frame:04d}.exr" for frame in (1, 2, 3)])

        # A bundle that was made with these programs runs with them, too.
        words = ["-i", self.folder / "in/shot.####.exr", "-o", outputs / "shot.####.exr", "--frames", "1-3"]
        done = run(command, "openjd", *words, "--bundle", self.folder / "new bundle", PATH=path, POLYRECON="")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"({programs / 'polyrecon'})", done.stdout)
        values = yaml.safe_load((self.folder / "new bundle" / "parameter_values.yaml").read_text())["parameterValues"]
        given = {value["name"]: value["value"] for value in values}
        self.assertNotIn("Polyrecon", given)
        self.assertEqual(given["PolyreconFarm"], str(FARM / "farm.py"))  # of this checkout

    def test_options_are_checked_before_a_bundle_is_written(self):
        words = ["-i", self.folder / "in/shot.####.exr", "-o", self.folder / "o.####.exr", "--frames", "1-3"]
        words += ["--bundle", self.folder / "bundle", "--polyrecon", POLYRECON]
        for options in (["--qualty", "best"], ["--quality", "bst"]):
            done = run(sys.executable, FARM / "farm.py", "openjd", *words, "--", *options)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
            self.assertIn(options[-1] if options[0] == "--quality" else options[0], done.stderr)
            self.assertFalse((self.folder / "bundle").exists())

    def test_a_broken_frame_fails_its_task_and_no_other(self):
        broken = self.folder / "in/shot.0003.exr"
        broken.write_bytes(broken.read_bytes()[:-1])
        words = ["--step", "Denoise", *self.parameters()]
        done = run(OPENJD, "run", FARM / "template.yaml", *words, "--task-param", "Frames=3-4")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("openjd_fail: ", done.stdout)
        self.assertIn("shot.0003.exr", done.stdout)
        self.assertEqual(self.outputs(), ["shot.0004.exr"])

    def test_a_bundle_names_programs_that_are_not_on_the_path(self):
        words = ["-i", self.folder / "in/shot.####.exr", "-o", self.folder / "out/shot.####.exr", "--frames", "1"]
        words += ["--bundle", self.folder / "bundle", "-v"]
        command = [sys.executable, FARM / "farm.py", "openjd", *words]
        away = {**os.environ, "POLYRECON": POLYRECON, "PATH": os.defpath}
        near = {**os.environ, "PATH": os.path.dirname(POLYRECON) + ":" + os.environ["PATH"]}
        near.pop("POLYRECON")
        for environment, named in ((away, True), (near, False)):
            done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            values = yaml.safe_load((self.folder / "bundle/parameter_values.yaml").read_text())["parameterValues"]
            given = {value["name"]: value["value"] for value in values}
            self.assertEqual(given.get("Polyrecon"), POLYRECON if named else None)
            self.assertIn("Quality: standard", done.stdout.splitlines())

    def test_a_bundle_for_a_shot(self):
        bundle = self.folder / "bundle"
        words = ["-i", self.folder / "in/shot.####.exr", "-o", self.folder / "out/shot.####.exr", "--frames", "1-5x2"]
        words += ["--bundle", bundle, "--worker-cpus", "4", "--worker-memory", "16G", "--polyrecon", POLYRECON]
        words += ["--gpus", "2"]
        done = run(sys.executable, FARM / "farm.py", "openjd", *words, "--", "--quality", "draft", "--alpha")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        checked = run(OPENJD, "check", bundle / "template.yaml")
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        amounts = yaml.safe_load((bundle / "template.yaml").read_text())["steps"][0]["hostRequirements"]["amounts"]
        least = {amount["name"]: amount["min"] for amount in amounts}
        self.assertEqual((least["amount.worker.vcpu"], least["amount.worker.gpu"]), (1, 2))
        self.assertEqual(sorted(least), ["amount.worker.gpu", "amount.worker.memory", "amount.worker.vcpu"])
        self.assertIn("each with 1 thread, 2 graphics cards and ", done.stdout)
        values = yaml.safe_load((bundle / "parameter_values.yaml").read_text())["parameterValues"]
        given = {value["name"]: value["value"] for value in values}
        self.assertEqual((given["Frames"], given["Quality"], given["Threads"]), ("1,3,5", "draft", 1))
        # parameter_values.yaml is for Deadline Cloud; openjd takes the same values by name.
        self.assertEqual(given["Polyrecon"], POLYRECON)
        done = run(
            OPENJD,
            "run",
            bundle / "template.yaml",
            "--step",
            "Report",
            "--run-dependencies",
            *(word for name, value in given.items() for word in ("-p", f"{name}={value}")),
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(self.outputs(), [f"shot.{frame:04d}.exr" for frame in (1, 3, 5)])
