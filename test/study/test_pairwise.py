"""Comparisons of two samples against published results, and the family's error rate."""

import itertools
import unittest

import numpy as np
from scipy import stats

import paths  # noqa: F401
import worked_examples as examples
from study import pairwise


class PublishedResults(unittest.TestCase):
    def test_paired_t_test_of_students_sleep_data(self):
        """t = -4.0621, df = 9, p = 0.002833; mean difference -1.58."""
        result = pairwise.paired(examples.SLEEP_FIRST, examples.SLEEP_SECOND)
        self.assertAlmostEqual(result.statistic, -4.0621, delta=0.00005)
        self.assertAlmostEqual(result.p, 0.002833, delta=0.0000005)
        self.assertEqual((result.df, result.n_a, round(result.difference, 9)), (9, 10, -1.58))
        self.assertAlmostEqual(result.effect, -4.0621 / np.sqrt(10), delta=0.00005)

    def test_welchs_t_test_of_the_same(self):
        """t = -1.8608, df = 17.776, p = 0.07939 (R's t.test); d = -1.58 / 1.8986, pooled by hand from the
        variances 3.200556 and 4.009000."""
        result = pairwise.independent(examples.SLEEP_FIRST, examples.SLEEP_SECOND)
        self.assertAlmostEqual(result.statistic, -1.8608, delta=0.00005)
        self.assertAlmostEqual(result.df, 17.776, delta=0.0005)
        self.assertAlmostEqual(result.p, 0.07939, delta=0.000005)
        self.assertAlmostEqual(result.effect, -1.58 / np.sqrt((3.200556 + 4.009) / 2), delta=0.00005)

    def test_signed_rank_test_of_the_depression_scale(self):
        """V = 40 of 45, two-sided p = 0.0390625."""
        result = pairwise.signed_rank(examples.DEPRESSION_BEFORE, examples.DEPRESSION_AFTER)
        self.assertAlmostEqual(result.p, 0.0390625, places=12)
        self.assertEqual(result.statistic, 45 - 40)
        self.assertAlmostEqual(result.effect, (40 - 5) / 45)

    def test_rank_sum_test(self):
        """Hollander and Wolfe (1973), page 69: permeability at term and at 12 to 26 weeks; W = 35, two-sided
        p = 0.2544 (R's wilcox.test)."""
        result = pairwise.rank_sum([0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46],
                                   [1.15, 0.88, 0.90, 0.74, 1.21])
        self.assertEqual(result.statistic, 35)
        self.assertAlmostEqual(result.p, 0.2544, delta=0.02)  # older scipy approximates
        self.assertAlmostEqual(result.effect, 2 * 35 / 50 - 1)


class SignedRank(unittest.TestCase):
    def test_p_with_ties_is_that_of_all_sign_patterns(self):
        a, b = np.array([7, 8, 6, 9, 5, 7, 10]), np.array([5, 6, 7, 6, 5, 8, 6])
        differences = (a - b)[a != b]
        ranks = stats.rankdata(np.abs(differences))
        observed = min(ranks[differences > 0].sum(), ranks[differences < 0].sum())
        sums = [sum(itertools.compress(ranks, signs)) for signs in itertools.product([0, 1], repeat=len(ranks))]
        expected = min(1.0, 2 * np.mean([s <= observed for s in sums]))
        self.assertAlmostEqual(pairwise.signed_rank(a, b).p, expected, places=12)

    def test_no_difference_at_all_is_no_evidence(self):
        self.assertEqual(pairwise.signed_rank([4, 5, 6], [4, 5, 6]).p, 1.0)


class Family(unittest.TestCase):
    def test_bonferroni_multiplies_by_the_comparisons_made(self):
        np.testing.assert_allclose(pairwise.bonferroni([0.01, 0.04, 0.5]), [0.03, 0.12, 1.0])
        np.testing.assert_allclose(pairwise.bonferroni([0.01, np.nan]), [0.01, np.nan])

    def test_among_studies_without_an_effect_at_most_one_in_twenty_has_a_significant_pair(self):
        random, studies, false_alarms = np.random.RandomState(5), 1000, 0
        for _ in range(studies):
            samples = random.normal(size=(3, 15))
            p = [pairwise.independent(a, b).p for a, b in itertools.combinations(samples, 2)]
            false_alarms += min(pairwise.bonferroni(p)) < 0.05
        self.assertLessEqual(false_alarms, stats.binom.ppf(0.999, studies, 0.05))
        self.assertGreater(false_alarms, stats.binom.ppf(0.001, studies, 0.02))  # nor is it far too careful

    def test_stars(self):
        self.assertEqual([pairwise.stars(p) for p in (0.05, 0.049, 0.0099, 0.0009, np.nan)],
                         ['', '*', '**', '***', ''])


class TinySamples(unittest.TestCase):
    def test_have_no_p_value_and_do_not_fail(self):
        for result in (pairwise.independent([1.0], [2.0, 3.0]), pairwise.paired([1.0], [2.0]),
                       pairwise.paired([1, 2, 3], [2, 3, 4]), pairwise.independent([], [1.0, 2.0]),
                       pairwise.signed_rank([], []), pairwise.rank_sum([], [1.0])):
            self.assertTrue(np.isnan(result.p) and np.isnan(result.effect), result)


if __name__ == '__main__':
    unittest.main()
