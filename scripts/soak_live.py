#!/usr/bin/python3
"""Records a scripted hand and plays it in a loop through the nodes, at ten times its speed, for hours. Prints memory and
open files of the node, the log's size and the 99th percentile of step times, and exits with 1 if any of them grows after the
first tenth of the time."""
import collections
import functools
import math
import os
import shutil
import signal
import statistics
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
NODE = "/interaction_node"  # from the tracker's message to the markers, as playback.launch has it
LOOK = 30.0  # [s] between two checks
MAX_MEMORY, MAX_TIME = 1.05, 1.5  # ratio to the maximum of the first tenth; times vary with the machine's load
MAX_LOG = 130000  # bytes an hour: for each of up to three reasons why frames are lost, a line of 0.7 kB a minute
PAGE = os.sysconf("SC_PAGE_SIZE") / 1048576.0

Look = collections.namedtuple("Look", "minutes memory files log")


def end(process):
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
        process.wait(60)


def soak(scenario):
    """Calls scenario(hours, folder, start) beside a master and prints whether nothing grew. Ends the programs that it started,
    the last first. Returns the exit status."""
    folder, running = tempfile.mkdtemp(), []
    os.environ["ROS_LOG_DIR"] = log = os.path.join(folder, "log")
    os.mkdir(log)

    def start(*command):
        with open(os.path.join(log, "screen"), "a", encoding="utf-8") as screen:
            running.insert(0, subprocess.Popen(command, start_new_session=True, stdout=screen, stderr=screen))
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


def log_bytes():
    files = (os.path.join(path, name) for path, _, names in os.walk(os.environ["ROS_LOG_DIR"]) for name in names)
    return sum(map(os.path.getsize, files))


def looks(hours, *nodes):
    """Yields a look at the nodes every 30 s for `hours`, at least ten: memory and open files of each, and the size of
    the log and of all that was printed."""
    begin = time.monotonic()
    while time.monotonic() < begin + 3600 * hours:
        time.sleep(min(LOOK, 360 * hours))
        memory, files = zip(*map(memory_and_files, nodes))
        yield Look((time.monotonic() - begin) / 60, memory, files, log_bytes())


def is_bounded(values, ratio, more=0):
    """True if no value exceeds the maximum of the first tenth, times `ratio`, plus `more`."""
    return max(values) <= ratio * max(values[:max(1, len(values) // 10)]) + more


def is_flat(seen, hours):
    return (all(is_bounded(memory, MAX_MEMORY) for memory in zip(*(look.memory for look in seen))) and
            all(is_bounded(files, 1) for files in zip(*(look.files for look in seen))) and
            is_bounded([look.log for look in seen], 1, MAX_LOG * max(hours, 0.1)))


def record(bag, start):
    """Two runs of the hand, with what comes before and after."""
    recorder = start("rosbag", "record", "-O", bag, "/leap_motion/leap_device")
    hand = start("rosrun", "mr_hand_interaction", "synthetic_hand_node", "_motion:=grasp_cube")
    time.sleep(25)  # the hand plays in real time
    end(hand)
    end(recorder)


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

    def take_p99(self):
        """Median since the last call [us]."""
        times, self.p99 = self.p99, []
        return statistics.median(times) if times else math.nan


def watch(hours):
    live, seen, times = Live(), [], []
    print("%6s %8s %8s %6s %9s %8s" % ("min", "loops", "MiB", "files", "log/bytes", "p99/us"))
    for look in looks(hours, NODE):
        seen.append(look)
        times.append(live.take_p99())
        print("%6.1f %8d %8.2f %6d %9d %8.1f" % (look.minutes, live.loops, *look.memory, *look.files, look.log, times[-1]),
              flush=True)
    return is_flat(seen, hours) and is_bounded(times, MAX_TIME) and live.loops > 0


def loop(hours, folder, start):
    bag = os.path.join(folder, "hand.bag")
    record(bag, start)
    start("roslaunch", "mr_hand_interaction", "playback.launch", "bag:=" + bag, "scene:=cube", "rviz:=false", "loop:=true",
          "rate:=%d" % RATE)
    rospy.init_node("soak", disable_signals=True)
    return watch(hours)


if __name__ == "__main__":
    sys.exit(soak(loop))
