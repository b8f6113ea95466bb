#!/usr/bin/python3
"""What an explanation says of attempts that fail for one known reason each, and that what it says was missing would have held."""

import json
import math
import os
import re
import shutil
import subprocess
import tempfile
import unittest

from pinching import (HALF, LIMIT, MASS, MOVES, PEAK, RADIUS, RATE, REPLAY, STIFFNESS, Attempt, replay, replay_is_built,
                      script)

from runs import losses as finding
from runs.explanation import as_json
from runs.page import page_of
from runs.story import Story
from runs.tables import Run

SLIPPERY, WEAK, OPENING = {'friction': 0.04}, {'overlap': 0.0001}, {'opens_at': 0.9}


class Sweep(Attempt):
    """A finger strikes the cube from one side, and it flies away."""

    def fingers(self, time):
        return [(1, (-HALF - 0.02 - RADIUS + 0.5 * min(time, 0.045), 0.0, 0.0), (0, 1, 0))]

    def offset(self, _):
        return (0.0, 0.0, 0.0)


class Folders(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = holder.name


@unittest.skipUnless(replay_is_built(), 'replay is not built')
class ExplainTest(Folders):
    stories = {}

    def story(self, **changes):
        """Each attempt is replayed once."""
        key = json.dumps(changes, sort_keys=True)
        if key not in self.stories:
            with tempfile.TemporaryDirectory() as folder:
                self.stories[key] = Attempt(**changes).story(folder)
        return self.stories[key]

    def loss(self, **changes):
        """The first loss of the cube."""
        losses = [loss for loss in self.story(**changes).losses if loss.object == 'object']
        self.assertTrue(losses, changes)
        self.assertNotIn('\n', losses[0].text)
        return losses[0]

    def told_again(self, change, **changes):
        """The only loss of a story whose object has been changed."""
        with tempfile.TemporaryDirectory() as folder:
            story = Attempt(**changes).story(folder)
        self.assertEqual(len(story.losses), 1)
        change(story.objects['object'], story.losses[0].until)
        story.losses = []
        finding.add_losses(story)
        self.assertEqual(len(story.losses), 1)
        return story.losses[0]

    def test_what_is_held_to_the_end_has_not_been_lost(self):
        story = self.story()
        self.assertEqual(story.losses, [])
        self.assertEqual(story.objects['object'].state[-1], 'hold')

    def test_each_attempt_fails_for_its_own_reason(self):
        for cause, changes in (('too_little_friction', SLIPPERY), ('too_little_force', WEAK),
                               ('wrong_faces', {'adjacent': True, 'rise': 0.0}), ('tracking_lost', {'unseen': (0.8, 2.0)}),
                               ('tracking_lost', {'missing': (0.8, 1.3)}), ('out_of_bounds', {'bound': 0.1}),
                               ('hand_jumped', {'jumps_at': 1.0}), ('blocked', {'ceiling': 0.1}), ('hand_opened', OPENING),
                               ('impact', {'overlap': 0.0005, 'rise': 0.0, 'ball_speed': 2.0})):
            with self.subTest(cause=cause):
                loss = self.loss(**changes)
                self.assertEqual(loss.cause, cause, loss.text)
                self.assertEqual(loss.by, 'ball' if cause == 'impact' else '')

    def test_what_the_hold_survived_is_no_cause(self):
        """The hand opens soon after the tracker did not see it for a moment, or after a ball hit the cube."""
        for what in ({'unseen': (0.6, 0.63), 'rise': 0.0}, {'ball_speed': 0.5, 'rise': 0.0}):
            self.assertEqual(self.story(**what).losses, [])
            for wait in (0.1, 0.3):
                loss = self.loss(opens_at=0.63 + wait, **what)
                self.assertEqual(loss.cause, 'hand_opened', loss.text)

    def test_a_hand_that_puts_down_opens_also_if_its_fingers_slid_before(self):
        loss = self.loss(ceiling=0.1, rise=0.085, opens_at=1.2)
        self.assertEqual(loss.cause, 'hand_opened', loss.text)
        self.assertLess(float(re.search(r'from ([0-9.]+) s[.,]', loss.text.split('slid before')[1]).group(1)), 1.15)

    def test_an_obstacle_holds_back_with_what_the_hand_gives(self):
        """Friction of two fingers that slide, and no assist."""
        loss = self.loss(ceiling=0.1)
        force = float(re.search(r'held it back with ([0-9.]+) N', loss.text).group(1))
        self.assertAlmostEqual(force, 0.75 * loss.friction * 2.0 * STIFFNESS * Attempt.overlap, delta=0.2 * force)

    def test_the_friction_that_would_have_held_holds(self):
        loss = self.loss(**SLIPPERY)
        self.assertAlmostEqual(loss.load, MASS * PEAK * Attempt.rise, delta=0.02 * loss.load)  # differences over 40 ms
        self.assertEqual(self.story(friction=1.05 * loss.friction_needed).losses, [])
        self.assertTrue(self.story(friction=0.5 * loss.friction_needed).losses)

    def test_the_push_that_would_have_held_holds(self):
        loss = self.loss(**WEAK)
        factor = (loss.push + loss.push_needed) / loss.push
        self.assertEqual(self.story(overlap=1.05 * factor * WEAK['overlap']).losses, [])

    def test_assist_that_was_active_until_shortly_before_gave_way(self):
        def assisted_until(before):
            def change(thing, until):
                thing.assisted = thing.time < until - before
            return self.told_again(change, **WEAK)
        late, early = assisted_until(0.10), assisted_until(0.20)
        self.assertEqual(late.cause, 'assist_ended', late.text)
        self.assertEqual(early.cause, 'too_little_force', early.text)
        for loss in (late, early):
            self.assertIn('(contact/grasp_assist)', loss.text)
        self.assertNotIn('grasp_assist', self.loss(**WEAK).text)

    def test_the_share_of_assist_is_its_force_over_that_and_what_contacts_applied_together(self):
        def change(thing, until):
            thing.assisted = (thing.time > until - 0.3) & (thing.time < until - 0.2)
            thing.assist, thing.carried = 3.0 * thing.assisted, 1.0 + 0.0 * thing.carried
        loss = self.told_again(change, **WEAK)
        self.assertAlmostEqual(loss.assistance.force, 3.0)
        self.assertAlmostEqual(loss.assistance.share, 0.75)
        self.assertLess(loss.assistance.until, loss.until - 0.2)
        self.assertIn('with 3 N on average, 75 % of what acted on it', loss.text)

    def test_a_change_of_the_running_scene_shortly_before_a_loss_is_its_cause(self):
        story = self.story(**WEAK)
        end = min(story.losses[0].until, story.losses[0].grasp_end or math.inf)
        for before, cause in ((0.19, 'changed'), (0.0, 'changed'), (0.21, 'too_little_force'), (-0.01, 'too_little_force')):
            line = '%.3f s: set grasp/object=never' % (end - before)
            with tempfile.TemporaryDirectory() as folder:
                run = Run(Attempt(**WEAK).replay(folder))
                run.summary['live_run'] = {'changes': ['0.100 s: reset', line]}
                story = Story(run)
            finding.add_losses(story)
            self.assertEqual(story.losses[0].cause, cause, story.losses[0].text)
            if cause == 'changed':
                self.assertIn('shortly before, at %s. ' % line, story.losses[0].text)

    def test_a_hand_that_opens_has_opened_also_if_assist_supported_what_it_held(self):
        def change(thing, _):
            thing.assisted[:] = True
        self.assertEqual(self.told_again(change, **OPENING).cause, 'hand_opened')

    def test_fingers_are_told_in_the_order_in_which_they_touched_last(self):
        until = self.loss(**WEAK).until
        first, last = '%.2f s' % (math.floor((until - 0.055) * RATE) / RATE), '%.2f s' % until
        for finger, order in ((0, ('thumb', 'index')), (1, ('index', 'thumb'))):
            def leave(thing, until, finger=finger):
                for i, touches in enumerate(thing.touches):
                    if thing.time[i] > until - 0.055:
                        thing.touches[i] = [touch for touch in touches if touch.finger != finger]
            self.assertIn('Last touches: the %s at %s, then the %s at %s.' % (order[0], first, order[1], last),
                          self.told_again(leave, **WEAK).text)

    def test_what_one_finger_sweeps_away_was_touched_and_is_no_loss(self):
        story = Sweep(until=0.5).story(self.folder)
        self.assertEqual(story.losses, [])
        self.assertEqual([touch.fingers for touch in story.touches], [[1]])
        self.assertGreater(story.touches[0].speed, 0.05)
        self.assertIn('the index touched it', page_of(story))

    def test_pictures_are_wanted_of_the_grasp_and_of_its_end_from_across_the_grip(self):
        story = self.story(**OPENING)
        self.assertEqual([moment.what for moment in story.moments], ['grasp', 'before_loss', 'loss'])
        self.assertAlmostEqual(story.moments[1].time, story.losses[0].until - 0.15, delta=1.1 / RATE)
        for moment in story.moments:
            self.assertEqual(moment.loss, 0)
            self.assertAlmostEqual(abs(moment.across[0]), 1.0, delta=0.05)
        page = page_of(story)
        for number in range(3):
            self.assertIn('<!--picture %d-->' % number, page)

    def test_a_hand_that_opens_is_told_from_when_it_does(self):
        loss = self.loss(**OPENING)
        # A tenth of the way that has let go, in a smooth motion of 0.3 s.
        self.assertTrue(OPENING['opens_at'] < loss.opened < OPENING['opens_at'] + 0.1, loss.opened)

    def test_the_text_says_why_the_event_has_another_time_than_the_last_touch(self):
        story = self.story(**OPENING)
        (end,) = [event.time for event in story.events if event.kind == 'GRASP_END']
        loss = story.losses[0]
        self.assertEqual(loss.grasp_end, end)
        self.assertGreater(end, loss.until)
        self.assertIn('GRASP_END came at %.2f s, %.2f s after the last touch: ' % (end, end - loss.until), loss.text)
        self.assertIsNone(self.loss(adjacent=True, rise=0.0).grasp_end)  # which never was a grasp

    def test_fingers_have_their_forces_utilisations_and_faces(self):
        thing = self.story(until=0.59).objects['object']
        self.assertEqual(len(thing.touches[-1]), 2)
        for touch in thing.touches[-1]:
            self.assertAlmostEqual(touch.normal, STIFFNESS * 0.002, delta=0.02)
            self.assertAlmostEqual(touch.tangential, 0.0, delta=0.01)  # nothing weighs anything, and nothing moves
            self.assertEqual(touch.face, '-x' if touch.finger == 0 else '+x')
            self.assertFalse(touch.slips)
        self.assertAlmostEqual(thing.margin[-1], 0.8 * 2 * 4.0, delta=0.05)
        self.assertGreater(thing.bearable[-1], 100.0)
        self.assertAlmostEqual(thing.half[0], HALF)

    def test_what_slides_bears_its_load_just_once_and_what_holds_more_often(self):
        for slides, changes in ((False, {'overlap': 0.004, 'until': 1.3}), (True, {'friction': 0.04, 'until': 0.8})):
            thing = self.story(**changes).objects['object']
            least = min(thing.bearable[(thing.level == 3) & (thing.time > MOVES)])
            if slides:  # in the step in which it begins to slide by static friction, 4/3 of the dynamic, then by that
                self.assertGreater(least, 0.95 * 3 / 4)  # within what the iteration leaves
                self.assertLess(least, 1.05)
            else:
                self.assertGreater(least, 1.2)

    def test_json_and_page_hold_what_was_found(self):
        story = self.story(**SLIPPERY)
        told = json.loads(json.dumps(as_json(story)))
        self.assertEqual([loss['cause'] for loss in told['losses']], ['too_little_friction'])
        self.assertEqual(told['losses'][0]['text'], story.losses[0].text)
        self.assertLessEqual({'free', 'contact', 'slip', 'drop'}, {part['state'] for part in told['objects'][0]['line']})
        for moment in told['moments']:
            (hand, points), = moment['keypoints'].items()
            hand = story.hands[int(hand)]
            tips = hand.tips[list(hand.frame).index(moment['frame'])]
            self.assertEqual(len(points), 21)
            for finger in (0, 1):  # those that this hand has
                self.assertEqual(points[4 + 4 * finger], [round(x, 6) for x in tips[finger]])
        page = page_of(story)
        self.assertIn('too slippery', page)
        self.assertIn('<h3>object, %.2f s' % story.losses[0].until, page)  # as its text has it
        self.assertIn('<svg', page)
        for other in ('http:', 'https:', 'src=', '<script'):
            self.assertNotIn(other, page)

    def test_charts_of_an_object_end_soon_after_its_last_touch(self):
        story = self.story(until=6.0, **SLIPPERY)
        start, until, end = map(float, re.search(r'Charts show ([\d.]+) to ([\d.]+) s.*?ends at ([\d.]+) s', page_of(story),
                                                 re.DOTALL).groups())
        self.assertLess(until, story.losses[0].until + 1.5)  # the fingers touch it again for a moment
        self.assertLess(start, story.losses[0].start)
        self.assertAlmostEqual(end, 6.0, delta=0.02)


@unittest.skipUnless(replay_is_built(), 'replay is not built')
class CommandsTest(Folders):
    def files(self, folder):
        found = {}
        for name in os.listdir(folder):
            with open(os.path.join(folder, name), 'rb') as file:
                found[name] = file.read()
        return found

    def test_a_folder_is_explained_as_it_is_and_nothing_else_in_it_changes(self):
        """A what-if of a recording: not the recording's own run."""
        output = Attempt().replay(self.folder, '--set', 'material/dynamic_friction=0.01', '--object-pose',
                                  'object,0,0,0.001,0,0,0,1')
        before = self.files(output)
        done = script('explain', output, '--no-pictures')
        self.assertEqual(done.returncode, 0, done.stderr)
        after = self.files(output)
        self.assertEqual(set(after) - set(before), {'explain.html', 'explain.json'})
        for name, content in before.items():
            self.assertEqual(after[name], content, name)
        refused = script('explain', output, '--set', 'gravity=[0,0,-1]')
        self.assertEqual((refused.returncode, refused.stderr.count('\n')), (2, 1), refused.stderr)

    def test_a_bag_of_hands_alone_is_said_to_run_through_the_scene_and_not_to_be_at_fault(self):
        Attempt(until=0.3).replay(self.folder)
        scene, bag, again = (os.path.join(self.folder, name) for name in ('pinch.urdf', 'pinch.bag', 'again'))
        done = replay('--scene', scene, '--input', bag, '--output', again)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("runs the hands of %s through scene 'pinch'" % bag, done.stderr)
        self.assertNotIn('not known', done.stderr)

    def test_stamps_in_another_unit_are_named(self):
        recording = os.path.join(self.folder, 'recording.csv')
        subprocess.run([os.path.join(os.path.dirname(REPLAY), 'synthetic_hand_node'), '--csv', recording, '--motion', 'grasp_cube',
                        '--rate', '60'], check=True, timeout=LIMIT)
        with open(recording, encoding='ascii') as file:
            header, *rows = file.readlines()[:50]
        self.assertTrue(header.startswith('time_s,'))
        for factor, pause, question in ((1000.0, 0.0, 'are these milliseconds or microseconds?'),
                                        (0.001, 0.0, 'are these 1000 times too small?'), (1.0, 0.0, ''), (1.0, 1000.0, '')):
            with self.subTest(factor=factor, pause=pause):
                csv = os.path.join(self.folder, '%g_%g.csv' % (factor, pause))
                with open(csv, 'w', encoding='ascii') as file:
                    file.write(header)
                    for i, row in enumerate(rows):
                        time, rest = row.split(',', 1)
                        file.write('%r,%s' % (factor * float(time) + pause * (i > 25), rest))
                done = replay('--scene', 'cube', '--input', csv, '--output', csv + '.out')
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual('s apart; usual' in done.stderr, bool(question), done.stderr)
                self.assertIn(question, done.stderr)

    def test_a_recording_is_replayed_with_the_options_that_follow_it(self):
        output = Attempt(**OPENING).replay(self.folder)
        shutil.rmtree(output)
        done = script('explain', 'pinch.bag', '--scene', 'pinch.urdf', '--set', 'filter/type=none', '--no-pictures', '--output',
                      'report', cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('hand_opened: object', done.stdout)
        self.assertTrue(done.stdout.endswith('1 lost or released; report/explain.html\n'), done.stdout)
        self.assertTrue(os.path.isfile(os.path.join(self.folder, 'report', 'explain.json')))

    def test_replay_calls_the_scripts(self):
        output = Attempt(**OPENING).replay(self.folder, '--explain', '--export', '50')
        for name in ('explain.html', 'explain.json', 'demonstration.csv', 'demonstration.bag'):
            self.assertTrue(os.path.isfile(os.path.join(output, name)), name)
        same = replay('--compare', output, output)
        self.assertEqual(same.returncode, 0, same.stderr)
        self.assertIn('1 of 1 objects within 1e-09 m and 1e-09 rad in every frame', same.stdout)
        for words in (['--compare', output], ['--compare', output, output, output], ['--scene', 'cube', '--compare'],
                      ['--compare', output, output, '--tolerance', '1e-3'], ['--compare', output, output, '--tolerance', '0,nan']):
            refused = replay(*words)
            self.assertEqual((refused.returncode, refused.stderr.count('\n')), (2, 1), refused.stderr)

    def test_the_markers_of_chosen_frames_are_those_that_a_run_once_more_shows(self):
        import rosbag
        output = Attempt(**OPENING).replay(self.folder)
        with open(os.path.join(output, 'summary.json')) as file:
            summary = json.load(file)
        again = os.path.join(self.folder, 'again')
        done = replay(*summary['arguments'], '--output', again, '--marker-frames', '70,5')
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(again, 'summary.json')) as file:
            self.assertEqual(json.load(file)['state_hash'], summary['state_hash'])
        with rosbag.Bag(os.path.join(again, 'markers.bag')) as bag:
            told = [(topic, message) for topic, message, _ in bag.read_messages()]
        self.assertEqual([message.data for topic, message in told if topic == '/frame'], [5, 70])
        self.assertTrue(all(message.markers for topic, message in told if topic == '/markers'))
        refused = replay(*summary['arguments'], '--output', again, '--marker-frames', '1,x')
        self.assertEqual((refused.returncode, refused.stderr.count('\n')), (2, 1), refused.stderr)


if __name__ == '__main__':
    unittest.main()
