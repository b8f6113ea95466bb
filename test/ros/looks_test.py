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

from mr_hand_interaction.msg import ObjectStateArray

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, os.pardir, os.pardir, "scripts")]
import screenshot  # noqa: E402
from launching import Launch  # noqa: E402
from watch_demo import Demo  # noqa: E402

WIDTH, HEIGHT = 400, 250
TIME_LIMIT = 400.0  # s; far beyond what is needed, so that only a real failure meets it
RUN = 60.0  # s; the scripted hand holds the cube after 4 of them
RUNS = 3


def missing_tools():
    return [tool for tool in ("Xvfb", "rviz", "import", "convert", "compare", "identify") if not shutil.which(tool)]


def is_skin(r, g, b):
    return r > 110 and 0.60 * r < g < 0.88 * r and 0.75 * g < b < 0.95 * g


def is_touching(r, g, b):
    return r > 90 and g < 0.56 * r and b < 0.45 * r


def is_cube(r, g, b):
    return r > 70 and 0.6 * r < g < 0.8 * r and b < 0.15 * r


def is_text(r, g, b):
    return min(r, g, b) > 100 and max(r, g, b) < 1.15 * min(r, g, b)


class Region:
    """The pixels of a colour: their share of the picture, and their middle, from its top left."""

    def __init__(self, picture, is_of_colour):
        rgb = subprocess.run(["convert", picture, "-resize", f"{WIDTH}x{HEIGHT}!", "-depth", "8", "rgb:-"], check=True,
                             stdout=subprocess.PIPE).stdout
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
                                   "-noreset", "-nolisten", "tcp"], pass_fds=[writing], stderr=subprocess.DEVNULL)
        os.close(writing)
        self.addCleanup(screen.wait)
        self.addCleanup(screen.terminate)
        with os.fdopen(reading) as pipe:
            os.environ["DISPLAY"] = ":" + pipe.readline().strip()
        os.environ.update({"LIBGL_ALWAYS_SOFTWARE": "1", "QT_X11_NO_MITSHM": "1"})

    def grasp(self):
        """Where to look at the hand that holds the cube, in a demo that stands still from now on."""
        moment = screenshot.parse(["--motion=grasp_cube", "--moment=grasp", "--size=1x1", "--output="])
        for _ in range(RUNS):
            demo = Demo()  # listens before the hand sets out
            launch = Launch("demo.launch", "motion:=grasp_cube", "rviz:=false", "loop:=false")
            launch.__enter__()
            focus = screenshot.stop_at_moment(demo, moment, time.monotonic() + RUN)
            # On a slow machine the hand may have gone on before the simulation stood still.
            if focus and rospy.wait_for_message("objects", ObjectStateArray, RUN).objects[0].held:
                self.addCleanup(launch.__exit__)
                return focus
            launch.__exit__()
        self.fail("the cube was not grasped")

    def draw(self, focus, hidden, least, view="0.5,0.55"):
        """The picture once it has these shares of colours."""
        shares = {}

        def complete(file):
            shares.update({colour.__name__: Region(file, colour).share for colour in least})
            return all(shares[colour.__name__] > share for colour, share in least.items())
        picture = os.path.join(self.folder.name, "picture.png")
        options = screenshot.parse(["--motion=grasp_cube", f"--view={view}", "--distance=0.34", f"--hide={hidden}",
                                    f"--size={WIDTH}x{HEIGHT}", f"--output={picture}"])
        self.assertTrue(screenshot.draw(options, focus, self.deadline, complete), f"rviz has not drawn all: {shares}")
        return picture

    def test_hand_cube_and_text_are_seen_and_the_hands_layer_can_be_switched_off(self):
        missing = missing_tools()
        if missing:
            self.skipTest(f"nothing to draw with: {', '.join(missing)} not installed")
        focus = self.grasp()
        self.start_screen()

        # They are 0.07, 0.017 and, of what is seen of the pads, 0.0006; where nothing touches the last is below 0.00002.
        picture = self.draw(focus, "text", {is_skin: 0.03, is_cube: 0.008, is_touching: 0.0003})
        skin, cube, touching = (Region(picture, colour) for colour in (is_skin, is_cube, is_touching))
        self.assertLess(skin.y, cube.y, "the hand comes from above")
        self.assertLess(abs(touching.x - cube.x), 0.2 * WIDTH, "the fingertips are at the cube")

        without = Region(self.draw(focus, "hand,text", {is_cube: 0.008}), is_skin)
        self.assertLess(without.share, 0.1 * skin.share)

        for view in "0.5,0.55", "top":
            # The cube too: rviz's splash screen has white letters.
            text = Region(self.draw(focus, "hand,contacts,friction,forces,Grid", {is_text: 0.001, is_cube: 0.008}, view), is_text)
            self.assertTrue(text.x < 0.4 * WIDTH and text.y > 0.9 * HEIGHT, f"the text is in the lower left corner: {view}")


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "looks", LooksTest)
