"""What labs hand in: consent and demographics, questionnaires, plans, power, learning, the data dictionary."""

import csv
import os
import tempfile
import unittest

import numpy as np
import pandas

import paths
import forked
import made_up_study
from study import demographics, plan, questions, session_folder, study_data

EARTH = (0, 0, -9.80665)
SOME = ('attempts', 'completion_time', 'drops')


class Labs(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.root = holder.name

    def run_script(self, name, *arguments, typed=''):
        return forked.run(paths.script(name), *arguments, typed=typed)

    def analyse(self, folder, *arguments, drawn=()):
        output = os.path.join(self.root, 'results')
        with made_up_study.undrawn(*drawn):
            done = self.run_script('analyse_study', folder, '--output', output, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return output

    def table(self, output, name):
        return pandas.read_csv(os.path.join(output, name + '.csv'))


class Participants(Labs):
    def test_asks_and_writes_what_the_paper_tells(self):
        folder = made_up_study.write_session(os.path.join(self.root, 'one'))
        done = self.run_script('ask_participant', folder, '--consent-form', 'ethics-7', typed='yes\n17\n24\nfemale\nleft\nnone\n')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("'17' is not a whole number from 18 to 100", done.stdout)
        said = demographics.of_folder(folder)
        self.assertEqual([said[name] for name in ('consent', 'consent_form', 'age', 'sex', 'handedness', 'mr_experience')],
                         [True, 'ethics-7', 24, 'female', 'left', 'none'])

    def test_without_consent_nothing_is_written(self):
        folder = made_up_study.write_session(os.path.join(self.root, 'one'))
        self.assertIn('Do not go on', self.run_script('ask_participant', folder, typed='no\n').stdout)
        self.assertIsNone(demographics.of_folder(folder))
        self.assertNotEqual(self.run_script('ask_participant', folder, typed='yes\n24\n').returncode, 0)
        self.assertIsNone(demographics.of_folder(folder))

    def test_who_took_back_consent_is_left_out_of_everything(self):
        for name, consent in (('P01', 'true'), ('P02', 'false'), ('P03', 'true')):
            folder = made_up_study.write_session(os.path.join(self.root, 's', name), name, trials=[
                {'completion_time': 10}, {'completion_time': 12}])
            with open(os.path.join(folder, 'participant.yaml'), 'w') as file:
                file.write('consent: %s\nage: 30\nsex: male\n' % consent)
        output = self.analyse(os.path.join(self.root, 's'))
        for name in ('trials', 'participants', 'tidy', 'demographics'):
            self.assertEqual(set(self.table(output, name)['participant']), {'P01', 'P03'}, name)
        with open(os.path.join(output, 'left_out.txt')) as file:
            self.assertIn('no consent from P02: all of theirs left out', file.read())

    def test_a_bad_file_is_refused_in_one_line(self):
        folder = made_up_study.write_session(os.path.join(self.root, 'one'))
        for text, words in (('age: 3\n', "no 'consent'"), ('consent: true\nsex: 7\n', "sex: '7' is not")):
            with open(os.path.join(folder, 'participant.yaml'), 'w') as file:
                file.write(text)
            with self.assertRaisesRegex(session_folder.StudyError, words):
                demographics.of_folder(folder)


class Questionnaires(Labs):
    def test_scales_are_those_of_their_authors(self):
        """Brooke: all neutral is 50, the best answers 100. TLX: the mean of six, from 0 to 100."""
        self.assertEqual(questions.derived({'sus_%d' % i: 3 for i in range(1, 11)}), {'sus': 50.0})
        self.assertEqual(questions.derived({'sus_%d' % i: 5 if i % 2 else 1 for i in range(1, 11)}), {'sus': 100.0})
        self.assertEqual(questions.derived(dict.fromkeys(questions.NASA_TLX, 7)), {'nasa_tlx': 35.0})
        self.assertEqual(questions.derived({'sus_1': 3}), {})

    def test_asked_in_the_terminal_and_analysed_beside_the_two_questions(self):
        for i, name in enumerate(('P01', 'P02', 'P03', 'P04')):
            folder = made_up_study.write_session(os.path.join(self.root, 's', name), name, ('beginner', 'veteran')[i % 2])
            typed = '7\n8\n' + '10\n' * 6 + '4\n2\n' * 5
            done = self.run_script('ask_ratings', folder, '--also', 'nasa_tlx', '--also', 'sus', typed=typed)
            self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(folder, 'ratings.csv'), 'a') as file:
            file.write('implicit,how_dizzy,37\n')
        ratings = self.table(self.analyse(os.path.join(self.root, 's')), 'ratings').set_index('question')
        self.assertEqual(list(ratings.index), ['naturalness', 'efficiency', 'how_dizzy', 'nasa_tlx', 'sus'])
        self.assertEqual(list(ratings.loc[['nasa_tlx', 'sus'], 'mean']), [50.0, 75.0])

    def test_off_its_scale_is_refused(self):
        for question, text in (('sus_1', '0'), ('tlx_effort', '21'), ('naturalness', '11'), ('of_ours', '101')):
            with self.assertRaises(ValueError):
                questions.score_of(question, text)


class Plans(Labs):
    def test_each_condition_has_each_place_and_follows_each_other_equally_often(self):
        for names in ('ab', 'abc', 'abcd', 'abcde'):
            square = plan.balanced_square(list(names))
            for place in range(len(names)):
                self.assertEqual(len({order[place] for order in square}), len(names))
            pairs = [pair for order in square for pair in zip(order, order[1:])]
            self.assertEqual({pairs.count(pair) for pair in pairs}, {len(square) // len(names)})
            self.assertEqual(len(set(pairs)), len(names) * (len(names) - 1))

    def plan(self, *arguments):
        path = os.path.join(self.root, 'plan.csv')
        done = self.run_script('plan_study', *arguments, '--output', path)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(path, newline='') as file:
            return list(csv.DictReader(file))

    def test_counterbalanced_within_each_group_over_days(self):
        rows = self.plan('--group', 'beginner:4', '--group', 'veteran:4', '--condition', 'implicit', '--condition',
                         'soft_pad', '--sessions', '2', '--days-between', '7', '--first', '2026-01-05')
        self.assertEqual(len(rows), 8 * 2 * 2)
        for group in ('beginner', 'veteran'):
            first = [row['condition'] for row in rows if row['group'] == group and (row['day'], row['step']) == ('1', '1')]
            self.assertEqual(sorted(first), ['implicit', 'implicit', 'soft_pad', 'soft_pad'])
        days = {row['day']: row['date'] for row in rows if row['participant'] == 'P01'}
        self.assertEqual(days, {'1': '2026-01-05', '2': '2026-01-12'})
        self.assertIn('session:=2', [row for row in rows if row['day'] == '2'][0]['run'])

    def test_the_paper_s_procedure(self):
        """Figure 10: veterans train with ours, then all do ours, then the baseline, each with its form."""
        rows = self.plan('--group', 'beginner:1', '--group', 'veteran:1', '--condition', 'implicit', '--condition',
                         'soft_pad', '--procedure', 'paper')
        steps = [(row['group'], row['phase'], row['condition'], bool(row['afterwards'])) for row in rows]
        self.assertEqual(steps, [('beginner', 'test', 'implicit', True), ('beginner', 'test', 'soft_pad', True),
                                 ('veteran', 'training', 'implicit_training', False),
                                 ('veteran', 'test', 'implicit', True), ('veteran', 'test', 'soft_pad', True)])

    def test_an_earlier_plan_stays(self):
        words = ('--group', 'beginner:1', '--condition', 'implicit')
        self.plan(*words)
        path = os.path.join(self.root, 'plan.csv')
        with open(path) as file:
            earlier = file.read()
        done = self.run_script('plan_study', *words, '--seed', '2', '--output', path)
        self.assertEqual(done.returncode, 2)
        self.assertIn("'%s' is there already; allowed: a file that is not" % path, done.stderr)
        with open(path) as file:
            self.assertEqual(file.read(), earlier)

    def test_a_day_that_is_none_is_named(self):
        done = self.run_script('plan_study', '--group', 'beginner:1', '--condition', 'implicit', '--first', '2026-13-01')
        self.assertEqual((done.returncode, done.stderr.count('\n')), (2, 1))
        self.assertIn("'2026-13-01' is not a day; allowed: YYYY-MM-DD", done.stderr)

    def test_no_argument_meets_a_shell(self):
        done = self.run_script('plan_study', '--group', 'a;b:3', '--condition', 'implicit')
        self.assertEqual((done.returncode, done.stderr.count('\n')), (1, 1))
        self.assertIn('allowed: a name', done.stderr)


class Power(Labs):
    def test_no_effect_is_found_in_5_percent_and_a_great_one_always(self):
        made_up_study.write_study(os.path.join(self.root, 'pilot'), 16, measures=SOME)
        found = {}
        for ratio, studies in (('1', '100'), ('2', '40')):
            done = self.run_script('power_study', os.path.join(self.root, 'pilot'), '--ratio', ratio, '--size', '8v8',
                                   '--studies', studies)
            self.assertEqual(done.returncode, 0, done.stderr)
            found[ratio] = int(done.stdout.splitlines()[1].split(',')[2])
        self.assertLessEqual(found['1'], 20, 'drawing from 8 makes of chance differences of the pilot real ones')
        self.assertGreaterEqual(found['2'], 38)

    def test_what_cannot_be_is_refused_in_one_line(self):
        made_up_study.write_study(os.path.join(self.root, 'pilot'), 4)
        for arguments in (('--size', '8'), ('--effect', 'condition'), ('--ratio', '0')):
            done = self.run_script('power_study', os.path.join(self.root, 'pilot'), *arguments)
            self.assertEqual((done.returncode, done.stderr.count('\n')), (1, 1), done.stderr)


class Learning(Labs):
    def study(self, sessions, slope=0.2, retention=1.2):
        random = np.random.RandomState(1)
        for person in range(8):
            level = random.normal(0, 0.2)
            for session in range(1, sessions + 1):
                trials = []
                for repetition in range(1, 5):
                    block = 4 * (session - 1) + repetition
                    worse = retention if session > 1 and repetition == 1 else 1.0
                    time = 30 * np.exp(level + random.normal(0, 0.03)) * block ** -slope * worse
                    trials.append({'completion_time': round(time, 4), 'repetition': repetition, 'drops': 0})
                made_up_study.write_session(os.path.join(self.root, 's', '%d_%d' % (person, session)), 'P%d' % person,
                                            trials=trials, session=session)
        return os.path.join(self.root, 's')

    def test_slope_and_retention_are_those_that_were_put_in(self):
        """30 s * block^-0.2: each doubling takes 2^-0.2 = 0.871. After the break 1.2 * (5 / 4)^-0.2 = 1.148."""
        output = self.analyse(self.study(2, retention=1.2), drawn=('learning.draw',))
        tests = self.table(output, 'learning_tests').set_index(['measure', 'effect'])
        retained = tests.loc['completion_time', 'retention: first of session 2 after last of 1']
        self.assertTrue(retained.low < 1.148 < retained.high, retained)
        self.assertGreater(retained.low, 1)
        self.assertTrue(os.path.exists(os.path.join(output, 'trainees', 'P0.html')))
        self.assertTrue(os.path.exists(os.path.join(output, 'figures', 'learning_0g.svg')))

    def test_slope_of_one_session(self):
        tests = self.table(self.analyse(self.study(1)), 'learning_tests').set_index(['measure', 'effect'])
        slope = tests.loc['completion_time', 'each doubling of blocks']
        self.assertTrue(slope.low < 2 ** -0.2 < slope.high, slope)

    def test_drops_that_get_fewer_are_found_by_permutation(self):
        """Eight people: 3, 2, 2, 1 drops over four blocks. Slope on log2(block), by hand: -0.9035. All 2^8 signs: 2 / 256."""
        for person in range(8):
            made_up_study.write_session(os.path.join(self.root, 's', str(person)), 'P%d' % person, trials=[
                {'repetition': block, 'drops': drops} for block, drops in enumerate((3, 2, 2, 1), 1)])
        tests = self.table(self.analyse(os.path.join(self.root, 's')), 'learning_tests').set_index(['measure', 'effect'])
        slope = tests.loc['drops', 'each doubling of blocks']
        self.assertEqual((slope.test, slope.n), ('permutation', 8))
        self.assertAlmostEqual(slope.p, 2 / 256)
        logs = [0.0, 1.0, np.log2(3), 2.0]
        by_hand = np.polyfit(logs, [3, 2, 2, 1], 1)[0]
        for value in (slope.estimate, slope.low, slope.high):
            self.assertAlmostEqual(value, by_hand)

    def test_each_person_has_a_page_and_each_gravity_a_table_in_it(self):
        for folder, name, gravity, drift in (('a', 'P 1', (0, 0, 0), 0.0123), ('b', 'P 1', EARTH, 0.0456), ('c', 'P_1', EARTH, 0.0789)):
            made_up_study.write_session(os.path.join(self.root, 's', folder), name, gravity=gravity,
                                        trials=[{'completion_time': 20, 'release_drift': drift}])
        folder = os.path.join(self.analyse(os.path.join(self.root, 's')), 'trainees')
        pages = sorted(name for name in os.listdir(folder) if name.endswith('.html'))
        self.assertEqual(len(pages), 2, pages)
        with open(os.path.join(folder, 'P_1.html'), encoding='utf-8') as file:
            page = file.read()
        for told in ('<h2>0 g</h2>', '<h2>1 g</h2>', '12.3', '45.6'):
            self.assertIn(told, page)

    def test_practice_counts_in_no_table_but_that_of_trials(self):
        folder = made_up_study.write_session(os.path.join(self.root, 's'), trials=[
            {'completion_time': 99, 'repetition': 0}, {'completion_time': 10, 'repetition': 1}])
        data = study_data.gather([session_folder.read_session(folder)])
        self.assertEqual(list(data.cells[data.cells['measure'] == 'completion_time']['value']), [10])
        self.assertTrue(any('practice' in note for note in data.notes))


class Tables(Labs):
    def test_every_column_of_every_table_is_explained(self):
        made_up_study.write_study(os.path.join(self.root, 's', 'a'), 4, conditions=('implicit', 'seed'))
        made_up_study.write_study(os.path.join(self.root, 's', 'b'), 4, gravity=EARTH)
        output = self.analyse(os.path.join(self.root, 's'))
        told = self.table(output, 'data_dictionary')
        self.assertEqual(list(told[told['meaning'].isna()]['column']), [])
        known = set(zip(told['table'], told['column']))
        for name in [file[:-4] for file in os.listdir(output) if file.endswith('.csv')]:
            for column in self.table(output, name).columns:
                self.assertIn((name, column), known)

    def test_gravity_is_a_factor_within_those_who_were_at_several(self):
        made_up_study.write_study(os.path.join(self.root, 's', 'a'), 6, measures=SOME)
        made_up_study.write_study(os.path.join(self.root, 's', 'b'), 4, gravity=EARTH, seed=5, measures=SOME)
        effects = self.table(self.analyse(os.path.join(self.root, 's')), 'effects')
        gravity = effects[(effects['effect'] == 'gravity') & (effects['measure'] == 'completion_time')]
        self.assertEqual((len(gravity), gravity['n'].iloc[0]), (1, 4))
        self.assertTrue(2 <= gravity['df_error'].iloc[0] < 4)  # 2, and more where a variance is estimated as 0

    def test_the_paper_s_procedure_keeps_its_beginners_in_the_comparison_of_conditions(self):
        """Veterans alone have a training phase; what is compared is what all were tested in."""
        made_up_study.write_study(os.path.join(self.root, 's', 'test'), 8, conditions=('implicit', 'seed'), measures=SOME)
        for number in (2, 4, 6, 8):
            made_up_study.write_session(os.path.join(self.root, 's', 'training', str(number)), 'P%02d' % number, 'veteran',
                                        'implicit_training', trials=[{'completion_time': 20 + number, 'drops': 0}])
        output = self.analyse(os.path.join(self.root, 's'),
                              drawn=('bars.draw_bars', 'distributions.draw_conditions'))
        for name in ('effects', 'anova'):
            table = self.table(output, name)
            table = table[(table['condition'] == 'all') & (table['measure'] == 'completion_time')]
            self.assertEqual(set(table['n']), {8}, name)
            self.assertIn('group x condition', set(table['effect']), name)
        pairs = self.table(output, 'post_hoc')
        pairs = pairs[(pairs['condition'] == 'all') & (pairs['measure'] == 'completion_time')]
        self.assertEqual([(row.a, row.b, row.comparisons) for row in pairs.itertuples()], [('implicit', 'seed', 1)])
        self.assertIn('implicit_training', set(self.table(output, 'bars')['condition']))
        with open(os.path.join(output, 'left_out.txt'), encoding='utf-8') as file:
            self.assertIn('implicit_training was training: not compared', file.read())
        done = self.run_script('power_study', os.path.join(self.root, 's'), '--effect', 'condition', '--size', '8',
                               '--studies', '5')
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_of_some_objects_alone(self):
        made_up_study.write_study(os.path.join(self.root, 's'), 4, measures=SOME)
        output = self.analyse(os.path.join(self.root, 's'), '--object', 'cube')
        self.assertEqual(set(self.table(output, 'trials')['object']), {'cube'})
        done = self.run_script('analyse_study', os.path.join(self.root, 's'), '--object', 'pear', '--output', output)
        self.assertEqual((done.returncode, done.stderr.count('\n')), (1, 1))
        self.assertIn("--object 'pear': no trial has it; allowed: cube, flat_cuboid, long_cuboid", done.stderr)

    def test_tidy_has_every_value_once(self):
        made_up_study.write_study(os.path.join(self.root, 's'), 2, repetitions=1)
        output = self.analyse(os.path.join(self.root, 's'))
        tidy, trials = self.table(output, 'tidy'), self.table(output, 'trials')
        times = tidy[tidy['measure'] == 'completion_time']
        self.assertEqual(sorted(times['value']), sorted(trials['completion_time']))
        self.assertEqual(len(tidy[tidy['measure'] == 'naturalness']), 2)


if __name__ == '__main__':
    unittest.main()
