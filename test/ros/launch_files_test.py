#!/usr/bin/env python3
"""What launch files make of their arguments: no shell reads any of them, and nobody but this machine may connect."""
import glob
import os
import shlex
import subprocess
import tempfile
import unittest

import roslaunch.arg_dump
import roslaunch.config
import roslaunch.xmlloader
import roslib.packages
import rosbag
import rospkg
import rostest
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import Empty
from tf2_msgs.msg import TFMessage

PACKAGE = "mr_hand_interaction"
FOLDER = os.path.join(rospkg.RosPack().get_path(PACKAGE), "launch")
FILES = sorted(os.path.basename(path) for path in glob.glob(os.path.join(FOLDER, "*.launch")))
NEEDED = {"playback.launch": ["bag:=/tmp/a.bag"], "webcam.launch": ["model:=/tmp/hand_landmarker.task"],
          "training.launch": ["participant:=P01"]}
SHELLS = ("sh", "bash", "dash", "zsh", "env", "xterm")


def config_of(name, *arguments):
    config = roslaunch.config.ROSLaunchConfig()
    argv = NEEDED.get(name, []) + list(arguments)
    roslaunch.xmlloader.XmlLoader().load(os.path.join(FOLDER, name), config, argv=argv, verbose=False)
    return config


def nodes_of(name, *arguments):
    return config_of(name, *arguments).nodes


def with_environment(**values):
    """The environment with these; None: without."""
    class Changed:
        def __enter__(self):
            self.before = dict(os.environ)
            for name, value in values.items():
                os.environ.pop(name, None)
                if value is not None:
                    os.environ[name] = value

        def __exit__(self, *_):
            os.environ.clear()
            os.environ.update(self.before)
    return Changed()


class LaunchFilesTest(unittest.TestCase):
    def test_there_are_launch_files(self):
        self.assertGreater(len(FILES), 7)

    def test_arguments_are_listed_where_none_is_given(self):
        for name in FILES:
            listed = roslaunch.arg_dump.get_args([os.path.join(FOLDER, name)])
            for argument in NEEDED.get(name, []):
                self.assertIn(argument.split(":=")[0], listed)
        for argument, folder in (("session:=1", "/s/P01_implicit_hatch"), ("session:=2", "/s/P01_implicit_hatch_2"),
                                 ("folder:=/f", "/f"), ("participant:=007", "/s/007_implicit_hatch"),
                                 ("condition:=1e5", "/s/P01_1e5_hatch")):
            config = config_of("training.launch", "sessions:=/s", "task:=/t/hatch.yaml", argument)
            self.assertEqual(config.params["/training_node/folder"].value, folder)
            bag = [node for node in config.nodes if node.package == "rosbag"][0]
            self.assertEqual(dict(bag.env_args)["RUN_WHEN_FILE"], folder + "/hands")

    def test_nodes_are_for_this_machine_alone_unless_asked(self):
        for name in FILES:
            with with_environment(ROS_IP=None, ROS_HOSTNAME=None):
                closed, opened = nodes_of(name), nodes_of(name, "network:=true")
            with with_environment(ROS_IP="192.168.7.7", ROS_HOSTNAME=None):
                chosen = nodes_of(name)
            self.assertTrue(closed)
            for node in closed:
                self.assertIn(("ROS_IP", "127.0.0.1"), node.env_args, "%s: %s" % (name, node.name))
            for node in opened:
                self.assertNotIn("ROS_IP", dict(node.env_args), "%s: %s" % (name, node.name))
            for node in chosen:
                self.assertIn(("ROS_IP", "192.168.7.7"), node.env_args, "%s: %s" % (name, node.name))

    def test_roles_of_several_machines_are_open_to_them(self):
        with with_environment(ROS_IP=None, ROS_HOSTNAME=None):
            for role in ("bridge", "simulation", "view"):
                for node in nodes_of("multi_machine.launch", "role:=" + role):
                    self.assertNotIn("ROS_IP", dict(node.env_args))

    def test_no_shell_reads_an_argument(self):
        for name in FILES:
            for node in nodes_of(name):
                words = (node.launch_prefix or "").split()
                self.assertFalse(words and os.path.basename(words[0]) in SHELLS, "%s: %s" % (name, node.launch_prefix))
        for argument in ("/tmp/`touch x`.bag", "/tmp/a'; touch x; '.bag"):
            for node in nodes_of("playback.launch", "bag:=" + argument):
                self.assertNotIn("touch", node.launch_prefix or "")

    def test_tracking_is_a_process_of_its_own_where_that_is_asked_for(self):
        def types(name, *arguments):
            return sorted(node.type for node in nodes_of(name, *arguments) if node.package == PACKAGE)
        simulating = [name for name in FILES if "hand_interaction_node" in types(name)]
        self.assertGreater(len(simulating), 6)
        for name in simulating:
            apart = types(name, "one_process:=false")
            self.assertEqual(apart.count("hand_tracking_node"), 1, name)
            self.assertEqual(apart.count("interaction_node"), 1, name)
            self.assertNotIn("hand_interaction_node", apart, name)

    def test_a_path_is_one_word_whatever_is_in_it(self):
        for path in ("/tmp/x y/my hand.bag", "/tmp/it's --loop \"my\" \\ hand.bag", "/tmp/a\tb.bag"):
            for name, argument, of in (("playback.launch", "bag", path), ("record.launch", "bag", path),
                                       ("training.launch", "folder", path + "/hands")):
                node = [node for node in nodes_of(name, argument + ":=" + path) if node.package == "rosbag"][0]
                self.assertEqual(dict(node.env_args)["RUN_WHEN_FILE"], of)
                self.assertEqual(shlex.split(node.args).count("@FILE"), 1)
                self.assertIn("run_when", node.launch_prefix)
            for name, argument, kind in (("mr_view.launch", "still", "image_publisher"), ("interaction.launch", "view", "rviz")):
                node = [node for node in nodes_of(name, argument + ":=" + path) if node.package == kind][0]
                self.assertEqual(shlex.split(node.args)[-1], path)

    def test_what_is_not_known_is_answered_with_what_is(self):
        for name, argument, allowed in (("multi_machine.launch", "role:=x", "bridge, simulation, view, all"),
                                        ("multi_machine.launch", "hands:=x", "leap, demo"),
                                        ("mr_view.launch", "hands:=x", "demo, leap, none"),
                                        ("training.launch", "hands:=x", "leap, operator, demo, none"),
                                        ("training.launch", "sessions:=x", "an absolute path"),
                                        ("training.launch", "folder:=~/x", "an absolute path"),
                                        ("record.launch", "bag:=x.bag", "an absolute path"),
                                        ("web.launch", "hands:=x", "headset, demo, leap, bag, none"),
                                        ("web.launch", "people:=3", "1, 2"),
                                        ("playback.launch", "rate:=x", "a number above 0"),
                                        ("playback.launch", "rate:=1 --pause", "a number above 0")):
            with self.assertRaises(roslaunch.xmlloader.XmlParseException) as told:
                nodes_of(name, argument)
            self.assertIn("'%s; allowed: %s'" % (argument, allowed), str(told.exception))

    @staticmethod
    def run_when(file, *arguments):
        """Exit status and what was said."""
        script = roslib.packages.find_node(PACKAGE, "run_when")[0]
        answer = subprocess.run([script, *arguments], env=dict(os.environ, RUN_WHEN_FILE=file), timeout=60,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        return answer.returncode, answer.stdout

    def test_a_bag_that_cannot_be_played_is_named_in_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            paths = {name: os.path.join(folder, "x y", name + ".bag") for name in ("none", "folder", "pipe", "empty", "text",
                                                                                 "other")}
            os.makedirs(paths["folder"])
            os.mkfifo(paths["pipe"])
            with open(paths["empty"], "w"), open(paths["text"], "w") as text:
                text.write("no bag")
            with rosbag.Bag(paths["other"], "w") as bag:
                bag.write("/other", Empty())
            for path, why in ((paths["none"], "there is no such bag"), (paths["folder"], "is a folder; allowed: a file"),
                              (paths["pipe"], "is a pipe; allowed: a file"), (paths["empty"], "is empty"),
                              (paths["text"], "This does not appear to be a bag file"), ("/dev/zero", "is a device"),
                              (paths["other"], "allowed: a bag with one of /hands")):
                status, said = self.run_when(path, "bag", "echo", "played", "--topics", "/hands")
                self.assertEqual(status, 1)
                self.assertTrue(said.startswith(path + ": "), said)
                self.assertIn(why, said)
                self.assertEqual(said.count("\n"), 1, said)
                if path != paths["other"]:  # whoever plays it says so
                    self.assertEqual(self.run_when(path, "bag_without", "leap_hands", "echo", "placed"), (0, ""))

    def test_a_mount_is_for_bags_in_which_nothing_places_the_device(self):
        with tempfile.TemporaryDirectory() as folder:
            for topic, frame, placed in (("/tf", "leap_hands", False), ("/tf_static", "/leap_hands", False),
                                         ("/tf", "cube", True), ("/other", "leap_hands", True)):
                path = os.path.join(folder, "a.bag")
                with rosbag.Bag(path, "w") as bag:
                    transform = TransformStamped(child_frame_id=frame)
                    transform.header.frame_id = "world"
                    bag.write(topic, TFMessage([transform]))
                self.assertEqual(self.run_when(path, "bag_without", "leap_hands", "echo", "placed"),
                                 (0, "placed\n" if placed else ""), (topic, frame))

    def test_a_bag_that_cannot_be_played_to_its_end_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.bag")
            with rosbag.Bag(path, "w") as bag:
                bag.write("/hands", Empty())
            self.assertEqual(self.run_when(path, "bag", "false", "--topics", "/hands"),
                             (1, path + ": is damaged: false ended with status 1 on the way\n"))

    def test_a_command_gets_the_file_as_it_is_named(self):
        for name in ("/tmp/x y/my hand.bag", "/tmp/$(touch x) 'a\" \\.bag"):
            self.assertEqual(self.run_when(name, "file", "echo", "-O", "@FILE"), (0, "-O " + name + "\n"))

    def test_a_command_that_is_not_there_is_named_in_one_line(self):
        self.assertEqual(self.run_when("", "file", "/nope/command"),
                         (1, "run_when: /nope/command: cannot be run: No such file or directory\n"))

    def test_waiting_for_a_message_needs_a_master(self):
        with with_environment(ROS_MASTER_URI="foo"):
            self.assertEqual(self.run_when("", "message", "/training/status", "true"), (1, (
                "run_when: ROS_MASTER_URI 'foo' is no address of a master; allowed: http://HOST:PORT\n")))

    def test_a_bag_s_name_is_a_name(self):
        with tempfile.TemporaryDirectory() as folder:
            made = os.path.join(folder, "made")
            for name in ("`touch %s`.bag" % made, "$(touch %s).bag" % made, "\"; touch %s; \".bag" % made):
                path = os.path.join(folder, name)
                self.assertEqual(self.run_when(path, "bag", "true"), (1, os.path.abspath(path) + ": there is no such bag\n"))
            self.assertFalse(os.path.exists(made))



if __name__ == "__main__":
    rostest.unitrun(PACKAGE, "launch_files", LaunchFilesTest)
