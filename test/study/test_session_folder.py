"""Reading session folders: what is wrong is said in one line with file and line, and nothing good is lost."""

import os
import re
import tempfile
import unittest

import paths  # noqa: F401
import made_up_study
from study import session_folder, study_data
from study.session_folder import StudyError


class Folders(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.root = holder.name

    def folder(self, name='one', **header):
        trials = [{'completion_time': 12.5, 'attempts': 1, 'drops': 0}, {'result': 'skipped'}]
        ratings = [('naturalness', 7), ('efficiency', 10)]
        return made_up_study.write_session(os.path.join(self.root, name), trials=trials, ratings=ratings, **header)

    def edit(self, file, pattern, replacement):
        path = os.path.join(self.root, 'one', file)
        with open(path, encoding='utf-8') as stream:
            text = stream.read()
        edited = re.sub(pattern, replacement, text, count=1, flags=re.M)
        self.assertNotEqual(edited, text)
        with open(path, 'w', encoding='utf-8') as stream:
            stream.write(edited)

    def assert_refused(self, *words):
        with self.assertRaises(StudyError) as caught:
            session_folder.read_session(os.path.join(self.root, 'one'))
        message = str(caught.exception)
        for word in words:
            self.assertIn(word, message)
        self.assertNotIn('\n', message)


class Reading(Folders):
    def test_a_session_is_read_as_written(self):
        session = session_folder.read_session(self.folder(group='veteran', gravity=(0, 0, -9.80665), simulated=True))
        self.assertEqual((session.participant, session.group, session.gravity, session.simulated),
                         ('P01', 'veteran', 1.0, True))
        self.assertEqual([row['completion_time'] for row in session.trials], [12.5, None])
        self.assertEqual(session.ratings[1], {'condition': 'implicit', 'question': 'efficiency', 'score': 10})
        self.assertEqual(session.notes, [])

    def test_a_trial_under_a_parameter_that_was_changed_meanwhile_is_left_out(self):
        where = made_up_study.write_session(os.path.join(self.root, 'one'), ratings=[], trials=[
            {'start': start, 'completion_time': 8.0, 'attempts': 1, 'drops': 0} for start in (0.0, 10.0, 20.0, 30.0)])
        events = [(12.0, 'parameter_changed', 'filter/type: none'), (15.0, 'parameter_changed', 'step: 0.002'),
                  (16.0, 'parameter_restored', 'filter/type: constant_velocity'), (25.0, 'parameter_restored', 'step: 0.001')]
        columns = ['time', 'trial', 'stage', 'event', 'object', 'detail']
        made_up_study.write_table(os.path.join(where, 'events.csv'), columns,
                                  [dict(dict.fromkeys(columns, ''), time=time, event=event, detail=detail)
                                   for time, event, detail in events])
        session = session_folder.read_session(where)
        self.assertEqual([row['start'] for row in session.trials], [0.0, 30.0])
        self.assertEqual(len(session.notes), 2)
        self.assertIn('trial 2: filter/type: none, which the session was not begun with: left out', session.notes[0])
        self.assertIn('trial 3: step: 0.002', session.notes[1])

    def test_columns_in_another_order_and_further_ones_do_no_harm(self):
        self.folder()
        path = os.path.join(self.root, 'one', 'ratings.csv')
        made_up_study.write_table(path, ['remark', 'score', 'question', 'condition'],
                                  [{'remark': 'x', 'score': 3, 'question': 'efficiency', 'condition': 'seed'}])
        session = session_folder.read_session(os.path.join(self.root, 'one'))
        self.assertEqual(session.ratings, [{'condition': 'seed', 'question': 'efficiency', 'score': 3}])

    def test_a_spreadsheets_line_ends_and_byte_order_mark_do_no_harm(self):
        path = os.path.join(self.folder(), 'ratings.csv')
        with open(path, 'w', encoding='utf-8-sig', newline='') as file:
            file.write('condition,question,score\r\n"soft_pad",naturalness,4\r\n\r\n')
        self.assertEqual(session_folder.read_session(os.path.dirname(path)).ratings,
                         [{'condition': 'soft_pad', 'question': 'naturalness', 'score': 4}])

    def test_a_line_cut_off_by_a_crash_is_left_out_and_said(self):
        with open(os.path.join(self.folder(), 'trials.csv'), 'a') as file:
            file.write('3,cube,impl')
        session = session_folder.read_session(os.path.join(self.root, 'one'))
        self.assertEqual(len(session.trials), 2)
        self.assertIn('trials.csv: line 4 was cut off', session.notes[0])

    def test_the_later_answer_counts_and_the_earlier_is_mentioned(self):
        with open(os.path.join(self.folder(), 'ratings.csv'), 'a') as file:
            file.write('implicit,naturalness,2\n')
        session = session_folder.read_session(os.path.join(self.root, 'one'))
        scores = {row['question']: row['score'] for row in session.ratings}
        self.assertEqual(scores, {'naturalness': 2, 'efficiency': 10})
        self.assertIn('1 answers replaced by later ones', session.notes[0])

    def test_folders_are_found_below_each_once(self):
        self.folder('one'), self.folder('deep/er/two', participant='P02')
        found = session_folder.find_sessions([self.root, os.path.join(self.root, 'one')])
        self.assertEqual([os.path.basename(folder) for folder in found], ['two', 'one'])


class Refusals(Folders):
    def test_missing_column(self):
        self.folder()
        self.edit('trials.csv', 'completion_time', 'time')
        self.assert_refused('one/trials.csv: line 1', "no column 'completion_time'")

    def test_columns_that_no_comma_separates(self):
        for separator, words in ((';', "separated by ';'; allowed: ','"), ('\t', "separated by tabs; allowed: ','")):
            for file, columns in (('trials.csv', session_folder.TRIALS), ('events.csv', session_folder.CHANGES)):
                with self.subTest(separator=separator, file=file):
                    with open(os.path.join(self.folder(), file), 'w') as table:
                        table.write(separator.join(columns) + '\n')
                    self.assert_refused('one/%s: line 1: columns are ' % file, words)
                    os.remove(os.path.join(self.root, 'one', file))

    def test_bad_numbers(self):
        for written in ('12.5s', 'nan', 'inf', '-1'):
            with self.subTest(written):
                self.folder()
                self.edit('trials.csv', '12.5', written)
                self.assert_refused('one/trials.csv: line 2: completion_time', "'%s'" % written)

    def test_attempts_that_are_no_count(self):
        self.folder()
        self.edit('trials.csv', r'12\.5,,,,1,', '12.5,,,,1.5,')
        self.assert_refused('trials.csv: line 2: attempts', "'1.5' is not a whole number")

    def test_too_few_fields_in_the_middle(self):
        self.folder()
        self.edit('trials.csv', r'^1,cube,.*$', '1,cube')
        self.assert_refused('trials.csv: line 2: 2 fields where the header has 18')

    def test_unknown_result(self):
        self.folder()
        self.edit('trials.csv', 'skipped', 'given up')
        self.assert_refused('trials.csv: line 3: result', "'given up' is not completed or skipped")

    def test_the_same_trial_twice(self):
        self.folder()
        self.edit('trials.csv', '^2,', '1,')
        self.assert_refused('trials.csv: trial 1 is there twice')

    def test_scores_off_the_scale(self):
        for written in ('11', '-1', '7.5', 'ten', ''):
            with self.subTest(written):
                self.folder()
                self.edit('ratings.csv', ',7$', ',' + written)
                self.assert_refused('ratings.csv: line 2: score', 'whole number from 0 to 10')

    def test_a_question_of_the_lab_s_own_stops_nothing(self):
        folder = self.folder()
        self.edit('ratings.csv', 'efficiency', 'fun')
        self.assertIn('fun', [row['question'] for row in session_folder.read_session(folder).ratings])
        self.edit('ratings.csv', 'fun,', 'fun,10')
        self.assert_refused('ratings.csv: line 3: score', 'is not a whole number from 0 to 100')

    def test_session_without_what_is_needed(self):
        for key, replacement, words in (('participant', '', "no 'participant'"),
                                        ('group', 'group: " "', "group: is empty"),
                                        ('participant', 'participant: "=1+1"', "'=1+1' begins as a spreadsheet's formula does"),
                                        ('version', 'version: 2', "'2' is not 1"),
                                        ('gravity', 'gravity: 9.81', 'is not three numbers'),
                                        ('simulated', 'simulated: perhaps', 'is not true or false'),
                                        ('group', 'group: [', 'is not YAML')):
            with self.subTest(replacement):
                self.folder()
                self.edit('session.yaml', '^%s:.*$' % key, replacement)
                self.assert_refused('one/session.yaml: ', words)

    def test_no_session_and_no_folder(self):
        with self.assertRaisesRegex(StudyError, 'no session.yaml in it or below'):
            session_folder.find_sessions([self.root])
        with self.assertRaisesRegex(StudyError, 'no such folder'):
            session_folder.find_sessions([os.path.join(self.root, 'nowhere')])


class Together(Folders):
    def gather(self):
        return study_data.gather([session_folder.read_session(f) for f in session_folder.find_sessions([self.root])])

    def test_a_participant_twice_in_one_condition_is_refused_with_both_files(self):
        self.folder('one'), self.folder('two')
        with self.assertRaisesRegex(StudyError, r"two/trials.csv: trials of participant 'P01' in condition 'implicit' "
                                                r'are also in .*one/trials.csv'):
            self.gather()

    def test_a_participant_in_two_groups_is_refused_with_both_files(self):
        self.folder('one'), self.folder('two', group='veteran', condition='seed')
        with self.assertRaisesRegex(StudyError, "two/session.yaml: participant 'P01' is a veteran here and a beginner "
                                                'in .*one/session.yaml'):
            self.gather()

    def test_different_tasks_are_refused_with_their_sessions(self):
        self.folder('one'), self.folder('two', participant='P02', task='dock'), self.folder('three', participant='P03')
        with self.assertRaisesRegex(StudyError, r"^sessions of different tasks: 'dock' \(.*/two\), 'pick_and_place' "
                                                r'\(.*/one and 1 more\); allowed: sessions of one task$'):
            self.gather()

    def test_a_gravity_and_simulated_operators_may_have_a_task_of_their_own_which_is_said(self):
        self.folder('one'), self.folder('two', simulated=True, task='dock')
        self.assertFalse([note for note in self.gather().notes if 'tasks' in note])
        self.folder('three', gravity=(0, 0, -9.80665), task='dock')
        self.assertIn('the tasks differ between gravities: dock, pick_and_place', self.gather().notes)

    def test_other_conditions_gravities_and_a_simulated_namesake_are_not_the_same(self):
        self.folder('one'), self.folder('two', condition='seed'), self.folder('three', gravity=(0, 0, -9.80665))
        self.folder('four', simulated=True)
        data = self.gather()
        self.assertEqual(len(data.trials), 8)
        self.assertEqual(study_data.parts(data), [(study_data.PEOPLE, 0.0), (study_data.PEOPLE, 1.0),
                                                  (study_data.SIMULATED, 0.0)])

    def test_trials_out_of_time_count_in_counts_alone(self):
        made_up_study.write_session(os.path.join(self.root, 'one'), trials=[
            {'completion_time': 10, 'drops': 0}, {'completion_time': 90, 'drops': 4, 'result': 'timed_out'},
            {'completion_time': 5, 'drops': 9, 'result': 'aborted'}])
        data = self.gather()
        cells = data.cells.set_index('measure')['value']
        self.assertEqual((cells['completion_time'], cells['drops'], cells['completed']), (10.0, 2.0, 0.5))
        self.assertEqual([note.split(':')[0] for note in data.notes],
                         ['1 of 3 trials aborted', '1 of 3 trials out of time', 'no ratings from P01'])


if __name__ == '__main__':
    unittest.main()
