#!/usr/bin/env python3
"""doctor finds what keeps a hand from the simulation, and says it in one line."""
import contextlib
import os
import subprocess
import sys
import tempfile
import threading
import unittest

import rospy
import rostest
from geometry_msgs.msg import Pose, PoseArray
from std_msgs.msg import Header, String

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from tracker_hands import joints, program, recording  # noqa: E402
from waiting import wait_until  # noqa: E402

TOPIC = "/hands/right/pose_array"


class Sender:
    """A tracker at work, in a thread."""

    def __init__(self, points, rate=60.0, frame="world", late=0.0, topic=TOPIC):
        self.message = PoseArray(header=Header(frame_id=frame), poses=[Pose() for _ in points])
        for pose, point in zip(self.message.poses, points):
            pose.position.x, pose.position.y, pose.position.z = point
        self.publisher = rospy.Publisher(topic, PoseArray, queue_size=10)
        self.period, self.late, self.over = 1.0 / rate, rospy.Duration(late), threading.Event()
        self.thread = threading.Thread(target=self.run)

    def run(self):
        while not self.over.wait(self.period):
            self.message.header.stamp = rospy.Time.now() - self.late
            self.publisher.publish(self.message)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()
        self.publisher.unregister()


def ask(*arguments, **environment):
    """Exit status, and what is wrong, by what was examined."""
    answer = subprocess.run([program("doctor"), "--seconds", "2"] + list(arguments), stdout=subprocess.PIPE, timeout=60,
                            env=dict(os.environ, **environment), universal_newlines=True, check=False)
    lines = [line.split(None, 2) for line in answer.stdout.splitlines()]
    return answer.returncode, {what: text for verdict, what, text in lines if verdict == "WRONG"}, len(lines)


class DoctorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("doctor_test")
        with tempfile.TemporaryDirectory() as folder:
            row = recording(folder, 30)[60]
        cls.hand = [(x, -z, y) for x, y, z in joints(row, 26)]

    def assert_wrong(self, what, *words, arguments=(), **environment):
        status, wrong, _ = ask(*arguments, **environment)
        self.assertEqual(status, 1)
        self.assertEqual(list(wrong), [what])
        for word in words:
            self.assertIn(word, wrong[what])

    @contextlib.contextmanager
    def parameter(self, name, value):
        rospy.set_param(name, value)
        yield
        rospy.delete_param(name)

    def test_nothing_is_wrong_where_a_hand_comes_through(self):
        with Sender(self.hand):  # which a busy machine keeps from its rate for a while
            wait_until(lambda: ask() == (0, {}, 9), "an answer of nine lines with nothing wrong")

    def test_ports_that_listen_on_every_interface_are_named(self):
        """roscpp's XML-RPC port does whatever ROS_IP says; were it bound some day, there is nothing to tell."""
        with Sender(self.hand):
            answer = subprocess.run([program("doctor"), "--seconds", "1"], stdout=subprocess.PIPE, timeout=60,
                                    universal_newlines=True, check=False)
        line = next(line for line in answer.stdout.splitlines() if " network " in line)
        self.assertIn("/hand_tracking_node" if "every interface" in line else "this machine alone", line)

    def test_no_master(self):
        self.assert_wrong("master", "http://127.0.0.1:9", "ROS_MASTER_URI", ROS_MASTER_URI="http://127.0.0.1:9")

    def test_no_driver(self):
        self.assert_wrong("topic", "no publisher")

    def test_another_type(self):
        publisher = rospy.Publisher("/text", String, queue_size=1)
        subscriber = rospy.Subscriber("/text", String, lambda _: None)
        self.assert_wrong("topic", "std_msgs/String", "leap_motion/Human", arguments=("--topic", "/text"))
        subscriber.unregister()
        publisher.unregister()

    def test_another_topic(self):
        with Sender(self.hand, topic="/elsewhere"):
            status, wrong, _ = ask("--topic", "/elsewhere")
        self.assertEqual((status, list(wrong)), (1, ["nodes", "hands"]))
        self.assertIn("topic:=/elsewhere", wrong["nodes"])

    def test_a_silent_driver(self):
        publisher = rospy.Publisher(TOPIC, PoseArray, queue_size=1)
        self.assert_wrong("rate", "silent")
        publisher.unregister()

    def test_each_of_two_topics_is_looked_at(self):
        left = TOPIC.replace("right", "left")
        with Sender(self.hand), Sender([(x + 0.3, y, z) for x, y, z in self.hand], topic=left, late=2.0):
            status, wrong, lines = ask()
        self.assertEqual(status, 1)
        self.assertIn(left + ": 2.0 s behind", wrong["stamps"])
        self.assertGreaterEqual(lines, 13)  # nodes, topic, rate and stamps of each
        with Sender(self.hand, topic="/a/left"), Sender(self.hand, topic="/a/right"):
            _, wrong, _ = ask()
        self.assertIn("left:=/a/left right:=/a/right", wrong["topic"])

    def test_a_slow_driver(self):
        with Sender(self.hand, rate=8.0):
            self.assert_wrong("rate", "at least 20 Hz")

    def test_a_clock_that_is_off(self):
        with Sender(self.hand, late=2.0):
            self.assert_wrong("stamps", "2.0 s behind")

    def test_a_frame_without_a_place(self):
        with Sender(self.hand, frame="nowhere"):
            status, wrong, _ = ask()
        self.assertEqual((status, list(wrong)), (1, ["mount", "hands"]))
        self.assertIn("'nowhere'", wrong["mount"])
        self.assertIn("no transform", wrong["hands"])

    def test_a_mirrored_hand(self):
        for points, topic in (([(-x, y, z) for x, y, z in self.hand], TOPIC), (self.hand, TOPIC.replace("right", "left"))):
            with Sender(points, topic=topic):
                self.assert_wrong("hands", "bend to its back", "swap")

    def test_no_hand_in_view(self):
        with Sender([]):
            self.assert_wrong("hands", "none is seen")

    def test_a_clock_that_nobody_publishes(self):
        with Sender(self.hand), self.parameter("/use_sim_time", True):
            _, wrong, _ = ask()
        self.assertIn("nobody publishes /clock", wrong["clock"])

    def tearDown(self):
        wait_until(lambda: not any(name in (TOPIC, TOPIC.replace("right", "left"), "/elsewhere", "/a/left", "/a/right") for name, _ in rospy.get_published_topics()),
                   "the sender's end")


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "doctor", DoctorTest)
