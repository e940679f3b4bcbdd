import itertools
import unittest

from pipelines.loop.budget import CONVERGENCE_RATE, MIN_SAMPLES
from pipelines.loop.sharing import Figures, left_to_target, mean_error_after, next_slice, shares_of

NOISY, QUIET, DEAR = Figures(0.1, 8, 1), Figures(0.001, 8, 1), Figures(0.01, 40, 5)


def error_of(frames, shares):
    return sum(frame.error_after(share) for frame, share in zip(frames, shares))


class Shares(unittest.TestCase):
    def test_no_other_division_leaves_less_error(self):
        frames = [NOISY, QUIET, DEAR]
        shares = shares_of(frames, 90.0)
        self.assertAlmostEqual(sum(shares), 90)
        for giver, taker in itertools.permutations(range(3), 2):
            moved = list(shares)
            amount = min(0.5, moved[giver])
            moved[giver], moved[taker] = moved[giver] - amount, moved[taker] + amount
            self.assertLessEqual(error_of(frames, shares), error_of(frames, moved))

    def test_frames_alike_get_alike(self):
        self.assertEqual(shares_of([NOISY] * 3, 30.0), [10, 10, 10])

    def test_a_frame_with_little_error_gets_nothing_while_the_others_gain_more(self):
        shares = shares_of([NOISY, QUIET], 4.0)
        self.assertAlmostEqual(shares[0], 4)
        self.assertEqual(shares[1], 0)

    def test_a_frame_without_error_gets_nothing(self):
        self.assertEqual(shares_of([Figures(0.0, 8, 1), QUIET], 5.0)[0], 0)
        self.assertEqual(shares_of([Figures(0.0, 8, 1)], 5.0), [0])

    def test_the_gains_of_all_that_get_something_become_equal(self):
        frames = [NOISY, QUIET, DEAR]
        gains = [
            CONVERGENCE_RATE * frame.error_after(share) / (frame.spent + share)
            for frame, share in zip(frames, shares_of(frames, 500.0))
        ]
        for gain in gains[1:]:
            self.assertAlmostEqual(gain / gains[0], 1)


class Targets(unittest.TestCase):
    def test_what_is_left_leads_to_the_target(self):
        frames = [NOISY, QUIET, DEAR]
        self.assertAlmostEqual(mean_error_after(frames, left_to_target(frames, 0.004)), 0.004, delta=1e-6)

    def test_a_target_that_is_reached_needs_nothing(self):
        self.assertEqual(left_to_target([NOISY, QUIET], 0.06), 0)


class Slices(unittest.TestCase):
    def test_the_frame_of_the_largest_gain_comes_first_and_doubles(self):
        index, amount, share = next_slice([QUIET, NOISY], 100.0)
        self.assertEqual((index, amount), (1, 8))
        self.assertGreater(share, 16)

    def test_a_share_below_two_rounds_is_one_round(self):
        _, amount, share = next_slice([NOISY], 15.0)
        self.assertEqual((amount, share), (15, 15))

    def test_a_round_is_long_enough_for_its_decision(self):
        _, amount, _ = next_slice([Figures(0.1, 8, 1, overhead=20)], 100.0)
        self.assertEqual(amount, 20)

    def test_small_shares_are_put_together(self):
        found = next_slice([NOISY] * 10, 2.0)  # 0.2 for each, where a round takes 1
        self.assertEqual(found[1:], (1, 1))

    def test_nothing_is_left_for_a_round(self):
        self.assertIsNone(next_slice([NOISY, QUIET], 0.9 * MIN_SAMPLES))
        self.assertIsNone(next_slice([NOISY], -3.0))
        self.assertIsNone(next_slice([Figures(0.0, 8, 1)] * 2, 100.0))
        self.assertIsNone(next_slice([], 100.0))


if __name__ == "__main__":
    unittest.main()
