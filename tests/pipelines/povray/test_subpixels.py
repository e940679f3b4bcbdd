import unittest

import numpy as np

from pipelines.povray.subpixels import estimate, join


class Subpixels(unittest.TestCase):
    def test_the_variance_of_white_noise(self):
        # With 4800 pixels x 3 channels the mean of squared errors has an error of 2 sqrt(2 / 14400) = 2.4 % at 2 sigma,
        # and the mean of the estimated variances a smaller one; 6 % is 5 sigma.
        for n in (2, 3, 4, 8):
            found = estimate(np.random.default_rng(n).normal(size=(60 * n, 80 * n, 3)), n)
            self.assertAlmostEqual(found.variance.mean() / (found.mean**2).mean(), 1, delta=0.06)
            self.assertAlmostEqual(found.variance.mean() * n * n, 1, delta=0.06)

    def test_halves_are_independent_and_make_up_the_mean(self):
        image = np.random.default_rng(1).normal(size=(240, 320, 3))
        found = estimate(image, 4)
        np.testing.assert_allclose((found.a + found.b) / 2, found.mean, atol=1e-12)
        # The correlation of 14400 independent pairs is below 5 / sqrt(14400).
        self.assertLess(abs(np.corrcoef(found.a.ravel(), found.b.ravel())[0, 1]), 0.042)

    def test_halves_cover_the_pixel_alike(self):
        # A linear change across the pixel has the same mean in both halves.
        y, x = np.mgrid[:48, :64] / 4
        for n in (2, 4, 8):
            found = estimate((3 * x - 2 * y)[..., None], n)
            np.testing.assert_allclose(found.a, found.b, atol=1e-12)

    def test_an_even_slope_is_no_noise(self):
        y, x = np.mgrid[:48, :64] / 4
        for n in (2, 4, 8):
            self.assertLess(estimate((3 * x - 2 * y)[..., None], n).variance.max(), 1e-20)

    def test_joined_samples_weigh_by_their_number(self):
        image = np.random.default_rng(2).normal(size=(8 * 20, 8 * 20, 1))
        small, large = estimate(image[::4, ::4], 2), estimate(image, 8)
        both = join(small, 4, large, 64)
        np.testing.assert_allclose(both.mean, (4 * small.mean + 64 * large.mean) / 68)
        np.testing.assert_allclose(both.variance, (16 * small.variance + 4096 * large.variance) / 68**2)

    def test_one_subpixel_has_no_variance(self):
        found = estimate(np.ones((3, 5, 3)), 1)
        self.assertEqual((found.mean.shape, found.variance.max()), ((3, 5, 3), 0))


if __name__ == "__main__":
    unittest.main()
