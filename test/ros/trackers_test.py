#!/usr/bin/env python3
"""Hands of any tracker, as docs/trackers.md publishes them: live on their topics, in one process or two, and from a bag."""
import concurrent.futures
import csv
import functools
import hashlib
import io
import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

import rosbag
import rospkg
import rospy
import rostest
from geometry_msgs.msg import Point, Point32, Pose, PoseArray, PoseStamped, WrenchStamped
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import PointCloud
from std_msgs.msg import String

from mr_hand_interaction.msg import ContactArray, HandFrame, ObjectStateArray, SimulationInput
from mr_hand_interaction.srv import SpawnObject, SpawnObjectRequest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from launching import Launch  # noqa: E402
from standing_clock import StandingClock  # noqa: E402
from tracker_hands import Dropouts, Noise, joints, program, recording  # noqa: E402
from waiting import TIMEOUT, wait_until  # noqa: E402

PACKAGE = rospkg.RosPack().get_path("mr_hand_interaction")
COUNTS, RATES = (21, 25, 26), (30, 60, 120)
NOISES = {0.001: 1, 0.003: 2, 0.005: 4}  # m: seeds for each count and rate
# Without noise the hand closes on the cube at 2.7 s and opens at 5.8 s; noise blurs both by the filter's lag.
GRASPED_BY, HELD_UNTIL, RELEASED_BY = 3.25, 5.5, 6.4  # s; at 30 Hz and 3 mm of noise the latest hand grasps at 3.17 s
# Of streams of 3 mm and more this ratio is held without a second grasp: with 12 seeds 105 of 108 at 3 and at 5 mm. A hand that trembles
# so may part for a frame or two while it closes. All three streams of 5 mm that fail have one of the first three seeds.
SEEDS, AT_ONCE = int(os.environ.get("MR_HAND_TRACKER_SEEDS", "0")), 0.9
CARRIED = 0.06  # m, of 0.08


def example():
    """The code that docs/trackers.md prints."""
    with open(os.path.join(PACKAGE, "docs", "trackers.md"), encoding="utf-8") as page:
        code = re.search(r"```python\n(.*?)```", page.read(), re.DOTALL).group(1)
    names = {"__name__": "example"}
    exec(compile(code, "docs/trackers.md", "exec"), names)  # pylint: disable=exec-used
    return names


EXAMPLE = example()


def in_world(place):
    """The Leap's y is up."""
    return place[0], -place[2], place[1]


LOCK = threading.Lock()


@functools.lru_cache(maxsize=None)
def rows_of(folder, rate):
    return recording(folder, rate)


def scripted(folder, rate):
    """Rows of the scripted hand, recorded once; who else wants them waits."""
    with LOCK:
        return rows_of(folder, rate)


class Motion:
    """What a tracker gives of the scripted hand, as messages with stamps from 1010 s on: the nodes' clock is behind."""

    def __init__(self, folder, count, rate, noise=0.0, seed=1, dropouts=Dropouts()):
        disturb = Noise(noise, seed)
        self.times, self.messages = [], []
        for row in scripted(folder, rate):
            points = [in_world(place) for place in disturb.on(joints(row, count))]
            points = dropouts.on(points, float(row["time_s"]))
            self.times.append(1010.0 + float(row["time_s"]))
            self.messages.append(EXAMPLE["hand"](points, "world", rospy.Time.from_sec(self.times[-1])))

    def as_point_clouds(self):
        self.messages = [PointCloud(header=array.header, points=[Point32(p.position.x, p.position.y, p.position.z)
                                                                 for p in array.poses]) for array in self.messages]
        return self


def thumb(count):
    first = {21: 1, 25: 1, 26: 2}[count]
    return range(first, first + 4)


def tips_of_thumb_and_index(count):
    return {21: (4, 8), 25: (4, 9), 26: (5, 10)}[count]


class TrackersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        rospy.init_node("trackers_test")
        cls.clear()
        cls.clock = StandingClock(lambda: cls.shown)
        cls.subscribers = [rospy.Subscriber(name, kind, take, queue_size=100, tcp_nodelay=True)
                           for name, kind, take in (("rendered_hands", HandFrame, cls.keeper("hands")),
                                                    ("contacts", ContactArray, cls.keeper("contacts")),
                                                    ("objects", ObjectStateArray, cls.take_objects))]
        cls.subscribers.append(rospy.Subscriber("simulation_input", SimulationInput, lambda taken: cls.inputs.append(taken)))
        cls.hands = {side: rospy.Publisher("hands/%s/pose_array" % side, PoseArray, queue_size=10)
                     for side in ("left", "right")}
        cls.clouds = rospy.Publisher("hands/right/point_cloud", PointCloud, queue_size=10)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def clear(cls):
        cls.shown, cls.kept = rospy.Time(), {"hands": {}, "contacts": {}, "objects": {}}

    @classmethod
    def keeper(cls, name):
        return lambda message: cls.kept[name].__setitem__(message.header.stamp, message)

    @classmethod
    def take_objects(cls, message):
        cls.kept["objects"][message.header.stamp] = message
        cls.shown = message.header.stamp

    def connected(self):
        return (all(s.get_num_connections() == 1 for s in self.subscribers) and
                all(p.get_num_connections() == 1 for p in (*self.hands.values(), self.clouds)))

    def drive(self, motion, *arguments, watch=lambda: None):
        """Gives each frame to the nodes once they have shown the one before, so that none is lost."""
        self.clear()
        type(self).inputs = []
        with Launch("leap.launch", "scene:=cube", "mount:=none", "rviz:=false", *arguments):
            wait_until(self.connected, "the nodes")
            wait_until(lambda: self.kept["objects"], "the scene")
            self.lead_in(motion)
            self.clear()
            for message in motion.messages:
                (self.clouds if isinstance(message, PointCloud) else self.hands["right"]).publish(message)
                wait_until(lambda: all(message.header.stamp in kept for kept in self.kept.values()),
                           "what comes of the frame at %s" % message.header.stamp)
                watch()
        wait_until(lambda: not any(s.get_num_connections() for s in self.subscribers), "the nodes' end")

    def lead_in(self, motion):
        """Frames without a hand, up to the motion's first. Each is waited for, because a frame far ahead of its stream is left
        out. The first may be lost, because the nodes may not know each other yet."""
        def comes_through(longest):
            self.hands["right"].publish(EXAMPLE["hand"]([], "world", stamp))
            try:
                wait_until(lambda: stamp in self.kept["hands"], "the frame without a hand at %s" % stamp, longest)
            except AssertionError:
                return False
            return True

        stamp, end = rospy.Time.from_sec(motion.times[0] - 1.0), rospy.Time.from_sec(motion.times[0] - 0.01)
        connected = comes_through(1.0)
        while stamp < end:
            stamp = min(stamp + rospy.Duration(0.01), end)  # about the rate of what follows: else that looks like bursts
            came = comes_through(TIMEOUT if connected else 1.0)
            self.assertTrue(came or not connected, "the frame without a hand at %s is lost" % stamp)
            connected = came
        self.assertTrue(connected, "no frame has come through")

    def digest(self, motion):
        """Of all that was published of its frames, but for counters."""
        text = hashlib.sha256()
        for name in sorted(self.kept):
            for stamp in (message.header.stamp for message in motion.messages):
                message = self.kept[name][stamp]
                message.header.seq = 0
                buffer = io.BytesIO()
                message.serialize(buffer)
                text.update(buffer.getvalue())
        return text.hexdigest()

    def replay(self, motion, topic="/hands/right/pose_array"):
        """The folder with what comes of the messages in a bag."""
        return self.replay_of(((topic, message, message.header.stamp) for message in motion.messages), "--scene", "cube")

    def replay_of(self, messages, *arguments):
        folder = tempfile.mkdtemp(dir=self.folder)
        bag, output = os.path.join(folder, "hands.bag"), os.path.join(folder, "result")
        with rosbag.Bag(bag, "w") as file:
            for message in messages:
                file.write(*message)
        subprocess.run([program("replay"), *arguments, "--input", bag, "--output", output], check=True,
                       stdout=subprocess.DEVNULL)
        return output

    @staticmethod
    def rows(folder, name):
        with open(os.path.join(folder, name), encoding="utf-8") as lines:
            return list(csv.DictReader(lines))

    def fault(self, folder):
        """What keeps the cube from having been grasped once, carried and let go; none: empty."""
        grasps = [(row["kind"], float(row["time"])) for row in self.rows(folder, "events.csv") if "GRASP" in row["kind"]]
        if [kind for kind, _ in grasps] != ["GRASP_BEGIN", "GRASP_END"]:
            return str(grasps)
        (_, begin), (_, end) = grasps
        if not (begin < GRASPED_BY and HELD_UNTIL < end < RELEASED_BY):
            return "grasped at %.2f s, let go at %.2f s" % (begin, end)
        heights = [float(row["pz"]) for row in self.rows(folder, "objects.csv") if float(row["time"]) < end]
        carried = max(heights) - heights[0]
        return "" if carried > CARRIED else "carried by %.3f m" % carried

    def faults(self, make, cases):
        """Of the motions that `make` makes of each of the cases, with its case; as many at once as there are processors."""
        def tried(case):
            fault = self.fault(self.replay(make(*case)))
            return "%s: %s" % (case, fault) if fault else ""
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return [fault for fault in pool.map(tried, cases) if fault]

    def test_every_tracker_holds_the_cube_in_noise_at_every_rate(self):
        for noise, seeds in NOISES.items():
            cases = list(itertools.product(COUNTS, RATES, range(1, (SEEDS or seeds) + 1)))
            faults = self.faults(lambda count, rate, seed: Motion(self.folder, count, rate, noise, seed), cases)
            allowed = int((1.0 - AT_ONCE) * len(cases)) if noise >= 0.003 or SEEDS > 3 else 0
            print("%g m: %d of %d" % (noise, len(cases) - len(faults), len(cases)))
            self.assertLessEqual(len(faults), allowed, "%g m: %s" % (noise, faults))

    def test_joints_that_vanish_for_moments_cost_no_grasp(self):
        dropouts = {"one in five": lambda _: Dropouts(share=0.2),
                    "the thumb": lambda count: Dropouts(hidden=thumb(count), burst=0.15, every=0.5),
                    "tips": lambda count: Dropouts(hidden=tips_of_thumb_and_index(count), burst=0.15, every=0.5)}

        def make(count, rate, name):
            return Motion(self.folder, count, rate, dropouts=dropouts[name](count))
        self.assertEqual(self.faults(make, itertools.product(COUNTS, RATES, dropouts)), [])

    def check_as_live(self, motion, topic="/hands/right/pose_array"):
        """A replay of the inputs that the node took moves the cube as the node did, on a machine of any speed; a replay of the
        messages that were sent has the same hands. Gives the folder of the second."""
        output = self.replay_of(("/simulation_input", taken, rospy.Time(1, i)) for i, taken in enumerate(self.inputs))
        with open(os.path.join(output, "summary.json"), encoding="utf-8") as file:
            live = json.load(file)["live_run"]
        self.assertEqual((live["missing"], live["same"]), (0, live["compared"]))
        self.assertGreater(live["compared"], len(motion.messages))
        replayed = self.rows(output, "objects.csv")[-len(motion.messages):]
        for row, message in zip(replayed, motion.messages):
            there = self.kept["objects"][message.header.stamp].objects[0].pose.position
            for axis, value in zip("xyz", (there.x, there.y, there.z)):
                self.assertAlmostEqual(value, float(row["p" + axis]), delta=1e-9)
        sent = self.replay(motion, topic)
        self.assertGreater(len(self.tracked(sent)), 1000)
        self.assertEqual(self.tracked(sent), self.tracked(output))
        return sent

    def tracked(self, folder):
        columns = ("side", "finger", "bone", "sx", "sy", "sz", "ex", "ey", "ez", "radius")
        return [tuple(map(row.get, columns)) for row in self.rows(folder, "hands.csv") if row["rendered"] == "0"]

    def test_one_process_and_two_and_a_replay_give_the_same(self):
        for count in COUNTS:
            motion = Motion(self.folder, count, 60, 0.003, dropouts=Dropouts(share=0.02))
            self.drive(motion, "one_process:=true")
            one = self.digest(motion)
            self.check_as_live(motion)
            if count == COUNTS[0]:
                self.drive(motion, "one_process:=false")
                self.assertEqual(one, self.digest(motion))

    def test_point_clouds_are_hands_too(self):
        motion = Motion(self.folder, 25, 60, 0.001).as_point_clouds()
        self.drive(motion)
        self.assertEqual(self.fault(self.check_as_live(motion, "/hands/right/point_cloud")), "")

    def test_the_example_s_hand_comes_and_goes_without_a_warning(self):
        motion = Motion(self.folder, 26, 60)
        motion.messages = motion.messages[:3]
        heard, listening = [], []
        # A warning of rospy about a node that ended while it connected; occurs on a busy machine.
        of_rospy = "Inbound TCP/IP connection failed"
        log = rospy.Subscriber("/rosout", Log, lambda said: heard.append(said.msg)
                               if said.level >= Log.WARN and of_rospy not in said.msg else None)

        def go():
            wait_until(log.get_num_connections, "the nodes' log")
            stamp = self.shown + rospy.Duration(0.005)
            self.hands["right"].publish(EXAMPLE["hand"]([], "", stamp))  # nor does it name a frame
            wait_until(lambda: stamp in self.kept["hands"], "the frame without a hand at %s" % stamp)
            listening.append(stamp)
        self.drive(motion, watch=go)
        log.unregister()
        self.assertEqual((len(listening), heard), (3, []))

    def test_standard_outputs_are_there_when_they_are_asked_for(self):
        motion = Motion(self.folder, 26, 60)
        seen = {"pose": [], "wrench": [], "held": [], "hand": []}
        subscribers = [rospy.Subscriber("objects/cube/pose", PoseStamped, seen["pose"].append),
                       rospy.Subscriber("objects/cube/wrench", WrenchStamped, seen["wrench"].append),
                       rospy.Subscriber("held_object", String, seen["held"].append),
                       rospy.Subscriber("rendered_hands/right/pose_array", PoseArray, seen["hand"].append)]
        mine = re.compile("/objects/cube|/held_object|pose_array$")

        def published():
            return {name for name, _ in rospy.get_published_topics() if mine.search(name) and "/hands/" not in name}
        off = []
        motion.messages, all_messages = motion.messages[:3], motion.messages
        self.drive(motion, watch=lambda: off.append(published()))
        self.assertEqual(off[-1], set())
        motion.messages = all_messages
        self.drive(motion, "standard_outputs:=true")
        self.check_standard_outputs(seen)
        # On the same roscore, whose parameters outlive a launch.
        motion.messages = all_messages[:3]
        self.drive(motion, watch=lambda: off.append(published()))
        self.assertEqual(off[-1], set())
        for subscriber in subscribers:
            subscriber.unregister()

    def check_standard_outputs(self, seen):
        poses = {message.header.stamp: message.pose for message in seen["pose"]}
        common = set(poses) & set(self.kept["objects"])
        self.assertGreater(len(common), 100)
        for stamp in common:
            self.assertEqual(poses[stamp], self.kept["objects"][stamp].objects[0].pose)
        self.assertEqual([message.data for message in seen["held"]], ["", "cube", ""])
        forces = {m.header.stamp: m.wrench.force for m in seen["wrench"]}
        pressed = 0
        for stamp, contacts in self.kept["contacts"].items():
            if stamp not in forces:
                continue
            pressed += bool(contacts.contacts)
            self.assertAlmostEqual(forces[stamp].z, sum(c.force.z for c in contacts.contacts), delta=1e-9)
        self.assertGreater(pressed, 100)
        self.assertTrue(all(len(message.poses) == 21 for message in seen["hand"]))

    def test_each_object_has_standard_topics_of_its_own_whatever_its_name(self):
        motion = Motion(self.folder, 26, 60)
        motion.messages = motion.messages[:1]

        def topics():
            return {name for name, _ in rospy.get_published_topics() if name.startswith("/objects/plate")}

        def spawn_both():
            rospy.wait_for_service("interaction_node/spawn", TIMEOUT)
            for height, name in enumerate(("plate-1", "plate_1")):
                answer = rospy.ServiceProxy("interaction_node/spawn", SpawnObject)(SpawnObjectRequest(
                    name=name, shape="sphere", size=[0.02], mass=0.1, pose=Pose(position=Point(0.3, 0.3, 0.2 + 0.1 * height))))
                self.assertTrue(answer.success, answer.message)
            wait_until(lambda: len(topics()) == 4, "topics of both")
        self.drive(motion, "standard_outputs:=true", watch=spawn_both)

    def test_the_example_publishes_what_its_tracker_sees(self):
        rows = recording(self.folder, 60)[100:110]
        marks = [(rospy.Time.from_sec(2000.0 + i / 60.0), joints(row, 26)) for i, row in enumerate(rows)]
        got = {"left": [], "right": []}
        subscribers = [rospy.Subscriber("hands/%s/pose_array" % side, PoseArray, got[side].append) for side in got]

        def tracker():
            wait_until(lambda: all(topic.get_num_connections() for topic in list(self.hands.values()) + subscribers),
                       "the example")
            for stamp, points in marks:
                yield stamp, {"left": [points[0], None] + points[2:]}
        EXAMPLE["publish_hands"](tracker())
        wait_until(lambda: all(len(messages) == len(marks) for messages in got.values()), "its messages")
        self.assertEqual({len(message.poses) for message in got["right"]}, {0})
        self.assertEqual({len(message.poses) for message in got["left"]}, {26})
        self.assertNotEqual(got["left"][0].poses[1].position.x, got["left"][0].poses[1].position.x)  # NaN
        for subscriber in subscribers:
            subscriber.unregister()


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "trackers", TrackersTest)
