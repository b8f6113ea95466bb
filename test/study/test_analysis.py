"""From sessions to tables: the right numbers go into the right tests, and what is left out is said."""

import os
import tempfile
import unittest

import numpy as np
from scipy import stats

import paths  # noqa: F401
import made_up_study
import worked_examples as examples
from study import analysis, session_folder, study_data

KING_GROUPS = {'control': 'beginner', 'same': 'veteran'}


class Studies(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.root = holder.name

    def study(self, *arguments, **options):
        made_up_study.write_study(self.root, *arguments, measures=('attempts', 'completion_time'), **options)
        return self.analyse()

    def analyse(self):
        folders = session_folder.find_sessions([self.root])
        self.data = study_data.gather([session_folder.read_session(folder) for folder in folders])
        return analysis.analyse(self.data)

    def rewrite(self, participant, change, condition='implicit'):
        """Lets `change` alter the rows of a session's trials.csv."""
        path = os.path.join(self.root, '%s_%s' % (participant, condition), 'trials.csv')
        rows = session_folder.read_table(path, session_folder.TRIALS, [])
        rows = [{key: '' if value is None else value for key, value in row.items()} for row in rows]
        made_up_study.write_table(path, list(session_folder.TRIALS), change(rows))

    def select(self, table, **equal):
        for column, value in equal.items():
            table = table[table[column] == value]
        return table

    def effects(self, results, measure='completion_time', condition='implicit'):
        return self.select(results.anova, measure=measure, condition=condition).set_index('effect')


class Numbers(Studies):
    def test_published_example_through_files(self):
        """Two of the three groups of King's rats: the effect of group is that of a one-way analysis of their means."""
        for i, (values, group) in enumerate(zip(examples.KING, examples.KING_GROUPS)):
            if group in KING_GROUPS:
                made_up_study.write_session(os.path.join(self.root, str(i)), 'R%02d' % i, KING_GROUPS[group], trials=[
                    {'object': 'interval %d' % j, 'completion_time': value} for j, value in enumerate(values)])
        results = self.analyse()
        some = examples.KING[:16].mean(axis=1)
        by_hand = stats.f_oneway(some[:8], some[8:])
        group = self.effects(results).loc['group']
        self.assertAlmostEqual(group.f, by_hand.statistic, places=9)
        self.assertEqual((group.df, group.df_error, group.n), (1, 14, 16))
        self.assertEqual(list(self.effects(results).index), ['group', 'object', 'group x object'])
        bars = self.select(results.bars, measure='completion_time', object='interval 0', group='beginner')
        self.assertAlmostEqual(bars['mean'].iloc[0], examples.KING[:8, 0].mean())
        self.assertAlmostEqual(bars['sd'].iloc[0], examples.KING[:8, 0].std(ddof=1))
        half = stats.t.interval(0.95, 7, 0, stats.sem(examples.KING[:8, 0]))[1]
        self.assertAlmostEqual(bars['ci95'].iloc[0], half)

    def test_repetitions_are_averaged_before_participants_are(self):
        for who, times in (('P01', (10, 20, 30)), ('P02', (50,))):
            made_up_study.write_session(os.path.join(self.root, who), who,
                                        trials=[{'completion_time': time} for time in times])
        results = self.analyse()
        row = self.select(results.comparison, quantity='completion_time').iloc[0]
        self.assertEqual((row['n'], row['mean']), (2, (20 + 50) / 2))

    def test_conditions_are_compared_within_participants(self):
        results = self.study(10, conditions=('implicit', 'soft_pad'), condition_effect=2.0)
        cells = self.select(self.data.cells, measure='completion_time')
        means = cells.groupby(['participant', 'condition'])['value'].mean().unstack()
        pair = self.select(results.classical_pairs, condition='all', measure='completion_time').iloc[0]
        t, p = stats.ttest_rel(means['implicit'], means['soft_pad'])
        self.assertEqual((pair.a, pair.b, pair.comparisons), ('implicit', 'soft_pad', 1))
        self.assertAlmostEqual(pair.statistic, t, places=9)
        self.assertAlmostEqual(pair.p_bonferroni, p, places=9)
        self.assertEqual(self.effects(results, condition='all').loc['condition'].df_error, 8)

    def test_pairs_are_corrected_within_their_family(self):
        pairs = self.select(self.study(12, object_effect=1.0).post_hoc, measure='completion_time')
        for family in (pairs[pairs['at'] == 'objects'], pairs[pairs['at'].str.startswith('at ')]):
            self.assertEqual(list(family['comparisons']), [3, 3, 3])
            np.testing.assert_allclose(family['p_bonferroni'], np.minimum(1, 3 * family['p']))

    def test_an_effect_of_object_alone_is_found_as_one(self):
        effects = self.effects(self.study(30, object_effect=1.5))
        self.assertLess(effects.loc['object'].p, 1e-6)
        self.assertGreater(effects.loc['group'].p, 0.05)
        self.assertGreater(effects.loc['group x object'].p, 0.05)

    def test_drops_in_all_of_one_group_and_none_of_the_other(self):
        """Welch's t has no variance to go by; exact tests have."""
        for i in range(8):
            made_up_study.write_session(os.path.join(self.root, str(i)), str(i), ('beginner', 'veteran')[i % 2], trials=[
                {'object': name, 'completion_time': 10 + i, 'attempts': 1, 'drops': 1 - i % 2} for name in 'ab'])
        results = self.analyse()
        for table, measure, at, p in ((results.any, 'drops', 'at a', 2 / 70), (results.post_hoc, 'drops', 'at b', 2 / 70),
                                      (results.post_hoc, 'drops', 'all objects', 2 / 70)):
            row = self.select(table, measure=measure, at=at).iloc[0]
            self.assertAlmostEqual(row.p, p)
        self.assertTrue(self.select(results.classical_pairs, measure='drops', at='at a')['p'].isna().all())

    def test_three_groups(self):
        for i in range(12):
            made_up_study.write_session(os.path.join(self.root, str(i)), str(i), ('beginner', 'pilot', 'veteran')[i % 3],
                                        trials=[{'object': name, 'completion_time': 10 + i * j + i % 5 + 9 * (i % 3 == 1),
                                                 'drops': i % 4} for j, name in enumerate('ab')])
        results = self.analyse()
        pairs = self.select(results.post_hoc, measure='completion_time', at='all objects')
        self.assertEqual(list(zip(pairs['a'], pairs['b'])), [('beginner', 'veteran'), ('beginner', 'pilot'),
                                                             ('veteran', 'pilot')])
        self.assertEqual(self.select(results.effects, measure='completion_time', effect='group')['df'].iloc[0], 2)

    def test_simulated_operators_of_two_seeds_are_two_people(self):
        for seed in (1, 2):
            made_up_study.write_session(os.path.join(self.root, str(seed)), simulated=True, seed=seed,
                                        trials=[{'completion_time': 10 + seed}])
        results = self.analyse()
        self.assertEqual(self.select(results.bars, measure='completion_time')['n'].iloc[0], 2)

    def test_the_paper_s_attempts_are_drops_during_manipulation(self):
        """In sessions from before they had a column they are counted from the events."""
        folder = made_up_study.write_session(os.path.join(self.root, 'a'), trials=[
            {'completion_time': 10, 'attempts': 4, 'drops': 3}])
        made_up_study.write_table(os.path.join(folder, 'events.csv'), ['trial', 'stage', 'event'], [
            {'trial': 1, 'stage': stage, 'event': event} for stage, event in (
                ('manipulation', 'dropped'), ('manipulation', 'grasped'), ('maintenance', 'dropped'),
                ('maintenance', 'dropped'))])
        results = self.analyse()
        means = {row.quantity: row.mean for row in results.comparison.itertuples()}
        self.assertEqual((means['grasps'], means['manipulation_drops'], means['drops']), (4, 1, 3))

    def test_simulated_operators_and_gravities_are_analysed_apart_and_marked(self):
        made_up_study.write_study(os.path.join(self.root, 'a'), 4)
        made_up_study.write_study(os.path.join(self.root, 'b'), 6, simulated=True)
        made_up_study.write_study(os.path.join(self.root, 'c'), 8, simulated=True, gravity=(0, 0, -9.80665))
        results = self.analyse()
        for table in (results.bars, results.comparison, results.anova, results.post_hoc, results.ratings):
            apart = table[table['gravity_g'].notna()]  # gravity within participants is beside them
            self.assertEqual(set(zip(apart['source'], apart['gravity_g'])), {
                ('people', 0.0), ('simulated operators, no person took part', 0.0),
                ('simulated operators, no person took part', 1.0)})
        self.assertEqual(sorted(set(results.anova['n'])), [4, 6, 8])


class LeftOut(Studies):
    def assert_noted(self, results, *words):
        self.assertTrue(any(all(word in note for word in words) for note in self.data.notes + results.notes),
                        self.data.notes + results.notes)

    def test_participant_without_an_object(self):
        self.study(8)
        self.rewrite('P03', lambda rows: [row for row in rows if row['object'] != 'flat_cuboid'])
        results = self.analyse()
        self.assertEqual(self.effects(results).loc['object'].n, 7)
        mixed = self.select(results.effects, measure='completion_time')
        self.assertEqual((set(mixed['n']), set(mixed['values'])), ({8}, {3 * 8 - 1}), 'the mixed model leaves nobody out')
        self.assert_noted(results, '0 g, implicit', 'completion_time'.replace('_', ' '),
                          'no value for every object from P03: left out of the analysis of variance')
        self.assertEqual(self.select(results.bars, measure='completion_time', object='cube',
                                     group='beginner')['n'].iloc[0], 4)

    def test_one_group(self):
        for i in range(5):
            made_up_study.write_session(os.path.join(self.root, str(i)), str(i), trials=[
                {'object': name, 'completion_time': 10 + i * j} for j, name in enumerate(('a', 'b', 'c'))])
        results = self.analyse()
        self.assertEqual(list(self.effects(results).index), ['object'])
        self.assert_noted(results, 'one group, beginner: its effect cannot be tested')

    def test_one_object(self):
        results = self.study(6, objects=('cube',))
        self.assertEqual(list(self.effects(results).index), ['group'])
        self.assert_noted(results, 'one object, cube: its effect cannot be tested')

    def test_groups_of_different_sizes_down_to_one(self):
        self.study(7)
        for name in ('P02', 'P04'):
            os.remove(os.path.join(self.root, name + '_implicit', 'trials.csv'))
        results = self.analyse()
        self.assertEqual(list(self.effects(results).index), ['object'])
        self.assert_noted(results, 'one participant in group veteran: left out of the analysis of variance')

    def test_a_single_trial(self):
        results = self.study(1, objects=('cube',), repetitions=1)
        self.assertTrue(results.anova.empty and results.post_hoc.empty)
        self.assert_noted(results, 'no analysis of variance: it needs two participants in a group')

    def test_a_measure_that_never_varies(self):
        results = self.study(6)
        self.assertTrue(self.effects(results, 'completed').empty)
        self.assert_noted(results, 'completed: every value is 1: nothing to test')

    def test_condition_that_some_did_not_do(self):
        self.study(8, conditions=('implicit', 'seed'))
        os.remove(os.path.join(self.root, 'P05_seed', 'trials.csv'))
        results = self.analyse()
        self.assertEqual(self.effects(results, condition='all').loc['condition'].n, 7)
        self.assert_noted(results, 'all conditions', 'no value for every condition from P05')

    def test_object_that_no_one_had_under_one_condition(self):
        self.study(4, conditions=('implicit', 'seed'))
        for i in range(4):
            self.rewrite('P%02d' % (i + 1), lambda rows: [r for r in rows if r['object'] != 'long_cuboid'], 'seed')
        results = self.analyse()
        self.assert_noted(results, 'over the objects that all conditions had: cube, flat_cuboid')
        cells = self.select(self.data.cells, measure='completion_time', participant='P01', condition='implicit')
        kept = cells[cells['object'] != 'long_cuboid']['value'].mean()
        pair = self.select(results.post_hoc, condition='all', measure='completion_time').iloc[0]
        others = self.select(self.data.cells, measure='completion_time', condition='implicit')
        others = others[others['object'] != 'long_cuboid'].groupby('participant')['value'].mean()
        self.assertAlmostEqual(others['P01'], kept)
        self.assertAlmostEqual(pair.centre_a, others.mean())

    def test_object_without_a_value_leaves_the_participants_others_to_the_pair_of_conditions(self):
        for condition, times in (('implicit', (10, 20, '')), ('seed', (13, 25, 90))):
            for i in range(2):
                made_up_study.write_session(
                    os.path.join(self.root, condition + str(i)), str(i), condition=condition,
                    trials=[{'object': name, 'completion_time': time and time + i * (1 if time == 13 else 0)}
                            for name, time in zip('abc', times)])
        pair = self.select(self.analyse().post_hoc, condition='all', measure='completion_time').iloc[0]
        self.assertEqual((pair.n_a, pair.centre_a, pair.centre_b), (2, 15.0, (13 + 25 + 14 + 25) / 4))

    def test_ratings_alone(self):
        for i, score in enumerate((3, 5, 9)):
            made_up_study.write_session(os.path.join(self.root, str(i)), str(i), ratings=[('naturalness', score)])
        results = self.analyse()
        self.assertEqual(results.ratings['median'].tolist(), [5.0])
        self.assertEqual(results.comparison['quantity'].tolist(), ['naturalness'])

    def test_nothing_at_all_is_refused(self):
        made_up_study.write_session(os.path.join(self.root, 'one'))
        with self.assertRaisesRegex(session_folder.StudyError, 'no trials and no ratings'):
            self.analyse()


if __name__ == '__main__':
    unittest.main()
