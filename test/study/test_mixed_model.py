"""Linear mixed models against R, statsmodels and the analysis of variance of balanced data."""

import unittest

import numpy as np
import pandas
from scipy import stats
import statsmodels.api as statsmodels

import paths  # noqa: F401
from study import mixed_model
from study.anova import mixed_anova
from study.linear import Model


def sum_coded(codes, count):
    return (np.eye(count)[codes] - np.eye(count)[codes][:, -1:])[:, :-1]


def example():
    """12 people in two groups, three objects, two conditions, a tenth missing: values, design, person, condition."""
    random = np.random.RandomState(1)
    n = 12
    person = np.repeat(np.arange(n), 6)
    group = (person < 5).astype(int)
    thing, system = np.tile(np.repeat(np.arange(3), 2), n), np.tile(np.arange(2), 3 * n)
    values = (10 + random.normal(size=n)[person] * 2 + random.normal(size=(n, 2))[person, system] * 1.5
              + random.normal(size=n * 6) + group * 1.0 + system * 0.5)
    kept = random.rand(n * 6) > 0.1
    g, o, c = sum_coded(group, 2), sum_coded(thing, 3), sum_coded(system, 2)
    design = np.column_stack([np.ones(len(values)), g, o, c, g * o, g * c])
    return values[kept], design[kept], person[kept], system[kept], thing[kept]


class AgainstOthers(unittest.TestCase):
    def test_agrees_with_lme4_and_pbkrtest(self):
        """R 4.2.2, lme4 1.1-31, lmerTest with pbkrtest: lmer(y ~ g*obj + g*cond + (1|part) + (1|part:cond)), type III with
        Kenward-Roger. lme4's own optimiser leaves five digits of the variances."""
        values, design, person, system, _ = example()
        model = mixed_model.fit(values, design, person, {'participant': 0 * person, 'with condition': system})
        np.testing.assert_allclose(np.sqrt(model.theta), [2.356156102486, 1.152301798262, 0.918903826031], rtol=1e-4)
        wanted = {(1,): (1.36770, 9.99426321, 0.26934), (2, 3): (0.78476, 34.86934675, 0.46412),
                  (4,): (1.55821, 9.94737839, 0.24051), (5, 6): (0.40850, 34.86934675, 0.66779),
                  (7,): (0.32516, 9.94737839, 0.58117)}
        for columns, (f, df_error, p) in wanted.items():
            test = mixed_model.f_test(model, np.eye(design.shape[1])[list(columns)])
            np.testing.assert_allclose((test.f, test.df_error, test.p), (f, df_error, p), rtol=3e-5)

    def test_agrees_with_nlme_where_objects_scatter_differently(self):
        """R 4.2.2, nlme 3.1-162: lme(y ~ design - 1, random = ~1|person, weights = varIdent(form = ~1|object))."""
        values, design, person, _, thing = example()
        values = values + np.random.RandomState(2).normal(size=len(values)) * np.array([0.0, 1.0, 3.0])[thing]
        model = mixed_model.fit(values, design, person, {'participant': 0 * person}, strata=thing)
        np.testing.assert_allclose(np.sqrt(model.theta), [2.491908, 1.24429829, 2.12253147, 2.60422734], rtol=1e-6)
        np.testing.assert_allclose(np.sqrt(np.diag(model.covariance))[:5],
                                   [0.776477850, 0.776477850, 0.316807374, 0.376426297, 0.232209530], rtol=1e-6)

    def test_agrees_with_statsmodels(self):
        values, design, person, _, _ = example()
        model = mixed_model.fit(values, design, person, {'participant': 0 * person})
        other = statsmodels.MixedLM(values, design, person).fit(reml=True)
        np.testing.assert_allclose(model.beta, other.fe_params, rtol=1e-4, atol=1e-5)
        np.testing.assert_allclose(model.theta, [other.cov_re[0, 0], other.scale], rtol=1e-3)
        np.testing.assert_allclose(np.sqrt(np.diag(model.covariance)), other.bse_fe, rtol=1e-3)

    def test_of_balanced_data_is_the_analysis_of_variance(self):
        """Exactly: F and degrees of freedom, as long as no variance is at 0."""
        random = np.random.RandomState(3)
        table = 10 + 2 * random.normal(size=(10, 1)) + random.normal(size=(10, 3))
        labels = ['a'] * 5 + ['b'] * 5
        cells = pandas.DataFrame([(str(i), labels[i], 'xyz'[j], table[i, j]) for i in range(10) for j in range(3)],
                                 columns=['participant', 'group', 'object', 'value'])
        model = Model(cells, {'group': ['a', 'b'], 'object': list('xyz')}, scatters_alike=True)
        for (_, test), effect in zip(model.effects(), mixed_anova(table, labels).effects):
            np.testing.assert_allclose((test.f, test.df_error), (effect.f, effect.df_error), rtol=1e-7)

    def test_so_it_is_of_four_people_with_two_degrees_of_freedom(self):
        """F has no mean there: what is divided by it is lost in rounding, or is nothing at all."""
        random, tested = np.random.RandomState(1), 0
        for _ in range(20):
            table = 10 + 3 * random.normal(size=(4, 1)) + random.normal(size=(4, 3))
            labels = ['a', 'a', 'b', 'b']
            cells = pandas.DataFrame([(str(i), labels[i], 'xyz'[j], table[i, j]) for i in range(4) for j in range(3)],
                                     columns=['participant', 'group', 'object', 'value'])
            model = Model(cells, {'group': ['a', 'b'], 'object': list('xyz')}, scatters_alike=True)
            if min(model.variances().values()) > 0.1:
                group, of_table = dict(model.effects())[('group',)], mixed_anova(table, labels).effects[0]
                np.testing.assert_allclose((group.f, group.df_error, group.p), (of_table.f, 2, of_table.p), rtol=1e-6)
                tested += 1
        self.assertGreater(tested, 10)


class Behaviour(unittest.TestCase):
    def cells(self, n=8, seed=1, effect=0.0):
        random = np.random.RandomState(seed)
        rows = [('P%d' % i, 'ab'[i % 2], thing, np.exp(3 + effect * (i % 2) + 0.3 * person + 0.2 * random.normal()))
                for i, person in enumerate(random.normal(size=n)) for thing in 'xyz']
        return pandas.DataFrame(rows, columns=['participant', 'group', 'object', 'value'])

    def model(self, cells, **options):
        return Model(cells, {'group': ['a', 'b'], 'object': ['x', 'y', 'z']}, **options)

    def test_a_missing_trial_costs_no_participant(self):
        """Every participant lacks one object: no analysis of variance could be made of any."""
        cells = self.cells(12, effect=2.0)
        left = cells[[j != i // 3 % 3 for i, j in enumerate(np.tile(range(3), 12))]]
        self.assertTrue((left.groupby('participant').size() == 2).all())
        tests = dict(self.model(left, logarithm=True).effects())
        self.assertLess(tests[('group',)].p, 0.01)
        self.assertGreater(tests[('group',)].df_error, 8)

    def test_a_cell_that_nobody_has_costs_the_interaction_and_no_more(self):
        cells = self.cells()
        left = cells[(cells['group'] == 'a') | (cells['object'] != 'z')]
        model = self.model(left)
        self.assertEqual([names for names, _ in model.effects()], [('group',), ('object',)])
        self.assertIsNone(model.difference({'group': 'a', 'object': 'z'}, {'group': 'b', 'object': 'z'}))

    def test_differences_of_logarithms_are_ratios_of_times(self):
        cells = self.cells(40, effect=np.log(1.5))
        model = self.model(cells, logarithm=True, scatters_alike=True)
        of = cells.assign(value=np.log(cells['value'])).groupby(['group', 'participant'])['value'].mean()
        difference = model.difference({'group': 'b'}, {'group': 'a'})
        self.assertAlmostEqual(difference.estimate, of['b'].mean() - of['a'].mean(), places=9)
        pooled = np.sqrt((of['a'].var() + of['b'].var()) / 20)  # of balanced data the interval is that of a t-test
        self.assertAlmostEqual(difference.high - difference.estimate, stats.t.ppf(0.975, 38) * pooled, places=6)

    def test_participants_who_do_not_differ_leave_the_residual_alone(self):
        random = np.random.RandomState(5)
        model = mixed_model.fit(random.normal(size=30) - np.repeat(0.0, 30), np.ones((30, 1)),
                                np.tile(range(10), 3), {'participant': np.zeros(30)})
        self.assertTrue((model.theta >= 0).all())
        self.assertTrue(np.isfinite(mixed_model.f_test(model, [[1.0]]).p))

    def test_order_is_adjusted_for_where_it_can_be_told_from_the_objects(self):
        cells = self.cells()
        cells['order'] = np.tile([1, 2, 3], 8)
        self.assertEqual(self.model(cells, covariates=['order']).covariates, [])
        cells['order'] = np.random.RandomState(1).permutation(cells['order'])
        self.assertEqual(self.model(cells, covariates=['order']).covariates, ['order'])

    def test_an_object_at_which_people_scatter_gives_no_star_for_the_groups_there(self):
        """Scatter of 0.1, 0.2 and 0.5 by object and no effect: with one residual variance for all objects 14 % of
        studies have p < 0.05 for the groups at the third; of 300 more than 26 are less likely than 1 in 1000 at 5 %."""
        found = {True: 0, False: 0}
        for seed in range(300):
            random = np.random.RandomState(seed)
            rows = [('P%d' % i, 'ab'[i % 2], thing, 0.25 * person + scatter * random.normal())
                    for i, person in enumerate(random.normal(size=16)) for thing, scatter in zip('xyz', (0.1, 0.2, 0.5))]
            cells = pandas.DataFrame(rows, columns=['participant', 'group', 'object', 'value'])
            for alike in found:
                difference = self.model(cells, scatters_alike=alike).difference({'group': 'a', 'object': 'z'},
                                                                                {'group': 'b', 'object': 'z'})
                found[alike] += difference.p < 0.05
        self.assertLessEqual(found[False], stats.binom.isf(0.001, 300, 0.05))
        self.assertGreater(found[True], stats.binom.isf(0.001, 300, 0.05))

    def test_one_value_for_each_effect_is_too_few(self):
        with self.assertRaisesRegex(ValueError, 'too few values'):
            mixed_model.fit([1.0, 2.0], np.eye(2), [0, 1], {})


if __name__ == '__main__':
    unittest.main()
