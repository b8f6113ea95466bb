"""The scripted hand as other trackers would give it: joints in the order of MediaPipe, WebXR or OpenXR, with noise."""
import csv
import os
import random
import subprocess

import roslib.packages

FINGERS = ("thumb", "index", "middle", "ring", "pinky")


def program(name):
    return roslib.packages.find_node("mr_hand_interaction", name)[0]


def recording(folder, rate, motion="grasp_cube", side="right"):
    """Rows of one run, each with a hand or without; lengths in metres, in the Leap's frame."""
    file = os.path.join(folder, "%s_%s_%g.csv" % (motion, side, rate))
    subprocess.run([program("synthetic_hand_node"), "--csv", file, "--motion", motion, "--side", side,
                    "--rate", str(rate)], check=True)
    with open(file, encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def point(row, joint):
    return tuple(float(row["%s_%s" % (joint, axis)]) for axis in "xyz")


def joints(row, count):
    """What a tracker with so many joints gives of a row; nothing of one without a hand."""
    if not row["palm_x"]:
        return []
    first = {21: 1, 25: 0, 26: 0}[count]
    points = [point(row, "palm")] if count == 26 else []
    points.append(point(row, "wrist"))
    for finger in FINGERS:
        points += [point(row, "%s_j%d" % (finger, j)) for j in range(1 if finger == "thumb" else first, 5)]
    assert len(points) == count
    return points


class Noise:
    """White, of a standard deviation [m] on each axis of each joint; the same for the same seed."""

    def __init__(self, deviation, seed=1):
        self.deviation, self.random = deviation, random.Random(seed)

    def on(self, points):
        return [tuple(x + self.random.gauss(0.0, self.deviation) for x in point) for point in points]


class Dropouts:
    """Joints that are not tracked, None in their place: of each frame a share at random, and in bursts of some seconds
    some that a hand hides from its tracker; the same for the same seed."""

    def __init__(self, share=0.0, hidden=(), burst=0.0, every=1.0, seed=1):
        self.share, self.hidden, self.burst, self.every, self.random = share, hidden, burst, every, random.Random(seed)

    def on(self, points, time):
        hides = time % self.every < self.burst
        return [None if self.random.random() < self.share or (hides and i in self.hidden) else point
                for i, point in enumerate(points)]
