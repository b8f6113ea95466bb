#!/usr/bin/env python3
"""mediapipe_bridge and webcam.launch, with stand-ins for MediaPipe and the camera (stand_in)."""
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
from tracker_hands import program, recording  # noqa: E402
from waiting import wait_until  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
# In the Leap's frame 0.9 m above its origin, and the same in world, where its y is up: looks down.
CAMERA, MOUNT = "0.05 0.9 0.02", "0.05 -0.02 0.9 1 0 0 0"


class MediapipeBridgeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("mediapipe_bridge_test")
        cls.folder = tempfile.mkdtemp()
        cls.path = os.environ.get("PYTHONPATH", "")
        recording(cls.folder, 30)
        cls.recording = os.path.join(cls.folder, "grasp_cube_right_30.csv")
        cls.seen = os.path.join(cls.folder, "seen.csv")
        cls.model = os.path.join(cls.folder, "hand_landmarker.task")
        with open(cls.model, "w", encoding="utf-8") as file:
            file.write("no model")
        os.environ.update(PYTHONPATH=os.path.join(HERE, "stand_in") + os.pathsep + cls.path, CAMERA=CAMERA,
                          MEDIAPIPE_STAND_IN=cls.seen)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_a_hand_before_the_camera_takes_the_cube_once_and_lets_it_go(self):
        events, frames = [], []
        kinds = (InteractionEvent.GRASP_BEGIN, InteractionEvent.GRASP_END)
        subscribers = [rospy.Subscriber("interaction_events", InteractionEvent, events.append, queue_size=1000),
                       rospy.Subscriber("hand_frame", HandFrame, frames.append, queue_size=1000)]

        def grasps():
            return [event.kind for event in list(events) if event.kind in kinds]
        with Launch("webcam.launch", "model:=" + self.model, "mount:=" + MOUNT, "rviz:=false"):
            wait_until(lambda: all(subscriber.get_num_connections() for subscriber in subscribers), "both nodes")
            os.rename(self.recording, self.seen)
            wait_until(lambda: len(grasps()) >= 2, "a grasp and its end")
        self.assertEqual(grasps(), list(kinds))
        hands = [hand for frame in frames for hand in frame.hands]
        self.assertEqual({hand.side for hand in hands}, {1})
        self.assertAlmostEqual(hands[-1].confidence, 0.75, delta=1e-6)
        for subscriber in subscribers:
            subscriber.unregister()

    def refusal(self, path, *arguments):
        answer = subprocess.run([program("mediapipe_bridge")] + list(arguments), stderr=subprocess.PIPE, universal_newlines=True,
                                env=dict(os.environ, PYTHONPATH=path), check=False, timeout=60)
        self.assertEqual(answer.returncode, 1)
        return answer.stderr

    def test_what_is_missing_is_named(self):
        self.assertIn("pip install mediapipe", self.refusal(self.path))
        self.assertIn("hand_landmarker.task", self.refusal(os.environ["PYTHONPATH"], "_model:=/no/where"))
        self.assertIn("camera '7' cannot be opened", self.refusal(os.environ["PYTHONPATH"], "_camera:=7"))


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "mediapipe_bridge", MediapipeBridgeTest)
