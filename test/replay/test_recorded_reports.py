#!/usr/bin/python3
"""Reports on replays of recorded people's hands have no figure that is none, and a row for each frame."""

import glob
import json
import os
import tempfile
import unittest

from pinching import PACKAGE, replay, replay_is_built

from runs.demonstration import demonstration_of
from runs.explanation import as_json, explained
from runs.page import page_of
from runs.tables import Run

FOLDER = os.environ.get('MR_HAND_RECORDINGS') or os.path.join(PACKAGE, '..', 'shared', 'recordings')
RECORDINGS = [path for path in sorted(glob.glob(os.path.join(FOLDER, '*.csv'))) if os.path.basename(path) != 'MANIFEST.csv']
SCENES = ('cube', 'cube_on_table', 'mixed')
MAX_PAGES = 2  # of runs with losses, which take longest


@unittest.skipUnless(replay_is_built(), 'replay is not built')
@unittest.skipUnless(RECORDINGS, 'no recordings in %s: set MR_HAND_RECORDINGS to their folder' % FOLDER)
class RecordingsTest(unittest.TestCase):
    def test_every_recording_is_reported_on(self):
        losses = pages = 0
        for i, recording in enumerate(RECORDINGS):
            with self.subTest(recording=recording), tempfile.TemporaryDirectory() as folder:
                done = replay('--scene', SCENES[i % len(SCENES)], '--input', recording, '--output', folder)
                self.assertEqual(done.returncode, 0, done.stderr)
                run = Run(folder)
                story = explained(run)
                told = json.dumps(as_json(story), allow_nan=False)
                losses += len(story.losses)
                for loss in story.losses:
                    self.assertNotRegex(loss.text, r'\b(nan|inf)\b')
                    self.assertIn(loss.cause, told)
                if story.losses and pages < MAX_PAGES:
                    pages += 1
                    self.assertIn(story.losses[0].object, page_of(story))
                self.assertEqual(len(demonstration_of(run).table()), run.summary['frames'])
        self.assertGreater(losses, 0)


if __name__ == '__main__':
    unittest.main()
