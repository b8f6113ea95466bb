#!/usr/bin/env python3
"""demo.launch: the scripted hand takes the cube, carries it, lets it go, and the next run begins anew."""
import math
import os
import sys
import unittest

import rospy
import rostest

from mr_hand_interaction.msg import HandFrame, InteractionEvent, ObjectStateArray, Phalanx

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from waiting import wait_until  # noqa: E402

START = (0.0, 0.0, 0.22)  # of the cube's centre [m]
CARRIED = 0.04  # m: half of the way that the hand carries it
NEAR_START = 0.005  # m


class DemoTest(unittest.TestCase):
    def setUp(self):
        rospy.init_node("demo_test")
        self.cube, self.kinds, self.touching = None, [], set()
        self.subscribers = [rospy.Subscriber("objects", ObjectStateArray, self.take_objects),
                            rospy.Subscriber("rendered_hands", HandFrame, self.take_rendered),
                            rospy.Subscriber("interaction_events", InteractionEvent, self.take_event)]

    def take_objects(self, message):
        self.cube = message.objects[0]

    def take_rendered(self, message):
        self.touching = {p.finger for hand in message.hands for p in hand.phalanges if p.touching}

    def take_event(self, event):
        self.kinds.append(event.kind)

    def way(self):
        p = self.cube.pose.position
        return math.dist((p.x, p.y, p.z), START)

    def test_cube_is_grasped_carried_released_and_put_back_for_the_next_run(self):
        wait_until(lambda: self.cube and self.cube.held and self.way() > CARRIED, "the cube held and carried")
        wait_until(lambda: Phalanx.THUMB in self.touching and len(self.touching) > 1, "thumb and fingers touching")
        wait_until(lambda: InteractionEvent.GRASP_END in self.kinds and not self.cube.held, "the release")
        self.assertGreater(self.way(), CARRIED)
        wait_until(lambda: self.way() < NEAR_START, "the reset before the next run")
        wait_until(lambda: self.cube.held and self.way() > CARRIED, "the next run")


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "demo", DemoTest)
