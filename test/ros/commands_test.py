#!/usr/bin/env python3
"""Every command that README.md and docs/*.md print does what a user may expect of it: it is run as printed, with the
arguments that a user fills in, or it is in EXCEPTED with the reason why not."""
import contextlib
import dataclasses
import glob
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

import rosbag
import roslaunch.config
import roslaunch.xmlloader
import rosgraph
import rospkg
import rospy
import rostest
from geometry_msgs.msg import Pose, PoseArray

from mr_hand_interaction.msg import RecordedFile, SimulationInput, TrainingStatus

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from launching import Launch  # noqa: E402
from tracker_hands import joints, recording  # noqa: E402
from waiting import wait_until  # noqa: E402

NAME = "mr_hand_interaction"
PACKAGE = rospkg.RosPack().get_path(NAME)
PAGES = [os.path.join(PACKAGE, "README.md")] + sorted(glob.glob(os.path.join(PACKAGE, "docs", "*.md")))
BEGINNINGS = re.compile(r"(roslaunch|rosrun|rosservice|rostopic|rosbag|rosdep|rosparam|snakemake|make|source|export|cd|git|"
                        r"apt-get|real_grasps|simulated_study|replay|scripts/\w+|benchmark/[\w/]+\.py) ?")

PROGRAMS = ("analyse_study", "ask_participant", "ask_ratings", "calibrate_mount", "calibrate_study", "doctor", "explain",
            "hand_interaction_node", "hand_tracking_node", "interaction_node", "marker_relay_node", "plan_study",
            "power_study", "replay", "run_when", "set", "simulated_operator_node", "simulated_study", "synthetic_hand_node",
            "training_keys", "training_node")

EXCEPTED = (  # what the command begins with, and why it is not run here
    ("git clone|cd ~/catkin_ws|rosdep", "fetches and builds a workspace"),
    ("apt-get install", "installs packages"),
    ("source devel/setup.bash", "this test would not be found without"),
    ("export ROS_", "addresses of the user's machines"),
    ("rosrun rqt_(reconfigure|plot)", "Debian 12 does not have it"),
    ("rosrun mr_hand_interaction (filters|stability_map)", "takes long; built with BUILD_BENCHMARKS alone"),
    ("rosrun mr_hand_interaction (analyse_study|ask_ratings)", "test_analyse_study and test_ask_ratings run it"),
    ("roslaunch benchmark/latency", "measures the machine; built with BUILD_BENCHMARKS alone"),
    ("roslaunch --wait .*role:=view|roslaunch .*role:=view", "multi_machine.test runs it"),
    ("real_grasps|benchmark/", "need recordings or results; benchmark/real_grasps/test has its own"),
    ("snakemake", "test_workflow runs it"),
    ("make ", "builds"),
    ("simulated_study", "as rosrun, below"),
    ("replay", "as rosrun, below"),
    ("rosbag decompress", "the user's own bag"),
)


@dataclasses.dataclass(frozen=True)
class Command:
    page: str
    line: int
    text: str

    def __str__(self):
        return "%s:%d: %s" % (os.path.relpath(self.page, PACKAGE), self.line, self.text)


def without_comment(text):
    return re.sub(r"\s+# .*$", "", text).strip()


def printed_in_blocks(lines):
    """Lines of what is indented or fenced as code, those that end in a backslash joined with the next."""
    fence, begun = None, None
    for number, line in enumerate(lines, 1):
        opening = re.match(r"```(\w*)", line)
        if opening:
            fence = (opening.group(1) or "plain") if fence is None else None
            continue
        if not (fence in ("plain", "sh", "bash") or (fence is None and line.startswith("    "))):
            continue
        first, text = begun or (number, "")
        text = (text + " " + line.strip()).strip()
        begun = (first, text[:-1]) if text.endswith("\\") else None
        if begun is None:
            yield first, without_comment(text)


def printed_in_text(lines):
    """Commands with arguments between backquotes."""
    for number, line in enumerate(lines, 1):
        for code in re.findall(r"`([^`]+)`", line) if not line.startswith("    ") else ():
            if " " in code:
                yield number, code


def commands():
    found = {}
    for page in PAGES:
        with open(page, encoding="utf-8") as file:
            lines = file.read().splitlines()
        for number, text in list(printed_in_blocks(lines)) + list(printed_in_text(lines)):
            if BEGINNINGS.match(text):
                found.setdefault(text, Command(page, number, text))
    return list(found.values())


COMMANDS = commands()


def excepted(text):
    return [index for index, (beginning, _) in enumerate(EXCEPTED) if re.match(beginning, text)]


def to_run(beginning):
    return [command for command in COMMANDS if command.text.startswith(beginning) and not excepted(command.text)]


class CommandsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("commands_test")
        cls.folder = tempfile.mkdtemp()
        cls.environment = dict(os.environ, HOME=cls.folder, ROS_HOME=os.path.join(cls.folder, ".ros"))
        os.environ["HOME"] = cls.folder  # training.launch and record.launch look there

    def setUp(self):
        self.write_files()

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def write_files(cls):
        """What the commands name as the user's."""
        bag = os.path.join(cls.folder, "hand.bag")
        with open(os.path.join(PACKAGE, "config", "scenes", "cube.urdf"), "rb") as scene:
            files = [RecordedFile("scene.urdf", scene.read())]
        with rosbag.Bag(bag, "w") as file:
            begin = SimulationInput(kind=SimulationInput.BEGIN, run=1, text="{version: '0', scene: cube}", files=files)
            file.write("/simulation_input", begin, rospy.Time.from_sec(999.0))
            for number, row in enumerate(recording(cls.folder, 30)[:90], 1):
                stamp = rospy.Time.from_sec(1000.0 + float(row["time_s"]))
                taken = SimulationInput(kind=SimulationInput.FRAME, run=1, sequence=number, time=stamp.to_nsec(),
                                        expected=stamp.to_nsec())
                file.write("/simulation_input", taken, stamp)
                message = PoseArray(poses=[Pose() for _ in joints(row, 21)])
                message.header.stamp, message.header.frame_id = stamp, "leap_hands"
                for pose, place in zip(message.poses, joints(row, 21)):
                    pose.position.x, pose.position.y, pose.position.z = place
                file.write("/hands/right/pose_array", message, stamp)
        shutil.copy(bag, os.path.join(cls.folder, "hands.bag"))
        with open(os.path.join(cls.folder, "points.yaml"), "w", encoding="utf-8") as file:
            file.write("points:\n")
            for index, (x, y, z) in enumerate(((0, 0, 0), (0.2, 0, 0), (0, 0.2, 0), (0.2, 0.2, 0.1))):
                file.write("  - {name: p%d, world: [%g, %g, %g], device: [%g, %g, %g]}\n" % (index, x, y, z, x, z, -y))

    def words(self, command):
        """As a shell would split it, and with the values that a user fills in."""
        text = re.sub(r'"\.\.\."|"x y z qx qy qz qw"', '"0 0 0 0.7071067811865476 0 0 0.7071067811865476"', command.text)
        text = text.replace("$HOME", self.folder)
        return [re.sub("^~(?=/|$)", self.folder, word) for word in shlex.split(text)]

    def run_command(self, words, timeout=120, stdin=""):
        done = subprocess.run(words, cwd=self.folder, env=self.environment, input=stdin, timeout=timeout, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        return done.returncode, done.stdout

    def assert_runs(self, command, words=None, **options):
        status, output = self.run_command(words or self.words(command), **options)
        self.assertEqual(status, 0, "%s\n%s" % (command, output))
        return output

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

    @staticmethod
    def nodes_of(file, arguments):
        config = roslaunch.config.ROSLaunchConfig()
        roslaunch.xmlloader.XmlLoader().load(os.path.join(PACKAGE, "launch", file), config, argv=arguments, verbose=False)
        return config.nodes

    def assert_comes_up(self, command, file, arguments):
        """All of its nodes, but those that wait for a participant or a device before they begin."""
        nodes = [node for node in self.nodes_of(file, arguments) if not node.launch_prefix]
        names = {"/" + node.name for node in nodes}
        self.assertTrue(names, command)
        master = rosgraph.Master("/commands_test")

        def up():
            state = master.getSystemState()
            return names <= {node for topics in state for _, listed in topics for node in listed}
        with Launch(file, *arguments) as launch:
            wait_until(lambda: up() or launch.process.poll() is not None, "the nodes of %s" % command)
            self.assertIsNone(launch.process.poll(), command)

    def test_launch_files_bring_their_nodes_up(self):
        launches, failures = to_run("roslaunch "), []
        self.assertGreater(len(launches), 8)
        for command in launches:
            words = [word for word in self.words(command)[1:] if word != "--wait"]
            self.assertEqual(words[0], NAME, command)
            rviz = [] if words[1] == "record.launch" else ["rviz:=false"]
            with self.each(failures, command):
                self.assert_comes_up(command, words[1], words[2:] + rviz)
            rospy.set_param("/use_sim_time", False)
            self.write_files()  # record.launch has written one of them
        self.assertEqual(failures, [])

    def test_programs_run(self):
        self.assertGreater(len(to_run("rosrun ")), 6)
        failures = []
        status = rospy.Publisher("training/status", TrainingStatus, queue_size=1, latch=True)
        status.publish(TrainingStatus())
        with Launch("demo.launch", "rviz:=false"):
            rospy.wait_for_service("/interaction_node/set", 60.0)
            for command in to_run("rosrun "):
                words, options = self.words(command), {}
                if "simulated_study" in words:
                    words += ["--operators", "1-1", "--model", "implicit", "--gravity", "0"]
                if "training_keys" in words:
                    options["stdin"] = "q"
                with self.each(failures, command):
                    if "doctor" in words:
                        self.assertIn("master", self.run_command(words)[1])
                    else:
                        self.assert_runs(command, words, **options)
            for command in to_run("rosservice "):
                with self.each(failures, command):
                    self.assertIn("success: True", self.assert_runs(command))
        status.unregister()
        self.assertEqual(failures, [])

    def test_every_program_tells_its_use_without_a_master(self):
        failures = []
        environment = dict(self.environment, ROS_MASTER_URI="http://127.0.0.1:9")
        for program in PROGRAMS:
            done = subprocess.run(["rosrun", NAME, program, "--help"], env=environment, timeout=60, check=False,
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  universal_newlines=True)
            if done.returncode != 0 or len(done.stdout) < 80 or done.stderr:
                failures.append("%s: %d\n%s%s" % (program, done.returncode, done.stdout, done.stderr))
        self.assertEqual(failures, [])

    def test_a_node_refuses_an_argument_that_it_does_not_know(self):
        for program in [name for name in PROGRAMS if name.endswith("_node")]:
            status, output = self.run_command(["rosrun", NAME, program, "--rate", "3"], timeout=60)
            self.assertNotEqual(status, 0, program)
            self.assertEqual(output.count("\n"), 1, output)
            self.assertIn("--help", output)

    def test_scripts_know_the_options_that_are_printed(self):
        self.assertGreater(len(to_run("scripts/")), 5)
        failures = []
        for command in to_run("scripts/"):
            words = shlex.split(command.text)
            with self.each(failures, command):
                told = self.assert_runs(command, [os.path.join(PACKAGE, words[0]), "--help"])
                for option in re.findall(r"--[a-z-]+", command.text):
                    self.assertTrue(option == "--help" or option in told, "%s is not among\n%s" % (option, told))
        self.assertEqual(failures, [])


if __name__ == "__main__":
    rostest.rosrun(NAME, "commands", CommandsTest)
