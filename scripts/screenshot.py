#!/usr/bin/python3
"""Waits for a moment of a running demo or recording, pauses the simulation there, and takes rviz's picture of it.
Exits with 0 if it was taken, 1 if the time was up before, 2 on bad usage."""
import argparse
import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from study import program  # noqa: E402

import rospkg
import rospy
import yaml
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool
from visualization_msgs.msg import MarkerArray

from watch_demo import COLOURS, Demo, colours_of, grab, join_master

MOMENTS = ("hand", "contact", "grasp", "done")
VIEWS = {"front": (6.05, 0.5), "left": (3.9, 0.45), "right": (0.5, 0.6), "back": (2.2, 0.5), "top": (6.05, 1.3),
         "below": (6.05, -0.6)}
LAYERS = ("hand", "ghost", "objects", "fixtures", "contacts", "friction", "forces", "impacts", "shadows", "text", "Grid")
STOPPED = 3.0  # s; a clock that stands still for so long belongs to a bag that is over
FONT = os.path.join(rospkg.RosPack().get_path("rviz"), "ogre_media", "fonts", "liberation-sans", "LiberationSans-Regular.ttf")
STILL_CROP = "890x556+388+75"  # the camera's panel of rviz/mr_view.rviz in a window of 1280x800, to the size of a picture
STILL_REMAPS = ["/mr_view/image:=/camera/image_raw", "/mr_view/camera_info:=/camera/camera_info"]
STILL_PERIOD = 3.0  # s between two pictures that must be equal: hands come after the room
OFF_AT_FIRST = ("capsules", "newtons", "share")


class Missed(Exception):
    """Error with one line: why the moment has not come."""


def view(text):
    if text in VIEWS:
        return VIEWS[text]
    yaw, pitch = (float(number) for number in text.split(","))
    return yaw, pitch


def layers(text):
    names = [name for name in text.split(",") if name]
    unknown = set(names) - set(LAYERS + OFF_AT_FIRST)
    if unknown:
        raise argparse.ArgumentTypeError(f"unknown layer {', '.join(sorted(unknown))}")
    return names


def parse(arguments):
    parser = argparse.ArgumentParser(prog="screenshot")
    parser.add_argument("--motion", required=True)
    parser.add_argument("--bag", default="", help="is played in place of the motion")
    parser.add_argument("--still", default="", help="a camera's picture that it draws into")
    parser.add_argument("--moment", choices=MOMENTS, default="done")
    parser.add_argument("--time", type=lambda text: float(text) if text else None)
    parser.add_argument("--view", type=view, default=VIEWS["front"])
    parser.add_argument("--distance", type=float, default=0.42)
    parser.add_argument("--hide", type=layers, default=[])
    parser.add_argument("--show", type=layers, default=[])
    parser.add_argument("--size", required=True)
    parser.add_argument("--output", required=True)
    parser.add_argument("--time-limit", type=float, default=120.0)
    parser.add_argument("--check", action="store_true", help="the options alone")
    return parser.parse_args(arguments)


def has_come(demo, options):
    if options.time is not None:
        return demo.seen_for() >= options.time
    if options.moment == "hand":
        return demo.palm is not None
    if options.moment == "contact":
        return bool(demo.touched)
    if options.moment == "grasp":
        return any(thing.held for thing in demo.objects.values())
    if options.bag:
        return demo.carried() or demo.flew_off()
    return demo.done(options.motion)


class PlayedClock:
    """Detects the end of a bag: its clock has run, and has stopped."""

    def __init__(self):
        self.last = None
        self.subscriber = rospy.Subscriber("/clock", Clock, self.take, queue_size=10)

    def take(self, _):
        self.last = time.monotonic()

    def is_over(self):
        return self.last is not None and time.monotonic() > self.last + STOPPED


def middle(demo):
    """Between the hand's palm and the object nearest to it."""
    palm = demo.palm
    nearest = min((thing.pose.position for thing in demo.objects.values()),
                  key=lambda p: (p.x - palm.x) ** 2 + (p.y - palm.y) ** 2 + (p.z - palm.z) ** 2, default=palm)
    return {axis.upper(): 0.5 * (getattr(palm, axis) + getattr(nearest, axis)) for axis in "xyz"}


def write_config(options, focus, file):
    from rviz_stage import picture_view, shipped_view  # which imports this
    if options.still:
        yaml.safe_dump(shipped_view("mr_view"), file)
        file.flush()
        return
    config = picture_view("interaction", *(2 * int(number) for number in options.size.split("x")))
    manager = config["Visualization Manager"]
    manager["Views"]["Current"].update({"Yaw": options.view[0], "Pitch": options.view[1], "Distance": options.distance,
                                        "Focal Point": focus})
    for display in manager["Displays"]:
        if display["Name"] in options.hide:
            display["Enabled"] = display["Value"] = False
        if display["Name"] == "Hands and objects":
            display.update({name.capitalize(): name not in options.hide for name in LAYERS if name != "Grid"})
            display.update({name.capitalize(): name in options.show for name in OFF_AT_FIRST})
    yaml.safe_dump(config, file)
    file.flush()


def covers_screen(file):
    """True once rviz's window is open. Its splash screen is on a black background."""
    corner = subprocess.run(["convert", file, "-crop", "1x1+2+2", "-depth", "8", "rgb:-"], stdout=subprocess.PIPE, check=True)
    return any(corner.stdout)


def has_scene(file):
    return covers_screen(file) and colours_of(file) >= COLOURS


def grab_picture(file, still):
    grab(file)
    if still:
        subprocess.run(["mogrify", "-crop", STILL_CROP, "+repage", file], check=True)


def drawn_picture(rviz, size, output, complete, deadline, still=False):
    """True if rviz has drawn a complete picture and no longer changes it. The picture, at half the screen's size, is then in
    the file."""
    with tempfile.TemporaryDirectory() as folder:
        before, now = os.path.join(folder, "before.png"), os.path.join(folder, "now.png")
        grab_picture(before, still)
        while time.monotonic() < deadline and rviz.poll() is None:
            time.sleep(STILL_PERIOD if still else 0.5)
            grab_picture(now, still)
            same = subprocess.run(["compare", "-metric", "AE", before, now, "null:"], stderr=subprocess.DEVNULL,
                                  check=False).returncode == 0
            if same and complete(now):
                subprocess.run(["convert", now, "-resize", size, "-strip", output], check=True)
                return True
            os.replace(now, before)
    return False


def draw(options, focus, deadline, complete=has_scene):
    """Starts rviz on the present scene, and ends it when its picture is taken. Repeats if rviz crashes at its start, which
    happens rarely."""
    with tempfile.NamedTemporaryFile("w", suffix=".rviz", encoding="utf-8") as config:
        write_config(options, focus, config)
        while time.monotonic() < deadline:
            window = STILL_REMAPS if options.still else ["--fullscreen"]
            rviz = subprocess.Popen(["rosrun", "rviz", "rviz", "-d", config.name] + window,
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                if drawn_picture(rviz, options.size, options.output, complete, deadline, bool(options.still)):
                    return True
            finally:
                rviz.terminate()
                rviz.wait()
    return False


def stop_at_moment(demo, options, deadline):
    """Pauses the simulation when the moment has come, and returns where to look. Raises Missed."""
    clock = PlayedClock()
    while not demo.wait_for(lambda: demo.palm is not None and has_come(demo, options), min(deadline, time.monotonic() + 0.2)):
        if time.monotonic() >= deadline:
            raise Missed(f"the moment has not come within {options.time_limit:.0f} s")
        if options.bag and clock.is_over():
            raise Missed(f"{program.one_line(options.bag)} was over, {demo.seen_for():.1f} s after its first hand, before the "
                         f"moment came; allowed: --moment {' '.join(MOMENTS)}, or --time with fewer seconds")
    rospy.ServiceProxy("interaction_node/pause", SetBool)(True)
    with demo.changed:
        return middle(demo)


def text_shown(deadline):
    """Returns the scene's text, which is below the scene and outside of close pictures."""
    told = []

    def take(array):
        told.extend(marker.text for marker in array.markers if marker.ns == "text")
    subscriber = rospy.Subscriber("markers", MarkerArray, take)
    while not told and time.monotonic() < deadline:
        time.sleep(0.05)
    subscriber.unregister()
    return told[-1] if told else ""


def write_below(text, file):
    subprocess.run(["convert", file, "-font", FONT, "-pointsize", "15", "-fill", "#d0d4da", "-undercolor", "#20242b80",
                    "-gravity", "southwest", "-annotate", "+14+12", text, "-strip", file], check=True)


def main():
    options = parse(sys.argv[1:])
    if options.check:
        return 0
    deadline = time.monotonic() + options.time_limit
    os.makedirs(os.path.dirname(options.output) or ".", exist_ok=True)
    join_master("screenshot", deadline)
    try:
        focus = stop_at_moment(Demo(), options, deadline)
    except Missed as error:
        sys.exit(f"screenshot: {error}")
    text = "" if "text" in options.hide else text_shown(deadline)
    options.hide.append("text")
    if not draw(options, focus, deadline):
        print(f"screenshot: rviz has not drawn it within {options.time_limit:.0f} s", file=sys.stderr)
        return 1
    if text:
        write_below(text, options.output)
    return 0


if __name__ == "__main__":
    program.run(main, at_once=True)
