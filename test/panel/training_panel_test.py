#!/usr/bin/env python3
"""rviz with the experimenter's configuration has the panel: it listens to training/status."""
import os
import signal
import subprocess
import time
import unittest

import rosgraph
import rostest

PACKAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
LIMIT = 300.0  # s, far beyond what rviz takes to come up


def listeners(topic):
    subscribers = rosgraph.Master("/training_panel_test").getSystemState()[1]
    return [node for name, nodes in subscribers if name == topic for node in nodes]


class PanelInRviz(unittest.TestCase):
    def test_rviz_loads_the_panel(self):
        rviz = subprocess.Popen(["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", "rosrun", "rviz", "rviz", "-d",
                                 os.path.join(PACKAGE, "rviz", "experimenter.rviz")], start_new_session=True,
                                env=dict(os.environ, LIBGL_ALWAYS_SOFTWARE="1"), stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT)
        try:
            end = time.monotonic() + LIMIT
            while not listeners("/training/status") and rviz.poll() is None and time.monotonic() < end:
                time.sleep(0.2)  # between looks at the master
            self.assertIsNone(rviz.poll(), "rviz ended: %s" % (rviz.poll() is not None and rviz.communicate()[0]))
            self.assertTrue(listeners("/training/status"))
        finally:
            if rviz.poll() is None:
                os.killpg(rviz.pid, signal.SIGTERM)
                rviz.communicate()


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "training_panel_in_rviz", PanelInRviz)
