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

    def driver(self, script, *words, **environment):
        """Runs a driver as a user does; returns the finished process."""
        command = [sys.executable, ROOT / "pipelines" / "blender" / script, *map(str, words)]
        return subprocess.run(
            command, capture_output=True, text=True, cwd=self.folder, env={**os.environ, **environment}
        )
