#!/usr/bin/python3
"""Records a scripted hand and plays it in a loop through the nodes for hours of its own time: memory, open files and
the steps' 99th percentile of the node, ten times on the way. Exits with 1 if any grows after the first of them."""
import functools
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from mr_hand_interaction.msg import ObjectStateArray

RATE = 10
LOOKS = 10
NODE = "/interaction_node"  # from the tracker's message to the picture, as playback.launch has it
MOST_MEMORY, MOST_TIME = 1.05, 1.5  # ratio to the first check; times vary with the machine's load
PAGE = os.sysconf("SC_PAGE_SIZE") / 1048576.0


def end(process):
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
        process.wait(60)


def soak(scenario):
    """Calls scenario(hours, folder, start) beside a master and prints whether nothing grew. Ends the programs that it started,
    the last first. Returns the exit status."""
    folder, running = tempfile.mkdtemp(), []
    os.environ["ROS_LOG_DIR"] = os.path.join(folder, "log")

    def start(*command):
        running.insert(0, subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        return running[0]
    try:
        start("roscore", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1].strip("/"))
        while not rosgraph.is_master_online():
            time.sleep(0.1)
        is_flat = scenario(float(sys.argv[1]), folder, start)
    finally:
        for process in running:
            end(process)
        shutil.rmtree(folder)
    print("flat" if is_flat else "NOT FLAT")
    return 0 if is_flat else 1


@functools.lru_cache()  # each query of a node opens a file in it for a while
def process_of(node):
    return "/proc/%d/" % ServerProxy(rosgraph.Master("/soak").lookupNode(node)).getPid("/soak")[2]


def memory_and_files(node):
    """Resident memory [MiB] and number of open files of a node's process."""
    process = process_of(node)
    with open(process + "statm") as statm:
        return [int(statm.read().split()[1]) * PAGE, len(os.listdir(process + "fd"))]


def record(bag, start):
    """Two runs of the hand, with what comes before and after."""
    recorder = start("rosbag", "record", "-O", bag, "/leap_motion/leap_device")
    hand = start("rosrun", "mr_hand_interaction", "synthetic_hand_node", "_motion:=grasp_cube")
    time.sleep(25)  # the hand plays in real time
    end(hand)
    end(recorder)


class Look:
    def __init__(self, p99):
        self.p99 = p99
        self.memory, self.files = memory_and_files(NODE)


class Live:
    def __init__(self):
        self.p99, self.stamps, self.loops = [], 0, 0
        self.last = None
        self.subscribers = [rospy.Subscriber("/diagnostics", DiagnosticArray, self.take_diagnostics),
                            rospy.Subscriber("objects", ObjectStateArray, self.take_objects)]

    def take_diagnostics(self, message):
        for status in message.status:
            if status.name == "interaction_node: interaction":
                self.p99 += [float(v.value) for v in status.values if v.key == "step time p99 [us]"]

    def take_objects(self, message):
        self.loops += self.last is not None and message.header.stamp < self.last
        self.last = message.header.stamp
        self.stamps += 1

    def look(self):
        times, self.p99 = sorted(self.p99), []
        return Look(times[len(times) // 2] if times else 0.0)


def flat(looks):
    first = looks[0]
    return all(look.memory < MOST_MEMORY * first.memory and look.files <= first.files and
               look.p99 < MOST_TIME * first.p99 for look in looks)


def watch(hours):
    live, looks = Live(), []
    print("%6s %8s %8s %6s %8s" % ("look", "loops", "MiB", "files", "p99/us"))
    for number in range(1, LOOKS + 1):
        time.sleep(hours * 3600 / RATE / LOOKS)
        looks.append(live.look())
        print("%6d %8d %8.2f %6d %8.1f" % (number, live.loops, looks[-1].memory, looks[-1].files, looks[-1].p99),
              flush=True)
    return flat(looks) and live.loops > 0


def loop(hours, folder, start):
    bag = os.path.join(folder, "hand.bag")
    record(bag, start)
    start("roslaunch", "mr_hand_interaction", "playback.launch", "bag:=" + bag, "scene:=cube", "rviz:=false", "loop:=true",
          "rate:=%d" % RATE)
    rospy.init_node("soak", disable_signals=True)
    return watch(hours)


if __name__ == "__main__":
    sys.exit(soak(loop))
