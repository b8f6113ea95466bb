#!/usr/bin/env python3
"""The package on the systems where ROS 1 is run: which ROS is taken, which Python, catkin's rules, the container, the release."""
import ast
import glob
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# What catkin_lint takes for a fault and is none: rviz is found by cmake/rviz.cmake where it is there, urdfdom is no catkin
# package, folders and files are made in the build folder, and without catkin the tests are added at another place.
NO_FAULTS = ("build_depend on 'rviz'", "build_depend on 'pluginlib'", "build_depend on 'urdfdom'", "/generated'",
             "/mr_hand_interactionConfig", "subdirectory 'test' is added a second time")
# Gone from Python 3.13, or to go.
NO_MODULES = {"asynchat", "asyncore", "cgi", "cgitb", "crypt", "distutils", "imp", "nntplib", "pipes", "smtpd", "telnetlib"}
NO_NAMES = {"utcnow", "utcfromtimestamp", "getdefaultlocale"}


def text_of(*path):
    with open(os.path.join(PACKAGE, *path), encoding="utf-8") as file:
        return file.read()


def python_programs():
    for folder in ("scripts", "test", "benchmark", "modelling", "workflow"):
        for path in glob.glob(os.path.join(PACKAGE, folder, "**", "*"), recursive=True):
            if not os.path.isfile(path) or path.endswith(".pyc"):
                continue
            with open(path, "rb") as file:
                if path.endswith(".py") or b"python3" in file.readline(80):
                    yield path


class SystemsTest(unittest.TestCase):
    def found_ros(self, folder, **environment):
        """What scripts/setup takes: prefix, Python, and whether packages of apt are asked for."""
        script = 'set -euo pipefail; source scripts/setup; printf "%%s\\n" "$(found_ros %s)" "$python" "${conda:+conda}"' % folder
        done = subprocess.run(["bash", "-c", script], cwd=PACKAGE, env=dict(PATH="/usr/bin:/bin", HOME=folder, **environment),
                              stdout=subprocess.PIPE, universal_newlines=True, check=True)
        return done.stdout.split("\n")[:3]

    def test_any_ros_1_below_opt_and_a_conda_environment_are_taken(self):
        with tempfile.TemporaryDirectory() as folder:
            def install(*names):
                for name in names:
                    os.makedirs(os.path.join(folder, name, "share/catkin/cmake"))
                    open(os.path.join(folder, name, "share/catkin/cmake/catkinConfig.cmake"), "w").close()
                return [os.path.join(folder, name) for name in names]
            os.makedirs(os.path.join(folder, "rolling"))  # of ROS 2
            self.assertEqual(self.found_ros(folder), ["", "/usr/bin/python3", ""])
            noetic, one = install("noetic", "one")
            self.assertEqual(self.found_ros(folder)[0], one)
            self.assertEqual(self.found_ros(folder, ROS_DISTRO="noetic")[0], noetic)
            self.assertEqual(self.found_ros(folder, ROS_DISTRO="rolling")[0], one)
            with tempfile.TemporaryDirectory() as conda:
                self.assertEqual(self.found_ros(folder, CONDA_PREFIX=conda), [one, "/usr/bin/python3", ""])
            (conda,) = install("conda")
            self.assertEqual(self.found_ros(folder, CONDA_PREFIX=conda), [conda, conda + "/bin/python3", "conda"])

    def test_no_program_has_what_python_3_13_has_not(self):
        count = 0
        for path in python_programs():
            with open(path, encoding="utf-8") as file:
                source = file.read()
            for node in ast.walk(ast.parse(source, path)):
                if isinstance(node, (ast.Import, ast.ImportFrom)):
                    names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [name.name for name in node.names]
                    self.assertFalse({name.split(".")[0] for name in names} & NO_MODULES, path)
                if isinstance(node, ast.Attribute):
                    self.assertNotIn(node.attr, NO_NAMES, path)
            count += 1
        self.assertGreater(count, 100)
        done = subprocess.run([sys.executable, "-W", "error::DeprecationWarning", "-W", "error::SyntaxWarning", "-c",
                               "import sys\nfor path in sys.argv[1:]: "
                               "compile(open(path, encoding='utf-8').read(), path, 'exec')"] + list(python_programs()),
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self.assertEqual(done.returncode, 0, done.stdout)

    @unittest.skipUnless(shutil.which("catkin_lint"), "catkin-lint is not installed")
    def test_catkin_lint_finds_no_fault(self):
        with tempfile.TemporaryDirectory() as folder:  # without what has been built
            package = os.path.join(folder, "mr_hand_interaction")
            shutil.copytree(PACKAGE, package, ignore=lambda _, names: {"build", "devel", "out", ".git"} & set(names))
            done = subprocess.run(["catkin_lint", "-W1", package], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  universal_newlines=True)
        self.assertNotIn("cannot lint", done.stdout)
        self.assertIn("checked 1 packages", done.stdout)
        faults = [line for line in done.stdout.splitlines() if ": error: " in line]
        self.assertEqual([line for line in faults if not any(known in line for known in NO_FAULTS)], [])

    def test_the_container_runs_commands_that_there_are(self):
        """scripts/test_container runs them, which takes minutes."""
        lines = dict(line.split(" ", 1) for line in text_of("Containerfile").splitlines() if line[:1].isupper())
        self.assertIn("debian:bookworm", lines["FROM"])
        bash, script = json.loads(lines["ENTRYPOINT"])
        self.assertEqual(bash, "bash")  # found on PATH, and the script from WORKDIR
        for words in ([script], json.loads(lines["CMD"]), lines["RUN"].split()):
            self.assertTrue(os.access(os.path.join(PACKAGE, words[0]), os.X_OK), words)
            for option in words[1:]:
                usage = subprocess.run([os.path.join(PACKAGE, words[0]), "--help"], stdout=subprocess.PIPE, universal_newlines=True)
                self.assertIn(option, usage.stdout)
        self.assertEqual({"build", "devel"} - set(text_of(".dockerignore").split()), set())

    @unittest.skipUnless(os.path.exists(os.path.join(PACKAGE, "devel", "setup.bash")), "not built with catkin")
    def test_the_container_s_entry_point_leaves_options_to_the_command(self):
        done = subprocess.run(["bash", os.path.join(PACKAGE, "scripts/in_container"), "printf", "%s,", "--help", "--local"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self.assertEqual((done.returncode, done.stdout), (0, "--help,--local,"))

    def test_all_files_tell_one_version(self):
        version = xml.etree.ElementTree.parse(os.path.join(PACKAGE, "package.xml")).getroot().findtext("version")
        self.assertIn("\nversion: %s\n" % version, text_of("CITATION.cff"))
        self.assertIn("project(mr_hand_interaction VERSION %s " % version, text_of("CMakeLists.txt"))
        self.assertIn("\n%s (" % version, text_of("CHANGELOG.rst"))


if __name__ == "__main__":
    unittest.main()
