"""The Snakemake workflow: what it plans, and a small study and batch of replays run here."""

import collections
import csv
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import paths  # noqa: F401: does not leave bytecode behind

WORKFLOW = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'workflow')
SUMMARY = '{"frames": 7, "step_time_us": {"p50": 1, "p99": 2}, "events": {}, "objects_held_at_end": []}'
SNAKEMAKE = shutil.which('snakemake')


def programs():
    """The folder of the programs in a sourced catkin space, or nothing."""
    for prefix in os.environ.get('CMAKE_PREFIX_PATH', '').split(os.pathsep):
        folder = os.path.join(prefix, 'lib', 'mr_hand_interaction')
        if os.path.exists(os.path.join(folder, 'simulated_study')):
            return folder
    return None


def columns():
    names = ['time_s', 'frame_id', 'hand_id', 'is_left', 'confidence', 'grab_strength', 'pinch_strength']
    names += [what + axis for what in ('palm', 'palm_normal', 'palm_dir', 'palm_vel', 'wrist', 'elbow')
              for axis in ('_x', '_y', '_z')] + ['palm_width']
    for finger in ('thumb', 'index', 'middle', 'ring', 'pinky'):
        names.append(finger + '_width')
        names += ['%s_j%d%s' % (finger, j, axis) for j in range(5) for axis in ('_x', '_y', '_z')]
    return names


@unittest.skipUnless(SNAKEMAKE, 'no snakemake here: apt-get install snakemake')
class Workflow(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.root = holder.name

    def write(self, name, text):
        with open(os.path.join(self.root, name), 'w', encoding='utf-8') as file:
            file.write(text)
        return os.path.join(self.root, name)

    def write_recording(self, name):
        """A second without a hand in view."""
        names = columns()
        rows = [','.join(names)] + ['%.3f,%d,-1%s' % (0.01 * i, i, ',' * (len(names) - 3)) for i in range(100)]
        return self.write(name, '\n'.join(rows) + '\n')

    def configure(self, **config):
        config.setdefault('output', 'out')
        return self.write('config.json', json.dumps(config))

    def snakemake(self, *arguments):
        environment = dict(os.environ, HOME=self.root, XDG_CACHE_HOME=self.root)
        return subprocess.run(self.command(*arguments), env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True)

    def command(self, *arguments):
        return [SNAKEMAKE, '-s', os.path.join(WORKFLOW, 'Snakefile'), '--directory', self.root,
                '--configfile', os.path.join(self.root, 'config.json')] + list(arguments or ['--cores', '1'])

    def planned(self):
        """Jobs that are left to do, by rule."""
        done = self.snakemake('--dry-run', '--quiet', '--cores', '1')
        self.assertEqual(done.returncode, 0, done.stdout)
        rows = [line.split() for line in done.stdout.splitlines()]  # job and count; the other way round before 6
        rows = [row for row in rows if len(row) in (2, 4) and any(map(str.isdigit, row))]
        return collections.Counter({next(word for word in row if not word.isdigit()): int(next(filter(str.isdigit, row)))
                                    for row in rows})

    def rows(self, *name):
        with open(os.path.join(self.root, *name), encoding='utf-8') as file:
            return list(csv.DictReader(file))

    def test_dry_run_plans_each_batch_of_operators_under_each_condition(self):
        self.configure(study={'operators': 12, 'batch': 5, 'models': ['implicit', 'seed'], 'gravities': [0, 1]})
        planned = self.planned()
        self.assertEqual([planned[rule] for rule in ('operators', 'analyse', 'replay')], [3 * 2 * 2, 1, 0])

    def test_dry_run_plans_each_recording_scene_and_setting(self):
        recordings = [self.write_recording(name) for name in ('a.csv', 'b.csv', 'c.csv')]
        self.configure(study={'operators': 0}, replay={
            'recordings': recordings, 'scenes': ['cube', 'ball'],
            'settings': {'default': {}, 'raw': {'filter/type': 'none'}}})
        planned = self.planned()
        self.assertEqual([planned[rule] for rule in ('replay', 'replay_table', 'operators')], [3 * 2 * 2, 1, 0])

    def test_two_recordings_of_one_name_are_refused(self):
        os.mkdir(os.path.join(self.root, 'x'))
        recordings = [self.write_recording('a.csv'), self.write_recording(os.path.join('x', 'a.csv'))]
        self.configure(study={'operators': 0}, replay={'recordings': recordings})
        done = self.snakemake('--dry-run', '--cores', '1')
        self.assertNotEqual(done.returncode, 0)
        self.assertIn('have the same name', done.stdout)

    def test_dry_run_plans_each_seed(self):
        self.configure(study={'operators': 4, 'batch': 4, 'models': ['implicit'], 'gravities': [0], 'seed': [1, 2, 3]})
        self.assertEqual(self.planned()['operators'], 3)

    def test_each_job_runs_on_a_node_of_its_own(self):
        """The profile `separate`: an empty folder and environment for each job, as on a cluster."""
        fake = self.write('replay', '#!/bin/sh\nwhile [ "$1" != --output ]; do shift; done\nmkdir -p "$2"\n'
                          'echo \'%s\' > "$2/summary.json"\npwd > "$2/node.txt"\n' % SUMMARY)
        os.chmod(fake, 0o755)
        self.configure(programs=self.root, study={'operators': 0}, replay={
            'recordings': [self.write_recording('a.csv')], 'scenes': ['cube', 'ball']})
        done = self.snakemake('--profile', os.path.join(WORKFLOW, 'profiles', 'separate'))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual([row['frames'] for row in self.rows('out', 'replays.csv')], ['7', '7'])
        self.assertEqual(done.stdout.count('Submitted job'), 3, done.stdout)

    def test_after_a_kill_it_wants_to_be_unlocked_and_then_goes_on(self):
        fake = self.write('replay', '#!/bin/sh\nwhile [ "$1" != --output ]; do shift; done\nmkdir -p "$2"\n'
                          'touch "%s/begun"\n[ -e "%s/let" ] || exec sleep 600\necho \'%s\' > "$2/summary.json"\n'
                          % (self.root, self.root, SUMMARY))
        os.chmod(fake, 0o755)
        self.configure(programs=self.root, study={'operators': 0}, replay={'recordings': [self.write_recording('a.csv')]})
        environment = dict(os.environ, HOME=self.root, XDG_CACHE_HOME=self.root)
        running = subprocess.Popen(self.command(), env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   start_new_session=True)
        deadline = time.monotonic() + 300
        while not os.path.exists(os.path.join(self.root, 'begun')) and time.monotonic() < deadline:
            time.sleep(0.1)
        os.killpg(running.pid, signal.SIGKILL)
        running.wait()
        self.write('let', '')
        done = self.snakemake('--rerun-incomplete', '--cores', '1')
        self.assertNotEqual(done.returncode, 0)
        self.assertIn('--unlock', done.stdout)
        self.assertEqual(self.snakemake('--unlock', '--cores', '1').returncode, 0)
        done = self.snakemake('--rerun-incomplete', '--cores', '1')
        self.assertEqual(done.returncode, 0, done.stdout)

    @unittest.skipUnless(programs(), 'simulated_study is in no sourced catkin space: source devel/setup.bash')
    def test_a_small_run_makes_one_table_of_each_and_goes_on_where_it_was(self):
        self.configure(programs=programs(), study={'operators': 2, 'group_size': 1, 'batch': 1, 'models': ['implicit'],
                                                   'gravities': [0]},
                       replay={'recordings': [self.write_recording('empty.csv')], 'scenes': ['cube', 'ball'],
                               'settings': {'default': {}, 'raw': {'filter/type': 'none'}}})
        done = self.snakemake()
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual({row['condition'] for row in self.rows('out', 'results', 'comparison.csv')}, {'implicit'})
        self.assertEqual({(row['recording'], row['scene'], row['setting'], row['frames'])
                          for row in self.rows('out', 'replays.csv')},
                         {('empty', scene, setting, '100')
                          for scene in ('cube', 'ball') for setting in ('default', 'raw')})
        self.assertEqual(self.planned()['all'], 0)
        for lost in (('sessions', 'seed_1', 'implicit', '0g', 'from_2'), ('results',)):
            shutil.rmtree(os.path.join(self.root, 'out', *lost))
        planned = self.planned()
        self.assertEqual([planned[rule] for rule in ('operators', 'replay')], [1, 0])


if __name__ == '__main__':
    unittest.main()
