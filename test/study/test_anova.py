"""The analysis of variance against published results, against statsmodels and scipy, and on many seeded studies."""

import unittest

import numpy as np
from scipy import stats

import paths  # noqa: F401
import worked_examples as examples
from study.anova import mixed_anova


def effects_of(values, groups):
    result = mixed_anova(values, groups)
    return {effect.name: effect for effect in result.effects}, result.sphericity


class PublishedResults(unittest.TestCase):
    """Tolerances are half a unit of the last digit printed."""

    def test_one_group_that_violates_sphericity(self):
        effects, sphericity = effects_of(examples.BUSHTUCKER, ['all'] * 8)
        within = effects['within']
        self.assertAlmostEqual(within.f, 3.79, delta=0.005)
        self.assertEqual((within.df, within.df_error), (3, 21))
        self.assertAlmostEqual(within.p_uncorrected, 0.026, delta=0.0005)
        self.assertAlmostEqual(sphericity.w, 0.136, delta=0.0005)
        self.assertAlmostEqual(sphericity.chi_squared, 11.41, delta=0.005)
        self.assertEqual(sphericity.df, 5)
        self.assertAlmostEqual(sphericity.p, 0.047, delta=0.0005)
        self.assertAlmostEqual(sphericity.greenhouse_geisser, 0.533, delta=0.0005)
        self.assertAlmostEqual(sphericity.huynh_feldt, 0.666, delta=0.0005)
        self.assertAlmostEqual(within.p_greenhouse_geisser, 0.063, delta=0.0005)
        self.assertAlmostEqual(within.p_huynh_feldt, 0.048, delta=0.0005)
        self.assertEqual((within.correction, within.p), ('Greenhouse-Geisser', within.p_greenhouse_geisser))

    def test_one_group_that_does_not(self):
        effects, sphericity = effects_of(examples.MIGRAINE, ['all'] * 9)
        within = effects['within']
        self.assertAlmostEqual(within.ss, 2449.20, delta=0.005)
        self.assertAlmostEqual(within.ss_error, 230.40, delta=0.005)
        self.assertAlmostEqual(within.f, 85.04, delta=0.005)
        # From SPSS's output for these data.
        self.assertAlmostEqual(sphericity.w, 0.282, delta=0.0005)
        self.assertAlmostEqual(sphericity.chi_squared, 8.114, delta=0.0005)
        self.assertAlmostEqual(sphericity.p, 0.537, delta=0.0005)
        self.assertAlmostEqual(sphericity.greenhouse_geisser, 0.684, delta=0.0005)
        self.assertEqual(sphericity.huynh_feldt, 1.0)
        self.assertEqual((within.correction, within.p), ('none', within.p_uncorrected))

    def test_three_groups_and_six_levels(self):
        effects, sphericity = effects_of(examples.KING, examples.KING_GROUPS)
        printed = {'group': (285815.04, 2, 384722.06, 21, 7.80), 'within': (399736.56, 5, 281199.31, 105, 29.85),
                   'interaction': (80819.96, 10, 281199.31, 105, 3.02)}
        for name, (ss, df, ss_error, df_error, f) in printed.items():
            with self.subTest(name):
                self.assertAlmostEqual(effects[name].ss, ss, delta=0.01)
                self.assertAlmostEqual(effects[name].ss_error, ss_error, delta=0.01)
                self.assertEqual((effects[name].df, effects[name].df_error), (df, df_error))
                self.assertAlmostEqual(effects[name].f, f, delta=0.005)
                self.assertAlmostEqual(effects[name].partial_eta_squared, ss / (ss + ss_error), delta=1e-6)
        self.assertAlmostEqual(sphericity.greenhouse_geisser, 0.6569, delta=0.00005)


class AgreesWithOthers(unittest.TestCase):
    def setUp(self):
        self.random = np.random.RandomState(11)

    def test_with_statsmodels_where_all_are_in_one_group(self):
        try:
            import pandas
            from statsmodels.stats.anova import AnovaRM
        except ImportError as error:
            self.skipTest('%s (Debian: python3-statsmodels)' % error)
        values = self.random.normal(size=(9, 4)) + [0.0, 0.3, 0.1, 0.9]
        rows = [(i, j, values[i, j]) for i in range(9) for j in range(4)]
        table = AnovaRM(pandas.DataFrame(rows, columns=['who', 'level', 'y']), 'y', 'who', ['level']).fit().anova_table
        within = effects_of(values, [0] * 9)[0]['within']
        self.assertAlmostEqual(within.f, table['F Value'].iloc[0], places=9)
        self.assertAlmostEqual(within.p_uncorrected, table['Pr > F'].iloc[0], places=9)

    def test_with_scipy_where_there_is_one_level(self):
        values, groups = self.random.normal(size=(13, 1)), np.repeat(['a', 'b', 'c'], [5, 2, 6])
        effects, sphericity = effects_of(values, groups)
        f, p = stats.f_oneway(*[values[groups == name, 0] for name in 'abc'])
        self.assertAlmostEqual(effects['group'].f, f, places=9)
        self.assertAlmostEqual(effects['group'].p, p, places=9)
        self.assertEqual((list(effects), sphericity), (['group'], None))

    def test_with_regressions_where_groups_differ_in_size(self):
        """Type III by leaving one term out of a regression with a constant for each participant."""
        groups, levels = np.repeat([0, 1, 2], [3, 7, 5]), 4
        values = self.random.normal(size=(15, levels)) + 0.5 * groups[:, None] * np.arange(levels)
        sums = np.vstack([np.eye(levels - 1), -np.ones(levels - 1)])  # effects that sum to 0
        of_group = np.vstack([np.eye(2), -np.ones(2)])[groups]
        who = np.kron(np.eye(15), np.ones((levels, 1)))
        level = np.kron(np.ones((15, 1)), sums)
        both = np.kron(of_group, sums)

        def residual(*terms):
            design = np.hstack(terms)
            return np.sum((values.ravel() - design @ np.linalg.lstsq(design, values.ravel(), rcond=None)[0]) ** 2)

        full, effects = residual(who, level, both), effects_of(values, groups)[0]
        self.assertAlmostEqual(effects['within'].ss, residual(who, both) - full, places=8)
        self.assertAlmostEqual(effects['interaction'].ss, residual(who, level) - full, places=8)
        self.assertAlmostEqual(effects['interaction'].ss_error, full, places=8)

    def test_two_levels_are_a_paired_t_test_and_two_groups_a_t_test(self):
        values = self.random.normal(size=(12, 2))
        within = effects_of(values, [0] * 12)[0]['within']
        t, p = stats.ttest_rel(values[:, 0], values[:, 1])
        self.assertAlmostEqual(within.f, t ** 2, places=9)
        self.assertAlmostEqual(within.p, p, places=9)
        group = effects_of(values, [0] * 5 + [1] * 7)[0]['group']
        t, p = stats.ttest_ind(values[:5].mean(axis=1), values[5:].mean(axis=1))
        self.assertAlmostEqual(group.f, t ** 2, places=9)
        self.assertAlmostEqual(group.p, p, places=9)

    def test_huynh_feldt_is_the_ratio_of_unbiased_estimates(self):
        """For S with f degrees of freedom, E tr(S)^2 = tr^2 + 2 q / f and E tr(S^2) = q (f + 1) / f + tr^2 / f, where
        tr and q are the traces of the true matrix and of its square; solved for tr^2 and q."""
        groups = np.asarray(examples.KING_GROUPS)
        centred = np.vstack([examples.KING[groups == g] - examples.KING[groups == g].mean(axis=0)
                             for g in ('control', 'same', 'different')])
        rotated = centred @ np.linalg.svd(np.eye(6) - 1 / 6)[0][:, :5]
        f, s = 21, rotated.T @ rotated / 21
        from_s = np.linalg.solve([[1.0, 2 / f], [1 / f, (f + 1) / f]], [np.trace(s) ** 2, np.trace(s @ s)])
        self.assertAlmostEqual(effects_of(examples.KING, groups)[1].huynh_feldt, from_s[0] / (5 * from_s[1]), places=9)


class ManyStudies(unittest.TestCase):
    """Rates of significant results among seeded studies; the bounds hold for 999 of 1000 such counts."""
    STUDIES = 500

    def rates(self, mixing, effect, field='p', sizes=(15, 15)):
        random, groups = np.random.RandomState(20), np.repeat(range(len(sizes)), sizes)
        counts = dict.fromkeys(('group', 'within', 'interaction'), 0)
        for _ in range(self.STUDIES):
            noise = random.normal(size=(len(groups), len(mixing))) @ mixing
            person = random.normal(size=(len(groups), 1))
            for one in mixed_anova(noise + person + effect[groups], groups).effects:
                counts[one.name] += getattr(one, field) < 0.05
        return counts

    def assert_count(self, count, chance):
        low, high = stats.binom.interval(0.999, self.STUDIES, chance)
        self.assertTrue(low <= count <= high, '%d is not within %d..%d' % (count, low, high))

    def test_without_an_effect_one_in_twenty_is_significant(self):
        for name, count in self.rates(np.eye(3), np.zeros((2, 3)), sizes=(15, 15)).items():
            with self.subTest(name):
                self.assert_count(count, 0.05)

    def test_also_with_small_groups_of_different_sizes(self):
        for name, count in self.rates(np.eye(3), np.zeros((2, 3)), sizes=(4, 9)).items():
            with self.subTest(name):
                self.assert_count(count, 0.05)

    def test_correction_keeps_the_rate_where_sphericity_is_violated(self):
        uneven = np.diag([0.2, 0.2, 0.2, 3.0])
        without = self.rates(uneven, np.zeros((2, 4)), 'p_uncorrected')
        corrected = self.rates(uneven, np.zeros((2, 4)), 'p')
        for name in ('within', 'interaction'):
            with self.subTest(name):
                self.assertGreater(without[name], stats.binom.interval(0.999, self.STUDIES, 0.05)[1])
                self.assert_count(corrected[name], 0.05)

    def test_an_effect_is_found_as_often_as_theory_says(self):
        """Chances from the noncentral F distribution, for spherical data."""
        effect = np.array([[0.0, 0.0, 0.0], [0.9, 0.0, 0.6]])
        alike, interaction = effect.mean(axis=0) - effect.mean(), effect - effect.mean(axis=0)
        interaction = interaction - interaction.mean(axis=1, keepdims=True)
        of_group = effect.mean(axis=1) - effect.mean()
        counts = self.rates(np.eye(3), effect)
        of_means = 1 + 1 / 3  # variance of a participant's mean: the person's and a third of the noise's
        expected = {'group': (1, 28, 15 * np.sum(of_group ** 2) / of_means),
                    'within': (2, 56, 30 * np.sum(alike ** 2)),
                    'interaction': (2, 56, 15 * np.sum(interaction ** 2))}
        for name, (df, df_error, noncentrality) in expected.items():
            chance = stats.ncf.sf(stats.f.isf(0.05, df, df_error), df, df_error, noncentrality)
            with self.subTest(name, chance=chance):
                self.assertGreater(chance, 0.2)
                self.assert_count(counts[name], chance)


class Limits(unittest.TestCase):
    def test_participants_that_all_answer_alike_give_no_result(self):
        for effect in mixed_anova(np.full((6, 3), 0.1), [0, 0, 0, 1, 1, 1]).effects:
            self.assertTrue(np.isnan(effect.p) and np.isnan(effect.f))

    def test_too_few_for_mauchlys_test_are_corrected(self):
        effects, sphericity = effects_of([[1, 2, 4, 3], [2, 5, 5, 1], [1, 3, 6, 6]], ['all'] * 3)
        self.assertTrue(np.isnan(sphericity.p))
        self.assertEqual(effects['within'].correction, 'Greenhouse-Geisser')

    def test_no_error_to_compare_with_is_refused(self):
        with self.assertRaisesRegex(ValueError, 'no group has two participants'):
            mixed_anova([[1, 2], [3, 4]], ['a', 'b'])

    def test_missing_values_are_refused(self):
        with self.assertRaisesRegex(ValueError, 'full table'):
            mixed_anova([[1, np.nan], [3, 4], [5, 6]], ['a', 'a', 'a'])

    def test_results_do_not_depend_on_the_unit_or_the_order_of_levels(self):
        one = mixed_anova(examples.KING, examples.KING_GROUPS)
        other = mixed_anova(1e-6 * examples.KING[:, ::-1] + 0.5, examples.KING_GROUPS)
        for a, b in zip(one.effects, other.effects):
            self.assertAlmostEqual(a.p / b.p, 1.0, places=6)
        self.assertAlmostEqual(one.sphericity.w, other.sphericity.w, places=6)


if __name__ == '__main__':
    unittest.main()
