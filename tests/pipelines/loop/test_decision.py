import unittest

import numpy as np

from pipelines.loop import decision
from pipelines.loop.budget import Budget
from pipelines.loop.counts import Taken
from pipelines.loop.journal import HALVES, Part, State


def part(samples, seconds, masked=False, half="a", round_number=0, cost_weighted_samples=None):
    weighted = samples if cost_weighted_samples is None else cost_weighted_samples
    return Part("part.exr", half, round_number, 0, samples, weighted, seconds, masked, sha256="")


class Seconds(unittest.TestCase):
    def test_parts_that_were_rendered_in_one_go_count_together(self):
        first_pass = [part(8, 30.0), part(8, 0.2)]  # POV-Ray renders all samples with the first part.
        self.assertAlmostEqual(decision.seconds_per_uniform_sample(first_pass), 30.2 / 16)

    def test_short_and_masked_parts_do_not_set_the_price_of_a_uniform_sample(self):
        parts = [part(8, 30.0), part(8, 0.2), part(20, 10.0), part(99, 1.0, masked=True)]
        self.assertAlmostEqual(decision.seconds_per_uniform_sample(parts), 0.5)

    def test_masked_samples_are_assumed_dearer_until_measured_and_never_cheaper(self):
        uniform = [part(8, 8.0), part(8, 8.0)]
        self.assertEqual(decision.masked_over_uniform(uniform), decision.MASKED_OVER_UNIFORM)
        dear, cheap = (part(5, seconds, masked=True, cost_weighted_samples=10) for seconds in (15.0, 2.0))
        self.assertAlmostEqual(decision.masked_over_uniform([*uniform, dear]), 1.5)
        self.assertEqual(decision.masked_over_uniform([*uniform, cheap]), 1.0)

    def test_the_result_is_kept_in_reserve(self):
        state = State({}, parts=[part(8, 4.0), part(8, 4.0)])
        spent = decision.what_is_spent(state, 20.0, 3.0, 3.4)
        self.assertAlmostEqual(spent.result_seconds, 3.0 * 3.4)
        self.assertAlmostEqual(spent.seconds_per_sample, 0.5 * decision.MASKED_OVER_UNIFORM)
        self.assertEqual((spent.samples, spent.cost_weighted_samples), (16, 16))


class UniformRounds(unittest.TestCase):
    def test_the_first_pass_is_divided_into_parts_of_two_samples_or_one(self):
        for samples, parts in ((4, 4), (8, 8), (12, 6), (16, 8), (64, 32)):
            self.assertEqual(decision.first_pass_parts(samples, Budget(samples=100)), parts)
            self.assertEqual(decision.first_pass_parts(samples, Budget(seconds=100)), 2)

    def test_counts_can_be_divided_into_the_parts(self):
        first_pass = [part(4, 1.0, half=half) for half in HALVES]
        counts = decision.uniform_counts((2, 3), first_pass, 43)  # 21 for each half, in two parts
        self.assertEqual({half: set(values.flat) for half, values in counts.items()}, {"a": {20}, "b": {20}})
        plan = decision.plan_round(State({}, parts=first_pass, next_sample=8), 1, counts, 40)
        self.assertEqual((plan.parts, plan.first_samples), (2, {"a": 8, "b": 28}))

    def test_parts_that_are_as_long_tell_the_variance_already(self):
        parts = [part(16, 1.0), part(16, 1.0)]
        self.assertEqual(decision.uniform_counts((1, 1), parts, 30)["a"].max(), 15)
        self.assertEqual(decision.uniform_counts((1, 1), parts, 42)["a"].max(), 20)
        self.assertEqual(decision.uniform_counts((1, 1), parts, -5)["a"].max(), 0)

    def test_masked_seconds_buy_more_uniform_samples(self):
        parts = [part(8, 8.0)]
        self.assertAlmostEqual(decision.uniform_samples(Budget(seconds=9), parts, 10), 13)
        self.assertEqual(decision.uniform_samples(Budget(samples=9), parts, 10), 10)


class Plans(unittest.TestCase):
    def test_masked_counts_are_whole_blocks_of_the_sequence(self):
        counts = {"a": np.array([[0, 4], [16, 2]]), "b": np.array([[8, 8], [1, 0]])}
        plan = decision.plan_round(State({}, next_sample=20), 3, counts, 10.0)
        self.assertEqual(plan.first_samples, {"a": 32, "b": 48})
        self.assertEqual((plan.round, plan.parts, plan.parts_before, plan.cost_weighted_samples), (3, 1, 0, 10.0))

    def test_a_half_without_samples_shares_no_number(self):
        counts = {"a": np.array([[0, 0]]), "b": np.array([[0, 2]])}
        plan = decision.plan_round(State({}, next_sample=5), 1, counts, 1.0)
        self.assertEqual(plan.first_samples, {"a": 5, "b": 6})

    def test_a_round_that_is_continued_numbers_its_parts_on(self):
        parts = [part(4, 1.0, half=half, round_number=2) for half in "aabb"]
        counts = dict.fromkeys(HALVES, np.full((1, 2), 3))
        self.assertEqual(decision.plan_round(State({}, parts=parts), 2, counts, 6.0).parts_before, 2)


class Maps(unittest.TestCase):
    def pays(self, noisy_counts, quiet_counts, uniform):
        """The left half of the frame is noisy. Both halves of samples get the same counts."""
        noisy = np.repeat([[1.0, 1e-6]], 48, axis=1) * np.ones((96, 1))
        error_maps = {half: {"relvariance.Y": noisy, "relnoise.Y": noisy} for half in HALVES}
        taken = dict.fromkeys(HALVES, Taken(np.full(noisy.shape, 4.0), None))
        counts = dict.fromkeys(HALVES, np.where(noisy > 0.5, noisy_counts, quiet_counts))
        return decision.map_pays(error_maps, taken, counts, uniform)

    def test_samples_where_the_noise_is_pay(self):
        self.assertTrue(self.pays(16, 0, uniform=16))  # 8 for each half
        self.assertFalse(self.pays(0, 16, uniform=16))

    def test_it_depends_on_how_many_uniform_samples_the_seconds_buy(self):
        self.assertTrue(self.pays(16, 0, uniform=24))
        self.assertFalse(self.pays(16, 0, uniform=40))


if __name__ == "__main__":
    unittest.main()
