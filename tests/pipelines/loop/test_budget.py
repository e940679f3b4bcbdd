import unittest

from pipelines.loop.budget import (
    Budget,
    Spent,
    reason_to_stop,
    samples_left,
    samples_of_next_round,
    uniform_share,
)


def spent(samples, error=0.1, decision_seconds=0.5):
    """10 seconds are spent, a sample takes 1 second, and the result needs 2 more."""
    return Spent(samples, samples, 10.0, 1.0, decision_seconds, 2.0, error)


class Budgets(unittest.TestCase):
    def test_samples_double_and_the_last_round_takes_the_rest(self):
        done = []
        n = 8.0
        while extra := samples_of_next_round(Budget(samples=64), spent(n))[0]:
            done.append(extra)
            n += extra
        self.assertEqual(done, [8, 16, 32])
        # 16 samples are left: less than two rounds of 8 and more, so the round takes all of them.
        self.assertEqual(samples_of_next_round(Budget(samples=24), spent(8.0))[0], 16)
        self.assertEqual(samples_of_next_round(Budget(samples=8), spent(8.0)), (0.0, "the samples are spent"))

    def test_case31_seconds_leave_room_for_the_result(self):
        # 10 of 29 seconds are spent and 2 are kept for the result: 17 samples are left, more than two rounds of 8.
        self.assertEqual(samples_of_next_round(Budget(seconds=29), spent(8.0, decision_seconds=0.1))[0], 8)
        self.assertAlmostEqual(samples_of_next_round(Budget(seconds=20), spent(8.0))[0], 8)
        self.assertAlmostEqual(samples_of_next_round(Budget(seconds=15), spent(8.0))[0], 3)
        self.assertEqual(samples_of_next_round(Budget(seconds=12), spent(8.0)), (0.0, "the seconds are spent"))

    def test_a_decision_takes_a_small_share_of_a_round(self):
        # A decision takes 3 seconds, at most 5 % of its round: 60 seconds, and a sample takes 1.
        self.assertAlmostEqual(samples_of_next_round(Budget(seconds=200), spent(8.0, decision_seconds=3))[0], 60)
        # A budget of samples does not depend on the clock.
        self.assertEqual(samples_of_next_round(Budget(samples=64), spent(8.0, decision_seconds=2))[0], 8)

    def test_several_steps_at_once(self):
        self.assertEqual(samples_of_next_round(Budget(samples=100), spent(8.0), steps=3)[0], 24)
        self.assertEqual(samples_of_next_round(Budget(samples=50), spent(8.0), steps=3)[0], 42)

    def test_a_quarter_of_the_seconds_is_uniform(self):
        self.assertAlmostEqual(uniform_share(Budget(seconds=100), spent(8.0)), 15)  # 10 of the 25 are spent.
        self.assertLess(uniform_share(Budget(seconds=10), spent(8.0)), 0)

    def test_all_is_uniform_where_no_decision_would_pay(self):
        # A decision takes 3 seconds, so a round takes 60: after a quarter of 60 seconds, only 43 are left.
        self.assertAlmostEqual(uniform_share(Budget(seconds=60), spent(8.0, decision_seconds=3)), 48)
        self.assertAlmostEqual(uniform_share(Budget(seconds=100), spent(8.0, decision_seconds=3)), 15)

    def test_a_round_that_cannot_pay_is_not_decided(self):
        self.assertEqual(reason_to_stop(Budget(samples=8), spent(8.0)), "the samples are spent")
        self.assertEqual(reason_to_stop(Budget(samples=9), spent(8.0)), "")
        # A decision takes 3 seconds, so a round takes 60, after 10 that are spent and 2 for the result.
        self.assertEqual(reason_to_stop(Budget(seconds=71), spent(8.0, decision_seconds=3)), "the seconds are spent")
        self.assertEqual(reason_to_stop(Budget(seconds=73), spent(8.0, decision_seconds=3)), "")
        self.assertEqual(reason_to_stop(Budget(target=0.2), spent(8.0)), "")

    def test_samples_for_the_seconds_that_are_left(self):
        self.assertAlmostEqual(samples_left(Budget(seconds=15), spent(8.0)), 3)
        self.assertLess(samples_left(Budget(seconds=11), spent(8.0)), 0)
        self.assertEqual(samples_left(Budget(samples=100), spent(8.0)), 0)

    def test_a_target_takes_what_it_needs(self):
        self.assertEqual(samples_of_next_round(Budget(target=0.2), spent(8.0))[0], 0)
        # The error after n more samples is 0.1 (8 / (8 + n))^0.75.
        self.assertAlmostEqual(samples_of_next_round(Budget(target=0.1 * 2**-0.75), spent(8.0))[0], 8)
        self.assertAlmostEqual(samples_of_next_round(Budget(target=0.1 * (8 / 9) ** 0.75), spent(8.0))[0], 1)
        # 120 more are needed. One step is taken, and then it is decided again.
        self.assertEqual(samples_of_next_round(Budget(target=0.1 / 8), spent(8.0))[0], 8)


if __name__ == "__main__":
    unittest.main()
