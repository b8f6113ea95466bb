"""Has rviz draw markers picture by picture: each picture bears a mark, so that it is known when it has been drawn."""
import collections
import filecmp
import math
import os
import subprocess
import time

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from screenshot import has_scene
from watch_demo import grab

TOPICS = ("markers", "training/markers")
STARTED = 120.0  # s; by then the moment of a scene has come, and rviz has drawn
DRAWN = 20.0  # s; by then a picture has
BETWEEN = 0.1  # s, of two grabs that are to be the same
TICKS = ((0, 255, 0), (255, 0, 255))  # of the corner that tells one picture from the next


class Stage:
    """What rviz shows, marker by marker, as of a time."""

    def __init__(self):
        self.publishers = {topic: rospy.Publisher(topic, MarkerArray, queue_size=10) for topic in TOPICS}

    def is_watched(self):
        return self.publishers["markers"].get_num_connections() > 0

    def clear(self):
        for publisher in self.publishers.values():
            publisher.publish(MarkerArray([Marker(action=Marker.DELETEALL)]))

    def tick(self, picture, view, aspect):
        """A small mark in the lower right corner."""
        tick = Marker(ns="tick", type=Marker.TRIANGLE_LIST)
        tick.header.frame_id, tick.scale.x, tick.scale.y, tick.scale.z = "world", 1.0, 1.0, 1.0
        tick.pose.orientation.w = 1.0
        tick.points = [Point(*corner) for corner in corners_of_mark(view, aspect)]
        tick.colors = [ColorRGBA(*(channel / 255.0 for channel in TICKS[picture % 2]), 1.0)] * 3
        self.publishers["markers"].publish(MarkerArray([tick]))

    def show(self, messages):
        """The last of each marker: it stays until the next picture, however long that takes."""
        last = {topic: collections.OrderedDict() for topic in TOPICS}
        for _, topic, message in messages:
            if topic == "training/markers":  # each message has all
                last[topic] = {None: Marker(action=Marker.DELETEALL)}
            for marker in message.markers:
                if marker.action == Marker.DELETEALL:
                    last[topic] = {None: marker}
                marker.lifetime, marker.header.stamp = rospy.Duration(), rospy.Time()
                last[topic][marker.ns, marker.id] = marker
        for topic, markers in last.items():
            if markers:
                self.publishers[topic].publish(MarkerArray(list(markers.values())))


def corners_of_mark(view, aspect):
    """A triangle that fills the corner of what the orbiting view sees, at 0.1 m."""
    yaw, pitch = view["Yaw"], view["Pitch"]
    back = (math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch), math.sin(pitch))
    right = (-math.sin(yaw), math.cos(yaw), 0.0)
    up = (-math.cos(yaw) * math.sin(pitch), -math.sin(yaw) * math.sin(pitch), math.cos(pitch))
    half = 0.1 * math.tan(0.5 * view["Field of View"])
    focus = [view["Focal Point"][axis] for axis in "XYZ"]

    def at(x, y):
        return [focus[i] + (view["Distance"] - 0.1) * back[i] + half * (aspect * x * right[i] + y * up[i]) for i in range(3)]
    return at(0.97, -0.96), at(1.5, -0.96), at(0.97, -1.5)


def shows_tick(file, picture):
    """The size of the picture tells nothing of rviz's frame: the mark is looked for in the corner."""
    corner = subprocess.run(["convert", file, "-gravity", "southeast", "-crop", "4x4+2+2", "-depth", "8", "rgb:-"],
                            check=True, stdout=subprocess.PIPE).stdout
    wanted = TICKS[picture % 2]
    return all(abs(channel - wanted[i % 3]) < 60 for i, channel in enumerate(corner))


def drawn(picture, before, now, process):
    """Takes the screen's picture when its mark is there and it no longer changes."""
    deadline = time.monotonic() + DRAWN
    grab(before)
    while time.monotonic() < deadline and process.poll() is None:
        time.sleep(BETWEEN)
        grab(now)
        if filecmp.cmp(before, now, shallow=False) and shows_tick(now, picture):
            return
        os.replace(now, before)
    raise RuntimeError("rviz has not drawn")


def wait_for_rviz(stage, shown, folder, process):
    deadline, file = time.monotonic() + STARTED, os.path.join(folder, "start.png")
    while process.poll() is None and time.monotonic() < deadline:
        if stage.is_watched():
            stage.show(shown)
            grab(file)
            if has_scene(file):
                return
        time.sleep(0.5)
    raise RuntimeError("rviz has not started")
