"""Samples have numbers: no two are the same, and a pass may take numbers of several sequences."""

import unittest

import numpy as np

from pipelines.blender.renderer import BlenderRenderer
from pipelines.common import exr
from pipelines.loop.renderer import SAMPLE_COUNT
from tests.pipelines.blender.support import BLENDER_3, SceneTest

PICTURE = [f"ViewLayer.Combined.{c}" for c in "RGB"]


class Sequences(SceneTest):
    def renderer(self, kind, blender):
        renderer = BlenderRenderer(self.scene(kind, blender=blender), blender)
        self.addCleanup(renderer.close)
        renderer.begin(None)
        return renderer

    def uniform(self, renderer, first, samples):
        renderer.uniform(first, samples, self.folder / "part.exr")
        return exr.read(self.folder / "part.exr")

    def picture(self, renderer, first, samples=4):
        channels = self.uniform(renderer, first, samples)
        return np.stack([channels[name] for name in PICTURE], -1)

    def test_a_pass_across_the_end_of_a_sequence_goes_on_in_the_next(self):
        for blender in ("bpy", BLENDER_3):
            renderer = self.renderer("plain", blender)
            end = renderer.opened["sequence"]
            whole = self.uniform(renderer, end - 2, 8)
            before, after = self.uniform(renderer, end - 2, 2), self.uniform(renderer, end, 6)
            np.testing.assert_array_equal(whole[f"ViewLayer.{SAMPLE_COUNT}"], 8)
            for name in PICTURE:
                np.testing.assert_allclose(whole[name], (2 * before[name] + 6 * after[name]) / 8, rtol=1e-4, atol=1e-5)

    def test_the_next_sequence_has_other_samples(self):
        for kind in ("plain", "seed_animated"):
            renderer = self.renderer(kind, "bpy")
            pictures = [self.picture(renderer, first) for first in (0, 4, 256, 512)]
            for i, one in enumerate(pictures):
                for other in pictures[:i]:
                    self.assertGreater((one != other).mean(), 0.5, kind)
                    self.assertAlmostEqual(one.mean() / other.mean(), 1, delta=0.05)

    def test_a_seed_that_is_animated_is_left_to_the_file(self):
        renderer = self.renderer("seed_animated", "bpy")
        self.assertIsNone(renderer.opened["sequence"])
        still = self.picture(renderer, 0)
        renderer.begin(2)  # Only the seed differs in this frame.
        self.assertGreater((self.picture(renderer, 0) != still).mean(), 0.5)
        renderer.begin(1)
        np.testing.assert_allclose(self.picture(renderer, 0), still, rtol=1e-4, atol=1e-5)


if __name__ == "__main__":
    unittest.main()
