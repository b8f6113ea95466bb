#!/usr/bin/env python3
"""record.launch and playback.launch: what was recorded comes again when it is played, also when it loops."""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rosbag
import rosgraph
import rospy
import rostest
from rosgraph_msgs.msg import Clock

from mr_hand_interaction.msg import HandFrame, InteractionEvent, ObjectStateArray

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, os.pardir, os.pardir, "scripts")]
import screenshot  # noqa: E402
from launching import Launch  # noqa: E402
from waiting import wait_until  # noqa: E402
from watch_demo import Demo  # noqa: E402

DEVICE = "/leap_motion/leap_device"
MOUNT = "0.01 0 0 0.7071067811865476 0 0 0.7071067811865476"  # not the default: the bag's own must serve
PUSHED = 0.01  # m
TOLERANCE = 1e-9  # m: positions of two runs with the same input; they should be the same to the bit
EQUAL_FRAMES = 100  # at least, or the comparison has compared too little
RUNS = 5  # where the machine keeps the nodes waiting they lose frames, and what comes of another input is another thing


def subscribed(node, topic):
    subscribers = rosgraph.Master("/playback_test").getSystemState()[1]
    return any(name == topic and node in nodes for name, nodes in subscribers)


class PlaybackTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("playback_test")
        cls.folder = tempfile.mkdtemp(prefix="a nudge ")
        cls.bag = os.path.join(cls.folder, "of the cube.bag")
        cls.clear()
        cls.subscribers = [rospy.Subscriber("hand_frame", HandFrame, cls.take_frame),
                           rospy.Subscriber("objects", ObjectStateArray, cls.take_objects),
                           rospy.Subscriber("interaction_events", InteractionEvent, cls.take_event),
                           rospy.Subscriber("/clock", Clock, cls.take_clock)]
        for _ in range(RUNS):
            cls.record()
            if cls.is_whole(cls.recorded("/objects")):
                break

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def clear(cls):
        cls.frames, cls.objects, cls.kinds, cls.times, cls.object = {}, {}, [], [], None

    @classmethod
    def take_frame(cls, message):
        cls.frames[message.header.stamp] = message

    @classmethod
    def take_objects(cls, message):
        cls.object = message.objects[0]
        cls.objects[message.header.stamp] = message.objects[0]

    @classmethod
    def take_event(cls, event):
        cls.kinds.append(event.kind)

    @classmethod
    def take_clock(cls, message):
        cls.times.append(message.clock)

    @classmethod
    def pushed(cls):
        return (cls.object is not None and InteractionEvent.CONTACT_BEGIN in cls.kinds and
                abs(cls.object.pose.position.x) + abs(cls.object.pose.position.y) > PUSHED)

    @classmethod
    def record(cls):
        cls.clear()
        with Launch("record.launch", "bag:=" + cls.bag):
            wait_until(lambda: subscribed("/rosbag_record", DEVICE), "rosbag record")
            with Launch("leap.launch", "scene:=cube", "rviz:=false", "mount:=" + MOUNT):
                wait_until(lambda: subscribed("/interaction_node", DEVICE), "the pipeline")
                hand = subprocess.Popen(["rosrun", "mr_hand_interaction", "synthetic_hand_node", "_motion:=nudge",
                                         "_loop:=false"])
                wait_until(cls.pushed, "the cube pushed")
                wait_until(lambda: InteractionEvent.HAND_LOST in cls.kinds, "the end of the run")
                hand.wait(60)
        wait_until(lambda: os.path.exists(cls.bag), "the bag")

    @classmethod
    def recorded(cls, topic):
        with rosbag.Bag(cls.bag) as bag:
            return {message.header.stamp: message for _, message, _ in bag.read_messages([topic])}

    @classmethod
    def is_whole(cls, objects):
        """Whether the simulation took every frame of the device from the first to the last that these show. As the
        nodes find each other, the first few may be lost; nothing hangs on them."""
        sent = cls.recorded(DEVICE)
        taken = [stamp for stamp in sent if stamp in objects]
        return bool(taken) and all(stamp in objects for stamp in sent if min(taken) <= stamp <= max(objects))

    def play(self, *arguments):
        self.clear()
        return Launch("playback.launch", "bag:=" + self.bag, "scene:=cube", "rviz:=false", *arguments)

    def moment(self, name):
        """Whether scripts/screenshot stops there; else the line why not."""
        options = screenshot.parse(["--motion=grasp_cube", "--bag=" + self.bag, "--moment=" + name, "--size=8x5", "--output=none",
                                    "--time-limit=600"])  # far beyond the bag's end
        with self.play():
            try:
                return screenshot.stop_at_moment(Demo(), options, time.monotonic() + options.time_limit) is not None
            except screenshot.Missed as missed:
                return str(missed)

    def test_a_screenshot_knows_what_flew_off_and_does_not_wait_beyond_the_bags_end(self):
        self.assertIs(self.moment("done"), True)
        self.assertIn("was over", self.moment("grasp"))  # it is only nudged

    def difference(self):
        """What is not as it was recorded; empty: nothing."""
        recorded_frames, recorded_objects = self.recorded("/hand_frame"), self.recorded("/objects")
        both = set(self.frames) & set(self.objects) & set(recorded_frames) & set(recorded_objects)
        for stamp in sorted(both):
            if str(self.frames[stamp].hands) != str(recorded_frames[stamp].hands):
                return "other hands at %s" % stamp
            now, then = self.objects[stamp].pose.position, recorded_objects[stamp].objects[0].pose.position
            if max(abs(now.x - then.x), abs(now.y - then.y), abs(now.z - then.z)) > TOLERANCE:
                return "the cube is elsewhere at %s" % stamp
        return "" if len(both) > EQUAL_FRAMES else "only %d frames are in both" % len(both)

    def test_playing_gives_what_was_recorded(self):
        for _ in range(RUNS):
            with self.play():
                wait_until(lambda: InteractionEvent.HAND_LOST in self.kinds, "the end of the run")
            self.assertTrue(rospy.get_param("/use_sim_time"))
            difference = self.difference()
            if not difference or self.is_whole(self.objects):
                break
        self.assertEqual(difference, "")
        self.assertTrue(self.pushed())

    def test_a_bag_that_is_there_is_not_written_over(self):
        with open(self.bag, "rb") as file:
            before = file.read()
        done = subprocess.run(["roslaunch", "mr_hand_interaction", "record.launch", "bag:=" + self.bag],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=300)
        self.assertIn("%s: is there already; allowed: a file that is not" % self.bag, done.stdout)
        with open(self.bag, "rb") as file:
            self.assertEqual(file.read(), before)

    def test_a_bag_that_is_not_there_ends_the_launch_with_one_line(self):
        missing = os.path.join(self.folder, "no such.bag")
        told = subprocess.run(["roslaunch", "mr_hand_interaction", "playback.launch", "bag:=" + missing, "rviz:=false"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300, universal_newlines=True).stdout
        self.assertEqual([line for line in told.splitlines() if missing in line], [missing + ": there is no such bag"], told)
        self.assertNotIn("Error opening", told)
        self.assertEqual(told.count("process has died"), 1, told)

    def test_what_is_said_while_a_bag_is_played_stays_to_be_read(self):
        """rosbag writes its time over the same line again and again."""
        launch = subprocess.Popen(["roslaunch", "mr_hand_interaction", "playback.launch", "bag:=" + self.bag, "rviz:=false"],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self.clear()
        try:
            wait_until(lambda: InteractionEvent.HAND_LOST in self.kinds, "the end of the run")
        finally:
            launch.send_signal(signal.SIGINT)
            told = launch.communicate(timeout=120)[0]
        self.assertNotIn("Bag Time", told)
        self.assertNotIn("\r", told)

    def test_a_looping_bag_begins_anew_each_time(self):
        with self.play("loop:=true", "rate:=2"):
            for _ in range(2):
                wait_until(self.pushed, "the cube pushed")
                times = list(self.times)
                wait_until(lambda: any(b < a for a, b in zip(self.times[len(times) - 1:], self.times[len(times):])),
                           "the bag's beginning")
                wait_until(lambda: self.object.pose.position.x == self.object.pose.position.y == 0.0,
                           "the cube back at its start")
                del self.kinds[:]
            wait_until(self.pushed, "the cube pushed again")


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "playback", PlaybackTest)
