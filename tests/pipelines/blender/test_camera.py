"""The mask camera renders the same picture as Blender's camera, and only the pixels of the mask."""

import time
import unittest

import numpy as np

from pipelines.blender import masks
from pipelines.blender.renderer import MASKED_PASS, MASKED_PIXEL, BlenderRenderer
from pipelines.common import exr
from pipelines.common.rectangles import bounding_box
from pipelines.loop.pass_list import masked_passes
from pipelines.loop.renderer import RENDER_SECONDS, SAMPLE_COUNT
from tests.pipelines.blender.support import NO_BLENDER_5_2, PYTHON_OF_BLENDER_5_2, SceneTest

SAMPLES = 16


class Cameras(SceneTest):
    def passes(self, kind, samples, blender):
        """{channel: (Blender's camera, mask camera)} of the same samples of every pixel."""
        renderer = BlenderRenderer(self.scene(kind), blender)
        try:
            audit = renderer.begin(None)
            self.assertEqual(audit.method, "masks by a camera shader")
            files = self.folder / "unmasked.exr", self.folder / "masked.exr"
            renderer.uniform(0, samples, files[0])
            renderer.extra(0, np.full(renderer.shape, samples), files[1])
        finally:
            renderer.close()
        unmasked, masked = (exr.read(file) for file in files)
        return {
            name: (unmasked[name], masked[name]) for name in unmasked if name in masked and "Render Seconds" not in name
        }

    def assert_same_picture(self, kind, blender="bpy"):
        """Both cameras draw the same numbers, so every sample's path is the same up to rounding, which may change
        single paths: nearly all pixels agree closely, and the others differ by chance."""
        for name, (unmasked, masked) in self.passes(kind, SAMPLES, blender).items():
            scale = np.abs(unmasked).mean(dtype=float) + 1e-6
            off = np.abs(unmasked - masked) > 1e-3 * (np.abs(unmasked) + scale)
            self.assertLess(off.mean(), 0.03, f"{kind}: {name} differs in {off.mean():.1%} of the pixels")
            self.assertLess(abs((unmasked - masked).mean()) / scale, 2e-3, f"{kind}: {name}")

    def test_plain(self):
        self.assert_same_picture("plain")

    def test_shift_fit_aspect_near_plane_and_polygonal_blurred_lens(self):
        self.assert_same_picture("lens")

    @unittest.skipUnless(PYTHON_OF_BLENDER_5_2, NO_BLENDER_5_2)
    def test_the_same_lens_in_blender_5_2(self):
        self.assert_same_picture("lens", self.blender_5_2())

    def test_orthographic(self):
        self.assert_same_picture("orthographic")

    def test_motion(self):
        self.assert_same_picture("moving")

    def test_a_panoramic_camera_falls_back(self):
        renderer = BlenderRenderer(self.scene("panoramic"), "bpy")
        self.addCleanup(renderer.close)
        self.assertEqual(renderer.begin(None).method, "rectangles, because the camera is of type PANO")


class Masks(SceneTest):
    def test_each_pixel_gets_its_count_and_nothing_of_its_neighbours(self):
        self.check_counts("bpy")

    @unittest.skipUnless(PYTHON_OF_BLENDER_5_2, NO_BLENDER_5_2)
    def test_the_same_in_blender_5_2(self):
        self.check_counts(self.blender_5_2())

    def check_counts(self, blender):
        renderer = BlenderRenderer(self.scene(), blender)
        self.addCleanup(renderer.close)
        renderer.begin(None)
        random = np.random.default_rng(5)
        counts = random.choice([0, 1, 2, 8], size=renderer.shape)
        counts[:, -6:] = 0
        renderer.extra(8, counts, self.folder / "extra.exr")
        part = exr.read(self.folder / "extra.exr")
        np.testing.assert_array_equal(part[f"ViewLayer.{SAMPLE_COUNT}"], counts)
        # The time of a sample depends neither on its pixel's count nor on the number of passes.
        seconds = part[f"ViewLayer.{RENDER_SECONDS}"]
        a_sample = [np.median(seconds[counts == n] / n) for n in (1, 8)]
        self.assertLess(max(a_sample) / min(a_sample), 2)
        for samples in (1, 2, 8):
            renderer.uniform(8, samples, self.folder / "whole.exr")
            whole = exr.read(self.folder / "whole.exr")
            for channel in "RGB":
                name, place = f"ViewLayer.Combined.{channel}", counts == samples
                difference = np.abs(part[name] - whole[name])[place] > 1e-3 * (whole[name][place] + 0.01)
                self.assertLess(difference.mean(), 0.03, f"{samples} samples: rims are dark or bright")

    def test_an_interrupt_between_two_passes_starts_no_other(self):
        renderer = BlenderRenderer(self.scene(), "bpy")
        self.addCleanup(renderer.close)
        renderer.begin(None)
        counts = np.ones(renderer.shape, int)
        counts[: counts.shape[0] // 2] = 1 << 20  # hours
        for delay in (0, 0.001, 0.01, 0.1):
            passes = renderer._render_ahead(0, masked_passes(counts, MASKED_PASS, MASKED_PIXEL))
            next(passes)
            time.sleep(delay)
            with self.assertRaises(KeyboardInterrupt):
                passes.throw(KeyboardInterrupt())
            self.assertFalse(renderer.session.running)
        renderer.uniform(0, 1, self.folder / "after.exr")  # The renderer still works.

    def test_the_open_place_around_a_pixel(self):
        inside = np.zeros((3, 4), bool)
        inside[1, 2] = True
        mask = masks.subpixel_mask(inside, 0.25, 1)
        self.assertEqual(mask.shape, (20, 24))
        self.assertEqual(bounding_box(mask), (11, 7, 17, 13))  # 4 subpixels, and one on each side
        self.assertEqual(masks.subpixel_mask(inside, 0, 0).sum(), 16)


if __name__ == "__main__":
    unittest.main()
