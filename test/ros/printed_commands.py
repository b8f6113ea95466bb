"""The commands that README.md and docs/*.md print, and a user who runs them with what a user fills in."""
import dataclasses
import glob
import os
import re
import shlex
import subprocess

import rosbag
import rosgraph
import roslaunch.config
import roslaunch.xmlloader
import rospy
from geometry_msgs.msg import Pose, PoseArray

from mr_hand_interaction.msg import RecordedFile, SimulationInput

from launching import Launch
from tracker_hands import joints, recording
from waiting import wait_until

NAME = "mr_hand_interaction"
PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PAGES = [os.path.join(PACKAGE, "README.md")] + sorted(glob.glob(os.path.join(PACKAGE, "docs", "*.md")))
BEGINNINGS = re.compile(r"(roslaunch|rosrun|rosservice|rostopic|rosbag|rosdep|rosparam|snakemake|make|source|export|cd|git|"
                        r"apt-get|plotjuggler|real_grasps|simulated_study|replay|scripts/\w+|benchmark/[\w/]+\.py) ?")

EXCEPTED = (  # what the command begins with, and why it is not run here
    ("git clone|cd ~/catkin_ws|rosdep", "fetches and builds a workspace"),
    ("apt-get install", "installs packages"),
    ("source devel/setup.bash", "this test would not be found without"),
    ("export ROS_", "addresses of the user's machines"),
    ("rosrun rqt_(reconfigure|plot|multiplot)|plotjuggler", "Debian 12 does not have it"),
    ("rosrun mr_hand_interaction (filters|stability_map|real_grasps)", "measures; built by name alone"),
    ("rosrun mr_hand_interaction (analyse_study|ask_ratings)", "test_analyse_study and test_ask_ratings run it"),
    ("roslaunch benchmark/latency", "measures the machine; built by name alone"),
    ("roslaunch --wait .*role:=view|roslaunch .*role:=view", "multi_machine.test runs it"),
    ("roslaunch .*address:=192", "has an address of the user's machine; web.test runs it with this machine's own"),
    ("roslaunch mr_hand_interaction webcam.launch", "needs a webcam and MediaPipe; mediapipe_bridge.test runs the bridge"),
    ("rosrun mr_hand_interaction replay .*--serve", "serves until Ctrl-C; web.test runs it"),
    ("snakemake", "test_workflow runs it"),
    ("make ", "builds"),
    ("simulated_study", "as rosrun, below"),
    ("replay", "as rosrun, below"),
)


@dataclasses.dataclass(frozen=True)
class Command:
    page: str
    line: int
    text: str
    section: str

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


def sections_of(page, lines):
    """By line: README's are under its headings of the second order; every other page is one."""
    name, names = "", []
    for line in lines:
        if os.path.basename(page) == "README.md" and line.startswith("## "):
            name = line[3:].strip()
        names.append(name)
    return names


def commands():
    found = {}
    for page in PAGES:
        with open(page, encoding="utf-8") as file:
            lines = file.read().splitlines()
        sections = sections_of(page, lines)
        for number, text in list(printed_in_blocks(lines)) + list(printed_in_text(lines)):
            if BEGINNINGS.match(text):
                found.setdefault(text, Command(page, number, text, sections[number - 1]))
    return list(found.values())


def page_packages(page, section):
    """What this section of a page says to install."""
    with open(page, encoding="utf-8") as file:
        lines = file.read().splitlines()
    text = "\n".join(line for line, name in zip(lines, sections_of(page, lines)) if name == section)
    return sorted({name for listed in re.findall(r"apt-get install ([a-z0-9.+\s-]+)", text) for name in listed.split()})


def printed_scenes():
    """Name and text of each URDF that a page prints."""
    for page in PAGES:
        with open(page, encoding="utf-8") as file:
            for urdf, name in re.findall(r'^```xml\n(<robot name="(\w+)">\n.*?)^```$', file.read(), re.MULTILINE | re.DOTALL):
                yield name, urdf


COMMANDS = commands()


def excepted(text):
    return [index for index, (beginning, _) in enumerate(EXCEPTED) if re.match(beginning, text)]


def shortened(words, *options):
    """Words of simulated_study with one operator at 0 g, and these options, but where they say something else."""
    for option, value in (("--operators", "1-1"), ("--gravity", "0")) + options:
        words = words if option in words else words + [option, value]
    return words


def to_run(beginning):
    return [command for command in COMMANDS if command.text.startswith(beginning) and not excepted(command.text)]


class User:
    """At home in a folder, with files of the names that the commands have."""

    def __init__(self, folder):
        self.folder = folder
        self.environment = dict(os.environ, HOME=folder, ROS_HOME=os.path.join(folder, ".ros"))
        os.environ["HOME"] = folder  # training.launch and record.launch look there
        self.bags = {}

    def write_files(self):
        """What the commands name as the user's."""
        for name in ("hand.bag", "hands.bag"):
            if name not in self.bags:
                self.write_bag(name, of_a_live_run=name == "hand.bag")
                with open(os.path.join(self.folder, name), "rb") as file:
                    self.bags[name] = file.read()
            with open(os.path.join(self.folder, name), "wb") as file:
                file.write(self.bags[name])
        with open(os.path.join(self.folder, "points.yaml"), "w", encoding="utf-8") as file:
            file.write("points:\n")
            for index, (x, y, z) in enumerate(((0, 0, 0), (0.2, 0, 0), (0, 0.2, 0), (0.2, 0.2, 0.1))):
                file.write("  - {name: p%d, world: [%g, %g, %g], device: [%g, %g, %g]}\n" % (index, x, y, z, x, z, -y))
        self.write_mesh("part.stl")
        for name, urdf in printed_scenes():
            with open(os.path.join(self.folder, name + ".urdf"), "w", encoding="utf-8") as file:
                file.write(urdf)

    def write_mesh(self, name):
        """A block of 30 by 40 by 60 mm, as a CAD program writes it."""
        corners = [(30 * x, 40 * y, 60 * z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        with open(os.path.join(self.folder, name), "w", encoding="ascii") as file:
            file.write("solid part\n")
            for a, b, c, d in quads:
                for triangle in ((a, b, c), (a, c, d)):
                    file.write("facet normal 0 0 0\nouter loop\n%sendloop\nendfacet\n" %
                               "".join("vertex %d %d %d\n" % corners[corner] for corner in triangle))
            file.write("endsolid part\n")

    def write_bag(self, name, of_a_live_run):
        """Three seconds of the scripted hand; a live run's says what the simulation took, here frames without a hand."""
        with open(os.path.join(PACKAGE, "config", "scenes", "cube.urdf"), "rb") as scene:
            begin = SimulationInput(kind=SimulationInput.BEGIN, run=1, text="{version: '0', scene: cube}",
                                    files=[RecordedFile("scene.urdf", scene.read())])
        with rosbag.Bag(os.path.join(self.folder, name), "w") as file:
            if of_a_live_run:
                file.write("/simulation_input", begin, rospy.Time.from_sec(999.0))
            for number, row in enumerate(recording(self.folder, 30)[:90], 1):
                stamp = rospy.Time.from_sec(1000.0 + float(row["time_s"]))
                if of_a_live_run:
                    taken = SimulationInput(kind=SimulationInput.FRAME, run=1, sequence=number, time=stamp.to_nsec(),
                                            expected=stamp.to_nsec())
                    file.write("/simulation_input", taken, stamp)
                message = PoseArray(poses=[Pose() for _ in joints(row, 21)])
                message.header.stamp, message.header.frame_id = stamp, "leap_hands"
                for pose, place in zip(message.poses, joints(row, 21)):
                    pose.position.x, pose.position.y, pose.position.z = place
                file.write("/hands/right/pose_array", message, stamp)

    def words(self, command):
        """As a shell would split it, and with the values that a user fills in."""
        text = re.sub(r'"\.\.\."|"x y z qx qy qz qw"', '"0 0 0 0.7071067811865476 0 0 0.7071067811865476"', command.text)
        text = text.replace("$HOME", self.folder)
        return [re.sub("^~(?=/|$)", self.folder, word) for word in shlex.split(text)]

    def run(self, words, timeout=120, stdin="", folder=None):
        """Status and output."""
        done = subprocess.run(words, cwd=folder or self.folder, env=self.environment, input=stdin, timeout=timeout, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        return done.returncode, done.stdout

    def check_runs(self, command, words=None, **options):
        status, output = self.run(words or self.words(command), **options)
        assert status == 0, "%s\n%s" % (command, output)
        return output

    @staticmethod
    def nodes_of(file, arguments):
        config = roslaunch.config.ROSLaunchConfig()
        roslaunch.xmlloader.XmlLoader().load(os.path.join(PACKAGE, "launch", file), config, argv=arguments, verbose=False)
        return config.nodes

    def check_comes_up(self, command):
        """All nodes of a launch file, but those that wait for a participant or a device before they begin."""
        _, package, file, *arguments = [word for word in self.words(command) if word != "--wait"]
        assert package == NAME, command
        if file == "record.launch":  # never over a bag that is there
            for argument in arguments:
                if argument.startswith("bag:="):
                    os.remove(argument[len("bag:="):])
        else:
            arguments.append("rviz:=false")
        nodes = [node for node in self.nodes_of(file, arguments) if (node.launch_prefix or "").split()[2:3] not in
                 (["message"], ["bag_without"])]
        names = {node.namespace + node.name for node in nodes}
        assert names, command
        master = rosgraph.Master("/printed_commands")

        def up():
            state = master.getSystemState()
            return names <= {node for topics in state for _, listed in topics for node in listed}
        with Launch(file, *arguments) as launch:
            wait_until(lambda: up() or launch.has_ended(), "the nodes of %s" % command, period=0.1)
            assert not launch.has_ended(), command
