import unittest

from pipelines.loop.budget import Budget, Spent, even_share, next_slice, nothing_left, rest, seconds_per_even_sample


def spent(samples, seconds=10.0, error=0.1, judging=0.5):
    """10 seconds were spent; a sample takes one, the result 2 more."""
    return Spent(samples, seconds, samples, 1.0, judging, 2.0, error)


class Slices(unittest.TestCase):
    def test_samples_double_and_the_last_takes_the_rest(self):
        done = []
        n = 8.0
        while extra := next_slice(Budget(samples=64), spent(n))[0]:
            done.append(extra)
            n += extra
        self.assertEqual(done, [8, 16, 32])
        self.assertEqual(next_slice(Budget(samples=24), spent(8.0))[0], 8 + 8)  # 8 more would be no round of their own
        self.assertEqual(next_slice(Budget(samples=8), spent(8.0)), (0.0, "the samples are spent"))

    def test_case31_seconds_leave_room_for_the_result(self):
        # 8 samples took 8 of the 10 seconds; of 29, 2 are kept for the result, 17 are left: 17 samples, over 2 x 8.
        self.assertEqual(next_slice(Budget(seconds=29), spent(8.0, judging=0.1))[0], 8)
        self.assertAlmostEqual(next_slice(Budget(seconds=20), spent(8.0))[0], 8)
        self.assertAlmostEqual(next_slice(Budget(seconds=15), spent(8.0))[0], 3)
        self.assertEqual(next_slice(Budget(seconds=12), spent(8.0)), (0.0, "the seconds are spent"))

    def test_judging_takes_little_of_a_round(self):
        # A sample takes a second: rounds of 60 samples where judging takes 3 seconds.
        self.assertAlmostEqual(next_slice(Budget(seconds=200), spent(8.0, judging=3))[0], 60)
        self.assertEqual(next_slice(Budget(samples=64), spent(8.0, judging=2))[0], 8)  # not by the clock

    def test_a_quarter_of_the_seconds_is_even(self):
        self.assertAlmostEqual(even_share(Budget(seconds=100), spent(8.0)), 15)  # 10 of the 25 are spent
        self.assertLess(even_share(Budget(seconds=10), spent(8.0)), 0)

    def test_all_is_even_where_no_judgement_would_pay(self):
        # Judging takes 3 seconds, so a round takes 60: after a quarter of 60, which are even, 43 are left.
        self.assertAlmostEqual(even_share(Budget(seconds=60), spent(8.0, judging=3)), 48)
        self.assertAlmostEqual(even_share(Budget(seconds=100), spent(8.0, judging=3)), 15)

    def test_a_round_that_cannot_pay_is_not_judged(self):
        self.assertEqual(nothing_left(Budget(samples=8), spent(8.0)), "the samples are spent")
        self.assertEqual(nothing_left(Budget(samples=9), spent(8.0)), "")
        # 10 seconds are spent and 2 kept: judging takes 3, so a round takes 60.
        self.assertEqual(nothing_left(Budget(seconds=71), spent(8.0, judging=3)), "the seconds are spent")
        self.assertEqual(nothing_left(Budget(seconds=73), spent(8.0, judging=3)), "")
        self.assertEqual(nothing_left(Budget(target=0.2), spent(8.0)), "")

    def test_parts_that_were_rendered_in_one_go_are_not_free(self):
        def part(spp, seconds, masked=False):
            return {"spp": spp, "seconds": seconds, "masked": masked}

        first = [part(8, 30.0), part(8, 0.2)]  # POV-Ray: all samples come with the first part
        self.assertAlmostEqual(seconds_per_even_sample(first), 30.2 / 16)
        self.assertAlmostEqual(seconds_per_even_sample([*first, part(20, 10.0), part(99, 1.0, masked=True)]), 0.5)

    def test_the_rest_is_what_the_seconds_hold(self):
        self.assertAlmostEqual(rest(Budget(seconds=15), spent(8.0)), 3)
        self.assertLess(rest(Budget(seconds=11), spent(8.0)), 0)
        self.assertEqual(rest(Budget(samples=100), spent(8.0)), 0)

    def test_a_target_takes_what_it_needs(self):
        self.assertEqual(next_slice(Budget(target=0.2), spent(8.0))[0], 0)
        # 0.1 (8 / (8 + n))^0.75 = 0.1 * 2^-0.75 at n = 8, and 0.1 / 8 at n = 15 * 8.
        self.assertAlmostEqual(next_slice(Budget(target=0.1 * 2**-0.75), spent(8.0))[0], 8)
        self.assertAlmostEqual(next_slice(Budget(target=0.1 * (8 / 9) ** 0.75), spent(8.0))[0], 1)
        self.assertEqual(next_slice(Budget(target=0.1 / 8), spent(8.0))[0], 8)  # far: one step, then it is judged again


if __name__ == "__main__":
    unittest.main()
