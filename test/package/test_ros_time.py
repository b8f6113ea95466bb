"""ROS's times are subtracted and made by one checked function each: ros::Time's own arithmetic throws where a stamp or /clock
is beyond 2^31 s, and ended nodes."""
import pathlib
import re
import unittest

PACKAGE = pathlib.Path(__file__).resolve().parents[2]
ALLOWED = {"src/ros/hand_frame_conversion.cpp",  # to_ros_time, from_ros_time, seconds_between
           "src/ros/rviz/training_panel.cpp"}  # the machine's own clock alone
# A difference of times or a time and a duration; a time made of a number that may be too large; a sleep or a timer by
# ROS's clock, which subtract themselves.
FORBIDDEN = re.compile(r"\([^()]+-[^()]+\)\.toSec\(\)|ros::Duration\([a-z]|ros::Time\([a-z]|\.fromNSec\(|\.fromSec\(|ros::Time::sleepUntil|"
                       r"createTimer\(|ros::Rate|ros::Duration\([^)]*\)\.sleep")
WALL = re.compile(r"Wall")  # the machine's own clock, which no message sets
CONSTANT = re.compile(r"marker\.lifetime = ros::Duration\(lifetime\)")  # of a layer, half a second or for ever


def offences(text):
    lines = [line for line in text.splitlines() if not WALL.search(line) and not CONSTANT.search(line)]
    return [line.strip() for line in lines if FORBIDDEN.search(line)]


def sources():
    return {str(file.relative_to(PACKAGE)): file.read_text(encoding="utf-8")
            for folder in ("src/ros", "src/nodes", "src/replay", "src/record") for file in (PACKAGE / folder).rglob("*")
            if file.suffix in (".cpp", ".h")}


class RosTimeTest(unittest.TestCase):
    def test_no_arithmetic_that_throws_is_left(self):
        files = {file: text for file, text in sources().items() if file not in ALLOWED}
        self.assertGreater(len(files), 40)
        found = {file: offences(text) for file, text in files.items()}
        self.assertEqual({file: lines for file, lines in found.items() if lines}, {})

    def test_no_period_is_timed_by_a_clock_that_somebody_sets(self):
        """A system clock that was set back by an hour stopped for an hour what a waiting node shows: ros::SteadyTime."""
        found = {file for file, text in sources().items() if re.search(r"ros::WallTime\b|createWallTimer|WallTimer\b", text)}
        self.assertEqual(found, {"src/ros/input_log.h"})  # the name of a run

    def test_it_would_be_found(self):
        for line in ("double since = (now - last).toSec();", "header.stamp = ros::Time().fromNSec(start);",
                     "ros::Time(seconds)", "x += ros::Duration(period);", "ros::Time::sleepUntil(end);"):
            self.assertEqual(offences(line), [line])
        for line in ("(ros::WallTime::now() - time).toSec() > kOld", "ros::Time(0)", "ros::Time::now()"):
            self.assertEqual(offences(line), [])


if __name__ == "__main__":
    unittest.main()
