import unittest

import numpy as np

from pipelines.blender import regions


def taken(counts, overhead):
    passes = regions.plan(counts, overhead)
    samples = np.zeros(counts.shape, int)
    covered = np.zeros(counts.shape, int)
    for piece in passes:
        x0, y0, x1, y1 = piece.box
        samples[y0:y1, x0:x1] += piece.samples
        covered[y0:y1, x0:x1] += 1
    return passes, samples, covered


class Rectangles(unittest.TestCase):
    def test_an_even_map_is_one_rectangle(self):
        passes, samples, _ = taken(np.full((60, 80), 4), 100)
        self.assertEqual(len(passes), 1)
        self.assertTrue((samples == 4).all())

    def test_two_halves_are_two_where_a_pass_is_cheap_and_one_where_it_is_dear(self):
        counts = np.full((60, 80), 1)
        counts[:, 40:] = 32
        passes, samples, _ = taken(counts, 100)
        self.assertEqual(sorted((p.samples, p.box) for p in passes), [(1, (0, 0, 40, 60)), (32, (40, 0, 80, 60))])
        np.testing.assert_array_equal(samples, counts)
        self.assertEqual(len(taken(counts, 1e9)[0]), 1)

    def test_rectangles_do_not_overlap_and_cost_what_was_asked_for(self):
        random = np.random.default_rng(3)
        y, x = np.mgrid[:96, :128]
        wanted = 2.0 ** np.rint(3 + 2.5 * np.sin(x / 11) * np.cos(y / 17) + random.normal(0, 0.5, x.shape))
        passes, samples, covered = taken(np.where(wanted < 2, 0, wanted), 300)
        self.assertLessEqual(covered.max(), 1)
        self.assertGreater(len(passes), 8)
        self.assertLess(abs(np.log2(samples.sum() / wanted.sum())), 0.25)
        self.assertGreater(np.corrcoef(samples.ravel(), wanted.ravel())[0, 1], 0.7)

    def test_nothing_and_one_pixel(self):
        counts = np.zeros((40, 40))
        self.assertEqual(regions.plan(counts, 100), [])
        counts[5, 30] = 4096
        passes, samples, _ = taken(counts, 10)
        self.assertGreater(samples[5, 30], 0)
        self.assertLess((samples > 0).sum(), 400)
        self.assertLess(samples.sum(), 3 * 4096)


if __name__ == "__main__":
    unittest.main()
