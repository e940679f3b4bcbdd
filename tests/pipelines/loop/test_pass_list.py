import unittest

import numpy as np

from pipelines.loop.pass_list import masked_passes, rectangular_passes

COSTS = 100_000, 2.5  # Cost of a masked step and of each pixel of its box


def taken(counts, overhead):
    passes = rectangular_passes(counts, overhead)
    samples = np.zeros(counts.shape, int)
    covered = np.zeros(counts.shape, int)
    for render_pass in passes:
        x0, y0, x1, y1 = render_pass.box
        samples[y0:y1, x0:x1] += render_pass.samples
        covered[y0:y1, x0:x1] += 1
    return passes, samples, covered


class RectangularPasses(unittest.TestCase):
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
        self.assertEqual(rectangular_passes(counts, 100), [])
        counts[5, 30] = 4096
        _, samples, _ = taken(counts, 10)
        self.assertGreater(samples[5, 30], 0)
        self.assertLess((samples > 0).sum(), 400)
        self.assertLess(samples.sum(), 3 * 4096)

    def test_counts_too_few_for_a_rectangle_become_rows(self):
        counts = np.zeros((40, 60), int)
        counts[30:34, ::2] = 1  # 120 samples
        for overhead in (1e6, np.inf):
            passes, samples, _ = taken(counts, overhead)
            self.assertEqual((samples.sum(), samples.max()), (120, 1))
            self.assertEqual(len(passes), 1)
            self.assertGreaterEqual(passes[0].box[1], 30)
            self.assertLessEqual(passes[0].box[3], 34)
        single = np.zeros((40, 60), int)
        single[7, 50] = 1
        self.assertEqual([p.box for p in rectangular_passes(single, np.inf)], [(0, 7, 60, 8)])


class MaskedPasses(unittest.TestCase):
    def test_passes_lie_one_in_another_and_continue_the_sequence(self):
        counts = np.array([[0, 4, 4], [0, 0, 1]])
        passes = [(p.skip, p.samples, p.box, p.inside.tolist()) for p in masked_passes(counts, *COSTS)]
        self.assertEqual(
            passes, [(0, 1, (1, 0, 3, 2), [[True, True], [False, True]]), (1, 3, (1, 0, 3, 1), [[True, True]])]
        )
        self.assertEqual(masked_passes(np.zeros((2, 2)), *COSTS), [])

    def test_passes_are_cut_where_what_lies_between_costs_more_than_another_pass(self):
        counts = np.zeros((360, 640), int)
        counts[10:20, 10:30] = counts[340:350, 600:630] = 64
        self.assertEqual([p.box for p in masked_passes(counts, *COSTS)], [(10, 10, 30, 20), (600, 340, 630, 350)])
        near = np.zeros((360, 640), int)
        near[10:20, 10:30] = near[10:20, 100:120] = 64  # 45,000 samples in between, less than a pass
        self.assertEqual([p.box for p in masked_passes(near, *COSTS)], [(10, 10, 120, 20)])
        random = np.random.default_rng(8)
        counts = np.kron(random.choice([0, 0, 1, 4, 128], size=(18, 32)), np.ones((20, 20), int))
        taken = np.zeros_like(counts)
        for render_pass in masked_passes(counts, *COSTS):
            x0, y0, x1, y1 = render_pass.box
            self.assertTrue((taken[y0:y1, x0:x1][render_pass.inside] == render_pass.skip).all())
            taken[y0:y1, x0:x1] += render_pass.samples * render_pass.inside
        np.testing.assert_array_equal(taken, counts)


if __name__ == "__main__":
    unittest.main()
