"""What Cycles renders on: the choice, with Blender's own preferences. No graphics card is needed."""

import sys
import unittest

import bpy

from pipelines.blender.renderer import BlenderRenderer
from tests.pipelines.blender.support import BLENDER_3, ROOT, SceneTest

sys.path.append(str(ROOT / "pipelines" / "blender" / "inside"))
import camera
import device


class Preferences(unittest.TestCase):
    """A card is an entry of Cycles' list of devices, as the preferences store it."""

    def setUp(self):
        bpy.ops.wm.read_factory_settings()
        self.scene = bpy.context.scene
        self.scene.render.engine = "CYCLES"
        self.cycles = bpy.context.preferences.addons["cycles"].preferences
        self.cycles.refresh_devices()

    def tearDown(self):
        self.cycles.devices.clear()
        self.cycles.compute_device_type = "NONE"

    def add_card(self, kind, name):
        card = self.cycles.devices.add()
        card.id, card.name, card.type, card.use = f"{kind}_{name}", name, kind, False
        return card

    def used(self):
        return {found.name for found in self.cycles.devices if found.use}

    def choose(self, wanted, scene_device):
        self.scene.cycles.device = scene_device
        return device.choose(self.scene, wanted)

    def test_auto_is_as_the_scene_says_where_there_is_a_card(self):
        self.assertEqual(self.choose("auto", "GPU"), "CPU")
        self.assertEqual((self.scene.cycles.device, self.cycles.compute_device_type), ("CPU", "NONE"))
        self.add_card("HIP", "card")
        self.assertEqual(self.choose("auto", "CPU"), "CPU")
        self.assertEqual(self.choose("auto", "GPU"), "HIP")
        self.assertEqual((self.scene.cycles.device, self.cycles.compute_device_type), ("GPU", "HIP"))
        self.assertEqual(self.used(), {"card"})

    def test_gpu_is_refused_without_a_card(self):
        with self.assertRaisesRegex(RuntimeError, "--device gpu: Cycles finds no graphics card; use --device cpu"):
            self.choose("gpu", "CPU")
        self.add_card("CUDA", "card")
        self.assertEqual(self.choose("gpu", "CPU"), "CUDA")

    def test_cpu_is_the_processor(self):
        self.add_card("CUDA", "card")
        self.assertEqual(self.choose("cpu", "GPU"), "CPU")
        self.assertEqual(self.scene.cycles.device, "CPU")

    def test_all_cards_of_the_best_type_are_used_and_no_others(self):
        for kind, name in (("CUDA", "first by CUDA"), ("OPTIX", "first"), ("OPTIX", "second")):
            self.add_card(kind, name)
        self.assertEqual(self.choose("gpu", "GPU"), "OPTIX")
        self.assertEqual(self.used(), {"first", "second"})

    def test_masks_need_camera_shaders(self):
        def reason(kind):
            return camera.why_not(self.scene, self.scene.camera, bpy.context.evaluated_depsgraph_get(), kind)

        self.assertEqual((reason("CPU"), reason("OPTIX")), ("", ""))
        for kind in ("CUDA", "HIP", "METAL", "ONEAPI"):
            self.assertEqual(reason(kind), f"Cycles has no camera shaders on {kind}")


class Drivers(SceneTest):
    def test_a_scene_for_a_card_is_rendered_by_the_processor(self):
        for blender in filter(None, ("bpy", BLENDER_3)):
            renderer = BlenderRenderer(self.scene("on_a_card", blender=blender), blender)
            try:
                audit = renderer.begin(None)
            finally:
                renderer.close()
            self.assertIn("Cycles finds no graphics card: the processor renders", " ".join(audit.notes))
            self.assertIn("device: CPU", audit.details)

    def test_gpu_without_a_card_is_one_line(self):
        words = [self.scene(), "-o", self.folder / "out.exr", "--bpy", "--device", "gpu"]
        for script, more in (("render_passes.py", ["--spp", "8"]), ("adaptive.py", ["--budget-spp", "8"])):
            done = self.driver(script, *words, *more)
            self.assertEqual(done.returncode, 7, done.stderr)
            self.assertRegex(done.stderr.strip().splitlines()[-1], "--device gpu: Cycles finds no graphics card")


if __name__ == "__main__":
    unittest.main()
