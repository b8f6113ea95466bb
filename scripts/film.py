#!/usr/bin/python3
"""Records the poses of each scene in a separate run, lets rviz draw them picture by picture, and makes a film of the
pictures. scripts/film starts it, with a master and a screen. Also draws a bag of replay --markers, on a private screen."""
import argparse
import collections
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from study import program  # noqa: E402

import rosbag
import rospy
import yaml
from mr_hand_interaction.msg import HandFrame, TrainingStatus

from rviz_stage import POSES, STARTED, Stage, drawn, own_stage, picture_view, wait_for_rviz
from screenshot import FONT
from watch_demo import join_master

TOPICS = list(POSES) + ["training/markers"]
# `lead`: seconds before the moment that it is about, negative: after; `speed`: 0.1 is ten times slower; `eye`: overrides the view.
Scene = collections.namedtuple("Scene", "caption launch view lead speed eye", defaults=(1.0, {}))
DEMO = ["demo.launch", "rviz:=false"]
SCENES = {
    "grasp": Scene("grasp, carry, let go", DEMO + ["motion:=grasp_cube"], "interaction", 0.0),
    "catch": Scene("catch", DEMO + ["motion:=catch_ball"], "catch", 0.0),
    # Obliquely from the palm's side, so wide that the cube's flight is in view. The ring of an impact lasts 0.15 s: one picture
    # at full speed.
    "slap": Scene("slap, twenty times slower", DEMO + ["motion:=slap"], "interaction", -1.18, 1.0 / 20.0,
                  {"Yaw": 4.0, "Pitch": 0.25, "Distance": 0.62, "Focal Point": {"X": -0.12, "Y": 0.02, "Z": 0.24}}),
    "bar": Scene("pinch a slender bar", DEMO + ["motion:=pinch_long"], "interaction", 0.0),
    "training": Scene("training", ["training.launch", "rviz:=false", "record:=false", "participant:=P01", "hands:=operator"],
                      "training", 3.0),
}
WIDER = 1.2  # factor on the distance of rviz's initial view
BACKGROUND = "#3a3f47"
WRITERS = {".webp": ("img2webp", "webp"), ".mp4": ("ffmpeg", "ffmpeg")}  # program and package


def parse(arguments):
    parser = argparse.ArgumentParser(prog="film")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=[])
    parser.add_argument("--bag", help="of replay --markers: all of it")
    parser.add_argument("--output", default="out/film.webp", help="ends in .webp or .mp4")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--rate", type=float, default=10.0)
    parser.add_argument("--size", default="960x600")
    parser.add_argument("--quality", type=float, default=75.0)
    parser.add_argument("--still", type=float, help="seconds from the scene's begin: this one picture, a .png")
    parser.add_argument("--print-screen", action="store_true", help="the size of the screen that is needed, and no more")
    options = parser.parse_args(arguments)
    for scene in options.scenes:
        if scene not in SCENES:
            parser.error("unknown scene '%s'; allowed: %s" % (scene, ", ".join(SCENES)))
    options.scenes = options.scenes or list(SCENES)
    if options.still is not None:
        if len(options.scenes) != 1 or not options.output.endswith(".png"):
            parser.error("--still takes one scene and an output that ends in .png")
        options.seconds = options.still
    elif os.path.splitext(options.output)[1] not in WRITERS:
        parser.error("'%s' is no film; allowed: a file that ends in %s" % (options.output, " or ".join(WRITERS)))
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
    """Records everything that is shown into a bag, as Python would be too slow. Notes the main moment of the scene: a hand
    appears, or the object is to be at a place."""

    def __init__(self, training, folder):
        self.moment, self.bag = None, os.path.join(folder, "shown.bag")
        self.process = subprocess.Popen(["rosrun", "rosbag", "record", "-q", "-O", self.bag] + ["/" + topic for topic in TOPICS])
        if training:
            self.subscriber = rospy.Subscriber("training/status", TrainingStatus, self.take_status)
        else:
            self.subscriber = rospy.Subscriber("hand_frame", HandFrame, self.take_hands)

    def take_status(self, status):
        if status.phase == status.RUNNING and status.stage == status.MAINTENANCE:
            self.moment = self.moment or time.time()

    def take_hands(self, frame):
        if frame.hands:
            self.moment = self.moment or time.time()

    def wait(self, seconds, process):
        deadline = time.time() + STARTED
        while self.moment is None or time.time() < self.moment + seconds:
            if process.poll() is not None or (self.moment is None and time.time() > deadline):
                raise RuntimeError("the scene did not begin")
            time.sleep(0.05)

    def end(self):
        self.subscriber.unregister()
        self.process.send_signal(signal.SIGINT)
        self.process.wait(60)

    def shown(self, until):
        return [entry for entry in read_bag(self.bag) if entry[0] < until]


def read_bag(file):
    with rosbag.Bag(file) as bag:
        return [(stamp.to_sec(), topic.lstrip("/"), message)
                for topic, message, stamp in bag.read_messages(["/" + topic for topic in TOPICS])]


def record(scene, seconds, folder):
    arguments = list(scene.launch)
    if scene.view == "training":
        arguments.append("folder:=" + os.path.join(folder, "session"))
    if rospy.has_param("interaction_node"):
        rospy.delete_param("interaction_node")  # of the previous scene
    recorder = Recorder(scene.view == "training", folder)
    try:
        with Launched(arguments) as process:
            recorder.wait(seconds - scene.lead, process)
    finally:
        recorder.end()
    begin = recorder.moment - scene.lead
    return begin, recorder.shown(begin + seconds)


def write_config(scene, focus, size, file):
    width, height = (2 * int(number) for number in size.split("x"))
    config = picture_view(scene.view, width, height)
    for display in config["Visualization Manager"]["Displays"]:
        if display["Name"] == "Hands and objects":
            display["Text"] = False
    eye = config["Visualization Manager"]["Views"]["Current"]
    if scene.view != "training":
        eye["Distance"] *= WIDER
    eye.update(scene.eye)
    if focus:
        eye["Focal Point"], eye["Distance"] = focus
    yaml.safe_dump(config, file)
    file.flush()
    return eye, width / height


def focus_on(shown):
    """Focus and distance of a camera that sees all hands of a run, and objects near them."""
    palms = [hand.palm.position for _, topic, message in shown if topic == "rendered_view" for hand in message.rendered_hands]
    if not palms:
        return None
    spans = [(min(getattr(palm, axis) for palm in palms), max(getattr(palm, axis) for palm in palms)) for axis in "xyz"]
    middle = {axis.upper(): 0.5 * sum(span) for axis, span in zip("xyz", spans)}
    return middle, 0.42 + max(high - low for low, high in spans)


def up_to_first_hand(shown):
    """Skips to the first hand: an empty scene has too few colours to detect that rviz has drawn it."""
    first = next((k for k, (_, topic, message) in enumerate(shown) if topic == "rendered_view" and message.rendered_hands), 0)
    return shown[:first + len(TOPICS)]


def times_of(options):
    """Seconds of the pictures, from the scene's begin."""
    if options.still is not None:
        return [options.still]
    return [picture / options.rate for picture in range(int(options.seconds * options.rate))]


def draw(scene, begin, shown, options, folder, focus=None):
    """Yields the files of the pictures."""
    files = []
    before, now = (os.path.join(folder, name) for name in ("before.ppm", "now.ppm"))
    with Stage(TOPICS) as stage, tempfile.NamedTemporaryFile("w", suffix=".rviz", encoding="utf-8") as config:
        eye, aspect = write_config(scene, focus, options.size, config)
        rviz = subprocess.Popen(["rosrun", "rviz", "rviz", "--fullscreen", "-d", config.name],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            wait_for_rviz(stage, up_to_first_hand(shown), folder, rviz)
            stage.clear()
            since = 0.0
            for picture, seconds in enumerate(times_of(options)):
                until = begin + scene.speed * seconds
                stage.show([entry for entry in shown if since < entry[0] <= until])
                stage.tick(picture, eye, aspect)
                since = until
                drawn(picture, before, now, rviz)
                files.append(os.path.join(folder, "%04d.png" % picture))
                finish(now, scene.caption, options.size, files[-1])
        finally:
            rviz.terminate()
            rviz.wait()
    return files


def finish(picture, caption, size, file):
    """Halves the size, adds the caption, and removes the mark."""
    width, height = (2 * int(number) for number in size.split("x"))
    mark = "rectangle %d,%d %d,%d" % (0.983 * width, 0.978 * height, width, height)
    subprocess.run(["convert", picture, "-fill", BACKGROUND, "-draw", mark, "-resize", size, "-font", FONT, "-pointsize", "13",
                    "-fill", "#d0d4da", "-undercolor", BACKGROUND + "c0", "-gravity", "southwest",
                    "-annotate", "+12+10", caption, "-strip", file], check=True)


def main():
    try:
        return make(parse(sys.argv[1:]))
    except (RuntimeError, subprocess.SubprocessError) as error:
        return sys.exit("film: %s" % program.one_line(str(error)))


def film_of_bag(options, folder):
    width, height = (2 * int(number) for number in options.size.split("x"))
    shown = read_bag(options.bag)
    if not shown:
        raise RuntimeError("'%s' has no poses; allowed: a bag of replay --markers" % options.bag)
    options.seconds = shown[-1][0] - shown[0][0]
    with own_stage("film", width, height):
        return draw(Scene("", None, "interaction", 0.0), shown[0][0], shown, options, folder, focus_on(shown))


def film_of_scenes(options, parent):
    join_master("film", time.monotonic() + STARTED)
    files = []
    for name in options.scenes:
        folder = os.path.join(parent, name)
        os.mkdir(folder)
        begin, shown = record(SCENES[name], SCENES[name].speed * options.seconds, folder)
        files += draw(SCENES[name], begin, shown, options, folder)
        print("film: %s, %d pictures" % (name, len(files)), flush=True)
    return files


def write(files, options):
    if options.still is not None:
        shutil.copy(files[0], options.output)
        return
    if options.output.endswith(".mp4"):
        command = ["ffmpeg", "-y", "-loglevel", "error", "-f", "concat", "-safe", "0", "-r", "%g" % options.rate, "-i", "-",
                   "-pix_fmt", "yuv420p", "-crf", "20", options.output]
        subprocess.run(command, input="".join("file '%s'\n" % file for file in files), universal_newlines=True, check=True)
        return
    command = ["img2webp", "-loop", "0", "-kmin", "9", "-kmax", "17", "-m", "6", "-q", "%g" % options.quality, "-lossy",
               "-d", "%d" % round(1000 / options.rate)]
    subprocess.run(command + files + ["-o", options.output], check=True, stdout=subprocess.DEVNULL)


def make(options):
    if options.print_screen:
        print("x".join(str(2 * int(number)) for number in options.size.split("x")))
        return 0
    writer, package = WRITERS.get(os.path.splitext(options.output)[1], (None, None))
    if writer and not shutil.which(writer):
        raise RuntimeError("the program '%s' is missing; allowed: install the package '%s'" % (writer, package))
    os.makedirs(os.path.dirname(options.output) or ".", exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        write(film_of_bag(options, folder) if options.bag else film_of_scenes(options, folder), options)
    print("film: %s, %d kB" % (options.output, os.path.getsize(options.output) // 1000))
    return 0


if __name__ == "__main__":
    program.run(main, at_once=True)
