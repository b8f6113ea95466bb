#!/usr/bin/env python3
"""two_trackers.launch: two people who take a cube each, and one person whom two trackers see."""
import os
import shutil
import sys
import tempfile
import threading
import unittest

import rospy
import rostest
from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion

from mr_hand_interaction.msg import HandFrame, InteractionEvent
from mr_hand_interaction.srv import SpawnObject, SpawnObjectRequest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from launching import Launch  # noqa: E402
from tracker_hands import joints, recording  # noqa: E402
from waiting import TIMEOUT, wait_until  # noqa: E402

APART = 0.6  # m between the trackers of two people, and between the cubes


class MergeHandsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("merge_hands_test")
        cls.folder = tempfile.mkdtemp()
        cls.rows = {rate: recording(cls.folder, rate) for rate in (60, 100)}
        cls.publishers = {name: rospy.Publisher(name + "/hands/right/pose_array", PoseArray, queue_size=10)
                          for name in ("first", "second")}

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.events, self.frames = [], []
        self.subscribers = [rospy.Subscriber("interaction_events", InteractionEvent, self.events.append, queue_size=1000),
                            rospy.Subscriber("hand_frame", HandFrame, self.frames.append, queue_size=1000)]

    def tearDown(self):
        for subscriber in self.subscribers:
            subscriber.unregister()

    def play(self, name, rate, hides=lambda time: False):
        """The scripted hand as its tracker sees it, by a clock that all share."""
        begin = rospy.Time.now()
        for row in self.rows[rate]:
            time = float(row["time_s"])
            stamp = begin + rospy.Duration.from_sec(time)
            rospy.sleep(stamp - rospy.Time.now())
            message = PoseArray()
            message.header.stamp, message.header.frame_id = stamp, name + "_leap_hands"
            if not hides(time):
                message.poses = [Pose(position=Point(*point)) for point in joints(row, 25)]
            self.publishers[name].publish(message)

    def play_both(self, **hides):
        wait_until(lambda: all(p.get_num_connections() == 1 for p in self.publishers.values()), "the trackers' nodes")
        wait_until(lambda: all(s.get_num_connections() == 1 for s in self.subscribers), "the other nodes")
        threads = [threading.Thread(target=self.play, args=(name, rate), kwargs={"hides": hides.get(name, lambda _: False)})
                   for name, rate in (("first", 100), ("second", 60))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    def grasps(self):
        return [(event.object, event.kind, event.hand_id) for event in list(self.events)
                if event.kind in (InteractionEvent.GRASP_BEGIN, InteractionEvent.GRASP_END)]

    @staticmethod
    def mounts(*places):
        return ["%s_mount:=%g 0 0 0.7071067811865476 0 0 0.7071067811865476" % (name, place)
                for name, place in zip(("first", "second"), places)]

    def test_two_people_take_a_cube_each(self):
        with Launch("two_trackers.launch", "scene:=cube", "rviz:=false", *self.mounts(0.0, APART)):
            rospy.wait_for_service("interaction_node/spawn", TIMEOUT)
            answer = rospy.ServiceProxy("interaction_node/spawn", SpawnObject)(SpawnObjectRequest(
                name="other", shape="box", size=[0.05, 0.05, 0.05], mass=0.1,
                pose=Pose(position=Point(APART, *self.place_of_cube()), orientation=Quaternion(w=1.0))))
            self.assertTrue(answer.success, answer.message)
            self.play_both()
            wait_until(lambda: len(self.grasps()) >= 4, "both cubes taken and let go")
        begun = {name: hand for name, kind, hand in self.grasps() if kind == InteractionEvent.GRASP_BEGIN}
        self.assertEqual(set(begun), {"cube", "other"})
        self.assertEqual(len(set(begun.values())), 2)
        self.assertEqual(len(self.grasps()), 4)
        self.assertTrue(all(len(frame.hands) <= 2 for frame in self.frames))

    @staticmethod
    def place_of_cube():
        """y and z of the scene's cube, from its pose in tf's place: its file."""
        import rospkg
        import xml.etree.ElementTree as xml
        file = os.path.join(rospkg.RosPack().get_path("mr_hand_interaction"), "config", "scenes", "cube.urdf")
        for joint in xml.parse(file).getroot().iter("joint"):
            if joint.get("type") == "floating":
                return [float(value) for value in joint.find("origin").get("xyz").split()][1:]
        raise AssertionError("no floating joint in " + file)

    def test_one_person_is_held_on_to_by_the_tracker_that_still_sees_the_hand(self):
        """The second tracker stands 4 mm beside where it is said to, and the first loses the hand for a second."""
        with Launch("two_trackers.launch", "merge:=fused", "scene:=cube", "rviz:=false", *self.mounts(0.0, 0.004)):
            self.play_both(first=lambda time: 3.5 < time < 4.5)
            wait_until(lambda: len(self.grasps()) >= 2, "the cube taken and let go")
        self.assertEqual([(name, kind) for name, kind, _ in self.grasps()],
                         [("cube", InteractionEvent.GRASP_BEGIN), ("cube", InteractionEvent.GRASP_END)])
        self.assertEqual({hand.id for frame in self.frames for hand in frame.hands}, {2})


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "merge_hands", MergeHandsTest)
