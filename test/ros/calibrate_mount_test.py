#!/usr/bin/env python3
"""calibrate_mount: a hand that touches known points, as a Leap's driver would send it, gives the device's pose back."""
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy
import roslib.packages
import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import leap_messages  # noqa: E402

TOPIC = "/leap_motion/leap_device"
RATE = 300.0  # Hz: faster than a device, so that the test is short
JITTER = 0.0002  # m: of a Leap that sees a hand at rest
SAMPLES = 100
RADIUS = 0.009  # m: half of the fingers' width in leap_messages
UP = numpy.array((0.0, 0.0, 1.0))
POINTS = numpy.array([(-0.15, -0.10, 0.0), (0.15, -0.10, 0.0), (0.15, 0.12, 0.0), (-0.12, 0.10, 0.06)])
PLACE = numpy.array((0.05, -0.08, 0.02))  # of the device in world
TURN = numpy.array((0.6963642403, 0.1227878040, 0.1227878040, 0.6963642403))  # y up, turned by 20 degrees about z
# The mean at a point is off by 0.02 mm in each coordinate; over points 0.15 m from their middle, with the device
# 0.2 m from it, that is 0.1 mrad and 0.05 mm. Six times that:
TURN_TOLERANCE, PLACE_TOLERANCE = 0.6e-3, 0.3e-3


def matrix(q):
    x, y, z, w = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


class Driver(threading.Thread):
    """Sends a flat hand whose index fingertip rests on one point after the other."""

    def __init__(self):
        super().__init__(daemon=True)
        self.types = leap_messages.classes("head")
        self.publisher = rospy.Publisher(TOPIC, self.types["leap_motion/Human"], queue_size=10)
        self.tip = numpy.array(leap_messages.open_hand("right")[2][1][4])
        self.point, self.ended = None, threading.Event()
        self.random = random.Random(1)

    def offset(self, point):
        in_device = matrix(TURN).T @ (POINTS[point] + RADIUS * UP - PLACE)
        return in_device - self.tip + [self.random.gauss(0.0, JITTER) for _ in range(3)]

    def run(self):
        rate = rospy.Rate(RATE)
        while not self.ended.is_set() and not rospy.is_shutdown():
            point = self.point
            if point is None:
                message = leap_messages.human(self.types, rospy.get_time(), ())
            else:
                message = leap_messages.human(self.types, rospy.get_time(), offset=self.offset(point))
            self.publisher.publish(message)
            rate.sleep()


def calibrate(*arguments, **options):
    return subprocess.Popen(roslib.packages.find_node("mr_hand_interaction", "calibrate_mount")[:1] + list(arguments),
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, **options)


class CalibrateMountTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def file(self, name):
        return os.path.join(self.folder, name)

    def points_file(self):
        with open(self.file("points.yaml"), "w", encoding="utf-8") as file:
            file.write("points:\n")
            for point in POINTS:
                file.write("  - {world: [%g, %g, %g], normal: [0, 0, 1]}\n" % tuple(point))
        return self.file("points.yaml")

    def touch_as_asked(self, process):
        """All that it prints, while the hand goes where it says."""
        driver = Driver()
        driver.start()
        printed = ""
        for line in process.stdout:
            printed += line
            asked = re.match(r"point (\d) of %d: touch " % len(POINTS), line)
            if asked:
                driver.point = int(asked.group(1)) - 1
        driver.ended.set()
        driver.join()
        return printed

    def mount(self, printed):
        found = re.search(r'^mount:="(.*)"$', printed, re.MULTILINE)
        self.assertTrue(found, printed)
        values = numpy.array([float(value) for value in found.group(1).split()])
        self.assertEqual(len(values), 7)
        return values[:3], values[3:]

    def test_touched_points_give_the_mount_and_the_saved_ones_do_without_a_master(self):
        rospy.init_node("calibrate_mount_test")
        process = calibrate(self.points_file(), "--samples", str(SAMPLES), "--save", self.file("saved.yaml"))
        printed = self.touch_as_asked(process)
        self.assertEqual(process.wait(), 0, process.stderr.read())
        place, turn = self.mount(printed)
        self.assertLess(numpy.linalg.norm(place - PLACE), PLACE_TOLERANCE)
        self.assertLess(2 * numpy.linalg.norm(turn * numpy.sign(turn @ TURN) - TURN), TURN_TOLERANCE)
        self.assertEqual(len(re.findall("^residual of ", printed, re.MULTILINE)), len(POINTS))
        rms = float(re.search(r"^rms: (.*) mm$", printed, re.MULTILINE).group(1))
        self.assertLess(rms, 0.1)  # the means' 0.02 mm in three coordinates, three times over

        nowhere = dict(os.environ, ROS_MASTER_URI="http://localhost:1")
        again, error = calibrate(self.file("saved.yaml"), env=nowhere).communicate()
        self.assertEqual(error, "")
        numpy.testing.assert_allclose(numpy.hstack(self.mount(again)), numpy.hstack((place, turn)), atol=1e-5)

    def test_what_cannot_be_calibrated_is_refused_with_one_line(self):
        exact = ", ".join("{world: [%g, %g, 0], device: [%g, %g, 0]}" % (x, y, x, y) for x, y in ((0, 0), (1, 0)))
        cases = (("points: [%s]" % exact, [], 1, "2 points; at least three"),
                 ("points: [%s, {world: [2, 0, 0]}]" % exact, [], 1, "lie on one line"),
                 ("points: [%s, {world: [0, 1, 0], device: [0, 1.1, 0]}]" % exact, [], 1, "residual is too large"),
                 ("points: [%s, {world: [0, 1, 0], device: [0, 1.1, 0]}]" % exact, ["--max-rms", "100"], 0, ""),
                 ("points: []", ["--side", "both"], 2, "allowed: left or right"),
                 ("points: []", ["--samples", "0"], 2, "--samples '0' is not allowed"))
        for text, options, status, expected in cases:
            with open(self.file("case.yaml"), "w", encoding="utf-8") as file:
                file.write(text)
            process = calibrate(self.file("case.yaml"), *options)
            _, error = process.communicate()
            self.assertEqual(process.returncode, status, error)
            self.assertIn(expected, error)
            self.assertEqual(error.count("\n"), 1 if status else 0, error)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "calibrate_mount", CalibrateMountTest)
