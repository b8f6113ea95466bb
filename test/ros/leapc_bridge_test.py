#!/usr/bin/env python3
"""leapc_bridge, with a stand-in for Ultraleap's bindings (stand_in/leap): no device and no service is at hand."""
import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest

from mr_hand_interaction.msg import HandFrame, InteractionEvent

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from launching import Launch  # noqa: E402
from tracker_hands import FINGERS, program, recording  # noqa: E402
from waiting import wait_until  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))


class LeapcBridgeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("leapc_bridge_test")
        cls.folder = tempfile.mkdtemp()
        os.environ["PYTHONPATH"] = os.path.join(HERE, "stand_in") + os.pathsep + os.environ.get("PYTHONPATH", "")
        os.environ["LEAP_STAND_IN"] = os.path.join(cls.folder, "events.json")
        cls.rows = recording(cls.folder, 100)
        cls.left = recording(cls.folder, 100, side="left")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.frames, self.events, self.messages = [], [], {}
        self.subscribers = [rospy.Subscriber("hand_frame", HandFrame, self.frames.append, queue_size=1000),
                            rospy.Subscriber("interaction_events", InteractionEvent, self.events.append, queue_size=1000)]

    def tearDown(self):
        for subscriber in self.subscribers:
            subscriber.unregister()

    def play(self, events):
        with open(os.environ["LEAP_STAND_IN"], "w", encoding="utf-8") as file:
            json.dump(events, file)

    @contextlib.contextmanager
    def launch(self, *arguments):
        """The stand-in begins once both nodes are there, however busy the machine is."""
        go = os.environ["LEAP_STAND_IN"] + ".go"
        with Launch("leap.launch", "bridge:=true", "scene:=cube", "rviz:=false", *arguments):
            wait_until(lambda: all(subscriber.get_num_connections() for subscriber in self.subscribers), "both nodes")
            with open(go, "w", encoding="utf-8"):
                self.addCleanup(os.remove, go)
            yield

    def seen(self, side):
        return [hand for frame in list(self.frames) for hand in frame.hands if hand.side == side]

    def test_the_scripted_hand_takes_the_cube_once_and_lets_it_go(self):
        self.play([{"at": 2.0, "do": "device", "id": 1, "serial": "LP-123", "rows": self.rows}])
        kinds = (InteractionEvent.GRASP_BEGIN, InteractionEvent.GRASP_END)

        def grasps():
            return [(event.kind, event.header.stamp.to_sec()) for event in list(self.events) if event.kind in kinds]
        with self.launch():
            wait_until(lambda: len(grasps()) >= 2, "a grasp and its end")
        self.assertEqual([kind for kind, _ in grasps()], list(kinds))
        # By the device's clock, 2.7 s after its first frame and 5.8 s: as the recording has it.
        (_, begin), (_, end) = grasps()
        self.assertAlmostEqual(end - begin, 3.1, delta=0.3)
        self.check_hands()

    def check_hands(self):
        """Each bone has its own radius; stamps go as the device's clock does, whatever the network does."""
        hand = self.seen(1)[-1]
        self.assertAlmostEqual(hand.confidence, 1.0, delta=1e-6)
        self.assertAlmostEqual(hand.grab_strength, 0.25, delta=1e-6)
        for phalanx in hand.phalanges:
            width = float(self.rows[200][FINGERS[phalanx.finger] + "_width"]) - 1e-3 * phalanx.bone
            self.assertAlmostEqual(phalanx.radius, 0.5 * width, delta=1e-6)
        self.assertEqual(len(hand.phalanges), 19)  # the thumb's metacarpal has no length
        stamps = [frame.header.stamp.to_sec() for frame in self.frames]
        steps = [later - earlier for earlier, later in zip(stamps, stamps[1:])]
        # The stand-in's rows are 10 ms apart; both clocks are read one after the other, on a busy machine 5 ms apart.
        late = [step for step in steps if abs(step - 0.01) > 0.005]
        self.assertLess(len(late), 0.05 * len(steps), late[:10])

    def test_what_is_plugged_out_or_lost_comes_back_by_itself(self):
        begin = float(self.rows[150]["time_s"])
        second = [dict(row, time_s=str(float(row["time_s"]) - begin)) for row in self.rows[150:250]]
        self.play([{"at": 0.0, "do": "refuse", "until": 1.5},
                   {"at": 3.0, "do": "device", "id": 1, "serial": "LP-123", "rows": second},
                   {"at": 4.0, "do": "device lost", "id": 1},
                   {"at": 6.0, "do": "device", "id": 2, "serial": "LP-123", "rows": second},
                   {"at": 7.0, "do": "connection lost"},
                   {"at": 10.0, "do": "device", "id": 1, "serial": "LP-123", "rows": second}])
        with self.launch():
            def bouts():
                stamps = [frame.header.stamp.to_sec() for frame in list(self.frames) if frame.hands]
                return sum(b - a > 0.5 for a, b in zip(stamps, stamps[1:])) + bool(stamps)
            wait_until(lambda: bouts() == 3, "the hand, three times")
            wait_until(lambda: len([f for f in self.frames if not f.hands]) >= 2, "frames without a hand in between")

    def test_each_device_has_a_topic_by_its_serial_number(self):
        self.play([{"at": 1.0, "do": "device", "id": 1, "serial": "LP-123", "rows": self.rows},
                   {"at": 1.5, "do": "device", "id": 2, "serial": "LP-456", "rows": self.left}])
        with self.launch("serial:=LP-456"):
            wait_until(lambda: self.seen(0), "the left hand, of the device that was named")
            topics = {name: kind for name, kind in rospy.get_published_topics() if name.endswith("leap_device")}
            self.assertEqual(topics, {"/leap_motion/leap_device": "leap_motion/Human",
                                      "/leap_motion/device_LP_123/leap_device": "leap_motion/Human"})
            self.assertFalse(self.seen(1))

    def test_without_the_bindings_it_says_what_to_install(self):
        environment = dict(os.environ, PYTHONPATH=os.environ["PYTHONPATH"].split(os.pathsep, 1)[1])
        answer = subprocess.run([program("leapc_bridge")], stderr=subprocess.PIPE, env=environment, universal_newlines=True,
                                check=False, timeout=60)
        self.assertEqual(answer.returncode, 1)
        self.assertIn("leapc-python-bindings", answer.stderr)
        self.assertEqual(answer.stderr.count("\n"), 1)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "leapc_bridge", LeapcBridgeTest)
