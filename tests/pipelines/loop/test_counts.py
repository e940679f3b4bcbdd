import pathlib
import tempfile
import unittest

import numpy as np
import OpenImageIO as oiio

from pipelines.common import exr
from pipelines.common.polyrecon_cli import Polyrecon
from pipelines.loop.budget import CONVERGENCE_RATE
from pipelines.loop.counts import MAX_COUNT, Taken, cost_of_samples, gaussian_blur, quantise, weight_of_samples

ONES = np.ones((32, 48))


class Counts(unittest.TestCase):
    def test_powers_of_two_that_cost_what_was_wanted(self):
        random = np.random.default_rng(1)
        hills = gaussian_blur(random.normal(0, 1, (96, 144)), 20)
        wanted = np.exp(hills / hills.std() + 3)
        cost = np.where(np.arange(144) < 72, 1.0, 5.0) * np.ones((96, 1))
        counts = quantise(wanted, cost)
        self.assertLessEqual((cost * counts).sum(), (cost * wanted).sum() * 1.02)
        self.assertGreater((cost * counts).sum(), (cost * wanted).sum() * 0.9)
        used = counts[counts > 0]
        np.testing.assert_array_equal(2 ** np.rint(np.log2(used)).astype(int), used)
        self.assertGreaterEqual(used.min(), 2 ** np.floor(np.log2(wanted.mean() / 4)))
        self.assertGreater(np.corrcoef(np.log2(wanted[counts > 0]), np.log2(used))[0, 1], 0.9)

    def test_neighbours_mostly_share_a_count(self):
        wanted = np.random.default_rng(2).exponential(8, (64, 64))
        counts = quantise(wanted, np.ones((64, 64)))
        self.assertLess((counts[:, 1:] != counts[:, :-1]).mean(), 0.15)

    def test_case34_nothing_one_pixel_everything_and_no_numbers(self):
        self.assertEqual(quantise(0 * ONES, ONES).sum(), 0)
        self.assertTrue((quantise(4 * ONES, ONES) == 4).all())
        self.assertEqual(quantise(np.nan * ONES, ONES).sum(), 0)
        one = 0 * ONES
        one[7, 9] = 640
        counts = quantise(one, ONES)
        self.assertGreater(counts[7, 9], 1)  # The pixel has the largest count, shared by its neighbours.
        self.assertEqual(counts[7, 9], counts.max())
        self.assertLessEqual(counts.sum(), 640)
        self.assertEqual(counts[24:].sum(), 0)
        holed = 4 * ONES
        holed[3, 3] = np.nan
        self.assertTrue(np.isin(quantise(holed, ONES), (2, 4, 8)).all())
        self.assertLessEqual(quantise(1e9 * ONES, ONES).max(), MAX_COUNT)


def sample_map(variance, noise, samples, budget):
    """(extra samples of each pixel, error after them over the error before) of `polyrecon samplemap`."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [str(pathlib.Path(folder, name)) for name in ("error.exr", "samples.exr")]
        error = {"relmse.Y": variance, "relvariance.Y": variance, "relnoise.Y": noise, "samples.Y": samples}
        exr.write(paths[0], {**{f"mse.{c}": variance for c in "RGB"}, **error})
        Polyrecon().run("samplemap", "-e", paths[0], "-o", paths[1], "--budget", budget, "--max-samples", "4096")
        spec = oiio.ImageBuf(paths[1]).spec()
        before, after = (spec.getattribute(name) for name in ("errorBefore", "errorAfter"))
        return exr.read(paths[1])["samples.Y"], after / before


class ModelOfTheSampleMap(unittest.TestCase):
    """The loop's decisions predict with the model of `polyrecon samplemap`."""

    # dn = sqrt(V n / lambda) - n where no pixel's samples reach a limit: V is known but for a factor.

    def test_the_error_falls_at_the_same_rate(self):
        extra, left = sample_map(0.1 * ONES, 0.4 * ONES, 8 * ONES, "24")
        self.assertGreater(extra.min(), 0)
        weight = (extra.astype(float) + 8) ** 2 / 8
        expected = (weight * (8 / (8 + extra)) ** CONVERGENCE_RATE).sum() / weight.sum()
        self.assertAlmostEqual(left, expected, places=5)
        self.assertNotAlmostEqual(left, (weight * (8 / (8 + extra))).sum() / weight.sum(), places=2)

    def test_the_noise_of_a_pixel_has_the_same_weight(self):
        y, x = np.mgrid[0:96, 0:128]
        variance = 0.1 * (1.5 + np.sin(x / 25) * np.cos(y / 20))
        noise = 0.4 * (1.5 + np.sin(x / 30 + 1))
        samples = 2.0 + (x > 64)
        extra, _ = sample_map(variance, noise, samples, "64")
        inner = (
            slice(12, -12),
            slice(12, -12),
        )  # At the border the program's window ends, the loop's repeats the edge.
        self.assertGreater(extra[inner].min(), 0)
        weight = ((extra + samples) ** 2 / samples)[inner]
        ratio = weight_of_samples(variance, noise)[inner] / weight
        np.testing.assert_allclose(ratio / ratio.mean(), 1, atol=0.02)  # The program's window ends at two deviations.
        self.assertGreater(weight.max() / weight.min(), 3)


class Sums(unittest.TestCase):
    def test_parts_add_up_and_unknown_seconds_stay_unknown(self):
        known, unknown = Taken(2 * ONES, 3 * ONES), Taken(ONES, None)
        both = known + known
        self.assertEqual((both.counts.max(), both.seconds.max()), (4, 6))
        for mixed in (known + unknown, unknown + known):
            self.assertEqual(mixed.counts.max(), 3)
            self.assertIsNone(mixed.seconds)


class Costs(unittest.TestCase):
    def test_smoothed_relative_and_bounded(self):
        counts = 8 * ONES
        seconds = np.where(np.arange(48) < 24, 1.0, 3.0) * counts
        cost = cost_of_samples(Taken(counts, seconds))
        self.assertAlmostEqual(cost[16, 44] / cost[16, 4], 3, delta=0.05)
        self.assertAlmostEqual(cost.mean(), 1, delta=0.05)
        seconds[5, 5] = 1e12
        self.assertLessEqual(cost_of_samples(Taken(counts, seconds)).max(), 16)

    def test_unknown_is_the_same_everywhere(self):
        for seconds in (None, 0 * ONES, np.nan * ONES):
            self.assertTrue((cost_of_samples(Taken(ONES, seconds)) == 1).all())


if __name__ == "__main__":
    unittest.main()
