"""Small scenes whose passes can be computed by hand, and a folder for each test."""

import os
import pathlib
import tempfile
import unittest

SIZE = ("+W64", "+H48")
HEAD = "#version 3.7; global_settings { assumed_gamma %g }\n"
CAMERA = (
    "camera { location <0,0,-5> right x*4/3 up y direction z*1.5 }\n"  # a ray is (0.667 x, 0.5 y, 1.5), -1 < x, y < 1
)
# A ball of radius 1 at the origin in front of a wall at z = 2, on which the shadow of the ball falls.
BALL = """sphere { 0, 1 pigment { rgb <0.8,0.4,0.2> } finish { ambient 0.1 diffuse 0.6 } }
plane { -z, -2 hollow pigment { rgb <0.3,0.5,0.7> } finish { ambient 0.1 diffuse 0.6 } }
"""
LAMP = "light_source { <4,4,-6> color rgb 1 }\n"
# A soft shadow of few jittered samples: there is noise in the penumbra on the wall.
NOISY_LAMP = "light_source { <4,4,-6> color rgb 1 area_light x*5, y*5, 2, 2 jitter }\n"


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="polyrecon-test-")
        self.addCleanup(self.folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder.name)

    def scene(self, text, name="scene.pov"):
        path = pathlib.Path(name)
        path.write_text(text, encoding="utf-8")
        return path
