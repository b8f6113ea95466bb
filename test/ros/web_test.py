#!/usr/bin/env python3
"""A headset's hands through web.launch, in Chromium with an emulated headset, and what lookers-on see."""
import asyncio
import csv
import glob
import json
import math
import os
import shutil
import signal
import ssl
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request

import aiohttp
import numpy
import rosbag
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, PoseArray
from sensor_msgs.msg import PointCloud
from tf2_msgs.msg import TFMessage

from mr_hand_interaction.msg import HandFrame, InteractionEvent, ObjectStateArray
from mr_hand_interaction.srv import DeleteObject, SpawnObject, SpawnObjectRequest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, os.pardir, "web"), os.path.join(HERE, os.pardir, os.pardir, "scripts")]
import doors  # noqa: E402
import emulated_headset  # noqa: E402
from free_port import free_port  # noqa: E402
from launching import Launch  # noqa: E402
from tracker_hands import joints, program, recording  # noqa: E402
from waiting import wait_until  # noqa: E402

TOKEN = "test"
RATE = 60  # of the scripted hand, frames per second
GAP = 0.1  # [s]
CARRIED = 0.06  # m, of 0.08
POST = ("<robot name='afloat'><link name='world'/>"
        "<link name='post'><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>"
        "<joint name='far' type='fixed'><parent link='world'/><child link='post'/><origin xyz='0 0 -1'/></joint></robot>")
GRASP = [InteractionEvent.GRASP_BEGIN, InteractionEvent.GRASP_END]


def float32(number):
    return struct.unpack("f", struct.pack("f", number))[0]


def matrix(transform):
    """4x4, of a TransformStamped."""
    p, q = transform.transform.translation, transform.transform.rotation
    x, y, z, w = q.x, q.y, q.z, q.w
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z], [0, 0, 0, 1]])


class Viewer(threading.Thread):
    """Looks on as a browser does, until the end of the block: keeps the scene, and where things are."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.origin = "http://127.0.0.1:%d" % port
        self.bodies, self.places, self.largest, self.frames, self.hands = {}, {}, 0, 0, 0
        self._over = False

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self._over = True
        self.join()

    def run(self):
        asyncio.run(self._look())

    async def _look(self):
        async with aiohttp.ClientSession() as session:
            while not self._over:
                try:
                    async with session.ws_connect("%s/%s/socket" % (self.origin, TOKEN), origin=self.origin,
                                                  max_msg_size=0) as door:
                        while not self._over:
                            self._take((await door.receive(timeout=60)).data)
                except (aiohttp.ClientError, TypeError):
                    await asyncio.sleep(0.1)  # not there yet

    def _take(self, text):
        (kind, content), = json.loads(text).items()
        if kind == "scene":
            self.bodies = {body["id"]: body["name"] for body in content["bodies"]}
        if kind == "frame":
            self.frames += 1
            self.largest = max(self.largest, len(text))
            self.hands = len(content[0])
            self.places.update({entry[0]: [1e-4 * number for number in entry[2:5]] for entry in content[2]})

    def place(self, name):
        return next((self.places.get(id_) for id_, body in self.bodies.items() if body == name), None)


class WebTest(unittest.TestCase):
    def setUp(self):
        rospy.init_node("web_test")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.port = folder.name, free_port()
        self.left, self.right, self.late, self.mounts, self.kinds, self.objects = [], [], [], {}, [], {}
        for name, kind, take in (("hands/left/point_cloud", PointCloud, self.left.append),
                                 ("hands/right/point_cloud", PointCloud, self.take_right), ("/tf_static", TFMessage, self.take_mount),
                                 ("interaction_events", InteractionEvent, lambda event: self.kinds.append(event.kind)),
                                 ("objects", ObjectStateArray, self.take_objects)):
            self.addCleanup(rospy.Subscriber(name, kind, take, queue_size=100, tcp_nodelay=True).unregister)

    def take_right(self, cloud):
        self.late.append(rospy.get_time() - cloud.header.stamp.to_sec())
        self.right.append(cloud)

    def take_mount(self, message):
        self.mounts.update({transform.child_frame_id: transform for transform in message.transforms})

    def take_objects(self, message):
        self.objects = {state.name: state.pose.position for state in message.objects}

    def launch(self, *arguments):
        return Launch("web.launch", "token:=" + TOKEN, "port:=%d" % self.port, *arguments)

    def replay(self, name, *arguments):
        """The folder of its tables."""
        output = os.path.join(self.folder, name + "_result")
        subprocess.run([program("replay"), "--input", os.path.join(self.folder, name + ".bag"), "--output", output, *arguments],
                       check=True, stdout=subprocess.DEVNULL)
        return output

    @staticmethod
    def text(folder, name):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            return file.read()

    def write_bag(self, name, topic, messages):
        with rosbag.Bag(os.path.join(self.folder, name + ".bag"), "w") as bag:
            bag.write("/tf_static", TFMessage(list(self.mounts.values())), messages[0].header.stamp)
            for message in messages:
                bag.write(topic, message, message.header.stamp)

    def rows(self):
        """Of the scripted hand, in the space of the headset."""
        mount, = self.mounts.values()
        of_world = numpy.linalg.inv(matrix(mount))
        rows = [[(x, -z, y, 1.0) for x, y, z in joints(row, 25)] for row in recording(self.folder, RATE)]
        return [[float32(number) for point in row for number in (of_world @ point)[:3]] for row in rows if row]

    def test_a_headsets_hand_takes_carries_and_releases_as_a_tracker_s_does(self):
        missing = emulated_headset.missing()
        if missing:
            self.skipTest(missing)
        bag = os.path.join(self.folder, "live.bag")
        with self.launch("scene:=cube"), Launch("record.launch", "bag:=" + bag), Viewer(self.port) as viewer:
            wait_until(lambda: viewer.place("cube"), "the scene")
            headset = emulated_headset.Headset()
            self.addCleanup(headset.close)
            headset.open("http://127.0.0.1:%d/%s/" % (self.port, TOKEN))
            wait_until(lambda: headset.run("return page.drawing.complete"), "the page")
            headset.enter("immersive-ar")
            wait_until(lambda: self.left and self.right, "hands")
            for cloud in self.left[-1], self.right[-1]:
                self.check_hand(cloud)
            rows, names = self.rows(), headset.run("return import('./hands.js').then((hands) => hands.JOINTS)")
            headset.play(names, rows)
            wait_until(lambda: headset.run("return played") > len(rows), "the motion's end", 300)
            wait_until(lambda: InteractionEvent.HAND_LOST in self.kinds[-2:], "the hand's end")
            self.assertEqual(headset.errors(), [])
            wait_until(lambda: numpy.allclose(viewer.place("cube"), self.at("cube"), atol=1e-4), "the viewer's last frame")
        self.assertLessEqual(viewer.largest, 5000)
        late = sorted(self.late)
        print("from the headset's frame to a subscriber: median %.1f ms, p99 %.1f ms of %d frames" %
              (1e3 * late[len(late) // 2], 1e3 * late[int(0.99 * len(late))], len(late)))
        self.check_as_given(rows)
        self.check_live()
        self.check_grasp()

    def at(self, name):
        place = self.objects[name]
        return [place.x, place.y, place.z]

    def check_hand(self, cloud):
        self.assertEqual(len(cloud.points), 25)
        self.assertTrue(numpy.isfinite([(p.x, p.y, p.z) for p in cloud.points]).all())
        radius, confidence = cloud.channels
        self.assertEqual((radius.name, confidence.name), ("radius", "confidence"))
        self.assertTrue(all(0.003 < value < 0.03 for value in radius.values))
        self.assertEqual(set(confidence.values), {1.0})

    def check_as_given(self, rows):
        """The played rows are among the messages, each to the bit and in order; a page leaves out a frame rather than be late."""
        def numbers(cloud):
            return [number for p in cloud.points for number in (p.x, p.y, p.z)]
        begin = next(k for k, cloud in enumerate(self.right) if numbers(cloud) in rows)
        played = [cloud for cloud in self.right[begin:] if cloud.points]
        print("%d of %d frames came through" % (len(played), len(rows)))
        given = enumerate(rows)
        self.played = [(next((k for k, row in given if numbers(cloud) == row), None), cloud) for cloud in played]
        self.assertNotIn(None, [k for k, _ in self.played], "what was not given, or not in this order")

    def check_live(self):
        """The session is the live run again."""
        run = json.loads(self.text(self.replay("live"), "summary.json"))["live_run"]
        self.assertGreater(run["compared"], 100)
        self.assertEqual((run["same"], run["parts_at"]), (run["compared"], None))

    def check_grasp(self):
        """What came through takes the cube, carries it and lets go, and does to the bit what it does as PoseArray. Each frame
        has the time of its row: a browser that draws by software on a busy machine is as slow as it likes."""
        start = self.played[0][1].header.stamp
        for k, cloud in self.played:
            cloud.header.stamp = start + rospy.Duration(k / RATE)
            # a PoseArray has no radii
            cloud.channels = [channel for channel in cloud.channels if channel.name != "radius"]
        clouds = [cloud for _, cloud in self.played]
        arrays = [PoseArray(cloud.header, [Pose(position=Point(p.x, p.y, p.z)) for p in cloud.points]) for cloud in clouds]
        self.write_bag("clouds", "/hands/right/point_cloud", clouds)
        self.write_bag("arrays", "/hands/right/pose_array", arrays)
        clouds, arrays = (self.replay(name, "--scene", "cube") for name in ("clouds", "arrays"))
        for table in ("objects.csv", "contacts.csv", "events.csv"):
            self.assertEqual(self.text(clouds, table), self.text(arrays, table))
        events = [row["kind"] for row in csv.DictReader(self.text(clouds, "events.csv").splitlines())]
        # One grasp, and at most one more for each time that a busy machine's browser sent no hand for longer than GAP.
        stamps = [cloud.header.stamp.to_sec() for _, cloud in self.played]
        stalls = sum(after - before > GAP for before, after in zip(stamps, stamps[1:]))
        grasps = [kind for kind in events if "GRASP" in kind]
        self.assertEqual(grasps, ["GRASP_BEGIN", "GRASP_END"] * (len(grasps) // 2))
        self.assertIn(len(grasps) // 2, range(1, 2 + stalls))
        heights = [float(row["pz"]) for row in csv.DictReader(self.text(clouds, "objects.csv").splitlines())]
        self.assertGreater(max(heights) - heights[0], CARRIED)

    def test_lookers_on_see_what_comes_and_goes(self):
        with self.launch("hands:=demo"), Viewer(self.port) as first, Viewer(self.port) as second:
            for viewer in (first, second):
                wait_until(lambda: viewer.hands == 1 and viewer.place("cube"), "hand and cube")
            box = SpawnObjectRequest(name="box", shape="box", size=[0.05, 0.05, 0.1], mass=0.1)
            box.pose.position.x, box.pose.orientation.w = 0.3, 1.0
            rospy.wait_for_service("/interaction_node/spawn", 60)
            self.assertTrue(rospy.ServiceProxy("/interaction_node/spawn", SpawnObject)(box).success)
            for viewer in (first, second):
                wait_until(lambda: viewer.place("box"), "the box")
                self.assertAlmostEqual(viewer.place("box")[0], 0.3, delta=1e-4)
            self.assertTrue(rospy.ServiceProxy("/interaction_node/delete", DeleteObject)("box").success)
            for viewer in (first, second):
                wait_until(lambda: "box" not in viewer.bodies.values(), "the box's end")

    def test_a_recording_is_shown_as_it_was(self):
        bag = os.path.join(self.folder, "demo.bag")
        with self.launch("hands:=demo", "motion:=grasp_cube"), Launch("record.launch", "bag:=" + bag):
            wait_until(lambda: GRASP[1] in self.kinds, "a grasp")
        with rosbag.Bag(bag) as recorded:
            highest = max(message.objects[0].pose.position.z for _, message, _ in recorded.read_messages("/objects"))
        wait_until(lambda: not rospy.get_published_topics("/interaction_node"), "the nodes' end")
        with self.launch("hands:=bag", "bag:=" + bag, "loop:=false"), Viewer(self.port) as viewer:
            seen = 0.0
            wait_until(lambda: viewer.hands == 1 and viewer.place("cube"), "the recording")

            def was_carried():
                nonlocal seen
                seen = max(seen, viewer.place("cube")[2])
                return seen > highest - 0.002
            wait_until(was_carried, "the cube carried to %.3f m" % highest)

    def test_replay_serves_what_it_has_run(self):
        """roslaunch is started as a user's replay starts it, with the port and the token of this test."""
        recording(self.folder, RATE)
        hand, = glob.glob(os.path.join(self.folder, "*.csv"))
        stand_in = os.path.join(self.folder, "roslaunch")
        with open(stand_in, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\nexec '%s' \"$@\" token:=%s port:=%d\n" % (shutil.which("roslaunch"), TOKEN, self.port))
        os.chmod(stand_in, 0o755)
        served = subprocess.Popen([program("replay"), "--scene", "cube", "--input", hand, "--output", "served", "--serve"],
                                  cwd=self.folder, stdout=subprocess.DEVNULL,
                                  env=dict(os.environ, PATH=self.folder + os.pathsep + os.environ["PATH"]))
        try:
            with Viewer(self.port) as viewer:
                wait_until(lambda: viewer.hands == 1 and viewer.place("cube"), "hand and cube")
                start = viewer.place("cube")[2]
                wait_until(lambda: viewer.place("cube")[2] > start + CARRIED, "the cube carried")
        finally:
            served.send_signal(signal.SIGINT)
            self.assertEqual(served.wait(60), 0)

    def test_two_people_have_their_hands_in_one_scene(self):
        together = []  # frames with two hands

        def take(frame):
            if len(frame.hands) == 2:
                together.append(frame)
        self.addCleanup(rospy.Subscriber("hand_frame", HandFrame, take, queue_size=100).unregister)
        row = next(row for row in recording(self.folder, RATE) if row["palm_x"])
        points = [(x, -z, y, 0.008) for x, y, z in joints(row, 25)]
        numbers = 100 * [math.nan] + [number for point in points for number in point]

        async def be_there(place):
            async with aiohttp.ClientSession() as session:
                origin = "http://127.0.0.1:%d" % self.port
                async with session.ws_connect("%s/%s/socket" % (origin, TOKEN), origin=origin, max_msg_size=0) as door:
                    await doors.put_hands_in(door, place)
                    end = time.monotonic() + 60.0
                    while time.monotonic() < end and not together:
                        await door.send_bytes(struct.pack("<d200f50B", 1e3 * time.monotonic(), *numbers, *(25 * [0] + 25 * [2])))
                        await asyncio.sleep(1.0 / 60)

        async def two():
            await asyncio.gather(be_there([0, 0, 0, 0, 0, 0, 1]), be_there([0.5, 0, 0, 0, 0, 0, 1]))
        with self.launch("people:=2", "scene:=cube"), Viewer(self.port) as viewer:
            wait_until(lambda: viewer.place("cube"), "the scene")
            asyncio.run(two())
            self.assertTrue(together, "two hands in one frame")
            first, second = sorted(together[0].hands, key=lambda hand: hand.palm.position.x)
            self.assertNotEqual(first.id, second.id)
            self.assertAlmostEqual(second.palm.position.x - first.palm.position.x, 0.5, delta=1e-3)

    def test_two_people_who_float_have_frames_of_their_own_and_keep_all_momentum(self):
        """Ann, at rest, pushes a block; Ben drifts. Their hands are the same in the spaces of their headsets."""
        scene = os.path.join(self.folder, "afloat.urdf")
        for name, text in ((scene, POST),
                           (scene[:-4] + "yaml", "operators: {ann: {}, ben: {start: [0, 1, 0], twist: [0.02, 0, 0, 0, 0, 0]}}\n"
                            "bounds: {min: [-5, -5, -5], max: [5, 5, 5]}")):
            with open(name, "w", encoding="utf-8") as file:
                file.write(text)
        tracked, shown, states = [], {}, []
        for topic, kind, take in (("hand_frame", HandFrame, lambda frame: len(frame.hands) == 2 and tracked.append(frame)),
                                  ("rendered_hands", HandFrame, lambda frame: shown.update({frame.header.stamp: frame})),
                                  ("objects", ObjectStateArray, states.append)):
            self.addCleanup(rospy.Subscriber(topic, kind, take, queue_size=1000).unregister)
        row = next(row for row in recording(self.folder, RATE) if row["palm_x"])
        points = numpy.array([(x, -z, y) for x, y, z in joints(row, 25)])
        pushes, over = threading.Event(), threading.Event()

        async def be_there(place, push):
            async with aiohttp.ClientSession() as session:
                origin = "http://127.0.0.1:%d" % self.port
                async with session.ws_connect("%s/%s/socket" % (origin, TOKEN), origin=origin, max_msg_size=0) as door:
                    await doors.put_hands_in(door, place)
                    pushed = 0.0
                    while not over.is_set():
                        if push and pushes.is_set():
                            pushed = min(pushed + 0.3 / RATE, 0.2)
                        hand = numpy.column_stack([points + [pushed, 0, 0], numpy.full(25, 0.008)])
                        numbers = 100 * [math.nan] + list(hand.flat)
                        await door.send_bytes(struct.pack("<d200f50B", 1e3 * time.monotonic(), *numbers, *(25 * [0] + 25 * [2])))
                        await asyncio.sleep(1.0 / RATE)

        async def two():
            first = asyncio.ensure_future(be_there([0, 0, 0, 0, 0, 0, 1], True))
            while not self.mounts and not over.is_set():  # the first is person 1
                await asyncio.sleep(0.02)
            await asyncio.gather(first, be_there([0, 0, 0, 0, 0, 0, 1], False))

        def of(name, message):
            return next((state for state in message.objects if state.name == name), None)

        def place(pose):
            return numpy.array([pose.position.x, pose.position.y, pose.position.z])

        def momentum(message):
            return sum(state.mass * numpy.array([state.twist.linear.x, state.twist.linear.y, state.twist.linear.z])
                       for state in message.objects)
        with self.launch("people:=2", "scene:=" + scene), Viewer(self.port) as viewer:
            wait_until(lambda: viewer.bodies, "the scene")
            people = threading.Thread(target=lambda: asyncio.run(two()), daemon=True)
            people.start()
            try:
                wait_until(lambda: tracked and states, "two hands")
                first, second = sorted(tracked[-1].hands, key=lambda hand: hand.id % 2)
                self.assertTrue(numpy.allclose(place(first.palm), place(second.palm), atol=1e-3))
                ends = numpy.array([(bone.end.x, bone.end.y, bone.end.z) for bone in first.phalanges])
                box = SpawnObjectRequest(name="block", shape="box", size=[0.2, 0.4, 0.4], mass=5.0)
                box.pose.orientation.w = 1.0
                box.pose.position = Point(ends[:, 0].max() + 0.13, ends[:, 1].mean(), ends[:, 2].mean())
                rospy.wait_for_service("/interaction_node/spawn", 60)
                self.assertTrue(rospy.ServiceProxy("/interaction_node/spawn", SpawnObject)(box).success)
                wait_until(lambda: of("block", states[-1]), "the block")
                pushes.set()
                wait_until(lambda: of("block", states[-1]).twist.linear.x > 0.05, "the push")
                wait_until(lambda: of("ben", states[-1]).pose.position.x > 0.1, "Ben's drift")
            finally:
                over.set()
                people.join(10)
        sums = numpy.array([momentum(message) for message in states])
        self.assertLess(abs(sums - [80 * 0.02, 0, 0]).max(), 1e-12)
        self.assertLess(of("ann", states[-1]).twist.linear.x, -0.05 * 5 / 80)
        self.assertAlmostEqual(of("ben", states[-1]).twist.linear.x, 0.02, delta=1e-15)
        carried = []
        for message in states:
            hands = sorted(shown[message.header.stamp].hands, key=lambda hand: hand.id % 2) if message.header.stamp in shown else []
            if len(hands) == 2:
                carried.append([place(hand.palm) - place(of(name, message).pose) for hand, name in zip(hands, ("ann", "ben"))])
        self.assertGreater(len(carried), 10)
        self.assertTrue(numpy.allclose(*carried[0], atol=1e-3), "in the frames of their operators the hands are the same")
        off = [abs(ben - carried[0][1]).max() for _, ben in carried]
        self.assertLess(max(off), 1e-3, "Ben's goes where he drifts, but message %d of %d: %s" % (
            int(numpy.argmax(off)), len(off), carried[int(numpy.argmax(off))]))
        drifted = place(of("ben", states[-1]).pose) - place(of("ann", states[0]).pose)
        self.assertGreater(drifted[0], 0.1)
        self.assertAlmostEqual(drifted[1], 1.0, delta=1e-6)

    def test_https_makes_its_certificate_at_the_first_start(self):
        home = os.path.join(self.folder, "ros")
        command = [program("web_door"), "__name:=secure", "_https:=true", "_token:=" + TOKEN, "_port:=%d" % self.port]
        door = subprocess.Popen(command, env=dict(os.environ, ROS_HOME=home), stdout=subprocess.DEVNULL)
        try:
            def answers():
                made = glob.glob(os.path.join(home, "mr_hand_interaction", "*.pem"))
                try:
                    trusting = ssl.create_default_context(cafile=made[0])
                    page = "https://127.0.0.1:%d/%s/" % (self.port, TOKEN)
                    return urllib.request.urlopen(page, context=trusting, timeout=10).status == 200
                except (IndexError, OSError):
                    return False
            wait_until(answers, "the page by HTTPS")
        finally:
            door.send_signal(signal.SIGINT)
            self.assertEqual(door.wait(60), 0)

    def test_a_door_that_cannot_open_says_why_in_one_line(self):
        door = program("web_door")
        for arguments, line in ((["_port:=x"], "~port is x; allowed: 0 to 65535"),
                                (["_people:=3"], "~people is 3; allowed: 1 to 2"), (["_colour:=red"], "unknown parameter ~colour"),
                                (["_token:=a b"], "~token is 'a b'; allowed: 4 to 64"),
                                (["_three:=/nope"], "apt-get install libjs-three"),
                                (["_address:=192.0.2.1", "_https:=false"], "192.0.2.1 port 8765: "), (["now"], "unknown argument 'now'")):
            done = subprocess.run([door, *arguments, "__name:=refused"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  timeout=60, universal_newlines=True, check=False)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(line, done.stderr)
            for parameter in ("port", "people", "colour", "token", "three", "address", "https"):
                if rospy.has_param("/refused/" + parameter):
                    rospy.delete_param("/refused/" + parameter)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "web", WebTest)
