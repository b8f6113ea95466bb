#!/usr/bin/python3
"""Records the markers of each scene from a run of its own, has rviz draw them picture by picture, and makes a film of
the pictures. scripts/film starts it, with a master and a screen."""
import argparse
import collections
import filecmp
import os
import signal
import subprocess
import sys
import tempfile
import time

import rospy
import yaml
from mr_hand_interaction.msg import HandFrame, TrainingStatus
from visualization_msgs.msg import Marker, MarkerArray

from screenshot import REPOSITORY, has_scene
from watch_demo import grab, join_master

Scene = collections.namedtuple("Scene", "caption launch view lead")  # lead: seconds before the moment that it is about
DEMO = ["demo.launch", "rviz:=false"]
SCENES = {
    "grasp": Scene("grasp, carry, let go", DEMO + ["motion:=grasp_cube"], "interaction", 0.0),
    "catch": Scene("catch", DEMO + ["motion:=catch_ball"], "catch", 0.0),
    "slap": Scene("slap", DEMO + ["motion:=slap"], "interaction", 0.0),
    "bar": Scene("pinch a slender bar", DEMO + ["motion:=pinch_long"], "interaction", 0.0),
    "training": Scene("training", ["training.launch", "rviz:=false", "record:=false", "participant:=P01", "hands:=operator"],
                      "training", 3.0),
}
TOPICS = ("markers", "training/markers")
FONT = "/usr/share/rviz/ogre_media/fonts/liberation-sans/LiberationSans-Regular.ttf"
STARTED = 120.0  # s; by then the moment of a scene has come, and rviz has drawn
DRAWN = 20.0  # s; by then a picture has
BETWEEN = 0.15  # s, of two grabs that are to be the same


def parse(arguments):
    parser = argparse.ArgumentParser(prog="film")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=[])
    parser.add_argument("--output", default="out/film.webp")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--rate", type=float, default=10.0)
    parser.add_argument("--size", default="480x300")
    parser.add_argument("--quality", type=float, default=40.0)
    parser.add_argument("--print-screen", action="store_true", help="the size of the screen that is needed, and no more")
    options = parser.parse_args(arguments)
    for scene in options.scenes:
        if scene not in SCENES:
            parser.error("unknown scene '%s'; allowed: %s" % (scene, ", ".join(SCENES)))
    options.scenes = options.scenes or list(SCENES)
    return options


class Launched:
    def __init__(self, arguments):
        self.process = subprocess.Popen(["roslaunch", "mr_hand_interaction"] + arguments, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)

    def __enter__(self):
        return self.process

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(60)


class Recorder:
    """All that is shown, and when the moment was that the scene is about: a hand is seen, or the object at a place."""

    def __init__(self, training):
        self.moment, self.shown = None, []
        self.subscribers = [rospy.Subscriber(topic, MarkerArray, self.take, topic, queue_size=1000) for topic in TOPICS]
        if training:
            self.subscribers.append(rospy.Subscriber("training/status", TrainingStatus, self.take_status))
        else:
            self.subscribers.append(rospy.Subscriber("hand_frame", HandFrame, self.take_hands))

    def take(self, message, topic):
        self.shown.append((time.monotonic(), topic, message))

    def take_status(self, status):
        if status.phase == status.RUNNING and status.stage == status.MAINTENANCE:
            self.moment = self.moment or time.monotonic()

    def take_hands(self, frame):
        if frame.hands:
            self.moment = self.moment or time.monotonic()

    def wait(self, seconds, process):
        deadline = time.monotonic() + STARTED
        while self.moment is None or time.monotonic() < self.moment + seconds:
            if process.poll() is not None or (self.moment is None and time.monotonic() > deadline):
                raise RuntimeError("the scene did not begin")
            time.sleep(0.05)
        for subscriber in self.subscribers:
            subscriber.unregister()


def record(scene, seconds, folder):
    arguments = list(scene.launch)
    if scene.view == "training":
        arguments.append("folder:=" + os.path.join(folder, "session"))
    with Launched(arguments) as process:
        recorder = Recorder(scene.view == "training")
        recorder.wait(seconds - scene.lead, process)
    return recorder.moment - scene.lead, recorder.shown


class Stage:
    """What rviz shows, marker by marker, as of a time."""

    def __init__(self):
        self.publishers = {topic: rospy.Publisher(topic, MarkerArray, queue_size=10) for topic in TOPICS}

    def is_watched(self):
        return self.publishers["markers"].get_num_connections() > 0

    def clear(self):
        for publisher in self.publishers.values():
            publisher.publish(MarkerArray([Marker(action=Marker.DELETEALL)]))

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


def write_config(view, size, file):
    with open(os.path.join(REPOSITORY, "rviz", view + ".rviz"), encoding="utf-8") as source:
        config = yaml.safe_load(source)
    for display in config["Visualization Manager"]["Displays"]:
        if display["Name"] == "Hands and objects":
            display["Namespaces"]["text"] = False
    width, height = (2 * int(number) for number in size.split("x"))
    config["Window Geometry"].update({"Width": width, "Height": height})
    yaml.safe_dump(config, file)
    file.flush()


def drawn(before, now, process):
    """Takes the screen's picture when it no longer changes; scenes move, so it has changed since the last."""
    deadline = time.monotonic() + DRAWN
    time.sleep(2 * BETWEEN)
    grab(before)
    while time.monotonic() < deadline and process.poll() is None:
        time.sleep(BETWEEN)
        grab(now)
        if filecmp.cmp(before, now, shallow=False):
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


def draw(scene, begin, shown, options, folder):
    """Files of the pictures, one after the other."""
    stage, files = Stage(), []
    before, now = (os.path.join(folder, name) for name in ("before.ppm", "now.ppm"))
    with tempfile.NamedTemporaryFile("w", suffix=".rviz", encoding="utf-8") as config:
        write_config(scene.view, options.size, config)
        rviz = subprocess.Popen(["rosrun", "rviz", "rviz", "--fullscreen", "-d", config.name],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            wait_for_rviz(stage, shown, folder, rviz)
            stage.clear()
            since = 0.0
            for picture in range(int(options.seconds * options.rate)):
                until = begin + picture / options.rate
                stage.show([entry for entry in shown if since < entry[0] <= until])
                since = until
                drawn(before, now, rviz)
                files.append(os.path.join(folder, "%04d.png" % picture))
                finish(now, scene.caption, options.size, files[-1])
        finally:
            rviz.terminate()
            rviz.wait()
    return files


def finish(picture, caption, size, file):
    subprocess.run(["convert", picture, "-resize", size, "-font", FONT, "-pointsize", "13", "-fill", "#d0d4da", "-gravity",
                    "southwest", "-annotate", "+12+10", caption, "-strip", file], check=True)


def main():
    options = parse(sys.argv[1:])
    if options.print_screen:
        print("x".join(str(2 * int(number)) for number in options.size.split("x")))
        return 0
    join_master("film", time.monotonic() + STARTED)
    os.makedirs(os.path.dirname(options.output) or ".", exist_ok=True)
    with tempfile.TemporaryDirectory() as parent:
        files = []
        for name in options.scenes:
            folder = os.path.join(parent, name)
            os.mkdir(folder)
            begin, shown = record(SCENES[name], options.seconds, folder)
            files += draw(SCENES[name], begin, shown, options, folder)
            print("film: %s, %d pictures" % (name, len(files)), flush=True)
        command = ["img2webp", "-loop", "0", "-mixed", "-min_size", "-m", "6", "-q", "%g" % options.quality, "-lossy",
                   "-d", "%d" % round(1000 / options.rate)]
        subprocess.run(command + files + ["-o", options.output], check=True, stdout=subprocess.DEVNULL)
    print("film: %s, %d kB" % (options.output, os.path.getsize(options.output) // 1000))
    return 0


if __name__ == "__main__":
    try:
        code = main()
    except (RuntimeError, OSError, subprocess.SubprocessError) as error:
        print("film: %s" % error, file=sys.stderr)
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)  # rospy's threads would hold it up
