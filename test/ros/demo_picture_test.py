#!/usr/bin/env python3
"""What a demo without a display leaves behind is of one moment: picture and summary show what still stands afterwards."""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest

HERE = os.path.dirname(os.path.abspath(__file__))
SCRIPTS = os.path.join(HERE, os.pardir, os.pardir, "scripts")
sys.path[:0] = [HERE, SCRIPTS]
import looks_test  # noqa: E402
from launching import Launch  # noqa: E402
from waiting import wait_until  # noqa: E402
from watch_demo import CARRIED, SEEN_STRUCK, Demo, grab, without_status_bar  # noqa: E402

TIME_LIMIT = 240  # s; far beyond what is needed, so that only a real failure meets it


@unittest.skipIf(looks_test.missing_tools(), "not installed: " + ", ".join(looks_test.missing_tools()))
class DemoPictureTest(unittest.TestCase):
    start_screen = looks_test.LooksTest.start_screen

    def setUp(self):
        rospy.init_node("demo_picture_test")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.start_screen()

    def watch(self, motion):
        """Runs the demo until its picture is taken. What stands then: by object, where; and whether the picture does."""
        picture, later = (os.path.join(self.folder, name) for name in ("demo.png", "later.png"))
        demo = Demo()
        with Launch("demo.launch", "motion:=" + motion, "reset:=/watch_demo/reset"):
            subprocess.run([sys.executable, os.path.join(SCRIPTS, "watch_demo.py"), "--motion", motion, "--picture", picture,
                            "--time-limit", str(TIME_LIMIT)], check=True, stdout=subprocess.DEVNULL)
            wait_until(lambda: demo.still, "the simulation's stand")
            places = {name: thing.pose.position for name, thing in demo.objects.items()}
            held = {name for name, thing in demo.objects.items() if thing.held}
            grab(later)
        self.assertEqual(without_status_bar(picture), without_status_bar(later))
        with open(os.path.join(self.folder, "demo_summary.txt"), encoding="utf-8") as file:
            return file.read(), places, held

    def assert_tells(self, summary, name, place, least):
        told = re.search(name + r": at (\S+) (\S+) (\S+) m, (\S+) cm from its start", summary)
        for text, value in zip(told.groups(), (place.x, place.y, place.z)):
            self.assertAlmostEqual(float(text), value, delta=0.0006, msg=summary)
        self.assertGreaterEqual(float(told.group(4)), 100.0 * least - 0.05, summary)

    def test_a_cube_that_is_tapped_has_moved(self):
        summary, places, held = self.watch("tap")
        self.assert_tells(summary, "cube", places["cube"], SEEN_STRUCK)
        self.assertEqual(held, set())

    def test_a_cuboid_that_is_pinched_is_held(self):
        summary, places, held = self.watch("pinch_long")
        self.assert_tells(summary, "long_cuboid", places["long_cuboid"], CARRIED)
        self.assertEqual(held, {"long_cuboid"})
        self.assertIn(", held", summary)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "demo_picture", DemoPictureTest)
