#!/usr/bin/env python3
"""What goes wrong around nodes, and what holds all the same: docs/reliability.md."""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
import unittest

import rosbag
import rosgraph
import roslib.packages
import rospy
import rostest
from dynamic_reconfigure.client import Client
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import InteractiveMarkerFeedback, MarkerArray

from mr_hand_interaction.msg import HandFrame, ObjectStateArray
from mr_hand_interaction.srv import DeleteObject, SetParameter, SpawnObject, SpawnObjectRequest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, os.pardir, os.pardir, "scripts")]
from free_port import free_port  # noqa: E402
from waiting import TIMEOUT, wait_until  # noqa: E402

ROUNDS = 100  # of everything at once: a second's worth at 100 Hz
MOUNT = "0 0 0 0.7071067811865476 0 0 0.7071067811865476 world leap_hands".split()
NODES = {
    "hand_tracking_node": [],
    "interaction_node": ["_scene:=cube", "_place_by_mouse:=true"],
    "synthetic_hand_node": ["_motion:=nudge", "_reset:=/interaction_node/reset"],
}


def start(package, kind, arguments, **options):
    return subprocess.Popen(roslib.packages.find_node(package, kind)[:1] + arguments, **options)


def write_chains(path, chains=8, length=12):
    """Pendulums of many links, whose steps take long."""
    link = '<link name="%s"><inertial><mass value="0.1"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    joint = '<joint name="to_%s" type="continuous"><parent link="%s"/><child link="%s"/><axis xyz="0 1 0"/><origin xyz="%g %g 0"/></joint>'
    parts = ['<link name="wall"/>']
    for chain in range(chains):
        parent = "wall"
        for i in range(length):
            name = "link_%d_%d" % (chain, i)
            parts += [link % name, joint % (name, parent, name, 0.1 * (i > 0), 0.2 * chain * (i == 0))]
            parent = name
    with open(path, "w") as file:
        file.write('<robot name="chains">%s</robot>' % "".join(parts))


class Pipeline:
    """Context of all nodes from the tracker on, each in a process of its own."""

    def __init__(self, master=None, interaction=()):
        self.interaction = list(interaction)
        self.environment = dict(os.environ, ROS_MASTER_URI=master) if master else dict(os.environ)
        self.folder, self.processes = tempfile.mkdtemp(), {}

    def __enter__(self):
        self.mount = start("tf2_ros", "static_transform_publisher", MOUNT, env=self.environment)
        for kind in NODES:
            self.start(kind)
        return self

    def start(self, kind):
        with open(self.log(kind), "ab") as log:
            arguments = NODES[kind] + (self.interaction if kind == "interaction_node" else [])
            self.processes[kind] = start("mr_hand_interaction", kind, arguments, env=self.environment, stdout=log,
                                         stderr=log)

    def log(self, kind):
        return os.path.join(self.folder, kind)

    def said(self, kind, words):
        with open(self.log(kind), errors="replace") as log:
            return words in log.read()

    def kill(self, kind):
        self.processes[kind].kill()
        self.processes[kind].wait()

    def ended(self):
        return [kind for kind, process in self.processes.items() if process.poll() is not None]

    def __exit__(self, *_):
        for process in list(self.processes.values()) + [self.mount]:
            process.send_signal(signal.SIGINT)
        for process in list(self.processes.values()) + [self.mount]:
            process.wait(TIMEOUT)
        for kind in NODES:
            with open(self.log(kind), errors="replace") as log:
                sys.stdout.write(log.read())
        shutil.rmtree(self.folder)


class Seen:
    """How many of the messages have come that only come if all nodes work."""

    def __init__(self):
        self.counts = {"hands": 0, "objects": 0, "markers": 0}
        self.subscribers = [rospy.Subscriber("rendered_hands", HandFrame, self.take_hands),
                            rospy.Subscriber("objects", ObjectStateArray, lambda _: self.count("objects")),
                            rospy.Subscriber("markers", MarkerArray, lambda _: self.count("markers"))]

    def count(self, what):
        self.counts[what] += 1

    def take_hands(self, message):
        if message.hands:
            self.count("hands")

    def wait_for_more(self, when):
        before = dict(self.counts)
        for what in before:
            wait_until(lambda: self.counts[what] > before[what] + 3, what + " " + when)  # pylint: disable=cell-var-from-loop


class FaultsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("faults_test")
        cls.seen = Seen()

    def test_every_node_can_be_killed_and_started_again_while_the_others_run(self):
        with Pipeline() as pipeline:
            self.seen.wait_for_more("at first")
            for kind in NODES:
                pipeline.kill(kind)
                self.assertEqual(pipeline.ended(), [kind])
                pipeline.start(kind)
                self.seen.wait_for_more("after %s was killed" % kind)
                self.assertEqual(pipeline.ended(), [])

    def test_nodes_tell_of_a_master_that_was_started_anew_and_what_is_connected_goes_on(self):
        port = free_port()
        uri = "http://localhost:%d" % port
        command = ["rosmaster", "--core", "-p", str(port)]
        core = subprocess.Popen(command)
        self.addCleanup(lambda: (core.kill(), core.wait()))
        wait_until(lambda: rosgraph.is_master_online(uri), "the master, without which rostopic ends")
        with Pipeline(uri) as pipeline:
            viewer = subprocess.Popen(["rostopic", "echo", "-p", "/rendered_hands/header/stamp"],
                                      env=pipeline.environment, stdout=subprocess.PIPE, universal_newlines=True)
            self.addCleanup(lambda: (viewer.kill(), viewer.wait(), viewer.stdout.close()))
            lines = []
            threading.Thread(target=lambda: [lines.append(line) for line in viewer.stdout], daemon=True).start()
            wait_until(lambda: len(lines) > 3, "hands")
            core.kill()
            core.wait()
            for kind in NODES:
                wait_until(lambda: pipeline.said(kind, "no ROS master at " + uri), kind + " to miss its master")
            core = subprocess.Popen(command)
            for kind in NODES:
                wait_until(lambda: pipeline.said(kind, "start this node again"), kind + " to tell of the new master")
            before = len(lines)
            wait_until(lambda: len(lines) > before + 3, "hands without a master")
            self.assertEqual(pipeline.ended(), [])

    def test_a_recorder_without_room_says_so_and_ends_and_its_bag_is_whole(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        file = os.path.join(folder, "full.bag")
        # More than any disk has: as if it were full.
        recorder = subprocess.run(["roslaunch", "mr_hand_interaction", "record.launch", "bag:=" + file,
                                   "extra:=--min-space=900000G"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  universal_newlines=True, timeout=TIMEOUT)
        self.assertIn("Disabling recording", recorder.stdout)
        with rosbag.Bag(file) as bag:
            self.assertEqual(bag.get_message_count(), 0)

    def test_services_reconfigures_mouse_and_viewers_at_once_at_100_hz_stop_nothing(self):
        with Pipeline() as pipeline:
            self.seen.wait_for_more("at first")
            failures = []

            def repeat(work):
                try:
                    for i in range(ROUNDS):
                        work(i)
                        time.sleep(0.01)  # the rate at which things are asked for
                except Exception:
                    failures.append(traceback.format_exc())
            threads = [threading.Thread(target=repeat, args=[work]) for work in self.works()]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(failures, [])
            self.assertEqual(pipeline.ended(), [])
            self.seen.wait_for_more("at last")

    def test_a_scene_far_slower_than_real_time_keeps_answering_and_showing(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        scene = os.path.join(folder, "chains.urdf")
        write_chains(scene)
        # A second of these steps takes a core half a minute or more, so a frame that had to simulate all that has
        # passed since the last would take 30 times the last one's time.
        with Pipeline(interaction=["_scene:=" + scene, "_gravity:=[0, 0, -9.81]", "_step:=0.00001"]) as pipeline:
            rospy.wait_for_service("interaction_node/set", TIMEOUT)
            change = rospy.ServiceProxy("interaction_node/set", SetParameter)
            wait_until(lambda: pipeline.said("interaction_node", "slower than real time"), "time to be left out")
            for window in range(2, 6):
                asked = time.monotonic()
                self.assertTrue(change("filter/window", str(window)).success)
                # Ten frames of 50 ms wait before it at most: the rest is room for a loaded machine.
                self.assertLess(time.monotonic() - asked, 10.0)
                self.seen.wait_for_more("in a slow scene")

    @staticmethod
    def works():
        """What each asks for, again and again."""
        def service(name, kind):
            rospy.wait_for_service("interaction_node/" + name, TIMEOUT)
            return rospy.ServiceProxy("interaction_node/" + name, kind)
        spawn, delete = service("spawn", SpawnObject), service("delete", DeleteObject)
        change, pause, reset = service("set", SetParameter), service("pause", SetBool), service("reset", Trigger)
        tune = Client("interaction_node/tune", timeout=TIMEOUT)
        mouse = rospy.Publisher("interaction_node/place/feedback", InteractiveMarkerFeedback, queue_size=10)

        def demand(answer):
            assert answer.success, answer.message

        def come_and_go(i):
            request = SpawnObjectRequest(name="ball_%d" % i, shape="sphere", size=[0.02], mass=0.1)
            request.pose.position.x = 1.0  # where the cube does not get to, however it is pushed and dragged
            demand(spawn(request))
            demand(delete(request.name))

        def set_parameters(i):
            demand(change("filter/window", str(1 + i % 5)))
            demand(pause(i % 2 == 0))
            if i % 10 == 0:
                demand(reset())

        def drag(i):
            feedback = InteractiveMarkerFeedback(client_id="test", marker_name="cube", control_name="move y")
            feedback.event_type = InteractiveMarkerFeedback.MOUSE_UP if i % 10 == 9 else feedback.POSE_UPDATE
            feedback.header.frame_id = "world"
            feedback.pose.position.y, feedback.pose.position.z, feedback.pose.orientation.w = 0.1, 0.3, 1.0
            mouse.publish(feedback)

        def look(_):
            rospy.Subscriber("markers", MarkerArray, lambda _: None).unregister()

        return [come_and_go, set_parameters, drag, look,
                lambda i: tune.update_configuration({"step": 0.001 + 0.001 * (i % 3), "gravity_z": 0.1 * (i % 2),
                                                     "place_by_mouse": i % 20 != 19})]


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "faults", FaultsTest)
