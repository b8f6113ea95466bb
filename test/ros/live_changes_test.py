#!/usr/bin/env python3
"""interaction_node while it runs: objects that come and go, parameters that change, an object moved by the mouse."""
import math
import os
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

import rospkg
import rospy
import rostest
from dynamic_reconfigure.client import Client
from dynamic_reconfigure.msg import Config, DoubleParameter, StrParameter
from dynamic_reconfigure.srv import Reconfigure
from std_srvs.srv import SetBool, Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import InteractiveMarkerFeedback, InteractiveMarkerInit, Marker, MarkerArray

from mr_hand_interaction.msg import HandFrame, InteractionEvent, ObjectStateArray
from mr_hand_interaction.srv import DeleteObject, SaveWorld, SetParameter, SpawnObject, SpawnObjectRequest, SpawnUrdf, \
    SpawnUrdfRequest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from pointing_hand import PERIOD, frame, hand, push_tips  # noqa: E402
from standing_clock import INSTANT, StandingClock  # noqa: E402
from waiting import TIMEOUT, wait_until  # noqa: E402

NODE = "interaction_node/"


class Viewer:
    """What is on the screen of one that begins to listen now. An array has only what changed, so that none of them
    alone tells."""
    def __init__(self):
        self.shown = set()
        self.subscriber = rospy.Subscriber("markers", MarkerArray, self.take)

    def take(self, array):
        for marker in array.markers:
            key = (marker.ns, marker.id)
            if marker.action == Marker.DELETEALL:
                self.shown = set()
            else:
                self.shown = self.shown | {key} if marker.action == Marker.ADD else self.shown - {key}

    def objects(self):
        return sum(layer == "objects" for layer, _ in self.shown)


BALL = '<robot name="ball"><link name="ball"><collision><geometry><mesh filename="file://%s"/></geometry></collision></link></robot>'


def write_ball(path, rows, columns, radius=0.04):
    def point(row, column):
        up, turn = math.pi * row / rows, 2.0 * math.pi * (column % columns) / columns
        return radius * math.sin(up) * math.cos(turn), radius * math.sin(up) * math.sin(turn), radius * math.cos(up)
    triangles = []
    for row in range(rows):
        for column in range(columns):
            a, b, c, d = point(row, column), point(row + 1, column), point(row + 1, column + 1), point(row, column + 1)
            triangles += [(a, b, c)] * (row < rows - 1) + [(a, c, d)] * (row > 0)
    with open(path, "wb") as stream:
        stream.write(bytes(80) + struct.pack("<I", len(triangles)))
        for corners in triangles:
            stream.write(struct.pack("<12fH", 0, 0, 0, *(number for corner in corners for number in corner), 0))


class LiveChangesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("live_changes_test")
        cls.objects, cls.events, cls.frames, cls.shown, cls.viewer = {}, [], set(), rospy.Time(), Viewer()
        cls.clock = StandingClock(lambda: cls.shown)
        cls.subscribers = [rospy.Subscriber("objects", ObjectStateArray, cls.take_objects),
                           rospy.Subscriber("interaction_events", InteractionEvent, lambda m: cls.events.append(m)),
                           rospy.Subscriber("/tf", TFMessage, cls.take_transforms)]
        for name, kind in (("spawn", SpawnObject), ("delete", DeleteObject), ("set", SetParameter), ("spawn_urdf", SpawnUrdf),
                           ("save", SaveWorld), ("reset", Trigger),
                           ("pause", SetBool)):
            rospy.wait_for_service(NODE + name, 60.0)
            setattr(cls, name, staticmethod(rospy.ServiceProxy(NODE + name, kind)))
        cls.hands = rospy.Publisher("hand_frame", HandFrame, queue_size=10)
        cls.mouse = rospy.Publisher(NODE + "place/feedback", InteractiveMarkerFeedback, queue_size=10)
        wait_until(lambda: cls.hands.get_num_connections() and cls.mouse.get_num_connections(), "the node")
        wait_until(lambda: all(s.get_num_connections() for s in cls.subscribers + [cls.viewer.subscriber]), "the node")
        cls.clock.keep_up()

    @classmethod
    def take_objects(cls, message):
        cls.objects = {o.name: o for o in message.objects}
        cls.shown = message.header.stamp

    @classmethod
    def take_transforms(cls, message):
        cls.frames.update(t.child_frame_id for t in message.transforms)

    def setUp(self):
        self.clock.go_on(INSTANT)
        for name in set(self.objects) - {"cube"}:
            self.delete(name)
        if "cube" not in self.objects:
            self.spawn_box("cube", size=0.05, y=0.0, mass=0.1)
        self.assertTrue(self.reset().success)
        self.clock.go_on(INSTANT)
        self.assertEqual(list(self.objects), ["cube"])
        self.assertEqual(self.objects["cube"].pose.position.x, 0.0)

    def spawn_box(self, name, y=0.3, mass=0.05, size=0.04, **options):
        request = SpawnObjectRequest(name=name, shape="box", size=3 * [size], mass=mass, **options)
        request.pose.position.y, request.pose.position.z = y, 0.22
        return self.spawn(request)

    def push(self, until=0.02):
        """The finger pushes the cube."""
        for tip in push_tips(end=until):
            self.hands.publish(frame(self.clock.next_stamp(PERIOD), hand(tip)))
            self.clock.keep_up()

    def test_an_object_comes_and_goes_in_all_that_is_published(self):
        answer = self.spawn_box("box")
        self.assertTrue(answer.success, answer.message)
        self.clock.go_on(INSTANT)
        self.assertEqual(self.objects["box"].pose.position.y, 0.3)
        wait_until(lambda: "box" in self.frames, "its frame")
        wait_until(lambda: self.viewer.objects() == 2, "its marker")
        self.assertTrue(self.delete("box").success)
        self.clock.go_on(INSTANT)
        self.assertNotIn("box", self.objects)
        wait_until(lambda: self.viewer.objects() == 1, "its marker gone")

    def test_hands_do_not_wait_while_a_large_mesh_is_read(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh = os.path.join(folder, "ball.stl")
            write_ball(mesh, 160, 303)
            answers = []
            request = SpawnUrdfRequest(urdf=BALL % mesh)
            request.pose.position.y, request.pose.position.z = 0.3, 0.3
            caller = threading.Thread(target=lambda: answers.append(self.spawn_urdf(request)))
            caller.start()
            answered = 0
            while not answers:
                self.hands.publish(frame(self.clock.next_stamp(PERIOD), hand(-0.3)))
                self.clock.keep_up()
                answered += 1
            caller.join()
            self.assertTrue(answers[0].success, answers[0].message)
            self.clock.go_on(INSTANT)
            self.assertIn("ball", self.objects)
            # Reading it takes a third of a second or longer, so that a server that waits answers one frame, or two.
            self.assertGreater(answered, 5)

    def test_with_joints_a_urdf_comes_and_goes_and_the_world_is_saved_as_it_is(self):
        with open(os.path.join(rospkg.RosPack().get_path("mr_hand_interaction"), "config/scenes/tongs.urdf")) as urdf:
            request = SpawnUrdfRequest(name="my", urdf=urdf.read(), joints="{tongs_hinge: {start: 0.3}}")
        request.pose.position.y = 0.4
        answer = self.spawn_urdf(request)
        self.assertTrue(answer.success, answer.message)
        self.clock.go_on(INSTANT)
        self.assertEqual(set(self.objects), {"cube", "my_tongs", "my_arm"})
        wait_until(lambda: "my_arm" in self.frames, "its frame")
        self.assertFalse(self.spawn_urdf(request).success)
        self.assertFalse(self.save("not/absolute.urdf").success)
        with tempfile.TemporaryDirectory() as folder:
            saved = os.path.join(folder, "world.urdf")
            answer = self.save(saved)
            self.assertTrue(answer.success, answer.message)
            self.assertFalse(self.save(saved).success)
            with open(saved) as urdf:
                self.assertIn("my_tongs_hinge", urdf.read())
            with open(os.path.join(folder, "world.yaml")) as settings:
                self.assertIn("my_tongs_hinge", settings.read())
        self.assertTrue(self.delete("my_tongs").success)
        self.clock.go_on(INSTANT)
        self.assertEqual(list(self.objects), ["cube"])

    def test_one_line_says_why_an_object_is_refused(self):
        for answer in (self.spawn_box("cube"), self.spawn_box("a b"), self.spawn_box("far", y=50.0),
                       self.spawn_box("world"), self.spawn_box("leap_hands"), self.spawn_box("inside", y=0.01), self.spawn_box("odd", material="{restitution: 2}"),
                       self.spawn(SpawnObjectRequest(urdf="<robot"))):
            self.assertFalse(answer.success)
            self.assertIn("allowed", answer.message)
            self.assertNotIn("\n", answer.message)
        self.assertFalse(self.delete("nobody").success)
        self.clock.go_on(INSTANT)
        self.assertEqual(list(self.objects), ["cube"])

    def test_what_is_touched_and_deleted_is_left_in_order(self):
        self.assertTrue(self.delete("cube").success)
        self.assertTrue(self.spawn_box("heavy", y=0.0, mass=1e4).success)
        self.push(until=-0.015)

        def told():
            return [event.kind for event in list(self.events) if event.object == "heavy"]
        wait_until(lambda: InteractionEvent.CONTACT_BEGIN in told(), "the contact")
        self.assertTrue(self.delete("heavy").success)
        wait_until(lambda: InteractionEvent.HOVER_END in told(), "its end")
        self.assertEqual(told()[-2:], [InteractionEvent.CONTACT_END, InteractionEvent.HOVER_END])

    def test_parameters_change_by_their_names_and_a_bad_value_is_refused(self):
        answer = self.set("material/static_friction", "0.9")
        self.assertTrue(answer.success, answer.message)
        self.assertIn("0.9", answer.message)
        wait_until(lambda: rospy.get_param("/interaction_node/tune/material_static_friction") == 0.9, "the slider")
        for name, value in (("step", "-1"), ("speed", "1"), ("material/dynamic_friction", "7"), ("step", "[")):
            answer = self.set(name, value)
            self.assertFalse(answer.success)
            self.assertIn(name, answer.message)
            self.assertNotIn("\n", answer.message)
        self.assertTrue(self.set("material/static_friction", "0.8").success)

    def test_several_parameters_change_at_once_or_not_at_all(self):
        def run(*words):
            done = subprocess.run(["rosrun", "mr_hand_interaction", "set", "--node", "/interaction_node"] + list(words), timeout=60,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, check=False)
            return done.returncode, done.stdout
        status, said = run("material/static_friction", "0.2")
        self.assertEqual(status, 1)  # the dynamic friction is 0.6
        self.assertIn("both set at once", said)
        friction = ("material/static_friction", "0.2", "material/dynamic_friction", "0.1")
        status, said = run(*friction, "step", "-1")
        self.assertEqual(status, 1)
        self.assertIn("step", said)
        self.assertEqual(self.set("material/dynamic_friction", "0.6").message, "material/dynamic_friction is 0.6")
        self.assertEqual(run(*friction),
                         (0, "material/static_friction is 0.2, material/dynamic_friction is 0.1\n"))
        self.assertEqual(run("gravity", "[0, 0, -1.5]", "filter/type", "none")[0], 0)
        for words in (("step",), ("step", "0.001", "filter/type"), ("step", "0.001", "step", "0.002"), ("step", "[")):
            status, said = run(*words)
            self.assertEqual((status, said.count("\n")), (2, 1), said)
        self.assertEqual(run("material/static_friction", "0.8", "material/dynamic_friction", "0.6", "filter/type",
                             "constant_velocity", "gravity", "[0, 0, 0]")[0], 0)

    def test_dynamic_reconfigure_changes_what_flies_without_a_jump(self):
        client = Client("interaction_node/tune", timeout=TIMEOUT)
        self.push()
        self.assertGreater(self.objects["cube"].twist.linear.x, 0.1)
        speed = self.objects["cube"].twist.linear
        held = client.update_configuration({"contact_model": "seed", "step": 0.002, "filter_window": 5,
                                            "material_restitution": 0.1})
        self.assertEqual((held["contact_model"], held["filter_window"]), ("seed", 5))
        self.assertEqual(held["material_stiffness"], 100.0, "the model's own")
        self.clock.go_on(INSTANT)
        self.assertEqual(self.objects["cube"].twist.linear, speed)
        held = client.update_configuration({"gravity_z": -1.0})
        self.assertFalse(held["gravity_of_scene"])
        self.clock.go_on_until(lambda: self.objects["cube"].twist.linear.z < -0.2, "gravity")
        held = client.update_configuration({"gravity_of_scene": True, "contact_model": "implicit", "step": 0.001,
                                            "filter_window": 3, "material_restitution": 0.3})
        self.assertEqual(held["gravity_z"], 0.0)
        self.assertEqual(held["material_stiffness"], 2000.0)

    def test_dynamic_reconfigure_fixes_the_noise_that_is_estimated_and_gives_it_back(self):
        client = Client("interaction_node/tune", timeout=TIMEOUT)
        for wanted, estimated, noise in (({"filter_noise": 0.002}, False, 0.002),
                                         ({"filter_noise_estimated": True}, True, 0.0004),
                                         ({"filter_noise_estimated": False}, False, 0.0004)):
            held = client.update_configuration(wanted)
            self.assertEqual((held["filter_noise_estimated"], held["filter_noise"]), (estimated, noise))
        self.assertTrue(self.set("filter/noise", "estimated").success)

    def test_dynamic_reconfigure_refuses_a_bad_value_and_keeps_what_is_good(self):
        reconfigure = rospy.ServiceProxy(NODE + "tune/set_parameters", Reconfigure)
        for bad in (Config(doubles=[DoubleParameter("step", 7.0)]), Config(strs=[StrParameter("contact_model", "glue")]),
                    Config(doubles=[DoubleParameter("material_dynamic_friction", 0.9)])):
            held = reconfigure(bad).config
            values = {p.name: p.value for p in held.doubles + held.strs}
            self.assertEqual((values["step"], values["contact_model"], values["material_dynamic_friction"]),
                             (0.001, "implicit", 0.6))

    def test_the_mouse_moves_an_object_and_lets_it_go_at_rest(self):
        names = []
        init = rospy.Subscriber(NODE + "place/update_full", InteractiveMarkerInit,
                                lambda m: names.append([marker.name for marker in m.markers]))
        self.assertTrue(self.spawn_box("box").success)
        wait_until(lambda: names and sorted(names[-1]) == ["box", "cube"], "their markers")
        init.unregister()
        self.push()
        self.assertGreater(self.objects["cube"].twist.linear.x, 0.1)
        feedback = InteractiveMarkerFeedback(client_id="test", marker_name="cube", control_name="move y",
                                             event_type=InteractiveMarkerFeedback.POSE_UPDATE)
        feedback.header.frame_id = "world"
        feedback.pose.position.y, feedback.pose.position.z, feedback.pose.orientation.w = 0.1, 0.3, 1.0

        def dragged():
            self.mouse.publish(feedback)  # again and again, as rviz does: it is forgotten after a while
            return self.objects["cube"].pose.position.y == 0.1
        wait_until(dragged, "the cube where the mouse is")
        self.assertEqual(self.objects["cube"].twist.linear.x, 0.0)
        feedback.event_type = InteractiveMarkerFeedback.MOUSE_UP
        self.mouse.publish(feedback)
        self.clock.go_on(1.0)
        self.assertEqual(self.objects["cube"].pose.position.y, 0.1)
        self.assertEqual(self.objects["cube"].twist.linear.x, 0.0)

    def test_who_comes_late_sees_everything(self):
        self.assertTrue(self.spawn_box("box").success)
        # All subscribers of a topic in this process share one connection: it takes an end of it for a new one. As no
        # time passes, nothing is repeated.
        self.viewer.subscriber.unregister()
        type(self).viewer = Viewer()
        wait_until(lambda: self.viewer.objects() == 2, "a picture of both")

    def test_reset_brings_back_what_there_is(self):
        self.assertTrue(self.spawn_box("box").success)
        self.push()
        self.assertTrue(self.reset().success)
        self.clock.go_on(INSTANT)
        self.assertEqual(self.objects["cube"].pose.position.x, 0.0)
        self.assertEqual(self.objects["box"].pose.position.y, 0.3)

    def test_objects_come_and_go_while_paused(self):
        self.addCleanup(self.pause, False)
        self.assertTrue(self.pause(True).success)
        self.assertTrue(self.spawn_box("box").success)
        self.clock.go_on(INSTANT)
        self.assertIn("box", self.objects)
        self.assertTrue(self.delete("box").success)
        self.clock.go_on(INSTANT)
        self.assertNotIn("box", self.objects)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "live_changes", LiveChangesTest)
