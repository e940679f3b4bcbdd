"""What every driver's command line has in common: help with names and defaults, versions, one line about wrong use."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from pipelines.common import modules
from pipelines.common.version import VERSION

ROOT = Path(__file__).resolve().parents[3]
DRIVERS = {
    "polyrecon-blender": ["blender/adaptive.py"],
    "polyrecon-blender-passes": ["blender/render_passes.py"],
    "polyrecon-povray": ["povray/adaptive.py"],
    "polyrecon-povray-passes": ["povray/render_passes.py"],
    "polyrecon-farm": ["farm/farm.py"],
    "polyrecon-farm cost": ["farm/farm.py", "cost"],
    "polyrecon-farm openjd": ["farm/farm.py", "openjd"],
    "polyrecon-farm report": ["farm/farm.py", "report"],
    "polyrecon-farm slurm submit": ["farm/farm.py", "slurm", "submit"],
}
RENDERING = [name for name in DRIVERS if "farm" not in name]


def run(name, *words, python=(sys.executable, "-B"), script=None, **environment):
    script, *more = [script or ROOT / "pipelines" / DRIVERS[name][0], *DRIVERS[name][1:]]
    command = [*python, script, *more, *words]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, "COLUMNS": "999", **environment})


def help_of(name):
    """The help with each option on one line."""
    return re.sub(r"\n {20,}", "  ", run(name, "--help").stdout)


class CommandLines(unittest.TestCase):
    def test_help_names_the_command_and_the_defaults(self):
        for name in DRIVERS:
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                # Installed, the script has the command's name.
                installed = Path(folder, name.split()[0])
                script = ROOT / "pipelines" / DRIVERS[name][0]
                installed.write_text(
                    f"import sys; sys.path.insert(0, {str(ROOT)!r})\n"
                    f"from pipelines.{DRIVERS[name][0][:-3].replace('/', '.')} import main\nsys.exit(main())\n"
                )
                for path, shown in ((installed, name), (script, " ".join(map(str, [script, *DRIVERS[name][1:]])))):
                    done = run(name, "--help", script=path)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertTrue(done.stdout.startswith(f"usage: {shown} "), done.stdout)
                    for other in {"adaptive.py", "render_passes.py", "farm.py"} - {path.name}:
                        self.assertNotIn(other, done.stdout)
        for name, option, default in (
            ("polyrecon-blender", "--quality", "standard"),
            ("polyrecon-blender", "--first-pass", "8"),
            ("polyrecon-blender", "--dwa-level", "45"),
            ("polyrecon-blender-passes", "--parts", "8"),
            ("polyrecon-povray-passes", "--povray", "povray"),
            ("polyrecon-farm cost", "--frames", "1000"),
        ):
            self.assertRegex(help_of(name), rf"(?m)^  .*{option} .*\(default: {re.escape(default)}")

    def test_wrong_use_is_one_line_that_names_the_nearest(self):
        for name, words, line in (
            ("polyrecon-blender", ["--budgt-spp", "9"], "unknown option --budgt-spp: did you mean --budget-spp?"),
            ("polyrecon-blender", ["--budgt-spp=9"], "unknown option --budgt-spp: did you mean --budget-spp?"),
            ("polyrecon-povray", ["--zzz"], "unknown option --zzz; see "),
            ("polyrecon-blender", ["--quality", "standrd"], "did you mean standard?"),
            ("polyrecon-blender", ["--budget-sp", "9"], "unknown option --budget-sp: did you mean --budget-spp?"),
            ("polyrecon-farm", ["slrm"], "did you mean slurm?"),
            ("polyrecon-farm", ["hlep"], "did you mean help?"),
            ("polyrecon-farm slurm submit", ["--fames=1"], "unknown option --fames: did you mean --frames?"),
            ("polyrecon-blender", ["s.blend"], "required"),
        ):
            done = run(name, *words)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertTrue(done.stderr.startswith(f"{name}: "), done.stderr)
            self.assertIn(line, done.stderr)

    def test_versions_of_the_driver_and_of_the_program(self):
        for name in DRIVERS:
            first, second = run(name, "--version").stdout.splitlines()
            self.assertEqual(first, f"{name.split()[0]} {VERSION}")
            self.assertEqual(second, f"polyrecon {VERSION} ({os.environ['POLYRECON']})")
        done = run("polyrecon-farm", "--version", POLYRECON="/nowhere")
        self.assertIn("/nowhere: no such program", done.stdout)

    def test_a_program_that_is_not_polyrecon(self):
        with tempfile.TemporaryDirectory() as folder:
            words = ["-o", f"{folder}/o.exr", "--spp", "8", "--bpy", "--polyrecon", "/bin/true"]
            Path(folder, "s.blend").touch()
            done = run("polyrecon-blender-passes", f"{folder}/s.blend", *words)
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (4, 1), done.stderr)
        self.assertIn("/bin/true: is not polyrecon", done.stderr)

    def test_outputs_are_checked_before_any_work(self):
        with tempfile.TemporaryDirectory() as folder:
            scene, there = Path(folder, "s"), Path(folder, "there.exr")
            scene.touch()
            there.touch()
            for name in RENDERING:
                budget = [] if name == "polyrecon-povray-passes" else ["--spp", "8"]
                budget = budget if name.endswith("passes") else ["--budget-spp", "64"]
                for output, code, text in (
                    ("o.png", 2, "must end in .exr"),
                    ("there.exr", 2, "there.exr: exists already; add --overwrite to replace it"),
                    ("s/o.exr", 5, "s: is not a folder"),
                ):
                    with self.subTest(name=name, output=output):
                        done = run(name, scene, "-o", f"{folder}/{output}", *budget, BLENDER="bpy")
                        self.assertEqual(done.returncode, code, done.stderr)
                        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                        self.assertIn(text, done.stderr)
            self.assertEqual(sorted(os.listdir(folder)), ["s", "there.exr"])


class Checkout(unittest.TestCase):
    def test_nothing_is_left_in_it(self):
        with tempfile.TemporaryDirectory() as folder:
            pipelines = Path(folder, "pipelines")
            shutil.copytree(ROOT / "pipelines", pipelines, ignore=shutil.ignore_patterns("__pycache__"))
            before = sorted(pipelines.rglob("*"))
            for name in DRIVERS:
                done = run(name, "--help", python=(sys.executable,), script=pipelines / DRIVERS[name][0])
                self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(sorted(pipelines.rglob("*")), before)


class MissingModules(unittest.TestCase):
    def test_they_are_one_line_with_the_command_that_installs_them(self):
        """-I -S: this Python sees no installed package."""
        for name in RENDERING:
            done = run(name, "--help", python=(sys.executable, "-I", "-S", "-B"))
            self.assertEqual(done.returncode, 4, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertTrue(done.stderr.startswith(f"{name}: this Python lacks the modules numpy, OpenImageIO"))
            self.assertIn(f"{sys.executable} -m pip install numpy OpenImageIO jinja2 rich", done.stderr)
        done = run("polyrecon-farm openjd", "--help", python=(sys.executable, "-I", "-S", "-B"))
        self.assertEqual(done.returncode, 0, done.stderr)  # It needs none of them.

    def test_a_module_that_cannot_be_imported_is_named_with_the_reason(self):
        """As numpy is where it was compiled for another Python. Its message has several lines."""
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "jinja2.py").write_text("raise ImportError('\\nno symbol x\\n\\nread this')\n")
            done = run("polyrecon-povray", "--help", PYTHONPATH=folder)
        self.assertEqual(done.returncode, 4, done.stderr)
        advice = f"{sys.executable} -m pip install --force-reinstall jinja2"
        told = "polyrecon-povray: the module jinja2 of this Python cannot be imported (no symbol x): "
        self.assertEqual(done.stderr, told + advice + "\n")

    def test_faults_of_our_modules_are_not_blamed_on_others(self):
        with self.assertRaisesRegex(ImportError, "cannot import name 'nothing'"), modules.required("x", ["json"]):
            from pipelines.common.version import nothing  # noqa: F401

    def test_a_python_that_is_too_old_is_named(self):
        self.assertEqual(modules.too_old((3, 9, 0)), "")
        self.assertEqual(modules.too_old((3, 8, 18)), f"Python 3.9 or later is needed; {sys.executable} is 3.8")

    def test_blender_as_a_module_is_missing_in_one_line(self):
        """The system's Python has what drivers need, but no bpy."""
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder, "a.blend")
            scene.touch()
            words = ("--bpy", scene, "-o", Path(folder, "x.exr"), "--budget-spp", "8")
            done = run("polyrecon-blender", *words, python=("/usr/bin/python3", "-B"))
        told = "this Python lacks the module bpy: /usr/bin/python3 -m pip install bpy (for Python 3.11 or 3.13)\n"
        self.assertEqual((done.returncode, done.stderr), (4, "polyrecon-blender: " + told))
        script = ROOT / "pipelines" / "compositing" / "blender_comp.py"
        done = subprocess.run(["/usr/bin/python3", "-B", script, "x.exr", "--list"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (4, "blender_comp.py: " + told))


if __name__ == "__main__":
    unittest.main()
