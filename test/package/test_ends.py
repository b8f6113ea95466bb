#!/usr/bin/env python3
"""Whatever befalls a script, it ends with at most one line that names the thing, and never with a traceback."""
import contextlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.dont_write_bytecode = True
sys.path[:0] = [os.path.join(PACKAGE, "scripts"), os.path.join(PACKAGE, "test", "support")]

import forked  # noqa: E402
import runs.page  # noqa: E402,F401 pylint: disable=unused-import
import study.run  # noqa: E402,F401 pylint: disable=unused-import

LIMIT = 120  # s, far beyond what any takes
DEEP = 100000
HEADER = "version: 1\nparticipant: P01\ngroup: beginner\ncondition: implicit\ngravity: [0, 0, -9.81]\n"
PROGRAMS = ("analyse_study", "ask_participant", "ask_ratings", "calibrate_mount", "calibrate_study", "check_scene", "compare",
            "doctor", "explain", "export", "hand_interaction_node", "hand_tracking_node", "interaction_node", "plan_study",
            "power_study", "replay", "run_when", "set", "simulated_operator_node", "simulated_study", "synthetic_hand_node",
            "training_keys", "training_node", "web_door")
PLAN = ("plan_study", "--group", "beginner:2", "--condition", "implicit")


def has_ros():
    return subprocess.run(["/usr/bin/env", "python3", "-c", "import rospy, mr_hand_interaction.srv"], stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL).returncode == 0


def start(name, *arguments, **options):
    environment = dict(os.environ, **options.pop("environment", {}))
    options = dict(dict(stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE), **options)
    return subprocess.Popen([os.path.join(PACKAGE, "scripts", name), *arguments], env=environment, universal_newlines=True,
                            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler), **options)


def run(name, *arguments, **options):
    """Status, and what was printed on standard output and error."""
    process = start(name, *arguments, **options)
    try:
        said, complaint = process.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        process.kill()
        raise
    return process.returncode, said, complaint


def refused(name, *arguments):
    """As `run`, where only a file is wrong."""
    done = forked.run(os.path.join(PACKAGE, "scripts", name), *arguments)
    return done.returncode, done.stdout, done.stderr


def write(path, content):
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())


def make_huge(path):
    with open(path, "wb") as file:
        file.truncate(1 << 40)


# What may stand where a file should, and what is said of it.
NO_FILES = (("pipe", os.mkfifo, "is a pipe; allowed: a file"), ("folder", os.makedirs, "is a folder; allowed: a file"),
            ("device", lambda path: os.symlink("/dev/zero", path), "is a device or a socket; allowed: a file"),
            ("huge", make_huge, "has 1099511627776 bytes; allowed: at most"),
            ("bytes", lambda path: write(path, b"\xff\xfe\x00\x80"), "codec can't decode"))


class EndsTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = os.path.join(holder.name, "a session")
        os.mkdir(self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    @contextlib.contextmanager
    def there(self, name, make):
        path = self.path(name)
        make(path)
        yield path
        if os.path.isdir(path):
            os.rmdir(path)
        else:
            os.remove(path)

    def assert_refused(self, script, answer, path, why):
        status, _, complaint = answer
        self.assertEqual(status, 1, complaint)
        self.assertEqual(complaint.count("\n"), 1, complaint)
        self.assertTrue(complaint.startswith(script + ": "), complaint)
        self.assertLess(len(complaint), 1000)
        for word in (path, why):
            self.assertIn(word, complaint)

    def test_explain_names_what_is_wrong_with_a_summary(self):
        cases = NO_FILES + tuple(
            (text[:60], lambda path, text=text: write(path, text), why) for text, why in (
                ("", "is not JSON"), ("{", "is not JSON"), ("{}", "no 'input' in it"), ("[1]", "is not names with values"),
                ("null", "is not names with values"), ('{"input": 1}', "'input' is not a text"),
                ('{"input": "a.bag", "scene": "cube", "frames": "7"}', "'frames' is not a whole number"),
                ("[" * DEEP, "is nested too deep")))
        for what, make, why in cases:
            with self.subTest(what=what), self.there("summary.json", make) as path:
                self.assert_refused("explain", refused("explain", self.folder), path, why)

    def test_a_file_of_points_that_is_none_is_named(self):
        for what, make, why in NO_FILES + (("deep", lambda path: write(path, "[" * DEEP), "is nested too deep"),):
            with self.subTest(what=what), self.there("points.yaml", make) as path:
                self.assert_refused("calibrate_mount", refused("calibrate_mount", path), path, why)

    def test_a_session_that_is_none_is_named(self):
        cases = NO_FILES + tuple((text[:60], lambda path, text=text: write(path, text), why) for text, why in (
            (HEADER + "started: 2026-13-45\n", "is not YAML: month must be in 1..12"),
            (HEADER + "a: &a [1, 1]\nb: [*a, *a]\n", "has an alias"),
            (HEADER.replace("P01", "[P01]"), "participant: is a list; allowed: a text"),
            (HEADER.replace("implicit", "i\\x1b" * 10).replace("1\n", "'" + "9" * 100000 + "'\n", 1), "is not 1"),
            (HEADER + "a: " + "[" * 5000, "is nested too deep")))
        for what, make, why in cases:
            with self.subTest(what=what), self.there("session.yaml", make) as path:
                for script in ("ask_participant", "ask_ratings"):
                    self.assert_refused(script, refused(script, self.folder), path, why)
        with self.there("session.yaml", os.mkfifo) as path:
            for script in ("analyse_study", "power_study"):
                self.assert_refused(script, refused(script, self.folder), path, "is a pipe; allowed: a file")

    def test_a_table_that_is_none_is_named(self):
        write(self.path("session.yaml"), HEADER)
        cases = NO_FILES + tuple((text[:60], lambda path, text=text: write(path, text), why) for text, why in (
            ("a" * 200000, "line 1: field larger than field limit"), ('"' + "a" * 200000, "line 1: field larger")))
        for what, make, why in cases:
            with self.subTest(what=what), self.there("trials.csv", make) as path:
                answer = refused("analyse_study", self.folder, "--output", self.path("out"))
                self.assert_refused("analyse_study", answer, path, why)
        with self.there("ratings.csv", os.mkfifo) as path:
            self.assert_refused("ask_ratings", refused("ask_ratings", self.folder), path, "is no file; allowed: a file")
        for what, make, why in NO_FILES[:3]:
            with self.subTest(what=what), self.there("hands.csv", make) as path:
                answer = refused("analyse_study", "--trajectory", path, path, "--output", self.path("out"))
                self.assert_refused("analyse_study", answer, path, why)

    def test_a_plan_ends_before_time_does(self):
        answer = run(*PLAN, "--first", "9999-12-31", "--sessions", "2", "--output", self.path("plan.csv"))
        self.assert_refused("plan_study", answer, "--first 9999-12-31", "allowed: what ends by the year 9999")

    def test_a_wrong_argument_is_told_in_one_line(self):
        for script in ("analyse_study", "ask_participant", "ask_ratings", "calibrate_study", "compare", "explain", "export",
                       "plan_study", "power_study"):
            with self.subTest(script=script):
                status, said, complaint = refused(script, "--wrong")
                self.assertEqual((status, said, complaint.count("\n")), (2, "", 1), complaint)
                self.assertTrue(complaint.startswith(script + ": "), complaint)

    def test_a_reader_that_has_gone_is_no_fault(self):
        for command in (("plan_study", "--help"), PLAN + ("--output", self.path("plan.csv")), ("run_when", "--help"),
                        ("explain", "--help"), ("calibrate_study", "--studies", "1", "--design", "3v3")):
            with self.subTest(command=command):
                read, written = os.pipe()
                os.close(read)
                try:
                    self.assertEqual(run(*command, stdout=written), (128 + signal.SIGPIPE, None, ""))
                finally:
                    os.close(written)

    def test_a_full_disk_is_told(self):
        with open("/dev/full", "w") as full:
            status, _, complaint = run(*PLAN, "--output", self.path("plan.csv"), stdout=full)
        self.assertEqual(status, 1)
        self.assertRegex(complaint, r"\Aplan_study: .*No space left on device\n\Z")

    def test_ctrl_c_while_a_program_begins_ends_it_quietly(self):
        write(self.path("pandas.py"), "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\nwhile True:\n    pass\n")
        for script in ("analyse_study", "power_study", "calibrate_study"):
            answer = run(script, self.folder, environment={"PYTHONPATH": self.folder})
            self.assertEqual(answer, (130, "", ""))

    def test_what_nobody_thought_of_is_one_line_too(self):
        write(self.path("pandas.py"), "raise RuntimeError('first\\nsecond')\n")
        status, _, complaint = run("calibrate_study", environment={"PYTHONPATH": self.folder})
        self.assertEqual(status, 1)
        self.assertEqual(complaint, "calibrate_study: a fault of this program, please report it: RuntimeError: first?second "
                                    "(pandas.py, line 1)\n")


@unittest.skipUnless(has_ros(), "no ROS, or no workspace that has been sourced")
class EndsOfRosTest(unittest.TestCase):
    COMMANDS = (("set", "material/static_friction", "0.9"), ("doctor",), ("training_keys",), ("run_when", "message", "/a", "true"))

    def test_a_master_that_is_not_there_is_named(self):
        for uri, why in (("foo", "'foo' is no address of a master; allowed: http://HOST:PORT"), ("http://[", "is no address"),
                         ("http://127.0.0.1:x", "is no address"), ("", "'' is no address"),
                         ("http://127.0.0.1:9", "http://127.0.0.1:9 does not answer: start")):
            for command in self.COMMANDS:
                with self.subTest(uri=uri, command=command):
                    status, said, complaint = run(*command, environment={"ROS_MASTER_URI": uri})
                    self.assertEqual(status, 1)
                    self.assertEqual((said + complaint).count("\n"), 1, said + complaint)
                    self.assertIn(why, said + complaint)

    def test_every_program_tells_its_use_without_a_master(self):
        import roslib.packages
        for program in PROGRAMS:
            with self.subTest(program=program), mock.patch.dict(os.environ, ROS_MASTER_URI="http://127.0.0.1:9"):
                (path,) = roslib.packages.find_node("mr_hand_interaction", program)[:1]
                with open(path, "rb") as file:
                    script = file.read(2) == b"#!"
                done = forked.run(path, "--help") if script else subprocess.run(
                    [path, "--help"], timeout=LIMIT, check=False, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE, universal_newlines=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertGreater(len(done.stdout), 80)

    def test_ctrl_c_ends_quietly(self):
        for command in self.COMMANDS:
            with self.subTest(command=command), socket.socket() as silent:
                silent.bind(("127.0.0.1", 0))
                silent.listen()
                process = start(*command, environment={"ROS_MASTER_URI": "http://127.0.0.1:%d" % silent.getsockname()[1]})
                with silent.accept()[0]:
                    process.send_signal(signal.SIGINT)
                    self.assertEqual(process.communicate(timeout=LIMIT), ("", ""))
                self.assertEqual(process.returncode, 130)


if __name__ == "__main__":
    unittest.main()
