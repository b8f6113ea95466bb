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
TIMEOUT = 200.0  # s; a run lasts 9; where the nodes lose frames on a slow machine, the hand may lose the cube


class Run:
    """What has been seen of one run of the hand."""

    def __init__(self):
        self.carried = self.touching = self.released = False

    def is_whole(self):
        return self.carried and self.touching and self.released


class DemoTest(unittest.TestCase):
    def setUp(self):
        rospy.init_node("demo_test")
        self.runs, self.kinds = [Run()], set()
        self.subscribers = [rospy.Subscriber("objects", ObjectStateArray, self.take_objects),
                            rospy.Subscriber("rendered_hands", HandFrame, self.take_rendered),
                            rospy.Subscriber("interaction_events", InteractionEvent, self.take_event)]

    def take_objects(self, message):
        cube, run = message.objects[0], self.runs[-1]
        p = cube.pose.position
        way = math.dist((p.x, p.y, p.z), START)
        run.carried |= cube.held and way > CARRIED
        run.released |= run.carried and not cube.held and way > CARRIED
        if run.carried and not cube.held and way < NEAR_START:
            self.runs.append(Run())

    def take_rendered(self, message):
        touching = {p.finger for hand in message.hands for p in hand.phalanges if p.touching}
        self.runs[-1].touching |= Phalanx.THUMB in touching and len(touching) > 1

    def take_event(self, event):
        self.kinds.add(event.kind)

    def test_cube_is_grasped_carried_released_and_put_back_for_the_next_run(self):
        wait_until(lambda: any(run.is_whole() for run in self.runs), "the cube taken, carried and let go", TIMEOUT)
        wait_until(lambda: {InteractionEvent.GRASP_BEGIN, InteractionEvent.GRASP_END} <= self.kinds, "the events of it")
        runs = len(self.runs)
        wait_until(lambda: any(run.carried for run in self.runs[runs:]), "the next run", TIMEOUT)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "demo", DemoTest)
