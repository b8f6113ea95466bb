#!/usr/bin/env python3
"""A /clock that leaps, to where ros::Duration ends too, ends no node; the scripted hand and what it holds go on after it."""
import os
import sys
import threading
import time
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Clock

from mr_hand_interaction.msg import HandFrame

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from launching import Launch  # noqa: E402
from waiting import wait_until  # noqa: E402

LEAPS = (2147483648.5, 4294967295.0, 3000.0, 500.0)  # s; 2^31 s and the last that a stamp can be, and usual ones


class LeapingClock(threading.Thread):
    """ROS's time, at the pace of the wall; `leap` makes it another for one message."""

    def __init__(self):
        super().__init__()
        self.publisher = rospy.Publisher("/clock", Clock, queue_size=10)
        self.leap, self.over = None, threading.Event()
        self.begin = time.monotonic()

    def now(self):
        return rospy.Time.from_sec(1000.0 + time.monotonic() - self.begin)

    def run(self):
        while not self.over.wait(0.005):
            leap, self.leap = self.leap, None
            self.publisher.publish(rospy.Time.from_sec(leap) if leap else self.now())
            if leap:
                time.sleep(0.05)  # the nodes look at it


class LeapingClockTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("leaping_clock_test")
        cls.clock = LeapingClock()
        cls.clock.start()

    @classmethod
    def tearDownClass(cls):
        cls.clock.over.set()
        cls.clock.join()

    def test_ends_no_node_and_silences_no_hand(self):
        for one_process in ("true", "false"):
            frames = []
            subscriber = rospy.Subscriber("hand_frame", HandFrame, frames.append, queue_size=100)
            with Launch("demo.launch", "rviz:=false", "loop:=true", "one_process:=" + one_process) as launch:
                for leap in LEAPS:
                    wait_until(lambda: frames and abs((frames[-1].header.stamp - self.clock.now()).to_sec()) < 1.0,
                               "hands at the clock's time")
                    self.clock.leap = leap
                    wait_until(lambda: self.clock.leap is None, "the clock's leap")
                    del frames[:]
                    wait_until(lambda: len(frames) > 100, "hands after the clock was at %s" % leap)
                    self.assertFalse(launch.has_ended(), "the launch has ended")
            subscriber.unregister()


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "leaping_clock", LeapingClockTest)
