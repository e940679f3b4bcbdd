"""The base of the tests of the Blender drivers."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
MAKE_SCENE = Path(__file__).with_name("make_scene.py")
BLENDER_3 = shutil.which("blender")
PYTHON_OF_BLENDER_5_2 = shutil.which(ROOT / "build" / "venv_blender_5_2" / "bin" / "python3")
NO_BLENDER_5_2 = "Blender 5.2 needs Python 3.13, with which tests/pipelines/make_venv.sh installs it"


class SceneTest(unittest.TestCase):
    """Has a folder for each test, and makes scenes in it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def scene(self, kind="plain", name=None, blender="bpy"):
        path = self.folder / (name or f"{kind}.blend")
        script = [sys.executable, MAKE_SCENE]
        if blender != "bpy":
            script = [blender, "-b", "--factory-startup", "--python-exit-code", "7", "-P", MAKE_SCENE, "--"]
        subprocess.run([*script, path, kind], check=True, stdout=subprocess.DEVNULL)
        return path

    def blender_5_2(self):
        """A program that takes Blender's options and runs the module of Blender 5.2."""
        path = self.folder / "blender-5.2"
        path.write_text(f'#!/bin/sh\nfor script; do :; done\nexec "{PYTHON_OF_BLENDER_5_2}" -B "$script"\n')
        path.chmod(0o755)
        return path

    def driver(self, script, *words, **environment):
        """Runs a driver as a user does; returns the finished process."""
        command = [sys.executable, ROOT / "pipelines" / "blender" / script, *map(str, words)]
        return subprocess.run(
            command, capture_output=True, text=True, cwd=self.folder, env={**os.environ, **environment}
        )
