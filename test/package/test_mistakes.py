#!/usr/bin/env python3
"""What a newcomer gets wrong is answered in one line, the last that is printed, before anything is installed or built."""
import os
import subprocess
import tempfile
import unittest

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Neither a built workspace nor ROS's variables.
BARE = {"PATH": "/usr/bin:/bin", "HOME": tempfile.gettempdir()}


def last_line_of(script, *arguments):
    with tempfile.TemporaryDirectory() as elsewhere:
        told = subprocess.run([os.path.join(PACKAGE, "scripts", script), *arguments], cwd=elsewhere, env=BARE, timeout=300,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True)
    lines = told.stdout.splitlines()
    return told.returncode, lines[-1] if lines else "", told.stdout


class MistakesTest(unittest.TestCase):
    def test_a_plugin_that_is_not_built_is_answered_with_the_package_that_it_needs(self):
        status, line, told = last_line_of("run_when", "plugin", "true")
        self.assertEqual(status, 1, told)
        self.assertIn("librviz-dev", line)

    def test_a_name_that_is_not_known_is_answered_with_those_that_are(self):
        for script, arguments, wrong, allowed in (
                ("demo", ("--motion", "jump"), "jump", "grasp_cube"),
                ("demo", ("--scene", "table"), "table", "cube_on_table"),
                ("demo", ("--scene", "/no such/scene.urdf"), "/no such/scene.urdf", ""),
                ("screenshot", ("--motion", "jump"), "jump", "grasp_cube"),
                ("screenshot", ("--moment", "now"), "now", "done"),
                ("screenshot", ("--scene", "table"), "table", "cube_on_table"),
                ("screenshot", ("--bag", "no_such.bag"), "no_such.bag", ""),
                ("test", ("laws", "physics"), "physics", "test/ros/NAME.test")):
            with self.subTest(script=script, arguments=arguments):
                status, line, told = last_line_of(script, *arguments)
                self.assertEqual(status, 2, told)
                self.assertTrue(line.startswith(script + ": "), told)
                self.assertIn("'%s'" % wrong, line)
                self.assertIn(allowed, line)
                self.assertNotIn("== Building", told)

    def test_who_has_not_sourced_what_is_built_is_told_to(self):
        for script, arguments in (("set", ("material/static_friction", "0.9")), ("training_keys", ())):
            with self.subTest(script=script):
                status, line, told = last_line_of(script, *arguments)
                self.assertEqual(status, 1, told)
                self.assertIn("source devel/setup.bash", line)
                self.assertIn("/usr/bin/python3", line)
                self.assertNotIn("Traceback", told)

    def test_a_python_without_ros_first_on_the_path_gives_way_to_the_one_that_has_it(self):
        """As where pyenv or conda is active; and the script ends by itself where there is no other."""
        with tempfile.TemporaryDirectory() as folder:
            python = os.path.join(folder, "python3")
            with open(python, "w", encoding="ascii") as file:
                file.write('#!/bin/sh\nexec /usr/bin/python3 -I -S "$@"\n')
            os.chmod(python, 0o755)
            environment = dict(os.environ, PATH=folder + ":/usr/bin:/bin", ROS_MASTER_URI="http://127.0.0.1:9")
            for script, arguments in (("set", ("step", "0.001")), ("doctor", ()), ("run_when", ("message", "/a", "true"))):
                told = subprocess.run([os.path.join(PACKAGE, "scripts", script), *arguments], env=environment, timeout=60,
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      universal_newlines=True).stdout
                self.assertIn("http://127.0.0.1:9 does not answer", told, script)


if __name__ == "__main__":
    unittest.main()
