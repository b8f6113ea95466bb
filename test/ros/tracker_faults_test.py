#!/usr/bin/env python3
"""What trackers do to hand_tracking_node: placeholders, orders, units, clocks that step. Each test has a topic of its own,
which makes it a tracker of its own."""
import math
import os
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, Pose, PoseArray, Vector3
from sensor_msgs.msg import ChannelFloat32, PointCloud

from mr_hand_interaction.msg import Hand, HandFrame, LeapControllerBone, LeapControllerFinger, LeapControllerHand

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import leap_messages  # noqa: E402
from waiting import wait_until  # noqa: E402

PERIOD = 0.01  # s between frames


def joints(side="right"):
    """In the order of MediaPipe; in front of the origin, where no joint is a placeholder."""
    _, wrist, chains = leap_messages.open_hand(side)
    return [wrist] + [joint for chain in chains for joint in chain[1:]]


def in_manos_order(points):
    order = [0] + [1 + 4 * f + k for f in (1, 2, 4, 3, 0) for k in range(3)] + [4 + 4 * f for f in range(5)]
    return [points[i] for i in order]


class ControllerHand(LeapControllerHand):
    _type = "leap_motion_controller/Hand"


class TrackerFaultsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("tracker_faults_test")
        cls.frames, cls.counts, cls.last = [], {}, {}
        cls.subscribers = [rospy.Subscriber("hand_frame", HandFrame, cls.frames.append, queue_size=1000),
                           rospy.Subscriber("/diagnostics", DiagnosticArray, cls.take_diagnostics)]
        wait_until(lambda: cls.counts, "diagnostics")

    @classmethod
    def take_diagnostics(cls, message):
        for status in message.status:
            if "hand input" in status.name:
                cls.counts.update({value.key: float(value.value) for value in status.values})
                cls.last.update({value.key: status.message for value in status.values})

    def wait_for_count(self, key, count):
        wait_until(lambda: self.counts.get(key) == count, "%s: %g" % (key, count))

    @staticmethod
    def pose_array(points, stamp=None):
        message = PoseArray(poses=[Pose(position=Point(*point)) for point in points])
        message.header.stamp, message.header.frame_id = stamp or rospy.Time.now(), "world"
        return message

    def play(self, topic, count, message_of, kind=PoseArray, frames=None, refused=0):
        """The hand_frames that come of as many messages, evenly. The publisher stays until all have been taken or refused, as
        what it has not sent yet goes with it."""
        key = "rejected: unusable hand"
        publisher, before, refused_before = rospy.Publisher(topic, kind, queue_size=100), len(self.frames), self.counts[key]
        wait_until(lambda: publisher.get_num_connections() > 0, "a subscriber of " + topic)
        pace = rospy.Rate(1.0 / PERIOD)
        for i in range(count):
            publisher.publish(message_of(i))
            pace.sleep()
        expected = before + (count if frames is None else frames)
        wait_until(lambda: len(self.frames) >= expected, "%d frames of %s" % (expected - before, topic))
        if refused:
            self.wait_for_count(key, refused_before + refused)
        publisher.unregister()
        return self.frames[before:]

    def test_a_step_of_the_trackers_clock_is_taken_out_and_counted(self):
        key = "clock steps taken out"
        for step, topic in ((-20.0, "hands/pose_array"), (10.0, "hands/point_cloud")):  # longer than a busy machine is late
            before = self.counts[key]
            begin = rospy.Time.now()
            frames = self.play(topic, 60, lambda i, b=begin, s=step: self.pose_array(
                joints(), b + rospy.Duration(i * PERIOD + (s if i >= 30 else 0.0))), frames=59)
            stamps = [frame.header.stamp.to_sec() for frame in frames]
            steps = [b - a for a, b in zip(stamps, stamps[1:])]
            self.assertGreater(min(steps), 0.0)
            self.assertLess(max(steps), 5.0)  # half of the smaller step; 20 ms, but for what a busy machine is late by
            self.assertTrue(all(len(frame.hands) == 1 for frame in frames))
            self.wait_for_count(key, before + 1)

    def test_a_hand_of_placeholders_is_none_and_counted_once(self):
        key = "hands of placeholders"
        before, refused = self.counts[key], self.counts["rejected: unusable hand"]
        dead = [(0.0, 0.0, 0.0)] * 21
        frames = self.play("/leapmotion/hands/left", 40, lambda i: self.pose_array(joints("left") if i < 10 else dead))
        self.assertEqual([len(frame.hands) for frame in frames], 10 * [1] + 30 * [0])
        self.wait_for_count(key, before + 1)
        self.assertEqual(self.counts["rejected: unusable hand"], refused)

    def test_manos_order_is_recognised_on_a_topic_of_any_name(self):
        frames = self.play("headset/left_joints", 10, lambda i: self.pose_array(in_manos_order(joints("left"))))
        hand, chains = frames[-1].hands[0], leap_messages.open_hand("left")[2]
        self.assertEqual(hand.side, Hand.LEFT)
        for phalanx in hand.phalanges:
            if phalanx.bone > 0:  # metacarpals are filled in
                for point, expected in ((phalanx.start, chains[phalanx.finger][phalanx.bone]),
                                        (phalanx.end, chains[phalanx.finger][phalanx.bone + 1])):
                    self.assertLess(math.dist((point.x, point.y, point.z), expected), 1e-9)
        self.assertGreater(self.counts["order of joints recognised"] + 1, 0)

    def test_millimetres_are_refused_with_the_argument_that_converts(self):
        millimetres = [[1000.0 * x for x in point] for point in joints()]
        self.play("hands/right/point_cloud", 5, lambda i: self.pose_array(millimetres), frames=0, refused=5)
        self.assertIn("as of millimetres; allowed: metres; scale:=0.001", self.last["rejected: unusable hand"])

    def test_radii_and_confidence_of_a_point_cloud_are_used(self):
        points = joints()
        radii = [0.004 + 0.0002 * i for i in range(len(points))]

        def cloud(_):
            message = PointCloud(points=[Point(*point) for point in points])
            message.header = self.pose_array([]).header
            message.channels = [ChannelFloat32("radius", radii), ChannelFloat32("confidence", [0.5] * len(points))]
            return message
        hand = self.play("hands/left/point_cloud", 5, cloud, PointCloud)[-1].hands[0]
        self.assertAlmostEqual(hand.confidence, 0.5, delta=1e-6)
        for phalanx in hand.phalanges:
            first = 1 + 4 * phalanx.finger + phalanx.bone - 1
            if phalanx.bone > 0:
                self.assertAlmostEqual(phalanx.radius, 0.5 * (radii[first] + radii[first + 1]), delta=1e-6)

    def test_hands_of_the_driver_in_a_container_are_taken(self):
        palm, _, chains = leap_messages.open_hand("right")

        def hand(_):
            message = ControllerHand(lmc_hand_id=40, grab_strength=0.5, direction=Vector3(0, 0, -1))
            message.header = self.pose_array([]).header
            message.palm_center.position = Point(*palm)
            for finger, chain in enumerate(chains):
                bones = [LeapControllerBone(type=b, bone_start=Point(*chain[b]), bone_end=Point(*chain[b + 1]))
                         for b in range(4)]
                message.finger_list.append(LeapControllerFinger(type=finger, bone_list=bones))
            return message
        self.assertEqual(ControllerHand._md5sum, "4b3d566357beb37e9416db01e6dcc444")  # the driver's
        found = self.play("/leapmotion/hands/right", 5, hand, ControllerHand)[-1].hands[0]
        self.assertEqual((found.id, found.side, found.confidence, found.grab_strength), (40, Hand.RIGHT, 1.0, 0.5))
        self.assertEqual(len(found.phalanges), 19)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "tracker_faults", TrackerFaultsTest)
