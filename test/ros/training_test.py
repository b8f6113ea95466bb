#!/usr/bin/env python3
"""training.launch: a trial through the real nodes, its log, and what the experimenter does."""
import csv
import functools
import glob
import os
import pty
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from xmlrpc.client import ServerProxy

import rosgraph
import roslib.packages
import rospy
import rostest
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import MarkerArray

from mr_hand_interaction.msg import HandFrame, ObjectStateArray, TrainingEvent, TrainingStatus
from mr_hand_interaction.srv import SetParameter

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from launching import Launch  # noqa: E402
from waiting import wait_until  # noqa: E402

SCRIPTS = os.path.join(HERE, "..", "..", "scripts")
RUN = 150.0  # s; a run of the scripted hand lasts 9, and the first is without a trial
RUNS = 3  # where the machine keeps the nodes waiting they lose frames, and the hand what it cannot follow with
LOST = 0.015  # s between two stamps: of two frames at 115 Hz there are 0.0087
DRIFT = 0.2  # m, of what an operator has let go
HELD_UP = 0.1  # s between two stamps: longer than the frames of an operator wait in the nodes' queues


def trials(folder):
    with open(os.path.join(folder, "trials.csv"), newline="") as file:
        return list(csv.DictReader(file))


def has_pandas():
    return subprocess.call([sys.executable, "-c", "import pandas, scipy, matplotlib"], stderr=subprocess.DEVNULL) == 0


class TrainingTest(unittest.TestCase):
    begun = None  # the folder of begin_session

    @classmethod
    def tearDownClass(cls):
        if cls.begun is not None:
            shutil.rmtree(cls.begun)

    @classmethod
    def setUpClass(cls):
        rospy.init_node("training_test")
        cls.subscribers = [rospy.Subscriber("training/status", TrainingStatus, cls.take_status),
                           rospy.Subscriber("training/events", TrainingEvent, lambda event: cls.events.append(event)),
                           rospy.Subscriber("training/markers", MarkerArray, cls.take_markers),
                           rospy.Subscriber("rendered_hands", HandFrame, cls.take_rendered),
                           rospy.Subscriber("objects", ObjectStateArray, cls.take_objects)]

    def setUp(self):
        self.parent = tempfile.mkdtemp()
        self.folder = os.path.join(self.parent, "session")
        self.clear()

    def tearDown(self):
        shutil.rmtree(self.parent)

    @classmethod
    def clear(cls):
        cls.status, cls.seen, cls.layers, cls.objects, cls.events = None, set(), set(), [], []
        cls.rendered, cls.longest_break = None, 0.0

    @classmethod
    def take_status(cls, message):
        cls.status = message
        cls.seen.add((message.phase, message.stage, message.place, message.inside))

    @classmethod
    def take_markers(cls, message):
        cls.layers.update(marker.ns for marker in message.markers)

    @classmethod
    def take_rendered(cls, message):
        before, cls.rendered = cls.rendered, message.header.stamp
        if before is not None:
            cls.longest_break = max(cls.longest_break, (cls.rendered - before).to_sec())

    @classmethod
    def take_objects(cls, message):
        cls.objects = [thing.name for thing in message.objects]

    def training(self, *arguments):
        return Launch("training.launch", "participant:=P01", "rviz:=false", "folder:=" + self.folder, *arguments)

    def scripted_trial(self):
        with self.training("hands:=demo", "task:=" + os.path.join(HERE, "training_carry.yaml")):
            wait_until(lambda: self.status and self.status.result, "the end of a trial", RUN)
            self.assertEqual(self.status.phase, TrainingStatus.FINISHED)
            wait_until(lambda: glob.glob(self.folder + "/hands_*.bag*"), "the bag")
        return trials(self.folder)

    def test_scripted_hand_completes_a_trial_and_the_session_can_be_analysed(self):
        for run in range(RUNS):
            self.clear()
            self.folder = os.path.join(self.parent, "session%d" % run)
            (row,) = self.scripted_trial()
            if (row["result"], row["attempts"], row["drops"]) == ("completed", "1", "0") or self.longest_break < LOST:
                break
        for place in (1, 2, 3):
            self.assertIn((TrainingStatus.RUNNING, TrainingStatus.MAINTENANCE, place, True), self.seen)
        self.assertLessEqual({"target", "places", "path", "instructions", "result"}, self.layers)
        self.assertEqual((row["object"], row["result"], row["drops"]), ("cube", "completed", "0"))
        self.assertEqual(row["attempts"], "1")
        # From the grasp on the hand carries the cube 8 cm up, and turns it.
        self.assertAlmostEqual(float(row["path_length"]), 0.08, delta=0.02)
        self.assertGreater(float(row["grip_force_max"]), float(row["grip_force_mean"]))
        self.assertGreater(float(row["grip_force_mean"]), 0.05)
        self.assertLess(float(row["release_drift"]), 0.05)
        self.check_analysis()

    def test_a_device_is_worked_and_stands_anew_in_each_trial(self):
        with self.training("hands:=demo", "motion:=press_button", "task:=" + os.path.join(HERE, "training_panel.yaml")):
            wait_until(lambda: self.status and self.status.phase == TrainingStatus.FINISHED, "the end of the session", RUN)
            self.assertLessEqual({"button", "drawer", "door"}, set(self.objects))
        self.assertEqual([(row["object"], row["result"], row["drops"]) for row in trials(self.folder)],
                         2 * [("board", "completed", "0")])
        self.assertIn("object", self.layers)
        with open(os.path.join(self.folder, "events.csv"), newline="") as file:
            achieved = [row for row in csv.DictReader(file) if row["event"] == "goal_achieved"]
        self.assertEqual([row["detail"] for row in achieved], ["1", "2", "1", "2"])

    def operator_s_trials(self):
        with self.training("hands:=operator", "group:=veteran", "auto_next:=0.5", "record:=false"):
            wait_until(lambda: self.status and self.status.phase == TrainingStatus.FINISHED, "the session's end", 400.0)
        return trials(self.folder)

    def test_an_operator_does_the_paper_s_task_to_the_end(self):
        for run in range(RUNS):
            self.clear()
            self.folder = os.path.join(self.parent, "session%d" % run)
            rows = self.operator_s_trials()
            good = all(row["result"] == "completed" and float(row["release_drift"]) < DRIFT for row in rows)
            if good or self.longest_break < HELD_UP:
                break
        for place in (1, 2, 3):
            self.assertIn((TrainingStatus.RUNNING, TrainingStatus.MAINTENANCE, place, True), self.seen)
        self.assertEqual({row["object"]: row["result"] for row in rows},
                         dict.fromkeys(("cube", "flat_cuboid", "long_cuboid"), "completed"))
        for row in rows:
            self.assertGreaterEqual(float(row["maintenance_time"]), 9.0, "three places for 3 s each")
            self.assertLess(float(row["release_drift"]), DRIFT)

    def test_an_operator_taps(self):
        """Six trials; who is kept waiting by the machine may strike too late, and strikes again."""
        with self.training("hands:=operator", "task:=tap", "auto_next:=0.2", "record:=false"):
            wait_until(lambda: self.status and self.status.phase == TrainingStatus.FINISHED, "the session's end", 200.0)
        rows = trials(self.folder)
        self.assertEqual([row["object"] for row in rows].count("long_cuboid"), 3)
        self.assertGreaterEqual([row["result"] for row in rows].count("completed"), 5)

    def test_an_operator_opens_the_hatch_and_closes_it(self):
        """Undisturbed: 33 s, of which nearly all is waiting. A hand that lost frames may miss, and then tries again."""
        task = os.path.join(HERE, "training_hatch.yaml")
        for run in range(RUNS):
            self.clear()
            self.folder = os.path.join(self.parent, "session%d" % run)
            with self.training("hands:=operator", "group:=none", "task:=" + task, "record:=false"):
                wait_until(lambda: self.status and self.status.phase == TrainingStatus.FINISHED, "the session's end", 200.0)
            (row,) = trials(self.folder)
            if row["result"] == "completed" or self.longest_break < HELD_UP:
                break
        self.assertEqual(row["result"], "completed")
        with open(os.path.join(self.folder, "events.csv"), newline="") as file:
            achieved = [row["detail"] for row in csv.DictReader(file) if row["event"] == "goal_achieved"]
        self.assertEqual(achieved, ["1", "2", "3", "4", "5"])

    def test_an_operator_who_floats_pulls_along_a_rail_with_two_hands(self):
        """One trial of 13 s undisturbed; hands that lost frames may miss the rail, and take it again."""
        with self.training("hands:=operator", "group:=none", "task:=rail", "record:=false", "auto_next:=-1"):
            wait_until(lambda: self.status and self.status.result, "the end of a trial", 200.0)
        (row,) = trials(self.folder)
        self.assertEqual(row["result"], "completed")
        self.assertGreaterEqual(int(row["touches"]), 4, "each hand takes the rail twice")
        self.assertLess(float(row["operator_speed"]), 0.03)

    def check_analysis(self):
        if not has_pandas():
            print("analyse_study is not tried: python3-pandas, -scipy or -matplotlib is absent")
            return
        results = os.path.join(self.parent, "results")
        subprocess.check_call([sys.executable, os.path.join(SCRIPTS, "analyse_study"), self.folder,
                               "--output", results])
        with open(os.path.join(results, "trials.csv")) as file:
            self.assertIn("cube", file.read())
        self.assertTrue(os.path.exists(os.path.join(results, "figures", "trajectory_P01_implicit_0_g.png")))

    def call(self, name, *values):
        kind = SetBool if values else Trigger
        rospy.wait_for_service("training_node/" + name, 60.0)
        return rospy.ServiceProxy("training_node/" + name, kind)(*values)

    def begin(self):
        self.assertTrue(self.call("next").success)
        self.wait_for(TrainingStatus.RUNNING)
        wait_until(lambda: self.status.elapsed > 0.0, "the trial's clock")

    def wait_for(self, phase):
        wait_until(lambda: self.status and self.status.phase == phase, "phase %d" % phase)

    def test_next_pause_repeat_and_skip_by_service(self):
        with self.training("record:=false", "auto_next:=-1"):
            self.wait_for(TrainingStatus.READY)
            self.begin()
            self.assertFalse(self.call("next").success, "a trial is running")
            wait_until(lambda: self.objects == [self.status.object], "its object alone")
            self.assertTrue(self.call("pause", True).success)
            self.wait_for(TrainingStatus.PAUSED)
            elapsed = self.status.elapsed
            self.assertTrue(self.call("pause", False).success)
            wait_until(lambda: self.status.elapsed > elapsed, "time that goes on")
            first = self.status.object
            self.assertTrue(self.call("repeat").success)
            wait_until(lambda: self.status.result == "aborted" and self.status.elapsed > 0.0, "the trial anew")
            self.assertEqual(self.status.object, first)
            self.assertTrue(self.call("skip").success)
            wait_until(lambda: self.status.trial == 2, "the next trial")
            self.begin()
            wait_until(lambda: self.objects == [self.status.object], "its object alone")
            self.assertNotEqual(self.status.object, first)
        self.assertEqual(self.results(), [("1", "aborted"), ("2", "skipped"), ("3", "aborted")])
        self.check_published_events()

    def check_published_events(self):
        """Each row as it is in the file, from the first on that came after the test had been connected."""
        with open(os.path.join(self.folder, "events.csv"), newline="") as file:
            rows = [(row["event"], row["trial"] or "0", row["object"], row["detail"], "%.6f" % float(row["time"]), row["stamp"],
                     row["utc"]) for row in csv.DictReader(file)]
        told = [(event.event, str(event.trial), event.object, event.detail, "%.6f" % event.time,
                 "%d.%09d" % (event.header.stamp.secs, event.header.stamp.nsecs), event.utc) for event in self.events]
        self.assertLessEqual({"begun", "paused", "resumed", "ended"}, {row[0] for row in told})
        first = rows.index(told[0])
        self.assertEqual(told, rows[first:first + len(told)])

    def results(self):
        return [(row["trial"], row["result"]) for row in trials(self.folder)]

    def test_next_pause_repeat_and_skip_by_key(self):
        with self.training("record:=false", "auto_next:=-1"):
            self.wait_for(TrainingStatus.READY)
            ours, theirs = pty.openpty()
            keys = subprocess.Popen([sys.executable, os.path.join(SCRIPTS, "training_keys")], stdin=theirs,
                                    stdout=subprocess.PIPE)
            said = []
            listener = threading.Thread(target=lambda: [said.append(line) for line in keys.stdout], daemon=True)
            listener.start()
            wait_until(lambda: any(b"n: next" in line for line in said), "the keys")
            press = functools.partial(os.write, ours)
            press(b"n")
            wait_until(lambda: self.status.elapsed > 0.0, "the trial that n begins")
            press(b"p")
            # What p does next hangs on what the keys have been told of.
            wait_until(lambda: any(b": Pause" in line for line in said), "the pause on the keys' screen")
            press(b"p")
            self.wait_for(TrainingStatus.RUNNING)
            press(b"r")
            wait_until(lambda: self.status.result == "aborted" and self.status.elapsed > 0.0, "the trial anew")
            press(b"s")
            wait_until(lambda: self.status.trial == 2, "the next trial")
            press(b"sss?")  # typed ahead; the last s is refused
            questions = b"ask_ratings " + self.folder.encode()
            wait_until(lambda: any(questions in line for line in said), "a word of the questions")
            press(b"q")
            self.assertEqual(keys.wait(60), 0)
            self.wait_for(TrainingStatus.FINISHED)
            listener.join()
            keys.stdout.close()
            os.close(ours)
            os.close(theirs)
        self.assertEqual(self.results(), [("1", "aborted"), ("2", "skipped"), ("3", "skipped"), ("4", "skipped")])

    def test_goes_on_after_it_was_killed(self):
        with self.training("record:=false", "auto_next:=-1"):
            self.wait_for(TrainingStatus.READY)
            self.assertTrue(self.call("skip").success)
            self.begin()
            self.kill("training_node")
        self.clear()
        self.assertEqual([row["result"] for row in trials(self.folder)], ["skipped"])
        with self.training("record:=false", "auto_next:=-1"):
            self.wait_for(TrainingStatus.READY)
            self.assertEqual(self.status.trial, 2)
            self.begin()
            self.assertTrue(self.call("skip").success)
            wait_until(lambda: self.status.trial == 3, "the last trial")
        self.assertEqual([row["trial"] for row in trials(self.folder)], ["1", "3"], "2 was killed")

    @staticmethod
    def kill(name, by=signal.SIGKILL):
        uri = rosgraph.Master("/training_test").lookupNode("/" + name)
        os.kill(ServerProxy(uri).getPid("/training_test")[2], by)

    def test_a_signal_that_can_be_caught_writes_the_trial_s_row(self):
        for count, by in enumerate((signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT), 1):
            self.clear()
            with self.training("record:=false", "auto_next:=-1"):
                self.wait_for(TrainingStatus.READY)
                self.begin()
                self.kill("training_node", by)
                wait_until(lambda: len(trials(self.folder)) == count, "the row")
            self.assertEqual([row["result"] for row in trials(self.folder)], count * ["aborted"])

    def begin_session(self):
        """As training.launch leaves a folder whose session has begun: launched once for all tests that are refused it."""
        cls = type(self)
        if cls.begun is None:
            with self.training("record:=false"):
                self.wait_for(TrainingStatus.READY)
            cls.begun = tempfile.mkdtemp()
            shutil.copytree(self.folder, os.path.join(cls.begun, "session"))
        else:
            shutil.copytree(os.path.join(cls.begun, "session"), self.folder)

    def test_refuses_the_folder_of_another_participant(self):
        self.begin_session()
        command = roslib.packages.find_node("mr_hand_interaction", "training_node")[:1] + [
            "_participant:=P02", "_group:=beginner", "_handedness:=right", "_condition:=implicit",
            "_folder:=" + self.folder, "__name:=refused"]
        answer = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
        self.assertEqual(answer.returncode, 1)
        self.assertIn(b"participant", answer.stdout)
        self.assertIn(b"'P02'", answer.stdout)

    @staticmethod
    def node(folder, *arguments):
        command = roslib.packages.find_node("mr_hand_interaction", "training_node")[:1] + [
            "_participant:=P01", "_group:=beginner", "_handedness:=right", "_condition:=implicit",
            "_folder:=" + folder, "__name:=other"]
        return subprocess.Popen(command + list(arguments), stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def test_refuses_numbers_beyond_either_end(self):
        """A break that no duration of ROS can hold ended the node after the first trial."""
        for given, allowed in (("auto_next:=5e9", b"a number from -3600 to 3600 [s]"),
                               ("auto_next:=-3601", b"a number from -3600 to 3600 [s]"),
                               ("session:=0", b"a whole number from 1 to 2147483647")):
            refused = self.node(self.folder, "_" + given)
            self.assertIn(allowed, refused.communicate(timeout=120)[0])
            self.assertEqual(refused.returncode, 1)
            rospy.delete_param("/other")

    def test_a_task_that_no_operator_can_do_is_refused_before_there_is_a_folder(self):
        with open(os.path.join(self.parent, "crate.urdf"), "w") as file:
            file.write("<robot name='crate'><link name='crate'><collision><geometry><box size='0.3 0.2 0.25'/></geometry>"
                       "</collision></link></robot>")
        task = os.path.join(self.parent, "crates.yaml")
        with open(task, "w") as file:
            file.write("name: crates\ngravity: [0, 0, 0]\nobjects:\n  - {name: crate, file: crate.urdf, position: [0, 0, 0.3]}\n"
                       "goals:\n  - pick: {distance: 0.05}\n")
        refused = self.node(self.folder, "_operator:=true", "_task:=" + task)
        self.assertIn(b"object 'crate' is 0.2 m wide", refused.communicate(timeout=120)[0])
        self.assertEqual(refused.returncode, 1)
        self.assertFalse(os.path.exists(self.folder))
        rospy.delete_param("/other")

    def test_a_folder_that_is_removed_while_the_session_runs_ends_the_node_with_one_line(self):
        with self.training("record:=false", "auto_next:=-1"):
            self.wait_for(TrainingStatus.READY)
            folder = os.path.join(self.parent, "removed")
            other = self.node(folder, "training/status:=other/status", "training/events:=other/events")
            wait_until(lambda: os.path.exists(os.path.join(folder, "events.csv")), "the session's folder")
            shutil.rmtree(folder)
            told = other.communicate(timeout=120)[0]
        self.assertEqual(other.returncode, 1)
        self.assertEqual(told.count(b"removed or replaced while the session runs"), 1, told)
        rospy.delete_param("/other")

    def test_refuses_to_go_on_with_another_contact_model_under_the_same_condition(self):
        """The folder keeps what the session was begun with, and the events have the time of the clock."""
        self.begin_session()
        with open(os.path.join(self.folder, "events.csv"), newline="") as file:
            begun = next(csv.DictReader(file))
        self.assertLess(abs(float(begun["stamp"]) - time.time()), 600.0)
        self.assertRegex(begun["utc"], r"^20\d\d-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z$")
        command = roslib.packages.find_node("mr_hand_interaction", "training_node")[:1] + [
            "_participant:=P01", "_group:=beginner", "_handedness:=right", "_condition:=implicit",
            "_simulation:=other_node", "_folder:=" + self.folder, "__name:=refused"]
        rospy.set_param("/other_node/contact_model", "soft_pad")
        answer = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
        rospy.delete_param("/other_node")
        self.assertEqual(answer.returncode, 1)
        self.assertIn(b"'contact_model: implicit', this one has 'contact_model: soft_pad'", answer.stdout)

    def parameter_events(self):
        with open(os.path.join(self.folder, "events.csv"), newline="") as file:
            return [(row["event"], row["detail"], row["trial"]) for row in csv.DictReader(file)
                    if row["event"].startswith("parameter_")]

    def test_a_parameter_changed_while_the_session_runs_is_in_its_events(self):
        with self.training("record:=false", "auto_next:=-1"):
            self.wait_for(TrainingStatus.READY)
            self.begin()
            change = rospy.ServiceProxy("interaction_node/set", SetParameter)
            self.assertTrue(change("contact_model", "soft_pad").success)
            wait_until(lambda: len(self.parameter_events()) == 1, "the change's event")
            self.assertTrue(change("contact_model", "implicit").success)
            wait_until(lambda: len(self.parameter_events()) == 2, "the event of the change back")
            self.assertTrue(change("contact_model", "implicit").success, "changes nothing")
            self.assertTrue(change("gravity", "[0, 0, -1.5]").success)
            wait_until(lambda: len(self.parameter_events()) == 3, "the event of gravity")
        changed, restored, gravity = self.parameter_events()
        self.assertEqual(changed, ("parameter_changed", "contact_model: soft_pad", "1"))
        self.assertEqual(restored, ("parameter_restored", "contact_model: implicit", "1"))
        self.assertEqual(gravity[0], "parameter_changed")
        self.assertRegex(gravity[1], r"^gravity: \[0 +0 +-1\.5\]$")


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "training", TrainingTest)
