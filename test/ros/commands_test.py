#!/usr/bin/env python3
"""Every command that README.md and docs/*.md print does what a user may expect of it: it is run as printed, with the
arguments that a user fills in, or it is in EXCEPTED with the reason why not."""
import contextlib
import functools
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rospy
import rostest

from mr_hand_interaction.msg import TrainingStatus

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from launching import Launch  # noqa: E402
from printed_commands import COMMANDS, EXCEPTED, NAME, PACKAGE, User, excepted, shortened, to_run  # noqa: E402

NODES = ("hand_interaction_node", "hand_tracking_node", "interaction_node", "simulated_operator_node", "synthetic_hand_node",
         "training_node")



class CommandsTest(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        rospy.init_node("commands_test")
        cls.folder = tempfile.mkdtemp()
        cls.user = User(cls.folder)

    def setUp(self):
        self.user.write_files()

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @contextlib.contextmanager
    def each(self, failures, command):
        """All commands are tried; rosunit would take what fails in a subTest for passed."""
        try:
            yield
        except (AssertionError, subprocess.TimeoutExpired, rospy.ROSException) as error:
            failures.append("%s: %s" % (command, error))

    def test_each_command_is_run_or_excepted(self):
        self.assertGreater(len(COMMANDS), 40)
        run = {command for beginning in ("roslaunch ", "rosrun ", "rosservice ", "scripts/") for command in to_run(beginning)}
        for command in COMMANDS:
            self.assertTrue(command in run or excepted(command.text), "nothing is known of %s" % command)

    def test_no_exception_is_for_nothing(self):
        used = {index for command in COMMANDS for index in excepted(command.text)}
        for index, (beginning, _) in enumerate(EXCEPTED):
            self.assertIn(index, used, "no page has %s" % beginning)

    def test_launch_files_bring_their_nodes_up(self):
        launches, failures = to_run("roslaunch "), []
        self.assertGreater(len(launches), 8)
        for command in launches:
            with self.each(failures, command):
                self.user.check_comes_up(command)
            rospy.set_param("/use_sim_time", False)
            if "record.launch" in command.text:
                self.user.write_files()  # it has written one of them
        self.assertEqual(failures, [])

    def test_programs_run(self):
        self.assertGreater(len(to_run("rosrun ")), 6)
        failures = []
        status = rospy.Publisher("training/status", TrainingStatus, queue_size=1, latch=True)
        status.publish(TrainingStatus())
        with Launch("demo.launch", "rviz:=false"):
            rospy.wait_for_service("/interaction_node/set", 60.0)
            for command in to_run("rosrun "):
                words, options = self.found(self.user.words(command)), {}
                if "simulated_study" in command.text:
                    words = shortened(words, ("--model", "implicit"))
                if "training_keys" in command.text:
                    options["stdin"] = "q"
                with self.each(failures, command):
                    if "doctor" in command.text:
                        self.assertIn("master", self.user.run(words)[1])
                    else:
                        self.user.check_runs(command, words, **options)
            for command in to_run("rosservice "):
                with self.each(failures, command):
                    self.assertIn("success: True", self.user.check_runs(command))
        status.unregister()
        self.assertEqual(failures, [])

    @classmethod
    def found(cls, words):
        """Words of rosrun, without it."""
        assert words[:2] == ["rosrun", NAME], words
        return [cls.path_of(words[2])] + words[3:]

    @staticmethod
    @functools.lru_cache(maxsize=None)
    def path_of(program):
        """Where rosrun finds it, without the second that rosrun takes to find it."""
        found = roslib.packages.find_node(NAME, program)
        assert found, "rosrun finds no %s" % program
        return found[0]

    def test_check_scene_tells_what_became_of_each_scene_and_whether_all_load(self):
        status, said = self.user.run(["rosrun", NAME, "check_scene", "part.urdf", "rack", "--picture", "rack.svg"])
        self.assertEqual(status, 0, said)
        self.assertRegex(said, r"part +free +150 +72 +30, 40, 60 +1 +0.8 +0.3")
        self.assertRegex(said, r"shelf +fixture ")
        with open(os.path.join(self.user.folder, "rack.svg"), encoding="ascii") as picture:
            self.assertGreater(picture.read().count("<path"), 100)
        with open(os.path.join(self.user.folder, "bare.urdf"), "w", encoding="ascii") as file:
            file.write("<robot name='b'><link name='b.1'><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision>"
                       "</link></robot>")
        check_scene = self.path_of("check_scene")
        status, said = self.user.run([check_scene, "none.urdf", "bare.urdf", "--density", "500"])
        self.assertEqual(status, 1)
        self.assertIn("none.urdf", said)
        self.assertRegex(said, r"b_1 +free +500 ")
        self.assertRegex(said, r"warning: masses .*'b_1' 0.5 kg")
        for words in ([], ["cube", "--density", "0"], ["cube", "--colour"]):
            self.assertEqual(self.user.run([check_scene, *words])[0], 2, words)

    def test_a_node_refuses_an_argument_that_it_does_not_know(self):
        for program in NODES:
            status, output = self.user.run([self.path_of(program), "--rate", "3"], timeout=60)
            self.assertNotEqual(status, 0, program)
            self.assertEqual(output.count("\n"), 1, output)
            self.assertIn("--help", output)

    def test_scripts_know_the_options_that_are_printed(self):
        self.assertGreater(len(to_run("scripts/")), 5)
        failures, usage = [], {}
        for command in to_run("scripts/"):
            script = shlex.split(command.text)[0]
            with self.each(failures, command):
                if script not in usage:
                    usage[script] = self.user.check_runs(command, [os.path.join(PACKAGE, script), "--help"])
                told = usage[script]
                for option in re.findall(r"--[a-z-]+", command.text):
                    self.assertTrue(option == "--help" or option in told, "%s is not among\n%s" % (option, told))
        self.assertEqual(failures, [])


if __name__ == "__main__":
    rostest.rosrun(NAME, "commands", CommandsTest)
