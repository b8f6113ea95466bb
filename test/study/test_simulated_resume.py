"""simulated_study goes on with a session of the same system alone."""

import os
import subprocess
import tempfile
import unittest

import paths  # noqa: F401: does not leave bytecode behind
from test_workflow import programs


@unittest.skipUnless(programs(), 'simulated_study is in no sourced catkin space: source devel/setup.bash')
class Resume(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.root = holder.name
        self.trials = os.path.join(self.root, 'study', 'implicit_0g', 'P01', 'trials.csv')

    def run_study(self, *arguments):
        done = subprocess.run([os.path.join(programs(), 'simulated_study'), '--output', os.path.join(self.root, 'study'),
                               '--operators', '1', '--model', 'implicit', '--gravity', '0', *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        return done.returncode, done.stderr

    def test_the_same_goes_on_and_another_is_refused_in_one_line(self):
        self.assertEqual(self.run_study(), (0, ''))
        with open(self.trials) as file:
            played = file.read()
        self.assertEqual(self.run_study(), (0, ''))
        task = os.path.join(self.root, 'pick_and_place.yaml')
        kept = os.path.join(os.path.dirname(self.trials), 'setup', 'task.yaml')
        with open(kept) as file, open(task, 'w') as edited:
            edited.write(file.read().replace('hold: 3.0', 'hold: 2.5'))
        for arguments, words in ((('--set', 'contact/edge_grip=false'), ("'contact/edge_grip: true'", "grip: false'")),
                                 (('--task', task), ('setup/task.yaml:', 'hold: 2.5'))):
            status, said = self.run_study(*arguments)
            self.assertEqual((status, said.count('\n')), (1, 1), said)
            for word in words:
                self.assertIn(word, said)
        with open(self.trials) as file:
            self.assertEqual(file.read(), played)


if __name__ == '__main__':
    unittest.main()
