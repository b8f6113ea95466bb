#!/usr/bin/python3
"""Draws the moments of an explanation with rviz on a virtual screen, and puts the pictures into its page. scripts/explain
starts it on a folder with explain.html and explain.json, and a bag of replay --markers. Exits with 0 if they were drawn, 1
with a line if not."""
import base64
import contextlib
import copy
import html
import json
import math
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from study import program  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
WIDTH, HEIGHT = 460, 360  # of a picture; drawn twice as large, for smooth edges
SHOWN_WIDTH = 305  # on the page: three beside each other
QUALITY = "82"
KEPT = 0.975  # of the screen; the rest has the picture's mark
MOST = 60  # pictures of a page
PITCH, DISTANCE = 0.42, 0.42  # of rviz's fixed camera; the scene is moved in front of it [rad, m]
LAYERS = ("hand", "ghost", "objects", "fixtures", "friction", "forces", "newtons", "shadows")
HIDDEN = ("contacts", "share", "impacts", "capsules", "text")
WHAT = {"grasp": "the grasp begins", "before_loss": "before it goes", "loss": "the last touch"}


def write_config(file):
    import yaml
    from rviz_stage import picture_view
    config = picture_view("interaction", 2 * WIDTH, 2 * HEIGHT)
    manager = config["Visualization Manager"]
    # Markers, because the scene is moved in front of the camera.
    manager["Displays"] = [{"Class": "rviz/MarkerArray", "Enabled": True, "Value": True, "Marker Topic": "/markers",
                            "Name": "Hands and objects", "Queue Size": 10,
                            "Namespaces": {name: name in LAYERS for name in LAYERS + HIDDEN}}]
    eye = manager["Views"]["Current"]
    eye.update({"Yaw": 0.0, "Pitch": PITCH, "Distance": DISTANCE, "Focal Point": {"X": 0, "Y": 0, "Z": 0}})
    yaml.safe_dump(config, file)
    file.flush()
    return eye


def from_yaw(yaw):
    """Direction from the focus to a camera with that yaw."""
    return math.cos(yaw) * math.cos(PITCH), math.sin(yaw) * math.cos(PITCH), math.sin(PITCH)


def best_yaw(moment):
    """Yaw across the grip: shows both contact groups, and not from behind the palm."""
    to_palm = [palm - place for palm, place in zip(moment["palm"], moment["place"])]
    length = math.hypot(*to_palm) or 1.0

    def cost(yaw):
        back = from_yaw(yaw)
        along = sum(a * b for a, b in zip(back, moment["across"]))
        palm = sum(a * b for a, b in zip(back, to_palm)) / length
        return 2.0 * along * along + 1.5 * max(0.0, palm) - 0.15 * math.cos(yaw - 6.05)
    return min((2.0 * math.pi * i / 36 for i in range(36)), key=cost)


def focus_of(moment):
    """Focus between object and palm (near the palm for a large object), and the camera's distance from it."""
    radius = moment["radius"]
    share = 0.4 if radius < 0.1 else min(1.0, 1.0 - 0.06 / radius)
    focus = [place + share * (palm - place) for place, palm in zip(moment["place"], moment["palm"])]
    return focus, 0.26 + 1.2 * min(radius, 0.25)


def placed(marker, moment, yaw):
    """Moves a pose so that rviz's fixed camera sees it as a camera with that yaw would."""
    focus, distance = focus_of(moment)
    c, s = math.cos(-yaw), math.sin(-yaw)
    pose = marker.pose
    x, y, z = (getattr(pose.position, axis) - value for axis, value in zip("xyz", focus))
    back = (math.cos(PITCH), 0.0, math.sin(PITCH))
    further = distance - DISTANCE
    pose.position.x, pose.position.y, pose.position.z = (
        c * x - s * y - further * back[0], s * x + c * y, z - further * back[2])
    half_c, half_s, q = math.cos(-0.5 * yaw), math.sin(-0.5 * yaw), pose.orientation
    if q.x == q.y == q.z == q.w == 0.0:  # of markers that have points alone
        q.w = 1.0
    q.x, q.y, q.z, q.w = (half_c * q.x - half_s * q.y, half_c * q.y + half_s * q.x, half_c * q.z + half_s * q.w,
                          half_c * q.w - half_s * q.z)
    return marker


def read_moments(folder, markers):
    """[(number, moment, markers)]"""
    import rosbag
    moments = json.loads(program.read_text(os.path.join(folder, "explain.json")))["moments"]
    frame, shown = None, {}
    with rosbag.Bag(markers) as bag:
        for topic, message, _ in bag.read_messages():
            if topic == "/frame":
                frame = message.data
            else:
                shown[frame] = message
    return [(number, moment, copy.deepcopy(shown[moment["frame"]].markers)) for number, moment in enumerate(moments)
            if moment["frame"] in shown]


def draw(moments, folder):
    """Files of the pictures, by number."""
    from rviz_stage import Stage, Started, drawn, wait_for_rviz
    stage, files = Stage(["markers"]), {}
    before, now = (os.path.join(folder, name) for name in ("before.ppm", "now.ppm"))
    with tempfile.NamedTemporaryFile("w", suffix=".rviz", encoding="utf-8") as config, Started() as started:
        eye = write_config(config)
        rviz = started.start(["rviz", "--fullscreen", "-d", config.name])
        shown = [[(0.0, "markers", Markers([placed(marker, moment, best_yaw(moment)) for marker in markers]))]
                 for _, moment, markers in moments]
        wait_for_rviz(stage, shown[0], folder, rviz)
        for i, (number, _, _) in enumerate(moments):
            stage.clear()
            stage.show(shown[i])
            stage.tick(i, eye, WIDTH / HEIGHT)
            drawn(i, before, now, rviz)
            files[number] = os.path.join(folder, "%d.jpg" % number)
            finish(now, files[number])
    return files


def finish(picture, file):
    """Halves the size, and cuts off the edge with the mark."""
    inner = "%dx%d+0+0" % (KEPT * 2 * WIDTH, KEPT * 2 * HEIGHT)
    subprocess.run(["convert", picture, "-crop", inner, "+repage", "-resize", "%dx%d" % (WIDTH, HEIGHT), "-strip", "-quality",
                    QUALITY, file], check=True)


class Markers:
    """Markers in the form of a message, for the stage."""

    def __init__(self, markers):
        self.markers = markers


def figure(moment, file):
    with open(file, "rb") as picture:
        data = base64.b64encode(picture.read()).decode()
    caption = "%s, %.2f s: %s" % (moment["object"], moment["time"], WHAT[moment["what"]])
    return ("<figure><img width='%d' alt='%s' src='data:image/jpeg;base64,%s'><figcaption>%s</figcaption></figure>"
            % (SHOWN_WIDTH, html.escape(caption, quote=True), data, html.escape(caption)))


def put_into_page(moments, files, page):
    with open(page, encoding="utf-8") as file:
        text = file.read()
    for number, moment, _ in moments:
        text = text.replace("<!--picture %d-->" % number, figure(moment, files[number]))
    with open(page, "w", encoding="utf-8") as file:
        file.write(text)


def pictures(folder, markers):
    """Draws the pictures; returns their number."""
    from rviz_stage import own_stage
    moments = read_moments(folder, markers)
    if not moments:
        return 0
    with own_stage("explain_pictures", 2 * WIDTH, 2 * HEIGHT), tempfile.TemporaryDirectory() as scratch:
        chosen = moments[:MOST]
        put_into_page(chosen, draw(chosen, scratch), os.path.join(folder, "explain.html"))
    return len(chosen)


def main():
    if len(sys.argv) != 3:
        print(__doc__ + "\nusage: explain_pictures.py FOLDER MARKERS.bag", file=sys.stdout if "--help" in sys.argv else sys.stderr)
        return 0 if "--help" in sys.argv else 2
    program.find_built_modules()
    try:
        pictures(*sys.argv[1:])
    except ImportError as error:
        print("explain: no pictures: rviz draws them, and its Python modules are missing: %s in %s" % (error, sys.executable), file=sys.stderr)
    except Exception as error:  # the folder may contain anything
        print("explain: no pictures: %s" % program.one_line(str(error) or type(error).__name__), file=sys.stderr)
    else:
        return 0
    return 1


if __name__ == "__main__":
    program.run(main, at_once=True)
