#!/usr/bin/env python3
"""rviz draws the hand and the cube that it holds: by regions of colour, not by pixels."""
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, "scripts"))
import screenshot  # noqa: E402
from watch_demo import Demo  # noqa: E402

WIDTH, HEIGHT = 400, 250
TIME_LIMIT = 240.0  # s; far beyond what is needed, so that only a real failure meets it


def missing_tools():
    return [tool for tool in ("Xvfb", "rviz", "import", "convert", "compare", "identify") if not shutil.which(tool)]


def is_skin(r, g, b):
    return r > 110 and 0.60 * r < g < 0.88 * r and 0.75 * g < b < 0.95 * g


def is_touching(r, g, b):
    return r > 90 and g < 0.5 * r and b < 0.4 * r


def is_cube(r, g, b):
    return r > 70 and 0.6 * r < g < 0.8 * r and b < 0.15 * r


class Region:
    """The pixels of a colour: their share of the picture, and their middle, from its top left."""

    def __init__(self, picture, is_of_colour):
        rgb = subprocess.run(["convert", picture, "-depth", "8", "rgb:-"], check=True, stdout=subprocess.PIPE).stdout
        found = [i for i in range(WIDTH * HEIGHT) if is_of_colour(*rgb[3 * i:3 * i + 3])]
        self.share = len(found) / (WIDTH * HEIGHT)
        self.x = sum(i % WIDTH for i in found) / max(1, len(found))
        self.y = sum(i // WIDTH for i in found) / max(1, len(found))


class LooksTest(unittest.TestCase):
    def setUp(self):
        rospy.init_node("looks_test")
        self.deadline = time.monotonic() + TIME_LIMIT
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def start_screen(self):
        reading, writing = os.pipe()
        screen = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{2 * WIDTH}x{2 * HEIGHT}x24",
                                   "-nolisten", "tcp"], pass_fds=[writing], stderr=subprocess.DEVNULL)
        os.close(writing)
        self.addCleanup(screen.wait)
        self.addCleanup(screen.terminate)
        with os.fdopen(reading) as pipe:
            os.environ["DISPLAY"] = ":" + pipe.readline().strip()
        os.environ.update({"LIBGL_ALWAYS_SOFTWARE": "1", "QT_X11_NO_MITSHM": "1"})

    def draw(self, focus, hidden):
        picture = os.path.join(self.folder.name, "picture.png")
        options = screenshot.parse(["--motion=grasp_cube", "--view=0.5,0.55", "--distance=0.34", f"--hide={hidden}",
                                    f"--size={WIDTH}x{HEIGHT}", f"--output={picture}"])
        self.assertTrue(screenshot.draw(options, focus, self.deadline), "rviz has not drawn the scene")
        return picture

    def test_hand_and_cube_are_seen_and_the_hands_layer_can_be_switched_off(self):
        missing = missing_tools()
        if missing:
            self.skipTest(f"nothing to draw with: {', '.join(missing)} not installed")
        moment = screenshot.parse(["--motion=grasp_cube", "--moment=grasp", "--size=1x1", "--output="])
        focus = screenshot.stop_at_moment(Demo(), moment, self.deadline)
        self.assertIsNotNone(focus, "the cube was not grasped")
        self.start_screen()

        picture = self.draw(focus, "capsules,text")
        skin, cube, touching = (Region(picture, colour) for colour in (is_skin, is_cube, is_touching))
        self.assertGreater(skin.share, 0.03)  # it is 0.07
        self.assertGreater(cube.share, 0.008)  # 0.018
        self.assertGreater(touching.share, 0.0015)  # 0.004: the fingertips
        self.assertLess(skin.y, cube.y, "the hand comes from above")
        self.assertLess(abs(touching.x - cube.x), 0.2 * WIDTH, "the fingertips are at the cube")

        without = Region(self.draw(focus, "hand,capsules,text"), is_skin)
        self.assertLess(without.share, 0.1 * skin.share)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "looks", LooksTest)
