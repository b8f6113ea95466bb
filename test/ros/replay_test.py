#!/usr/bin/env python3
"""record.launch and replay: a replay of a bag alone is the live run, by the hash that the node told at the same stamp."""
import csv
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from xmlrpc.client import ServerProxy

import rosbag
import rosgraph
import rospy
import rostest
from dynamic_reconfigure.client import Client
from std_srvs.srv import SetBool, Trigger

from mr_hand_interaction.msg import InteractionEvent, SimulationInput, TrainingStatus
from mr_hand_interaction.srv import DeleteObject, SetParameter, SpawnObject, SpawnObjectRequest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from launching import Launch  # noqa: E402
from waiting import TIMEOUT, wait_until  # noqa: E402

NODE = "interaction_node/"
RUN = 120.0  # s; a run of the scripted hand lasts 9
CHANGES_APART = 40  # entries, so that each change has frames before and after it
MESH = """<robot name="m"><link name="m"><inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0"
ixz="0" iyz="0"/></inertial><collision><geometry><mesh filename="package://mr_hand_interaction/config/meshes/%s"
scale="1 1 1"/></geometry></collision></link></robot>"""


def recorded_topics():
    """Of interaction_node, those whose messages the recorder gets by now."""
    master = rosgraph.Master("/replay_test")
    if not any("/interaction_node" in nodes for _, nodes in master.getSystemState()[0]):
        return []
    _, _, connections = ServerProxy(master.lookupNode("/interaction_node")).getBusInfo("/replay_test")
    return [topic for _, peer, _, _, topic, *_ in connections if peer == "/rosbag_record"]


def reported_by_the_node(bag):
    """By the number of the last input: (stamp [ns], state hash), as /diagnostics had them."""
    reported = {}
    for _, message, _ in bag.read_messages(["/diagnostics"]):
        for status in message.status:
            values = {pair.key: pair.value for pair in status.values}
            if "state hash" in values:
                reported[int(values["simulation input"])] = (int(values["state stamp [ns]"]), values["state hash"])
    return reported


class ReplayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("replay_test")
        cls.subscribers = [rospy.Subscriber("simulation_input", SimulationInput, cls.take_input),
                           rospy.Subscriber("interaction_events", InteractionEvent, cls.take_event),
                           rospy.Subscriber("training/status", TrainingStatus, cls.take_status)]

    @classmethod
    def take_input(cls, message):
        cls.taken += 1

    @classmethod
    def take_event(cls, message):
        cls.kinds.append(message.kind)

    @classmethod
    def take_status(cls, message):
        cls.status = message

    def setUp(self):
        type(self).taken, type(self).kinds, type(self).status = 0, [], None
        for name in ("interaction_node", "synthetic_hand_node"):  # what an earlier launch has left
            if rospy.has_param(name):
                rospy.delete_param(name)
        self.folder = tempfile.mkdtemp()
        self.bag = os.path.join(self.folder, "hand.bag")

    def tearDown(self):
        shutil.rmtree(self.folder)

    def recording(self):
        return Launch("record.launch", "bag:=" + self.bag)

    def wait_for_recorder(self):
        """It connects to one topic after the other: an event before this may be in its inputs alone."""
        wait_until(lambda: {"/simulation_input", "/interaction_events", "/diagnostics"}.issubset(recorded_topics()),
                   "rosbag record")
        self.recorded_since = rospy.get_time()

    def wait_for_inputs(self, more=CHANGES_APART):
        end = self.taken + more
        wait_until(lambda: self.taken >= end, "%d more inputs" % more)

    def wait_for_a_whole_grasp(self):
        """The end of one that ended as the recorder came may be told late."""
        wait_until(lambda: InteractionEvent.GRASP_BEGIN in self.kinds, "a grasp", RUN)
        begin = self.kinds.index(InteractionEvent.GRASP_BEGIN)
        wait_until(lambda: InteractionEvent.GRASP_END in self.kinds[begin:], "the end of the grasp", RUN)

    def call(self, name, kind, *values):
        rospy.wait_for_service(NODE + name, 60.0)
        answer = rospy.ServiceProxy(NODE + name, kind)(*values)
        self.assertTrue(answer.success, answer.message)
        self.wait_for_inputs()

    def replay(self, bag, *arguments):
        output = os.path.join(self.folder, "out")
        subprocess.check_call(["rosrun", "mr_hand_interaction", "replay", "--input", bag, "--output", output] +
                              list(arguments))
        with open(output + "/summary.json") as file:
            summary = json.load(file)
        with open(output + "/hashes.csv") as file:
            hashes = {int(row["sequence"]): (int(row["stamp"]), row["state_hash"]) for row in csv.DictReader(file)}
        return summary, hashes, output

    def check_it_is_the_live_run(self, bag, *arguments):
        summary, hashes, output = self.replay(bag, *arguments)
        live = summary["live_run"]
        self.assertEqual((live["missing"], live["parts_at"], live["overridden"], summary["not_known"]),
                         (0, None, [], []))
        self.assertEqual(live["same"], live["compared"])
        self.assertGreater(live["compared"], 100)
        with rosbag.Bag(bag) as recorded:
            reported = {number: what for number, what in reported_by_the_node(recorded).items() if number in hashes}
            live_events = [(event.header.stamp.to_sec(), event.kind)
                           for _, event, _ in recorded.read_messages(["/interaction_events"])]
            first_frame = next(message.header.stamp.to_sec() for _, message, _ in recorded.read_messages(["/simulation_input"])
                               if message.kind == SimulationInput.FRAME)
        self.assertGreater(len(reported), 0)
        for number, (stamp, state_hash) in reported.items():
            self.assertEqual(hashes[number], (stamp, state_hash), "input %d" % number)
        with open(output + "/events.csv") as file:
            events = [(first_frame + float(row["time"]), getattr(InteractionEvent, row["kind"]))
                      for row in csv.DictReader(file)]
        last_state = 1e-9 * max(stamp for stamp, _ in reported.values()) + 0.001  # less than a frame later

        def grasps(events):
            return [kind for time, kind in events if self.recorded_since < time < last_state and
                    kind in (InteractionEvent.GRASP_BEGIN, InteractionEvent.GRASP_END)]
        self.assertEqual(grasps(events), grasps(live_events))
        return summary

    def test_the_demo_recorded_while_it_runs(self):
        with Launch("demo.launch", "rviz:=false"):
            wait_until(lambda: InteractionEvent.CONTACT_BEGIN in self.kinds, "the first touch", RUN)
            with self.recording():
                self.wait_for_recorder()
                del self.kinds[:]
                self.wait_for_a_whole_grasp()
                self.wait_for_inputs(300)  # some seconds, as the node tells its state once in each
        summary = self.check_it_is_the_live_run(self.bag)
        self.assertIn("GRASP_END", summary["events"])
        self.check_it_is_explained_with_pictures()
        self.check_a_what_if_is_explained_and_nothing_else_in_its_folder_changes()

    def check_a_what_if_is_explained_and_nothing_else_in_its_folder_changes(self):
        """Not the recorded run, which the pictures must not bring back either."""
        def contents(folder):
            files = {}
            for name in os.listdir(folder):
                with open(os.path.join(folder, name), "rb") as file:
                    files[name] = file.read()
            return files
        _, _, output = self.replay(self.bag, "--set", "material/static_friction=0.1", "--set", "material/dynamic_friction=0.1")
        before = contents(output)
        subprocess.run([os.path.join(self.package(), "scripts", "explain"), output], stdout=subprocess.DEVNULL, check=True,
                       timeout=RUN)
        after = contents(output)
        told = json.loads(after.pop("explain.json").decode())
        del after["explain.html"]
        self.assertEqual(after, before)
        self.assertIn("material/dynamic_friction=0.1 instead of 0.6", "\n".join(told["facts"]))

    def check_it_is_explained_with_pictures(self):
        output = os.path.join(self.folder, "explained")
        done = subprocess.run([os.path.join(self.package(), "scripts", "explain"), self.bag, "--output", output],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, timeout=RUN)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("hand_opened: cube", done.stdout)
        with open(output + "/explain.html") as file:
            page = file.read()
        self.assertNotIn("http", page)
        if not all(shutil.which(tool) for tool in ("rviz", "Xvfb", "import")):
            self.assertIn("explain: no pictures: ", done.stderr)
            return
        self.assertNotIn("no pictures", done.stderr)
        self.assertNotIn("<!--picture", page)
        pictures = re.findall("src='data:image/jpeg;base64,([^']*)'", page)
        self.assertGreaterEqual(len(pictures), 3)  # the grasp, before its end, its end
        for picture in pictures:  # a bare background of this size has 1 kB
            self.assertTrue(4000 < 0.75 * len(picture) < 40000, len(picture))

    def test_a_tuned_and_disturbed_run(self):
        mesh = os.path.basename(sorted(glob.glob(os.path.join(self.package(), "config", "meshes", "*.stl")))[0])
        with self.recording():
            with Launch("demo.launch", "rviz:=false", "gravity:=[0, 0, -0.2]", "noise:=1"):
                self.wait_for_recorder()
                self.wait_for_inputs()
                self.call("set", SetParameter, "material/static_friction", "1.1")
                self.call("set", SetParameter, "grasp/cube", "free")
                Client("interaction_node/tune", timeout=TIMEOUT).update_configuration(
                    {"filter_window": 5, "contact_model": "seed", "gravity_z": -0.1})
                self.wait_for_inputs()
                box = SpawnObjectRequest(name="box", shape="box", size=[0.03, 0.04, 0.05], mass=0.05,
                                         material="{static_friction: 0.9}")
                box.pose.position.x, box.pose.position.z, box.twist.angular.z = 0.3, 0.3, 1.0
                self.call("spawn", SpawnObject, box)
                of_mesh = SpawnObjectRequest(name="of_mesh", urdf=MESH % mesh)
                of_mesh.pose.position.x, of_mesh.pose.position.z = -0.5, 0.5
                self.call("spawn", SpawnObject, of_mesh)
                Client("interaction_node/tune", timeout=TIMEOUT).update_configuration({"contact_model": "implicit"})
                self.call("pause", SetBool, False)
                rospy.ServiceProxy(NODE + "pause", SetBool)(True)
                rospy.ServiceProxy(NODE + "pause", SetBool)(False)
                self.call("delete", DeleteObject, "box")
                self.call("reset", Trigger)
                self.wait_for_inputs(100)
        live = self.check_it_is_the_live_run(self.bag)["live_run"]
        said = "\n".join(live["changes"])
        for what in ("material/static_friction=1.1", "grasp/cube=free", "contact_model=seed", "gravity", "spawn 'box'", "spawn 'of_mesh'",
                     "pause", "go on", "delete 'box'", "reset"):
            self.assertIn(what, said)
        summary, _, _ = self.replay(self.bag, "--set", "material/dynamic_friction=0.3")
        self.assertEqual(summary["live_run"]["compared"], 0)
        self.assertIn("material/dynamic_friction=0.3 instead of 0.6", "\n".join(summary["live_run"]["overridden"]))

    def test_joints_in_the_scene_that_are_worked_by_hand_and_changed(self):
        with self.recording():
            with Launch("demo.launch", "rviz:=false", "scene:=panel", "motion:=open_drawer"):
                self.wait_for_recorder()
                wait_until(lambda: InteractionEvent.GRASP_BEGIN in self.kinds, "a grasp", RUN)
                self.call("set", SetParameter, "material/static_friction", "1.0")
                self.wait_for_a_whole_grasp()
                self.wait_for_inputs(100)
                self.call("reset", Trigger)
                self.wait_for_inputs(100)
        summary = self.check_it_is_the_live_run(self.bag, "--explain")
        self.assertEqual(summary["scene"], "panel")
        output = os.path.join(self.folder, "out")
        with open(output + "/joints.csv") as file:
            drawer = [float(row["position"]) for row in csv.DictReader(file) if row["name"] == "drawer_slide"]
        self.assertGreater(max(drawer), 0.05)
        self.assertLess(abs(drawer[-1]), 0.001)  # since the reset
        with open(output + "/explain.json") as file:
            story = json.load(file)
        told = {joint["name"]: [sample["position"] for sample in joint["samples"]] for joint in story["joints"]}
        self.assertAlmostEqual(max(told["drawer_slide"]), max(drawer), 5)
        with open(output + "/explain.html") as file:
            self.assertIn("drawer_slide", file.read())

    def test_a_training_session_with_three_objects(self):
        session = os.path.join(self.folder, "session")
        objects = []
        with Launch("training.launch", "participant:=P01", "rviz:=false", "folder:=" + session, "hands:=operator",
                    "auto_next:=-1", "auto_start:=false"):
            self.wait_for_recorder()
            for _ in range(3):
                wait_until(lambda: self.status and self.status.phase == TrainingStatus.READY, "the next trial")
                objects.append(self.status.object)
                rospy.wait_for_service("training_node/next", 60.0)
                self.assertTrue(rospy.ServiceProxy("training_node/next", Trigger)().success)
                wait_until(lambda: self.status.phase == TrainingStatus.RUNNING, "the trial")
                self.wait_for_inputs(200)
                self.assertTrue(rospy.ServiceProxy("training_node/skip", Trigger)().success)
            self.wait_for_inputs(100)  # so that the recorder has the last trial's events
        (bag,) = glob.glob(session + "/hands_*.bag")
        said = "\n".join(self.check_it_is_the_live_run(bag)["live_run"]["changes"])
        self.assertEqual(len(set(objects)), 3)
        for name in objects[1:]:  # the first may have come before the recorder did
            self.assertIn("spawn '%s'" % name, said)
        with open(os.path.join(self.folder, "out", "objects.csv")) as file:
            self.assertLessEqual(set(objects), {row["name"] for row in csv.DictReader(file)})

    @staticmethod
    def package():
        return os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "replay", ReplayTest)
