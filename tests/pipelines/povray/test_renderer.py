import pathlib

import numpy as np

from pipelines.common import exr
from pipelines.common.errors import DriverError
from pipelines.povray.renderer import PovrayRenderer, field_order

from .scenes import BALL, CAMERA, HEAD, NOISY_LAMP, SIZE, InFolder


class PovrayBehindTheLoop(InFolder):
    def renderer(self, first_pass=16):
        scene = self.scene(HEAD % 1 + CAMERA + BALL + NOISY_LAMP)
        renderer = PovrayRenderer(scene, list(SIZE), "povray", None, first_pass)
        self.addCleanup(renderer.close)
        return renderer

    def test_fields_of_the_first_pass(self):
        for n in (2, 4, 6, 8):
            order = field_order(n)
            self.assertEqual(len(set(order)), n * n)
            self.assertTrue(all((y + x) % 2 == (i >= n * n // 2) for i, (y, x) in enumerate(order)))
            first, second = np.array(order[::2]), np.array(order[1::2])
            np.testing.assert_array_equal((first - second) % n, n // 2)
        for wrong in (8, 9, 1):
            self.assertRaises(DriverError, self.renderer, wrong)

    def test_parts_of_the_first_pass_are_its_subpixels(self):
        renderer = self.renderer()
        audit = renderer.begin(None)
        self.assertEqual((audit.width, audit.height, audit.beauty), (64, 48, "Combined"))
        self.assertIn("POV-Ray 3", renderer.name)
        for index in range(8):
            renderer.uniform(2 * index, 2, pathlib.Path(f"part_{index}.exr"))
        parts = [exr.read(f"part_{index}.exr") for index in range(8)]
        mean = np.mean([part["Combined.G"] for part in parts], 0)
        whole = renderer.first[..., 1].reshape(48, 4, 64, 4).mean((1, 3))
        np.testing.assert_allclose(mean, whole, atol=1e-6)
        self.assertTrue(all((part["Sample Count.X"] == 2).all() for part in parts))
        renderer.complete(pathlib.Path("part_0.exr"))
        completed = exr.read("part_0.exr")
        np.testing.assert_array_equal(completed["Combined.G"], parts[0]["Combined.G"])
        self.assertIn("Denoising Normal Variance.X", completed)

    def test_extra_samples_are_new_and_no_more_than_asked_for(self):
        renderer = self.renderer()
        renderer.begin(None)
        counts = np.zeros((48, 64), int)
        counts[10:40, 5:20] = 16
        counts[30:48, 40:64] = 64
        grids, total = [], 0
        for number in range(3):
            target = pathlib.Path(f"part_{number}.exr")
            renderer.extra(16, counts, target)
            part = exr.read(target)
            taken = part["Sample Count.X"]
            self.assertLessEqual(taken.sum(), counts.sum())
            self.assertGreater(taken.sum(), 0.3 * counts.sum())
            self.assertEqual(taken[5, 50], 0)
            self.assertTrue((part["Combined.R"][taken > 0] > 0).all())
            grids.append(taken[40, 50] ** 0.5)
            total += taken
        self.assertEqual(len({*grids, 4.0}), 4)  # All differ, also from the grid of the first pass.
        # After an interruption the same target gets the same grids.
        renderer.extra(16, counts, target)
        self.assertEqual(exr.read(target)["Sample Count.X"][40, 50] ** 0.5, grids[-1])
