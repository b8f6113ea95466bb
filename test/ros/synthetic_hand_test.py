#!/usr/bin/env python3
"""synthetic_hand_node publishes what a Leap driver would, on an exact schedule."""
import subprocess
import threading
import unittest

import genpy.dynamic
import rospy
import rostest
from std_srvs.srv import Trigger, TriggerResponse

TOPIC = "/leap_motion/leap_device"
HEAD_MD5 = "2817a017ab58b244566892058c4f6e6d"
RATE = 115.0


class Listener:
    """Gathers frames until a condition holds."""

    def __init__(self):
        self.frames = []
        self.headers = []
        self.changed = threading.Condition()
        self.subscriber = rospy.Subscriber(TOPIC, rospy.AnyMsg, self.take, queue_size=1000)

    def take(self, message):
        with self.changed:
            self.frames.append(message._buff)
            self.headers.append(message._connection_header)
            self.changed.notify_all()

    def wait_for(self, condition, timeout):
        with self.changed:
            return self.changed.wait_for(lambda: condition(self), timeout)


class SyntheticHandTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.resets = 0
        cls.service = rospy.Service("reset_scene", Trigger, cls.reset)
        cls.listener = Listener()
        # Not before there is one who listens: it does not wait for one for long.
        node = subprocess.Popen(["rosrun", "mr_hand_interaction", "synthetic_hand_node", "_motion:=tap",
                                 "_rate:=%g" % RATE, "_side:=left", "_loop:=true", "_reset:=reset_scene"])
        cls.addClassCleanup(node.wait)
        cls.addClassCleanup(node.terminate)
        # One run of the tap and its pause take under six seconds.
        cls.looped = cls.listener.wait_for(lambda it: cls.resets > 0 and len(it.frames) > 8 * RATE, 60.0)
        header = cls.listener.headers[0]
        classes = genpy.dynamic.generate_dynamic(header["type"], header["message_definition"])
        cls.human = classes[header["type"]]
        with cls.listener.changed:
            cls.frames = [cls.human().deserialize(buffer) for buffer in cls.listener.frames]

    @classmethod
    def reset(cls, _):
        cls.resets += 1
        return TriggerResponse(success=True)

    def test_type_md5_and_definition_are_those_of_the_driver(self):
        header = self.listener.headers[0]
        self.assertEqual(header["type"], "leap_motion/Human")
        self.assertEqual(header["md5sum"], HEAD_MD5)
        self.assertEqual(self.human._md5sum, HEAD_MD5)

    def test_stamps_are_exactly_on_the_schedule(self):
        start = self.frames[0].header.stamp.to_nsec()
        for frame in self.frames:
            since = frame.header.stamp.to_nsec() - start
            nearest = round(since * RATE / 1e9) * 1e9 / RATE
            # Each stamp is rounded to a nanosecond, the first one too.
            self.assertLessEqual(abs(since - nearest), 2)

    def test_the_motion_is_seen_from_its_beginning(self):
        self.assertTrue(self.frames[0].left_hand.is_present)
        self.assertLess(self.frames[0].lmc_frame_id, RATE)

    def test_a_left_hand_is_there_with_all_its_bones_in_the_devices_frame(self):
        frame = self.frames[0]
        self.assertEqual(frame.header.frame_id, "leap_hands")
        self.assertEqual((frame.nr_of_hands, frame.right_hand.is_present), (1, False))
        self.assertEqual([len(finger.bone_list) for finger in frame.left_hand.finger_list], [4] * 5)
        self.assertGreater(frame.left_hand.palm_center.y, 0.1)  # y is up

    def test_it_repeats_with_a_new_id_after_frames_without_a_hand_and_a_reset(self):
        self.assertTrue(self.looped)
        self.assertTrue(any(frame.nr_of_hands == 0 for frame in self.frames))
        ids = {frame.left_hand.lmc_hand_id for frame in self.frames if frame.left_hand.is_present}
        self.assertGreaterEqual(len(ids), 2)

    def refusal(self, *arguments):
        command = ["rosrun", "mr_hand_interaction", "synthetic_hand_node", "__name:=refused", *arguments]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True, timeout=120)
        self.assertEqual(done.returncode, 1)
        return done.stdout

    def test_an_unknown_motion_or_parameter_stops_it_with_a_line_that_says_what_is_allowed(self):
        self.assertIn("use one of grasp_cube", self.refusal("_motion:=wave"))
        self.assertIn("unknown parameter 'speed'; allowed: loop, motion",
                      self.refusal_alone("_speed:=3"))
        self.assertIn("parameter 'rate': fast is not allowed; allowed: a number from 1 to 1000", self.refusal_alone("_rate:=fast"))

    def refusal_alone(self, argument):
        rospy.delete_param("/refused")
        return self.refusal(argument)


if __name__ == "__main__":
    rospy.init_node("synthetic_hand_test")
    rostest.rosrun("mr_hand_interaction", "synthetic_hand", SyntheticHandTest)
