"""The program as a user runs it: tables, figures and a report of one file."""

import itertools
import os
import re
import subprocess
import tempfile
import unittest
from unittest import mock
import xml.etree.ElementTree as ElementTree

import pandas

import paths
import forked
import made_up_study
from study import style, trajectories, with_r
from study.measures import MEASURES, with_unit
from study.run import run

TABLES = {name + '.csv' for name in (
    'any anova bars classical_pairs comparison data_dictionary demographics effects learning learning_tests participants '
    'post_hoc ratings rating_tests sphericity tidy trials').split()} | {'left_out.txt', 'report.html', 'figures', 'trainees'}
SOME = ('attempts', 'completion_time', 'drops')
NO_PERSON = 'no person took part'


class Program(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.root = holder.name
        self.output = os.path.join(self.root, 'results')

    def run_program(self, *arguments):
        return forked.run(paths.script('analyse_study'), *arguments, '--output', self.output)

    def read(self, *name):
        with open(os.path.join(self.output, *name), encoding='utf-8') as file:
            return file.read()

    def figures(self):
        return sorted(os.listdir(os.path.join(self.output, 'figures')))

    def write_hands(self, name, shake):
        path = os.path.join(self.root, name)
        columns = 'time,hand_id,side,finger,bone,rendered,sx,sy,sz,ex,ey,ez,radius,touching'.split(',')
        made_up_study.write_table(path, columns, [
            dict(dict.fromkeys(columns, 0), time=i / 100, hand_id=7, finger=1, bone=3, ex=0.002 * i + shake * (i % 2),
                 ey=0.1, ez=shake * (i % 3)) for i in range(300)])
        return path

    def test_a_study_of_people_and_simulated_operators(self):
        made_up_study.write_study(os.path.join(self.root, 'a'), 4, conditions=('implicit', 'soft_pad'),
                                  object_effect=2, measures=SOME)
        made_up_study.write_study(os.path.join(self.root, 'b'), 4, simulated=True, measures=SOME)
        hands = [self.write_hands('raw.csv', 0.004), self.write_hands('filtered.csv', 0.001)]
        done = self.run_program(self.root, '--trajectory', *hands)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout, os.path.join(self.output, 'report.html') + '\n')
        self.assertEqual(set(os.listdir(self.output)), TABLES)
        names = [name[:-4] for name in self.figures() if name.endswith('.svg')]
        self.assertEqual(names, ['bars_implicit_0g', 'bars_implicit_simulated_0g', 'bars_soft_pad_0g', 'conditions_0g',
                                 'further_implicit_0g', 'further_implicit_simulated_0g', 'further_soft_pad_0g',
                                 'learning_0g', 'learning_simulated_0g', 'ratings_0g', 'ratings_simulated_0g', 'trajectory_given'])
        self.assertEqual([name[:-4] for name in self.figures() if name.endswith('.png')], names)
        for name in names:
            drawn = self.read('figures', name + '.svg')
            ElementTree.fromstring(drawn)
            self.assertEqual(NO_PERSON in drawn, 'simulated' in name, name)
        report = self.read('report.html')
        self.assertEqual(report.count('<img '), len(names))
        self.assertEqual(re.findall(r'(?:src|href)="(?!data:)', report), [])  # nothing from outside the file
        self.assertTrue(NO_PERSON in report)
        for table in ('anova.csv', 'bars.csv', 'comparison.csv', 'post_hoc.csv', 'ratings.csv', 'participants.csv'):
            self.assertTrue(NO_PERSON in self.read(table), table)
        drawn = self.read('figures', 'trajectory_given.svg')
        for name, path in zip(('raw', 'filtered'), map(trajectories.read_path, hands)):
            self.assertTrue('%s: %.2f m long' % (name, path.length) in drawn)

    def test_the_same_sessions_give_the_same_files(self):
        made_up_study.write_study(os.path.join(self.root, 'a'), 2, objects=('cube',), measures=SOME)
        kept = []
        for _ in range(2):
            # Processes of their own: each has another order of sets.
            subprocess.run([paths.script('analyse_study'), os.path.join(self.root, 'a'), '--output', self.output], check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            kept.append([self.read('report.html'), self.read('anova.csv'), self.read('left_out.txt')])
        self.assertTrue(kept[0] == kept[1])

    def test_with_r_its_models_of_counts_are_there(self):
        """Or what is lost without R is said."""
        made_up_study.write_study(os.path.join(self.root, 'a'), 6, conditions=('implicit', 'seed'), measures=SOME)
        with made_up_study.undrawn():
            done = self.run_program(os.path.join(self.root, 'a'), '--r')
        self.assertEqual(done.returncode, 0, done.stderr)
        if with_r.missing():
            self.assertIn('no Poisson or negative binomial mixed models of counts', self.read('left_out.txt'))
            return
        theirs = pandas.read_csv(os.path.join(self.output, 'r_models.csv'))
        self.assertTrue(all(test.startswith('glmmTMB') for test in theirs['test']))
        self.assertIn('drops', set(theirs['measure']))
        told = pandas.read_csv(os.path.join(self.output, 'data_dictionary.csv'))
        told = told[(told['table'] == 'r_models') & told['meaning'].notna()]
        self.assertEqual(set(told['column']), set(theirs.columns))

    def test_without_r_it_is_said_what_is_lost_and_all_else_is_there(self):
        made_up_study.write_study(os.path.join(self.root, 'a'), 4, measures=SOME)
        with mock.patch.dict(os.environ, PATH=self.root), made_up_study.undrawn():
            notes = run([os.path.join(self.root, 'a')], self.output, [], ask_r=True)
        self.assertTrue(any('Rscript (r-base-core) not installed: no Poisson or negative binomial' in note for note in notes))
        self.assertFalse(os.path.exists(os.path.join(self.output, 'r_models.csv')))
        self.assertIn('mixed model F', self.read('effects.csv'))

    def test_the_report_begins_with_findings_their_effect_and_interval_and_who_took_part(self):
        made_up_study.write_study(os.path.join(self.root, 'a'), 6, conditions=('implicit', 'soft_pad'),
                                  condition_effect=3, measures=SOME)
        with made_up_study.undrawn():
            self.assertEqual(self.run_program(self.root).returncode, 0)
        report, pairs = self.read('report.html'), pandas.read_csv(os.path.join(self.output, 'post_hoc.csv'))
        pair = pairs[(pairs['measure'] == 'completion_time') & (pairs['at'] == 'conditions')].iloc[0]
        sentence = 'Completion time of implicit is %.3g times that of soft pad (95 %% interval %.3g to %.3g, p' % (
            pair.effect, pair.low, pair.high)
        self.assertTrue(0 < report.find(sentence) < report.find('Who took part') < report.find('<img '), sentence)
        effects = pandas.read_csv(os.path.join(self.output, 'effects.csv'))
        self.assertTrue(effects['partial_eta_squared'].between(0, 1).all())

    def test_figures_fit_the_page_and_titles_of_panels_do_not_meet(self):
        for width in (3.2, 4.6):
            figure, panels = style.new_figure(6, width, 2.0)
            for axes, measure in zip(panels.flat, MEASURES):
                style.panel_title(axes, with_unit(measure))
            style.finish(figure, 'A title that is long enough to be wrapped at the width of the page ' * 2, 'Caption', '')
            figure.canvas.draw()
            boxes = [axes._left_title.get_window_extent() for axes in panels.flat] + [
                text.get_window_extent() for text in figure.texts]
            self.assertLessEqual(figure.get_figwidth(), style.PAGE_WIDTH)
            self.assertEqual([pair for pair in itertools.combinations(boxes, 2) if pair[0].overlaps(pair[1])], [])

    def test_one_participant_with_one_trial(self):
        made_up_study.write_study(os.path.join(self.root, 'a'), 1, objects=('cube',), repetitions=1,
                                  measures=SOME)
        done = self.run_program(self.root)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('no analysis of variance', done.stderr)
        self.assertNotIn('Warning', done.stderr)

    def test_a_bad_file_is_named_in_one_line_and_nothing_is_written(self):
        made_up_study.write_session(os.path.join(self.root, 'one'), trials=[{'completion_time': 'soon'}])
        done = self.run_program(self.root)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "^analyse_study: .*one/trials.csv: line 2: completion_time: 'soon' is not a "
                                      'number\n$')
        self.assertFalse(os.path.exists(self.output))

    def test_a_session_without_trials_is_named(self):
        folders = [made_up_study.write_session(os.path.join(self.root, name), name, trials=[{'completion_time': 10}],
                                               ratings=[('efficiency', 5)]) for name in ('P01', 'P02', 'P03')]
        os.remove(os.path.join(folders[0], 'trials.csv'))
        made_up_study.write_session(folders[1], 'P02', ratings=[('efficiency', 5)])
        with made_up_study.undrawn():
            done = self.run_program(self.root)
        self.assertEqual(done.returncode, 0, done.stderr)
        for text in (done.stderr, self.read('left_out.txt')):
            self.assertIn('P01/trials.csv: no such file: only ratings of this session count\n', text)
            self.assertIn('P02/trials.csv: has no trials: only ratings of this session count\n', text)
            self.assertNotIn('P03/trials.csv', text)

    def test_a_file_is_no_place_for_results(self):
        made_up_study.write_study(os.path.join(self.root, 'a'), 1)
        open(self.output, 'w').close()
        done = self.run_program(self.root)
        self.assertEqual((done.returncode, done.stderr),
                         (1, 'analyse_study: %s: is not a folder; allowed: a folder, or a free name\n' % self.output))

    def test_trajectories_alone(self):
        hands = [self.write_hands('raw.csv', 0.004), self.write_hands('filtered.csv', 0.001)]
        self.assertEqual(self.run_program('--trajectory', *hands).returncode, 0)
        self.assertEqual(self.figures(), ['trajectory_given.png', 'trajectory_given.svg'])
        with open(hands[1], 'a') as file:
            file.write('3.0,7,0,1,3,0,0,0,0,there,0,0,0,0\n')
        self.assertEqual(self.run_program('--trajectory', *hands).stderr,
                         "analyse_study: %s: line 302: ex: 'there' is not a finite number\n" % hands[1])
        made_up_study.write_table(hands[1], ['time', 'hand_id'], [])
        self.assertIn("filtered.csv: line 1: no column 'finger'", self.run_program('--trajectory', *hands).stderr)

    def test_trajectories_of_a_session_that_has_both_files(self):
        for name, files in (('one', ('hands_raw.csv', 'hands.csv')), ('two', ('hands.csv',))):
            made_up_study.write_session(os.path.join(self.root, name), name, simulated=True,
                                        ratings=[('efficiency', 5)])
            for file in files:
                self.write_hands(os.path.join(name, file), 0.004 if 'raw' in file else 0.001)
        done = self.run_program(self.root)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([name for name in self.figures() if name.startswith('trajectory') and name.endswith('.svg')],
                         ['trajectory_one_implicit_0_g.svg'])
        self.assertTrue(NO_PERSON in self.read('figures', 'trajectory_one_implicit_0_g.svg'))
        self.assertIn('two: no trajectory drawn: it needs both hands_raw.csv and hands.csv', done.stderr)

    def test_one_session_of_each_group_and_condition_has_its_trajectory_drawn(self):
        for name, group in (('P01', 'beginner'), ('P02', 'veteran'), ('P03', 'beginner')):
            made_up_study.write_session(os.path.join(self.root, name), name, group, ratings=[('efficiency', 5)])
            self.write_hands(os.path.join(name, 'hands_raw.csv'), 0.004)
            with open(self.write_hands(os.path.join(name, 'hands.csv'), 0.001), 'a') as file:
                file.write('3.0,7,0,1,3,0,0.0')  # cut off by a crash
        done = self.run_program(self.root)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([name for name in self.figures() if name.startswith('trajectory') and name.endswith('.svg')],
                         ['trajectory_P01_implicit_0_g.svg', 'trajectory_P02_implicit_0_g.svg'])
        self.assertIn('1 sessions: no trajectory drawn', done.stderr)

    def test_a_path_across_a_tracking_loss_has_no_length_there(self):
        path = os.path.join(self.root, 'hands.csv')
        made_up_study.write_table(path, list(trajectories.COLUMNS), [
            dict(zip(trajectories.COLUMNS, (t, 3, 1, 3, 0, x, 0, 0)))
            for t, x in ((0.0, 0), (0.01, 0.1), (0.02, 0.3), (2.0, 7.0), (2.01, 7.4))])
        self.assertAlmostEqual(trajectories.read_path(path).length, 0.1 + 0.2 + 0.4)

    def test_no_folder_is_a_mistake_of_usage(self):
        done = self.run_program()
        self.assertEqual(done.returncode, 2)
        self.assertIn('a session folder or --trajectory is needed', done.stderr)


if __name__ == '__main__':
    unittest.main()
