#!/usr/bin/env python3
"""A /clock that leaps, for a message or longer, to where ros::Duration ends too, ends no node; the scripted hand and the
simulation go on after it, and so does the bag of a session."""
import glob
import os
import sys
import tempfile
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

LONG_LEAPS = ((3e9, 0.2), (4294967295.0, 0.2), (3e9, 1.5), (3000.0, 0.2))  # s: time, and for how long
LEAPS = (2147483648.5, 4294967295.0, 3000.0, 500.0)  # s; 2^31 s and the last that a stamp can be, and usual ones


class LeapingClock(threading.Thread):
    """ROS's time, at the pace of the wall; `leap` makes it another for one message, `leap_for` for longer."""

    def __init__(self):
        super().__init__()
        self.publisher = rospy.Publisher("/clock", Clock, queue_size=10)
        self.leap, self.over = None, threading.Event()
        self.begin = time.monotonic()
        self.elsewhere, self.back = None, 0.0

    def now(self):
        return rospy.Time.from_sec(1000.0 + time.monotonic() - self.begin)

    def leap_for(self, seconds, elsewhere):
        self.back = time.monotonic() + seconds
        self.elsewhere = elsewhere
        wait_until(lambda: self.elsewhere is None, "the clock to be back")

    def run(self):
        while not self.over.wait(0.005):
            if self.elsewhere is not None:
                away = time.monotonic() < self.back
                self.publisher.publish(rospy.Time.from_sec(self.elsewhere) if away else self.now())
                self.elsewhere = self.elsewhere if away else None
                continue
            leap, self.leap = self.leap, None
            self.publisher.publish(self.now() if leap is None else rospy.Time.from_sec(leap))
            if leap is not None:
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

    def test_the_simulation_follows_the_clock_after_a_leap_that_lasts(self):
        tracked, rendered = [], []
        subscribers = [rospy.Subscriber("hand_frame", HandFrame, tracked.append, queue_size=100),
                       rospy.Subscriber("rendered_hands", HandFrame, rendered.append, queue_size=100)]

        def is_at_the_clock(frames):
            return frames and abs((frames[-1].header.stamp - self.clock.now()).to_sec()) < 1.0

        with Launch("demo.launch", "rviz:=false", "loop:=true"):
            for elsewhere, seconds in LONG_LEAPS + LONG_LEAPS:
                wait_until(lambda: is_at_the_clock(rendered), "rendered hands at the clock's time")
                self.clock.leap_for(seconds, elsewhere)
                del tracked[:], rendered[:]
                wait_until(lambda: len([f for f in tracked if f.header.stamp < self.clock.now()]) > 100, "hands")
                wait_until(lambda: is_at_the_clock(rendered) and len(rendered) > 30,
                           "rendered hands after the clock was at %s for %s s" % (elsewhere, seconds))
        for subscriber in subscribers:
            subscriber.unregister()

    def test_a_session_is_recorded_again_after_a_clock_of_zero(self):
        with tempfile.TemporaryDirectory() as parent:
            folder = os.path.join(parent, "session")

            def bags():
                return [bag for bag in glob.glob(folder + "/hands_*.bag*") if os.path.getsize(bag) > 100000]

            with Launch("training.launch", "participant:=P01", "hands:=demo", "rviz:=false", "folder:=" + folder) as launch:
                wait_until(lambda: len(bags()) == 1, "the bag of the session")
                # rosbag ends with an error: it inserts no message at this time. A busy machine may let it miss a short one.
                self.clock.leap_for(1.0, 0.0)
                wait_until(lambda: len(bags()) > 1, "a bag after the clock was at 0")
                self.assertFalse(launch.has_ended(), "the launch has ended")


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "leaping_clock", LeapingClockTest)
