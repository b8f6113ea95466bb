#!/usr/bin/python3
"""Runs what is printed, section by section; scripts/try_commands starts it."""
import dataclasses
import glob
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

import rosgraph

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from launching import Launch  # noqa: E402
from printed_commands import COMMANDS, EXCEPTED, NAME, PACKAGE, User, excepted, page_packages, shortened  # noqa: E402

TIME_LIMIT = 900  # s, of a command; a picture on a slow machine takes minutes
NOT_TRIED = (  # what the command begins with, and why it is not run here; beyond what EXCEPTED says
    ("scripts/demo$", "has been run to come here"),
    (r"scripts/test( --no-\w+)*$", "runs by itself: scripts/test_on"),
    ("scripts/test_on", "brings us here"),
    ("scripts/benchmark --(full|real|jolt)|scripts/fuzz|scripts/calibrate_study", "takes long"),
    ("scripts/figures", "measures, for minutes"),
    ("scripts/import_captures", "needs captures; test_import_captures makes its own"),
    ("scripts/sanitize", "builds the core anew with sanitizers, over a quarter of an hour on two processors"),
    ("scripts/ask_ratings .*--page", "asks on a page in a browser; test_ask_ratings"),
    ("rosrun mr_hand_interaction training_keys", "needs a participant; training.test"),
)
RUN_AFTER_ALL = (  # what EXCEPTED says of other places
    "rosrun mr_hand_interaction (analyse_study|ask_ratings|stability_map --quick|real_grasps --list|filters --output \\. )",
    "make -C build/catkin (stability_map|real_grasps|latency|filters)",
    "roslaunch benchmark/latency", "apt-get install")
IN_THE_PACKAGE = ("make -C build/catkin", "roslaunch benchmark/")
ANSWERS = "yes\n31\nfemale\nright\nnone\n" + "4\n" * 20  # to whatever asks


def reason_not_to(text):
    reasons = [reason for beginning, reason in NOT_TRIED if re.match(beginning, text)]
    if not any(re.match(beginning, text) for beginning in RUN_AFTER_ALL):
        reasons += [EXCEPTED[index][1] for index in excepted(text)]
    return reasons[0] if reasons else None


def installed():
    told = subprocess.run(["dpkg-query", "-f", "${Package} ${db:Status-Status}\n", "-W"], check=True,
                          stdout=subprocess.PIPE, universal_newlines=True).stdout
    return {line.split()[0] for line in told.splitlines() if line.endswith(" installed")}


def apt(*words):
    environment = dict(os.environ, DEBIAN_FRONTEND="noninteractive")
    subprocess.run(["apt-get", "-y", "-q"] + list(words), check=True, env=environment, stdout=subprocess.DEVNULL)


class OwnPackages:
    """What a section names is there until the end of the block, and no longer."""

    def __init__(self, names):
        self.names = names

    def __enter__(self):
        self.before = installed()
        if set(self.names) - self.before:
            apt("install", "--no-install-recommends", *self.names)

    def __exit__(self, *_):
        added = sorted(installed() - self.before)
        if added:
            apt("purge", *added)


class Background:
    """A master, and while it is wanted a demo beside it."""

    def __init__(self):
        self.core = subprocess.Popen(["roscore", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]],
                                     stdout=subprocess.DEVNULL)
        while not rosgraph.is_master_online():
            if self.core.poll() is not None:
                sys.exit("try_commands: there is no master")
            time.sleep(0.1)
        self.demo = None

    def want_demo(self, wanted):
        if wanted and self.demo is None:
            self.demo = Launch("demo.launch", "rviz:=false")
            self.demo.__enter__()
            subprocess.run(["rosservice", "list"], check=True, stdout=subprocess.DEVNULL)
            while "/interaction_node/set" not in subprocess.run(["rosservice", "list"], stdout=subprocess.PIPE,
                                                                check=True, universal_newlines=True).stdout:
                time.sleep(0.5)
        if not wanted and self.demo is not None:
            self.demo.__exit__()
            self.demo = None

    def end(self):
        self.want_demo(False)
        self.core.send_signal(signal.SIGINT)
        self.core.wait(30)


class Tries:
    def __init__(self, folder):
        self.user, self.background = User(folder), Background()
        self.user.write_files()
        self.study = os.path.join(folder, "sessions")
        self.good, self.failed, self.left = [], [], []

    def sessions(self):
        if not os.path.isdir(self.study):
            status, output = self.user.run(["rosrun", NAME, "simulated_study", "--output", self.study, "--operators", "1-4",
                                            "--group-size", "2", "--gravity", "0"], timeout=TIME_LIMIT)
            assert status == 0, output
        return sorted(os.path.dirname(file) for file in glob.glob(self.study + "/**/trials.csv", recursive=True))

    def replayed(self):
        """A folder that replay has written."""
        folder = os.path.join(self.user.folder, "replayed")
        if not os.path.isdir(folder):
            bag = os.path.join(self.user.folder, "hands.bag")
            status, output = self.user.run(["rosrun", NAME, "replay", "--scene", "cube", "--input", bag, "--output", folder],
                                           timeout=TIME_LIMIT)
            assert status == 0, output
        return folder

    def filled_in(self, words):
        """With what stands for the user's own."""
        session = self.sessions()[0] if set(words) & {"SESSION", "SESSION_DIR"} or "ask_ratings" in words else ""
        places = {"SESSION": session, "SESSION_DIR": session, "SESSIONS": self.study, "DIR...": self.study,
                  "PILOT": self.study, "study": self.study, "fresh": self.study}
        if set(words) & {"SESSIONS", "DIR...", "PILOT", "study", "fresh"}:
            self.sessions()
        places["HZ"] = "50"
        if "FOLDER" in words:
            places["FOLDER"] = self.replayed()
        filled = [places.get(word, word) for word in words]
        return [session if re.search(r"/training/P07_implicit", word) else word for word in filled]

    def run(self, command):
        command = dataclasses.replace(command, text=re.sub(r" \[--[^]]*\](\.\.\.)?", "", command.text))
        text = command.text
        words = self.user.words(command)
        self.background.want_demo(re.match("rosrun|rosservice", text) is not None)
        if text.startswith(IN_THE_PACKAGE):
            self.user.check_runs(command, words, timeout=TIME_LIMIT, folder=PACKAGE)
            return
        if text.startswith("roslaunch "):
            self.user.check_comes_up(command)
            subprocess.run(["rosparam", "set", "/use_sim_time", "false"], check=True)
            self.user.write_files()
            return
        if "doctor" in words:
            assert "master" in self.user.run(words, timeout=TIME_LIMIT)[1]
            return
        if "simulated_study" in text:
            words = shortened(words)
        words = self.filled_in(words)
        if "power_study" in text:
            words += ["--studies", "20"]  # of each size; 500 took more than 15 minutes on a busy machine
        if words[0].startswith(("scripts/", "benchmark/")):
            words[0] = os.path.join(PACKAGE, words[0])
        output = self.user.check_runs(command, words, timeout=TIME_LIMIT, stdin=ANSWERS)
        assert not text.startswith("rosservice") or "success: True" in output, "%s\n%s" % (command, output)

    def try_one(self, command):
        reason = reason_not_to(command.text)
        if reason:
            self.left.append(command)
            print("left    %s: %s" % (command, reason), flush=True)
            return
        if command.text.startswith("apt-get "):
            return
        try:
            self.run(command)
            self.good.append(command)
            print("ok      %s" % command, flush=True)
        except (AssertionError, OSError, subprocess.SubprocessError) as error:
            self.failed.append(command)
            print("FAILED  %s\n%s" % (command, error), flush=True)


def groups(chosen):
    """Commands by page and section, in the order in which they are printed."""
    found = {}
    for command in COMMANDS:
        page = os.path.basename(command.page)
        if not chosen or page in chosen or command.section in chosen:
            found.setdefault((command.page, command.section), []).append(command)
    return found


def main():
    with tempfile.TemporaryDirectory() as folder:
        tries = Tries(folder)
        try:
            for (page, section), commands in groups(sys.argv[1:]).items():
                packages = page_packages(page, section)
                print("== %s %s %s" % (os.path.basename(page), section, " ".join(packages)), flush=True)
                with OwnPackages(packages):
                    for command in commands:
                        tries.try_one(command)
        finally:
            tries.background.end()
    for command in tries.failed:
        print("failed: %s" % command)
    print("%d passed, %d failed, %d not tried" % (len(tries.good), len(tries.failed), len(tries.left)))
    return 1 if tries.failed else 0


if __name__ == "__main__":
    sys.exit(main())
