"""The settings that the audit switches off do not change the picture."""

import unittest

import numpy as np

from pipelines.blender.renderer import BlenderRenderer
from pipelines.common import exr
from tests.pipelines.blender.support import BLENDER_3, SceneTest


class Audits(SceneTest):
    def render(self, scene, blender="bpy", before=None):
        renderer = BlenderRenderer(scene, blender)
        try:
            audit = renderer.begin(None)
            renderer.uniform(0, 2, self.folder / "part.exr")
            return (
                audit,
                renderer.opened["effects"],
                exr.read(self.folder / "part.exr", lambda name: ".Combined." in name),
            )
        finally:
            renderer.close()

    def test_what_is_switched_off_does_not_change_the_picture(self):
        for blender in ("bpy", BLENDER_3):
            plain, _, picture = self.render(self.scene("plain", blender=blender), blender)
            audit, _, same = self.render(self.scene("switched_on", blender=blender), blender)
            off = {switch.effect for switch in audit.switches} - {switch.effect for switch in plain.switches}
            self.assertLessEqual({"motion blur", "render border"}, off)
            for name in picture:
                np.testing.assert_array_equal(picture[name], same[name], f"{blender}: {name}")

    def test_motion_blur_of_what_moves_stays(self):
        audit, effects, _ = self.render(self.scene("moving"))
        self.assertTrue(effects["motion blur"] and effects["animation"])
        self.assertNotIn("motion blur", {switch.effect for switch in audit.switches})

    def test_effects_are_found(self):
        _, effects, _ = self.render(self.scene("lens"))
        self.assertEqual(
            {k: v for k, v in effects.items() if v}, {"depth of field": True, "lamps": 1, "denoising": True}
        )


if __name__ == "__main__":
    unittest.main()
