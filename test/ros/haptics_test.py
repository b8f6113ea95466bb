#!/usr/bin/env python3
"""haptics: what a glove is told about a finger that pushes the cube, by frame and by step."""
import os
import sys
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState

from mr_hand_interaction.msg import Hand, HandFrame, HapticsArray, ObjectStateArray, Phalanx, PhalanxHaptics

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from pointing_hand import PERIOD, SPEED, frame, hand, push_tips  # noqa: E402
from standing_clock import StandingClock  # noqa: E402
from waiting import wait_until  # noqa: E402

STEP = 0.002  # s, of the node that tells by step
MASS = 0.1 * 0.02 / (0.1 + 0.02)  # kg, of the cube and a fingertip against each other


LEVER = -9.81 * 0.1 * 0.04  # N m: weight of the lever times its arm
JOINTS = {"button_slide", "switch_hinge", "valve_axle", "lever_hinge", "drawer_slide", "door_hinge"}


class HapticsTest(unittest.TestCase):
    def test_a_glove_is_told_of_the_blow_by_frame_and_by_step(self):
        rospy.init_node("haptics_test")
        frames, steps, joints, shown = [], [], [], {}
        by_frame = rospy.Subscriber("haptics", HapticsArray, frames.append)
        by_step = rospy.Subscriber("by_step/haptics", HapticsArray, steps.append)
        by_joint = rospy.Subscriber("panel/haptics/joints", JointState, joints.append)
        none = rospy.Subscriber("haptics/joints", JointState, lambda _: self.fail("a scene without joints"))
        objects = [rospy.Subscriber(topic, ObjectStateArray, lambda m, of=topic: shown.update({of: m.header.stamp}))
                   for topic in ("objects", "by_step/objects", "panel/objects")]
        hands = rospy.Publisher("hand_frame", HandFrame, queue_size=10)
        wait_until(lambda: hands.get_num_connections() == 3, "the three nodes")
        wait_until(lambda: all(s.get_num_connections() > 0 for s in [by_frame, by_step, by_joint, none] + objects), "publishers")
        clock = StandingClock(lambda: min(shown.values()) if len(shown) == 3 else rospy.Time())
        clock.keep_up()

        def greeted():
            hands.publish(frame(clock.next_stamp(PERIOD)))
            return frames and steps and joints
        wait_until(greeted, "all that is published")
        clock.keep_up()
        begin = clock.stamp
        for tip in push_tips():
            stamp = clock.next_stamp(PERIOD)
            hands.publish(frame(stamp, hand(tip)))
            clock.keep_up()
        wait_until(lambda: frames[-1].header.stamp >= stamp and steps[-1].header.stamp >= stamp and
                   joints[-1].header.stamp >= stamp, "haptics")
        count = int(round((stamp - begin).to_sec() / PERIOD))
        frames = [m for m in frames if m.hands and m.header.stamp <= stamp]
        steps = [m for m in steps if m.hands and m.header.stamp <= stamp]

        self.assertEqual(len(frames), count)
        lengths = [(later.header.stamp - earlier.header.stamp).to_sec() for earlier, later in zip(steps, steps[1:])]
        self.assertAlmostEqual(sum(lengths), (stamp - begin).to_sec() - PERIOD, delta=1e-6)
        for message, length in zip(steps[1:], lengths):
            # A frame in which nothing is near is one step.
            touching = message.hands[0].phalanges
            self.assertAlmostEqual(length, STEP if touching or length < 0.5 * PERIOD else PERIOD, delta=1e-6)
        for messages in (frames, steps):
            self.check(messages)
        self.check_joints([m for m in joints if begin < m.header.stamp <= stamp], stamp - begin)

    def check(self, messages):
        told = [phalanx for message in messages for phalanx in message.hands[0].phalanges]
        self.assertEqual({(m.hands[0].id, m.hands[0].side) for m in messages}, {(7, Hand.RIGHT)})
        self.assertFalse(messages[0].hands[0].phalanges, "the finger has not yet arrived")
        self.assertTrue(told, "nothing is felt")
        for phalanx in told:
            self.assertEqual((phalanx.object, phalanx.finger, phalanx.bone), ("cube", Phalanx.INDEX, Phalanx.DISTAL))
            self.assertIn(phalanx.slip, (PhalanxHaptics.STICKING, PhalanxHaptics.SLIPPING))
            self.assertAlmostEqual(phalanx.normal.x, -1.0, delta=0.05)
            self.assertGreaterEqual(phalanx.pressure, 0.0)
        self.assertEqual({m.header.frame_id for m in messages}, {"world"})
        self.assertGreater(sum(phalanx.impulse.x for phalanx in told), 0.5 * MASS * SPEED)

    def check_joints(self, messages, duration):
        """Of a panel at 1 g that nothing touches: the lever's friction bears its weight."""
        self.assertGreaterEqual(len(messages), int(round(duration.to_sec() / PERIOD)))
        stamps = [m.header.stamp for m in messages]
        self.assertEqual(stamps, sorted(set(stamps)))
        for message in messages:
            self.assertEqual(message.header.frame_id, "world")
            self.assertEqual(set(message.name), JOINTS)
            effort = dict(zip(message.name, message.effort))
            # A step's friction is 1e-4 short of the weight (kStopOverInertia in joint_law.cpp) until the lever sleeps.
            self.assertAlmostEqual(effort["lever_hinge"], LEVER, delta=1.1e-4 * abs(LEVER))
            self.assertEqual(effort["drawer_slide"], 0.0)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "haptics", HapticsTest)
