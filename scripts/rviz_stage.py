"""Lets rviz draw poses and markers picture by picture. A mark in each picture shows when it has been drawn."""
import collections
import contextlib
import filecmp
import math
import os
import shutil
import signal
import subprocess
import threading
import time

import rospy
import yaml
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from mr_hand_interaction.msg import RenderedView, SceneDescription
from visualization_msgs.msg import Marker, MarkerArray

from free_port import free_port
from screenshot import has_scene
from watch_demo import grab, join_master

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAMS = {"rviz": "rviz", "roscore": "python3-roslaunch", "Xvfb": "xvfb", "import": "imagemagick", "convert": "imagemagick"}
MARKERS = ("markers", "training/markers")
POSES = {"scene": SceneDescription, "rendered_view": RenderedView}  # in the order in which they are shown
STARTED = 120.0  # s; limit for rviz to have started and drawn
DRAWN = 60.0  # s; limit for a picture, also on a busy machine
BETWEEN = 0.1  # s between two grabs that must be equal
TRIES = 10  # grabs of a scene before it is shown again from its beginning
TICKS = ((0, 255, 0), (255, 0, 255))  # colours of the mark in the corner, alternating from picture to picture


def missing_tools():
    """Packages of the programs that are missing."""
    return sorted({package for program, package in PROGRAMS.items() if not shutil.which(program)})


def shipped_view(name):
    """A configuration of rviz/."""
    for folder in (os.path.join(HERE, "..", "rviz"), os.path.join(HERE, "..", "..", "share", "mr_hand_interaction", "rviz")):
        if os.path.exists(os.path.join(folder, name + ".rviz")):
            with open(os.path.join(folder, name + ".rviz"), encoding="utf-8") as source:
                return yaml.safe_load(source)
    raise RuntimeError("rviz/" + name + ".rviz is not found; allowed: a built or installed package")


def picture_view(name, width, height):
    """A configuration of rviz/ for a window of this size without panels."""
    config = shipped_view(name)
    config["Panels"] = []
    config["Window Geometry"].update({"Width": width, "Height": height, "Hide Left Dock": True, "Hide Right Dock": True})
    return config


class Started:
    """Programs that end with this context."""

    def __init__(self):
        self.processes = []

    def start(self, command, **options):
        self.processes.append(subprocess.Popen(command, stdout=options.pop("stdout", subprocess.DEVNULL),
                                               stderr=subprocess.DEVNULL, **options))
        return self.processes[-1]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGINT if "roscore" in process.args[0] else signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def start_screen(started, width, height):
    read, write = os.pipe()
    started.start(["Xvfb", "-displayfd", str(write), "-noreset", "-screen", "0", "%dx%dx24" % (width, height), "-nolisten",
                   "tcp"], pass_fds=[write])
    os.close(write)
    with os.fdopen(read) as told:
        display = told.readline().strip()
    if not display:
        raise RuntimeError("Xvfb did not start")
    os.environ.update(DISPLAY=":" + display, LIBGL_ALWAYS_SOFTWARE="1", QT_X11_NO_MITSHM="1")
    for name in ("WAYLAND_DISPLAY", "XAUTHORITY"):
        os.environ.pop(name, None)


@contextlib.contextmanager
def own_stage(name, width, height):
    """A private screen and ROS master, with this process as a node."""
    missing = missing_tools()
    if missing:
        raise RuntimeError("rviz draws on a virtual screen, for which these packages are missing: " + " ".join(missing))
    with Started() as started:
        start_screen(started, width, height)
        os.environ.update(ROS_MASTER_URI="http://127.0.0.1:%d" % free_port(), ROS_IP="127.0.0.1")
        started.start(["roscore", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]])
        join_master(name, time.monotonic() + STARTED)
        yield


class Stage:
    """Messages of some topics that rviz shows at one time."""

    def __init__(self, topics):
        self.publishers = {topic: rospy.Publisher(topic, POSES.get(topic, MarkerArray), queue_size=100, latch=topic == "scene")
                           for topic in topics}
        self.mark = self.publishers[[topic for topic in MARKERS if topic in topics][-1]]
        self.poses, self.over = {}, threading.Event()
        self.repeating = threading.Thread(target=self.repeat, daemon=True)

    def __enter__(self):
        self.repeating.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        self.repeating.join()

    def is_watched(self):
        return all(publisher.get_num_connections() > 0 for publisher in self.publishers.values())

    def clear(self):
        for topic in MARKERS:
            if topic in self.publishers:
                self.publishers[topic].publish(MarkerArray([Marker(action=Marker.DELETEALL)]))

    def tick(self, picture, view, aspect):
        """A small mark in the lower right corner."""
        tick = Marker(ns="tick", type=Marker.TRIANGLE_LIST)
        tick.header.frame_id, tick.scale.x, tick.scale.y, tick.scale.z = "world", 1.0, 1.0, 1.0
        tick.pose.orientation.w = 1.0
        tick.points = [Point(*corner) for corner in corners_of_mark(view, aspect)]
        tick.colors = [ColorRGBA(*(channel / 255.0 for channel in TICKS[picture % 2]), 1.0)] * 3
        self.mark.publish(MarkerArray([tick]))

    def show(self, messages):
        """Shows the last of all poses and of each marker, until the next picture."""
        last = {topic: collections.OrderedDict() for topic in MARKERS}
        views = []
        for _, topic, message in messages:
            if topic in POSES:
                self.poses[topic] = message
                views += [message] if topic == "rendered_view" else []
                continue
            if topic == "training/markers":  # each message has all
                last[topic] = {None: Marker(action=Marker.DELETEALL)}
            for marker in message.markers:
                if marker.action == Marker.DELETEALL:
                    last[topic] = {None: marker}
                marker.lifetime, marker.header.stamp = rospy.Duration(), rospy.Time()
                last[topic][marker.ns, marker.id] = marker
        if any(topic == "scene" for _, topic, _ in messages):
            self.publishers["scene"].publish(self.poses["scene"])
        for message in views:  # all of them: an impact is in one frame only
            self.publishers["rendered_view"].publish(message)
        for topic, markers in last.items():
            if markers:
                self.publishers[topic].publish(MarkerArray(list(markers.values())))

    def repeat(self):
        """Sends hands again, because rviz removes hands without messages, also while a picture is taken."""
        while not self.over.wait(BETWEEN):
            if "rendered_view" in self.poses:
                self.publishers["rendered_view"].publish(self.poses["rendered_view"])


def corners_of_mark(view, aspect):
    """A triangle at 0.1 m that fills a corner of the orbiting view."""
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
    """Looks for the mark in the corner; the picture may include rviz's frame."""
    corner = subprocess.run(["convert", file, "-gravity", "southeast", "-crop", "4x4+2+2", "-depth", "8", "rgb:-"],
                            check=True, stdout=subprocess.PIPE).stdout
    wanted = TICKS[picture % 2]
    return all(abs(channel - wanted[i % 3]) < 60 for i, channel in enumerate(corner))


def drawn(picture, before, now, process):
    """Grabs the screen once it shows the mark and no longer changes."""
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
            for _ in range(TRIES):
                time.sleep(BETWEEN)
                grab(file)
                if has_scene(file):
                    return
        time.sleep(0.5)
    raise RuntimeError("rviz has not started")
