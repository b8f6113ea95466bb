#!/usr/bin/env python3
"""What launch files make of their arguments: no shell reads any of them, and nobody but this machine may connect."""
import glob
import os
import subprocess
import tempfile
import unittest

import roslaunch.config
import roslaunch.xmlloader
import roslib.packages
import rospkg
import rostest

PACKAGE = "mr_hand_interaction"
FOLDER = os.path.join(rospkg.RosPack().get_path(PACKAGE), "launch")
FILES = sorted(os.path.basename(path) for path in glob.glob(os.path.join(FOLDER, "*.launch")))
NEEDED = {"playback.launch": ["bag:=/tmp/a.bag"], "training.launch": ["participant:=P01"]}
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


    def test_a_bag_s_name_is_a_name(self):
        script = roslib.packages.find_node(PACKAGE, "run_when")[0]
        with tempfile.TemporaryDirectory() as folder:
            made = os.path.join(folder, "made")
            for name in ("`touch %s`.bag" % made, "$(touch %s).bag" % made, "\"; touch %s; \".bag" % made):
                answer = subprocess.run([script, "bag_without", "/tf_static", "true"],
                                        env=dict(os.environ, RUN_WHEN_BAG=name), stderr=subprocess.PIPE, timeout=60,
                                        universal_newlines=True)
                self.assertEqual(answer.returncode, 1)
                self.assertEqual(answer.stderr, name + ": there is no such bag\n")
            self.assertFalse(os.path.exists(made))


if __name__ == "__main__":
    rostest.unitrun(PACKAGE, "launch_files", LaunchFilesTest)
