#!/usr/bin/python3
"""A demonstration says the same as the tables that it is made of, at any rate."""

import csv
import json
import math
import os
import tempfile
import unittest

import numpy

from pinching import SUMMARY, Attempt, replay_is_built, script, write_tables

from runs.demonstration import Body, demonstration_of, joint_angles, keypoints
from runs.tables import Run, RunError


class TablesTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = holder.name

    def demonstration(self, **tables):
        write_tables(self.folder, **tables)
        with open(os.path.join(self.folder, 'summary.json'), 'w') as file:
            json.dump(dict(SUMMARY, input='a.csv'), file)
        return demonstration_of(Run(self.folder))

    def test_positions_go_on_straight_lines_and_rotations_the_shortest_way(self):
        quarter = math.sin(math.pi / 4.0)
        demonstration = self.demonstration(
            frames=[{'frame': 0, 'stamp': 0}, {'frame': 1, 'stamp': 20000000}],
            objects=[{'name': 'cube', 'qw': 1, 'frame': 0, 'held': 1},
                     {'name': 'cube', 'px': 0.4, 'qz': -quarter, 'qw': -quarter, 'frame': 1}]).at_rate(100.0)
        self.assertEqual(demonstration.stamps.tolist(), [0, 10000000, 20000000])
        cube = demonstration.objects['cube']
        self.assertAlmostEqual(cube.pose[1, 0], 0.2, 15)
        self.assertAlmostEqual(2.0 * math.atan2(cube.pose[1, 5], cube.pose[1, 6]), math.pi / 4.0, 12)
        self.assertEqual(cube.held.tolist(), [1, 1, 0])  # what acts is that of the frame before

    def test_the_wrench_is_of_all_contacts_about_the_centre_of_mass(self):
        demonstration = self.demonstration(
            frames=[{'frame': 0, 'stamp': 5}],
            objects=[{'name': name, 'px': 1, 'qw': 1, 'frame': 0} for name in ('ball', 'cube')],
            contacts=[{'object': 'cube', 'x': 1, 'y': 0.1, 'fz': 2, 'frame': 0}, {'object': 'cube', 'x': 1.2, 'fy': 3, 'frame': 0}])
        numpy.testing.assert_allclose(demonstration.objects['cube'].wrench, [[0, 3, 2, 0.2, 0, 0.6]], atol=1e-15)
        self.assertFalse(demonstration.objects['ball'].wrench.any())

    def test_forces_are_means_since_the_row_before_with_impulses(self):
        demonstration = self.demonstration(
            frames=[{'frame': i, 'stamp': 10000000 * i} for i in range(5)],
            objects=[{'name': 'cube', 'qw': 1, 'frame': i} for i in range(5)],
            contacts=[{'object': 'cube', 'x': 0.1, 'fy': 2, 'frame': 2}, {'object': 'cube', 'x': 0.1, 'jy': 0.03, 'frame': 3}])
        numpy.testing.assert_allclose(demonstration.objects['cube'].wrench[:, 1], [0, 0, 2, 3, 0], atol=1e-12)
        for rate, forces in ((50.0, [0, 1, 1.5]), (200.0, [0, 0, 0, 2, 2, 3, 3, 0, 0]), (40.0, [0, 1.4])):
            wrench = demonstration.at_rate(rate).objects['cube'].wrench
            numpy.testing.assert_allclose(wrench[:, 1], forces, atol=1e-12)
            numpy.testing.assert_allclose(wrench[:, 5], 0.1 * wrench[:, 1], atol=1e-12)

    def test_an_event_is_told_at_the_first_time_after_it_and_cells_of_what_is_not_there_are_empty(self):
        demonstration = self.demonstration(
            frames=[{'frame': i, 'stamp': 9000000 * i} for i in range(4)],
            objects=[{'name': 'cube', 'qw': 1, 'frame': 2}],
            events=[{'kind': 'HAND_FOUND', 'frame': 0}, {'kind': 'GRASP_BEGIN', 'object': 'cube', 'frame': 1},
                    {'kind': 'GRASP_END', 'object': 'cube', 'frame': 3}])
        self.assertEqual(demonstration.at_rate(100.0).table()['events'].tolist(), ['HAND_FOUND', 'GRASP_BEGIN cube', ''])
        rows = list(csv.DictReader(demonstration.table().to_csv(index=False).splitlines()))
        self.assertEqual([row['cube.px'] for row in rows], ['', '', '0.0', ''])
        self.assertEqual(rows[1]['cube.held'], '')

    def test_of_a_recording_that_begins_anew_the_last_part_counts(self):
        demonstration = self.demonstration(
            frames=[{'frame': 0, 'stamp': 50}, {'frame': 1, 'stamp': 60}, {'frame': 2, 'stamp': 10}, {'frame': 3, 'stamp': 20}],
            objects=[{'name': 'cube', 'px': i, 'qw': 1, 'frame': i} for i in range(4)])
        self.assertEqual(demonstration.stamps.tolist(), [10, 20])
        self.assertEqual(demonstration.objects['cube'].pose[:, 0].tolist(), [2.0, 3.0])

    def test_rows_of_frames_that_are_not_there_are_named(self):
        with self.assertRaisesRegex(RunError, r'frames.csv: has no frame; allowed: '):
            self.demonstration()
        with self.assertRaisesRegex(RunError, r'objects.csv: has a row of frame 7; allowed: 0 to 0, those of frames.csv'):
            self.demonstration(frames=[{'frame': 0}], objects=[{'name': 'cube', 'frame': 7}])

    def test_joints_are_bent_by_the_angle_between_their_bones(self):
        bones = Body(1).bones[0]
        bones[4:7] = [[0, 0, 0, 0.06, 0, 0], [0.06, 0, 0, 0.1, 0, 0], [0.1, 0, 0, 0.1, 0, -0.03]]
        angles = joint_angles(bones)
        self.assertEqual(sorted(angles), ['index_1', 'index_2'])
        self.assertAlmostEqual(angles['index_1'], 0.0, 12)
        self.assertAlmostEqual(angles['index_2'], 0.5 * math.pi, 12)


    def test_keypoints_are_the_wrist_and_the_ends_of_the_bones_thumb_first(self):
        bones = Body(2).bones
        bones[0] = numpy.arange(120).reshape(20, 6)
        points = keypoints(bones)
        self.assertEqual(points.shape, (2, 21, 3))
        numpy.testing.assert_array_equal(points[0, 1:], bones[0, :, 3:])
        numpy.testing.assert_array_equal(points[0, 0], bones[0, [4, 8, 12, 16], :3].mean(axis=0))
        self.assertTrue(numpy.isnan(points[1]).all())
        bones[0, 8] = numpy.nan  # a finger that is not seen
        numpy.testing.assert_array_equal(keypoints(bones)[0, 0], bones[0, [4, 12, 16], :3].mean(axis=0))


@unittest.skipUnless(replay_is_built(), 'replay is not built')
class ReplayTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.output = Attempt(opens_at=0.9).replay(holder.name)

    def test_events_and_the_path_stay_the_same_at_another_rate(self):
        own = demonstration_of(Run(self.output))
        even = own.at_rate(100.0)
        told = [[event for frame in demonstration.events for event in frame] for demonstration in (own, even)]
        self.assertIn('GRASP_BEGIN object', told[0])
        self.assertEqual(told[0][:len(told[1])], told[1])
        self.assertEqual(set(numpy.diff(even.stamps)), {10000000})
        for stamp, pose in zip(even.stamps, even.objects['object'].pose):
            nearest = int(numpy.argmin(numpy.abs(own.stamps - stamp)))
            apart = numpy.linalg.norm(pose[:3] - own.objects['object'].pose[nearest, :3])
            self.assertLessEqual(apart, 1e-9 * abs(own.stamps[nearest] - stamp) + 1e-6)  # no faster than 1 m/s

    def test_forces_give_the_object_its_momentum_at_any_rate(self):
        run = Run(self.output)
        self.assertTrue((run.contacts[['jx', 'jy', 'jz']] != 0.0).any(axis=None))
        own = demonstration_of(run)
        end = run.objects.iloc[-1]
        momentum = run.bodies['mass'].iloc[0] * end[['vx', 'vy', 'vz']].to_numpy(float)
        for rate in (0.0, 7.0, 30.0, 1000.0):
            rows = own.at_rate(rate) if rate else own
            given = (rows.objects['object'].wrench[1:, :3] * numpy.diff(rows.stamps)[:, None] / 1e9).sum(axis=0)
            numpy.testing.assert_allclose(given, momentum, atol=1e-3 * numpy.linalg.norm(momentum))

    def test_table_and_bag_hold_what_carries_the_object(self):
        import rosbag
        done = script('export', self.output, '--rate', '100')
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.output, 'demonstration.csv')) as file:
            rows = list(csv.DictReader(file))
        self.assertIn('right.index_3.x', rows[0])
        self.assertNotIn('left.palm.px', rows[0])
        self.assertEqual({row['object.held'] for row in rows}, {'0', '1'})
        with rosbag.Bag(os.path.join(self.output, 'demonstration.bag')) as bag:
            self.assertEqual({topic.msg_type for topic in bag.get_type_and_topic_info()[1].values()}, {
                'geometry_msgs/PoseArray', 'geometry_msgs/PoseStamped', 'geometry_msgs/WrenchStamped', 'sensor_msgs/JointState', 'std_msgs/String',
                'tf2_msgs/TFMessage'})
            self.assertEqual(bag.get_message_count('/demonstration/object/pose'), len(rows))
            _, keypoint, _ = next(bag.read_messages('/demonstration/right_hand/keypoints'))
        tip = keypoint.poses[8].position  # of the index, which the table has in the hand's first row
        first = next(row for row in rows if row['right.index_3.x'])
        self.assertAlmostEqual(tip.x, float(first['right.index_3.x']), 9)
        self.assertTrue(math.isnan(keypoint.poses[0].position.z))  # this hand has no metacarpals
        self.assertEqual((len(keypoint.poses), first['right.wrist.z']), (21, ''))
        for rate in ('0.5', '1001', 'x', 'nan'):
            refused = script('export', self.output, '--rate', rate)
            self.assertEqual((refused.returncode, refused.stderr.count('\n')), (2, 1), refused.stderr)

    def test_hdf5_has_lerobot_s_fields_and_the_table_s_numbers(self):
        try:
            import h5py
        except ImportError:
            self.skipTest('python3-h5py is not installed')
        done = script('export', self.output, '--rate', '50', '--hdf5')
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.output, 'demonstration.csv')) as file:
            rows = list(csv.DictReader(file))
        with h5py.File(os.path.join(self.output, 'demonstration.hdf5'), 'r') as file:
            self.assertEqual(set(file), {'observation.state', 'observation.environment_state', 'action', 'timestamp', 'frame_index',
                                         'episode_index', 'index', 'task_index', 'next.done'})
            self.assertEqual({len(file[name]) for name in file}, {len(rows)})
            self.assertAlmostEqual(file.attrs['fps'], 50.0, 6)
            self.assertEqual(file['next.done'][:].tolist(), [False] * (len(rows) - 1) + [True])
            state, names = file['observation.state'][:], list(file['observation.state'].attrs['names'])
            self.assertEqual(len(names), 7 + 63)
            numpy.testing.assert_array_equal(file['action'][:-1], state[1:])
            tip = [float(row['right.index_3.y'] or 'nan') for row in rows]
            numpy.testing.assert_allclose(state[:, names.index('right.index_3.y')], tip, atol=1e-6)
            things = file['observation.environment_state']
            held = things[:, list(things.attrs['names']).index('object.held')]
            self.assertEqual(held.tolist(), [float(row['object.held']) for row in rows])
            self.assertIn('GRASP_BEGIN object', file.attrs['events'])


if __name__ == '__main__':
    unittest.main()
