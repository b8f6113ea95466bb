#!/usr/bin/python3
"""Watches a running demo until the motion has succeeded, pauses the simulation at that moment, takes rviz's picture and
writes a summary beside it. Exits with 0 if it succeeded in time, else with 1."""
import argparse
import hashlib
import math
import os
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from study import program  # noqa: E402

import rosgraph
import rospy
from mr_hand_interaction.msg import ContactArray, HandFrame, InteractionEvent, ObjectStateArray
from std_srvs.srv import SetBool, Trigger, TriggerResponse

STRIKES = ("nudge", "tap", "slap")
TURNS = ("press_button", "flip_switch", "turn_valve", "pull_lever", "squeeze_tongs")  # the object hardly moves
CARRIED = 0.04  # m from its place, so that the picture shows it clearly
STRUCK = 0.01  # m
PUSHED = 0.004  # m, as a button is
TURNED = 0.25  # rad
SEEN_STRUCK = 0.03  # m, so that the picture shows it clearly
COLOURS = 500  # fewer: rviz has not drawn the scene yet
STEADY = 3  # successive equal pictures: rviz has drawn everything
BETWEEN = 0.7  # s between them
STATUS_BAR = 40  # rows of pixels in which rviz counts its pictures per second


def distance(a, b):
    return math.dist((a.x, a.y, a.z), (b.x, b.y, b.z))


def turn_between(a, b):
    return 2.0 * math.acos(min(1.0, abs(a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w)))


class Demo:
    """State of a running demo, from its messages; `changed` is notified with each."""

    def __init__(self):
        self.changed = threading.Condition()
        self.frames = 0
        self.palm = None
        self.first_seen = self.last_seen = None
        self.touched = set()
        self.grasped = set()
        self.most_contacts = 0
        self.objects = {}
        self.still = False  # unchanged since the message before
        self.start = {}  # positions of objects before they were grasped in this run
        self.run_began = rospy.Time()
        self.last_event = None
        rospy.Subscriber("hand_frame", HandFrame, self.take_frame, queue_size=100)
        rospy.Subscriber("contacts", ContactArray, self.take_contacts, queue_size=100)
        rospy.Subscriber("interaction_events", InteractionEvent, self.take_event, queue_size=100)
        rospy.Subscriber("objects", ObjectStateArray, self.take_objects, queue_size=10)

    def take_frame(self, frame):
        with self.changed:
            self.frames += 1
            if frame.hands:
                self.palm = frame.hands[0].palm.position
                self.last_seen = frame.header.stamp
                self.first_seen = self.first_seen or self.last_seen
            self.changed.notify_all()

    def take_contacts(self, message):
        with self.changed:
            self.most_contacts = max(self.most_contacts, len(message.contacts))

    def take_event(self, event):
        with self.changed:
            if event.kind == InteractionEvent.CONTACT_BEGIN:
                self.touched.add(event.object)
            if event.kind == InteractionEvent.GRASP_BEGIN:
                self.grasped.add(event.object)

    def take_objects(self, message):
        with self.changed:
            self.still = bool(self.objects) and all(
                thing.name in self.objects and self.objects[thing.name].pose == thing.pose for thing in message.objects)
            for thing in message.objects:
                # A late subscriber sees the middle of a run.
                if not thing.held and message.header.stamp >= self.run_began:
                    self.start.setdefault(thing.name, thing.pose)
                self.objects[thing.name] = thing
            self.changed.notify_all()

    def seen_for(self):
        """Seconds from the first frame with a hand to the last."""
        return (self.last_seen - self.first_seen).to_sec() if self.first_seen else 0.0

    def begin_run(self):
        """The scene has been reset."""
        with self.changed:
            self.run_began = rospy.Time.now()
            self.start.clear()
            self.touched.clear()
            self.grasped.clear()

    def moved(self, name):
        return 0.0 if name not in self.start else distance(self.objects[name].pose.position, self.start[name].position)

    def carried(self):
        return any(thing.held and name in self.grasped and self.moved(name) > CARRIED
                   for name, thing in self.objects.items())

    def struck(self, by=STRUCK):
        return any(name in self.touched and self.moved(name) > by for name in self.objects)

    def turned(self):
        return any(self.moved(name) > PUSHED
                   or turn_between(thing.pose.orientation, self.start[name].orientation) > TURNED
                   for name, thing in self.objects.items() if name in self.touched and name in self.start)

    def flew_off(self):
        return any(name in self.touched and not thing.held and self.moved(name) > CARRIED for name, thing in self.objects.items())

    def done(self, motion, struck=STRUCK):
        if motion in STRIKES:
            return self.struck(struck)
        return self.turned() if motion in TURNS else self.carried()

    def wait_for(self, condition, deadline):
        with self.changed:
            return self.changed.wait_for(condition, max(0.0, deadline - time.monotonic()))


def join_master(name, deadline):
    while not rosgraph.is_master_online() and time.monotonic() < deadline:
        time.sleep(0.1)
    rospy.init_node(name, disable_signals=True)


def rviz_listens():
    subscribers = rosgraph.Master("/watch_demo").getSystemState()[1]
    return any(topic == "/rendered_view" and "/rviz" in nodes for topic, nodes in subscribers)


def grab(file):
    """Writes a picture of the screen."""
    subprocess.run(["import", "-silent", "-window", "root", file], check=True)


def colours_of(file):
    return int(subprocess.run(["identify", "-format", "%k", file], check=True, stdout=subprocess.PIPE).stdout)


def without_status_bar(file):
    raw = subprocess.run(["convert", file, "-gravity", "south", "-chop", f"0x{STATUS_BAR}", "rgb:-"], check=True,
                         stdout=subprocess.PIPE).stdout
    return hashlib.sha256(raw).digest()


def take_picture(file, deadline):
    """True if the screen shows more than an empty window, and no longer changes. Its picture is in the file in any case."""
    alike, before = 0, None
    while alike < STEADY:
        grab(file)
        now = without_status_bar(file)
        alike = alike + 1 if now == before and colours_of(file) >= COLOURS else 1
        before = now
        if time.monotonic() > deadline:
            return False
        time.sleep(BETWEEN)
    return True


class Moment:
    """The moment of the picture: pauses the simulation, and prevents the hand's next run, which would begin with the reset
    service of this node."""

    def __init__(self, demo):
        self.come, self.demo = False, demo
        self.lock = threading.Lock()
        self.reset_scene = rospy.ServiceProxy("interaction_node/reset", Trigger)
        self.pause = rospy.ServiceProxy("interaction_node/pause", SetBool)
        rospy.Service("watch_demo/reset", Trigger, self.reset)

    def reset(self, _):
        with self.lock:
            if self.come:
                return TriggerResponse(False, "its picture is taken")
            answer = self.reset_scene()
            self.demo.begin_run()
            return answer

    def stop(self, what, deadline):
        """Pauses the simulation. If `what` no longer holds in the state that is then reached, resumes it and returns false."""
        with self.lock:
            self.pause(True)
            self.demo.wait_for(lambda: self.demo.still, deadline)  # what was sent before has come
            with self.demo.changed:
                self.come = what()
            if not self.come:
                self.pause(False)
            return self.come


def summary(demo, motion, done, picture):
    lines = [f"motion: {motion}",
             f"done: {'yes' if done else 'no'}",
             f"frames: {demo.frames}",
             f"contacts: {demo.most_contacts} at once at most",
             f"touched: {', '.join(sorted(demo.touched)) or 'nothing'}",
             f"grasped: {', '.join(sorted(demo.grasped)) or 'nothing'}"]
    for name, thing in sorted(demo.objects.items()):
        p = thing.pose.position
        lines.append(f"{name}: at {p.x:.3f} {p.y:.3f} {p.z:.3f} m, {100 * demo.moved(name):.1f} cm from its start"
                     f"{', held' if thing.held else ''}")
    lines.append(f"picture: {picture if os.path.exists(picture) else 'none'}")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--motion", required=True)
    parser.add_argument("--picture", required=True)
    parser.add_argument("--time-limit", type=float, default=120.0)
    options = parser.parse_args()
    deadline = time.monotonic() + options.time_limit
    os.makedirs(os.path.dirname(options.picture) or ".", exist_ok=True)
    if os.path.exists(options.picture):
        os.remove(options.picture)

    join_master("watch_demo", deadline)
    demo = Demo()
    what = lambda: demo.done(options.motion, SEEN_STRUCK)
    moment, done = Moment(demo), False
    while not done and demo.wait_for(lambda: what() and rviz_listens(), deadline):
        done = moment.stop(what, deadline) and take_picture(options.picture, deadline)
        if moment.come:
            break
    if not moment.come:
        grab(options.picture)
    with demo.changed:
        text = summary(demo, options.motion, done, options.picture)
    print(text, end="")
    with open(os.path.join(os.path.dirname(options.picture), "demo_summary.txt"), "w", encoding="utf-8") as file:
        file.write(text)
    if not done:
        missing = ("its picture stayed empty or went on changing" if moment.come
                   else "rviz did not subscribe to rendered_view" if what() and not rviz_listens() else "it was not seen done")
        print(f"watch_demo: {options.motion}, {options.time_limit:.0f} s: {missing}", file=sys.stderr)
    return 0 if done else 1


if __name__ == "__main__":
    program.run(main, at_once=True)
