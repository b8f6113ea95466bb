#!/usr/bin/env python3
"""The package as catkin_make install leaves it: what README.md starts by roslaunch and rosrun runs from there."""
import os
import re
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(PACKAGE, "build", "catkin")
NAME = "mr_hand_interaction"
DRAWING = ("screenshot", "film")
LIMIT = 300  # s, far beyond what any takes


@unittest.skipUnless(os.path.exists(os.path.join(BUILD, "cmake_install.cmake")) and shutil.which("rosrun"), "not built with catkin")
class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.prefix = holder.name
        subprocess.run(["cmake", "-DCMAKE_INSTALL_PREFIX=" + cls.prefix, "-P", os.path.join(BUILD, "cmake_install.cmake")],
                       stdout=subprocess.DEVNULL, check=True)
        prefixes = [path for path in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)
                    if path and not path.startswith(PACKAGE)]
        cls.environment = dict(
            os.environ, CMAKE_PREFIX_PATH=os.pathsep.join([cls.prefix] + prefixes), HOME=cls.prefix,
            ROS_PACKAGE_PATH=os.pathsep.join([os.path.join(path, "share") for path in [cls.prefix] + prefixes] + ["/usr/share"]),
            PYTHONPATH=os.pathsep.join([os.path.join(cls.prefix, "lib/python3/dist-packages")] +
                                       [path for path in os.environ.get("PYTHONPATH", "").split(os.pathsep)
                                        if path and not path.startswith(PACKAGE)]),
            LD_LIBRARY_PATH=os.path.join(cls.prefix, "lib"))
        for name in ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME"):
            cls.environment.pop(name, None)

    def run_(self, *command, **options):
        done = subprocess.run(command, env=self.environment, cwd=self.prefix, timeout=LIMIT, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, **options)
        return done.returncode, done.stdout

    def test_programs_and_launch_files_of_the_readme_are_those_of_the_install_space(self):
        with open(os.path.join(PACKAGE, "README.md"), encoding="utf-8") as file:
            readme = file.read()
        programs = set(re.findall(r"rosrun %s (\w+)" % NAME, readme))
        programs.update(name for name in re.findall(r"scripts/(\w+)", readme) if name not in ("demo", "test"))
        self.assertGreater(len(programs), 6)
        for program in sorted(programs.union(DRAWING)):
            status, said = self.run_("rosrun", NAME, program, "--help")
            self.assertEqual(status, 0, "%s: %s" % (program, said))
            self.assertGreater(len(said), 80, program)
        # As roslaunch --files does, which would read its own modules for each of them.
        files = ("import sys, roslaunch.rlutil as r\nwords = ['bag:=/hand.bag', 'participant:=P01', 'model:=/hand.task']\n"
                 "for file in sys.argv[1:]:\n    (path,) = r.resolve_launch_arguments(['%s', file])\n"
                 "    r.print_file_list([(path, words)])\n    print()" % NAME)
        launches = sorted(set(re.findall(r"(\w+\.launch)", readme)))
        status, said = self.run_("/usr/bin/env", "python3", "-c", files, *launches)
        self.assertEqual(status, 0, said)
        for launch, listed in zip(launches, said.strip().split("\n\n")):
            self.assertIn(os.path.join(self.prefix, "share", NAME, "launch", launch), listed)

    def test_rviz_finds_the_display_and_the_panel(self):
        if not os.path.exists(os.path.join(PACKAGE, "devel", "lib", "lib%s_rviz.so" % NAME)):
            self.skipTest("built without rviz")
        plugins = xml.etree.ElementTree.parse(os.path.join(self.prefix, "share", NAME, "rviz_plugins.xml")).getroot()
        self.assertEqual({plugin.get("name") for plugin in plugins.iter("class")},
                         {NAME + "/Interaction", NAME + "/TrainingPanel"})
        status, said = self.run_("ldd", os.path.join(self.prefix, plugins.get("path") + ".so"))
        self.assertEqual(status, 0, said)
        self.assertNotIn("not found", said)
        self.assertIn(os.path.join(self.prefix, "lib", "lib%s_ros.so" % NAME), said)

    @unittest.skipUnless(all(map(shutil.which, ("Xvfb", "rviz", "convert"))), "what draws rviz is not installed")
    def test_a_screenshot_is_drawn(self):
        picture = os.path.join(self.prefix, "picture.png")
        status, said = self.run_("rosrun", NAME, "screenshot", "--moment", "hand", "--size", "320x200", "--output", picture,
                                 "--time-limit", str(LIMIT - 60))
        self.assertEqual(status, 0, said)
        _, colours = self.run_("identify", "-format", "%k", picture)
        self.assertGreater(int(colours), 500)  # an empty scene has some dozens
        status, said = self.run_("rosrun", NAME, "screenshot", "--scene", "none")
        self.assertEqual(status, 2, said)
        self.assertIn("cube_on_table", said.splitlines()[-1])


if __name__ == "__main__":
    unittest.main()
