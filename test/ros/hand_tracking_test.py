#!/usr/bin/env python3
"""hand_tracking_node: what comes in as leap_motion/Human or PoseArray goes out as hand_frame in world."""
import contextlib
import math
import os
import subprocess
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Pose, PoseArray, TransformStamped
from tf2_msgs.msg import TFMessage

from mr_hand_interaction.msg import Hand, HandFrame

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import leap_messages  # noqa: E402
from waiting import wait_until  # noqa: E402

LEAP_TOPIC = "/leap_motion/leap_device"


def to_world(point):
    """The mount of this test: 0.1, 0.2, 0.3 and +90 degrees about x."""
    return (point[0] + 0.1, -point[2] + 0.2, point[1] + 0.3)


def mount():
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id = "world", "leap_hands"
    transform.transform.translation.x, transform.transform.translation.y = 0.1, 0.2
    transform.transform.translation.z = 0.3
    transform.transform.rotation.x = transform.transform.rotation.w = math.sqrt(0.5)
    return TFMessage([transform])


class HandTrackingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("hand_tracking_test")
        cls.frames, cls.counts, cls.reported = [], {}, rospy.Time()
        cls.next_stamp = 1000.0
        cls.transforms = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        cls.transforms.publish(mount())
        cls.subscribers = [rospy.Subscriber("hand_frame", HandFrame, cls.frames.append),
                           rospy.Subscriber("/diagnostics", DiagnosticArray, cls.take_diagnostics)]
        cls.types = leap_messages.classes("head")
        cls.leap = cls.connected_leap()
        cls.pose_arrays = rospy.Publisher("hands/pose_array", PoseArray, queue_size=10)
        wait_until(lambda: cls.counts, "diagnostics")
        cls.send_until_placed()

    @classmethod
    def take_diagnostics(cls, message):
        for status in message.status:
            if "hand input" in status.name:
                cls.counts.update({value.key: float(value.value) for value in status.values})
                cls.reported = message.header.stamp

    @classmethod
    def connected_leap(cls):
        publisher = rospy.Publisher(LEAP_TOPIC, cls.types["leap_motion/Human"], queue_size=10)
        wait_until(lambda: publisher.get_num_connections() > 0, "a subscriber of " + LEAP_TOPIC)
        return publisher

    @classmethod
    def send_until_placed(cls):
        """The mount and the connections take a moment to arrive."""
        def placed():
            cls.leap.publish(cls.human())
            return cls.frames
        wait_until(placed, "a hand_frame")
        cls.answer(cls.human())
        wait_until(lambda: cls.pose_arrays.get_num_connections() > 0, "a subscriber of hands/pose_array")

    @contextlib.contextmanager
    def driver(self, version):
        """A node of its own (a node has one type to a topic) that publishes one frame. Gives its stamp."""
        self.step_stamp()
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "leap_messages.py")
        command = [sys.executable, script, version, str(self.next_stamp)]
        process = subprocess.Popen(command, stdin=subprocess.PIPE)
        try:
            yield rospy.Time.from_sec(self.next_stamp)
        finally:
            process.communicate(b"")

    @contextlib.contextmanager
    def without_own_driver(self):
        """For a driver of another version: there is one at a time."""
        self.leap.unregister()
        yield
        type(self).leap = self.connected_leap()

    @classmethod
    def step_stamp(cls):
        cls.next_stamp += 0.01

    @classmethod
    def human(cls, sides=("right",), frame_id="leap_hands"):
        cls.step_stamp()
        return leap_messages.human(cls.types, cls.next_stamp, sides, frame_id)

    @classmethod
    def frame_at(cls, stamp):
        def found():
            return [frame for frame in list(cls.frames) if frame.header.stamp == stamp]
        wait_until(found, "the hand_frame at %s" % stamp.to_sec())
        return found()[-1]

    @classmethod
    def answer(cls, message, publisher=None):
        """The hand_frame with the message's stamp."""
        (publisher or cls.leap).publish(message)
        return cls.frame_at(message.header.stamp)

    @contextlib.contextmanager
    def expect_rejected(self, reason):
        """What is sent inside is counted once under its reason, and no hand_frame comes of it."""
        key = "rejected: " + reason
        self.assertIn(key, self.counts)
        # Counts come once a second: those of earlier tests must be in.
        now = rospy.Time.now()
        wait_until(lambda: self.reported >= now, "diagnostics")
        before, frames = self.counts[key], len(self.frames)
        yield
        wait_until(lambda: self.counts[key] > before, key)
        self.assertEqual(self.counts[key], before + 1)
        self.answer(self.human())
        self.assertEqual(len(self.frames), frames + 1)

    def assert_near(self, point, expected, tolerance=1e-9):
        for a, b in zip((point.x, point.y, point.z), expected):
            self.assertAlmostEqual(a, b, delta=tolerance)

    def assert_in_world(self, hand, side, wrist_tolerance=1e-7):  # the wrist travels as float32
        palm, wrist, chains = leap_messages.open_hand(side)
        self.assertEqual(hand.side, Hand.RIGHT if side == "right" else Hand.LEFT)
        self.assert_near(hand.wrist, to_world(wrist), wrist_tolerance)
        for phalanx in hand.phalanges:
            chain = chains[phalanx.finger]
            self.assert_near(phalanx.end, to_world(chain[phalanx.bone + 1]))
            self.assertFalse(phalanx.touching)
        return palm

    def test_definitions_are_the_published_ones(self):
        for version, md5 in leap_messages.MD5.items():
            self.assertEqual(leap_messages.classes(version)["leap_motion/Human"]._md5sum, md5)

    def test_every_version_is_placed_in_world_alike(self):
        hands = []
        frames = []
        with self.without_own_driver():
            for version in leap_messages.MD5:
                with self.driver(version) as stamp:
                    frames.append(self.frame_at(stamp))
        for frame in frames:
            self.assertEqual(frame.header.frame_id, "world")
            self.assertEqual([hand.id for hand in frame.hands], [21, 22])
            for hand, side in zip(frame.hands, ("right", "left")):
                palm = self.assert_in_world(hand, side)
                self.assert_near(hand.palm.position, to_world(palm))
                self.assertEqual(len(hand.phalanges), 19)
                self.assertAlmostEqual(hand.confidence, 0.75)
                # Fingers away from the user, +y in world; the back of the hand up.
                self.assertGreater(hand.palm.orientation.z, 0.69)
                self.assertGreater(hand.palm.orientation.w, 0.69)
            hands.append(str(frame.hands))
        self.assertEqual(len(set(hands)), 1, "the versions differ")

    def test_pose_array_is_a_hand(self):
        self.step_stamp()
        message = PoseArray()
        message.header.stamp, message.header.frame_id = rospy.Time.from_sec(self.next_stamp), "leap_hands"
        _, wrist, chains = leap_messages.open_hand("left")
        for point in [wrist] + [joint for chain in chains for joint in chain[1:]]:
            pose = Pose()
            leap_messages.set_point(pose.position, point)
            message.poses.append(pose)
        frame = self.answer(message, self.pose_arrays)
        self.assertEqual(len(frame.hands), 1)
        self.assert_in_world(frame.hands[0], "left")
        message.poses.pop()
        with self.expect_rejected("wrong finger or bone count"):
            self.pose_arrays.publish(message)

    def test_frames_without_hands_are_published(self):
        self.assertEqual(self.answer(self.human(())).hands, [])

    def test_a_hand_with_nan_is_dropped_and_the_other_stays(self):
        both = self.human(("right", "left"))
        both.left_hand.finger_list[1].bone_list[2].bone_end.position.y = float("nan")
        self.assertEqual([hand.id for hand in self.answer(both).hands], [21])
        alone = self.human()
        alone.right_hand.palm_center.x = float("nan")
        with self.expect_rejected("unusable hand"):
            self.leap.publish(alone)

    def test_wrong_finger_count_is_rejected(self):
        message = self.human()
        message.right_hand.finger_list.append(message.right_hand.finger_list[0])
        with self.expect_rejected("wrong finger or bone count"):
            self.leap.publish(message)

    def test_stamps_that_repeat_or_go_back_are_rejected(self):
        good = self.human()
        self.answer(good)
        with self.expect_rejected("stamp repeats or goes back"):
            self.leap.publish(good)
        late = self.human()
        late.header.stamp -= rospy.Duration(0.2)
        with self.expect_rejected("stamp repeats or goes back"):
            self.leap.publish(late)

    def test_a_stamp_that_is_no_time_is_rejected_and_the_next_frame_is_taken(self):
        for seconds in (4294967295, 4000000000):
            wrong = self.human()
            wrong.header.stamp = rospy.Time(seconds)
            with self.expect_rejected("stamp out of range"):
                self.leap.publish(wrong)

    def test_unknown_version_is_rejected(self):
        with self.expect_rejected("unknown message version"), self.without_own_driver(), self.driver("text"):
            wait_until(lambda: self.counts["rejected: unknown message version"] > 0, "the count")

    def test_unknown_frame_is_rejected(self):
        with self.expect_rejected("no transform"):
            self.leap.publish(self.human(frame_id="nowhere"))

    def test_a_transform_far_from_its_others_is_left_out_and_the_mount_goes_on(self):
        moving = rospy.Publisher("/tf", TFMessage, queue_size=10)
        wait_until(lambda: moving.get_num_connections() > 0, "a subscriber of /tf")

        def place(x, stamp):
            message = mount()
            message.transforms[0].header.stamp, message.transforms[0].child_frame_id = stamp, "arm"
            message.transforms[0].transform.translation.x = x
            moving.publish(message)

        def goes_to(x):
            """Messages of two topics may change places: a hand may be there before its transform."""
            place(x, rospy.Time.from_sec(self.next_stamp))
            on_arm = self.human(frame_id="arm")
            self.leap.publish(on_arm)
            self.answer(self.human())
            return any(abs(hand.wrist.x - wrist_x - x) < 1e-6 for frame in list(self.frames)
                       if frame.header.stamp == on_arm.header.stamp for hand in frame.hands)

        wrist_x = leap_messages.open_hand("right")[1][0]
        self.answer(self.human())
        wait_until(lambda: goes_to(0.5), "the arm")
        for stamp in (rospy.Time(4294967295, 999999999), rospy.Time.from_sec(self.next_stamp + 3600.0)):
            with self.expect_rejected("unusable transform"):
                place(9.0, stamp)
        wait_until(lambda: goes_to(0.6), "the arm where it has gone")

    def test_unset_stamp_becomes_the_time_of_receipt(self):
        before, frames = rospy.Time.now(), len(self.frames)
        message = self.human()
        message.header.stamp = rospy.Time()
        self.leap.publish(message)
        wait_until(lambda: len(self.frames) > frames, "a hand_frame")
        self.assertGreaterEqual(self.frames[-1].header.stamp, before)
        self.answer(self.human())  # back to recorded time: a restart


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "hand_tracking", HandTrackingTest)
