"""Exact and permutation tests against what can be counted by hand, and how often all tests find what is not there."""

import collections
import itertools
import unittest

import numpy as np
from scipy import stats

import paths
import forked
from study import calibration, exact, pairwise, permutation

FEW = 40  # studies of each design
SUSPICIOUS = 1e-4  # of the binomial distribution of false positives: 100 tests are made


class Permutations(unittest.TestCase):
    def test_three_against_three_all_apart(self):
        """Two of the 20 ways to choose three are as extreme."""
        self.assertEqual(permutation.groups([4, 5, 6], [1, 2, 3]), 2 / 20)

    def test_drops_in_all_of_four_and_in_none_of_26(self):
        """One of the 27405 ways to choose four."""
        self.assertEqual(permutation.groups([1] * 4, [0] * 26), 1 / 27405)

    def test_pairs_are_sign_flips(self):
        self.assertEqual(permutation.pairs([2, 2, 2, 2], [1, 1, 1, 1]), 2 / 16)
        self.assertEqual(permutation.pairs([1, 2], [1, 2]), 1.0)

    def test_random_arrangements_agree_with_all(self):
        random = np.random.RandomState(2)
        a, b = random.poisson(1.0, 6), random.poisson(2.5, 7)
        whole = permutation.groups(a, b)
        most, permutation.MOST_EXACT = permutation.MOST_EXACT, 0
        try:
            drawn = permutation.groups(a, b)
        finally:
            permutation.MOST_EXACT = most
        self.assertLess(abs(drawn - whole), 4 * np.sqrt(whole * (1 - whole) / permutation.DRAWN))

    def test_levels_by_hand(self):
        """Three participants, two levels: of the eight ways two are as extreme."""
        p = permutation.levels([[1, 0], [1, 0], [1, 0]])
        self.assertLess(abs(p - 2 / 8), 4 * np.sqrt(0.25 * 0.75 / permutation.DRAWN))

    def test_missing_values_stay_where_they_are(self):
        table = np.array([[1, np.nan, 0], [2, 1, np.nan], [3, 1, 0], [2, 2, 1]])
        for p in (permutation.levels(table), permutation.several_groups(table, list('aabb'), True),
                  permutation.several_groups(table, list('aabb'), False)):
            self.assertTrue(0 < p <= 1)

    def test_the_interval_of_a_ratio_holds_it_in_95_of_100(self):
        """Of 30 participants a little less often, as bootstrapped percentiles are: 88 to 99 of 100 are let pass."""
        held = 0
        for seed in range(100):
            random = np.random.RandomState(seed)
            rates = random.gamma(2.0, 1.0, 30)
            _, _, low, high = permutation.effect_of_pairs(random.poisson(2 * rates), random.poisson(rates))
            held += low <= 2.0 <= high
        self.assertTrue(88 <= held <= 99, held)

    def test_the_effect_beside_none_is_a_difference(self):
        name, difference, low, high = permutation.effect_of_groups([1, 3], [0, 0])
        self.assertEqual((name, difference, low, high), ('difference', 2.0, 1.0, 3.0))


class Exact(unittest.TestCase):
    def test_ranks_with_ties_by_going_through_all(self):
        random = np.random.RandomState(4)
        for _ in range(20):
            a, b = random.randint(0, 5, 4), random.randint(0, 5, 6)
            ranks = stats.rankdata(np.concatenate([a, b]))
            sums = np.array([sum(some) for some in itertools.combinations(ranks, 4)])
            wanted = np.mean(np.abs(sums - sums.mean()) >= abs(ranks[:4].sum() - sums.mean()) - 1e-9)
            self.assertAlmostEqual(exact.rank_sum_p(ranks, 4), wanted, places=12)

    def test_ranks_without_ties_are_those_of_the_tables(self):
        random = np.random.RandomState(5)
        values = random.permutation(17)
        wanted = stats.mannwhitneyu(values[:8], values[8:], alternative='two-sided', **(
            {'method': 'exact'} if hasattr(stats, 'binomtest') else {})).pvalue
        if hasattr(stats, 'binomtest'):
            self.assertAlmostEqual(pairwise.rank_sum(values[:8], values[8:]).p, wanted, places=12)

    def test_three_against_three_give_no_star(self):
        """The normal approximation gives 0.0469 here; there are 20 ways, and two are as extreme."""
        self.assertEqual(pairwise.rank_sum([9, 9, 9], [5, 5, 6]).p, 0.1)

    def test_all_of_one_group_and_none_of_the_other(self):
        had = exact.share([True] * 4), exact.share([False] * 26)
        self.assertAlmostEqual(exact.fisher([True] * 4, [False] * 26), 1 / 27405, places=12)
        self.assertAlmostEqual(had[0].low, 0.025 ** (1 / 4))
        self.assertAlmostEqual(had[1].high, 1 - 0.025 ** (1 / 26))

    def test_mcnemar_counts_those_who_differ(self):
        a, b = [True] * 6 + [False] * 4, [False] * 5 + [True] + [False] * 4
        self.assertAlmostEqual(exact.mcnemar(a, b), 2 / 32)
        self.assertEqual(exact.mcnemar([True], [True]), 1.0)


class Calibration(unittest.TestCase):
    """The quick version of scripts/calibrate_study."""

    @classmethod
    def setUpClass(cls):
        cls.rows = calibration.table(('3v20', '8v22'), FEW, 7)

    def test_no_test_that_gives_stars_finds_more_than_5_percent(self):
        most = stats.binom.isf(SUSPICIOUS, FEW, calibration.ALPHA)
        shown_to_be_wrong = ('classical', 'one residual', 'mixed model without')
        for row in self.rows:
            if not row['test'].startswith(shown_to_be_wrong) and row['drops'] != 'by group':
                self.assertLessEqual(row['significant'], most, row)

    def test_the_tests_are_not_empty(self):
        """Of exact tests rare drops leave fewer; of the others each finds some in all mechanisms together."""
        found = collections.Counter()
        for row in self.rows:
            if row['test'] in ('mixed model: group', 'mixed model: condition', 'permutation: group'):
                self.assertEqual(row['tested'], FEW, row)
                found[row['design'], row['test']] += row['significant']
        self.assertEqual(len(found), 6)
        self.assertGreater(min(found.values()), 0, found)

    def test_welch_on_frequent_drops_shows_why(self):
        found = [row['percent'] for row in self.rows if row['design'] == '3v20' and row['drops'] == 'frequent'
                 and row['test'] == "classical: Welch's t, stars for groups at objects"]
        self.assertGreater(found[0], 10)

    def test_the_program_writes_a_table(self):
        done = forked.run(paths.script('calibrate_study'), '--studies', '2', '--design', '2v3')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('| times, retries | mixed model: group |', done.stdout)
        done = forked.run(paths.script('calibrate_study'), '--design', '1v3')
        self.assertEqual((done.returncode, done.stderr.count('\n')), (1, 1))


if __name__ == '__main__':
    unittest.main()
