"""Waiting on a condition, in wall time whatever ROS's clock does."""
import time

import rospy

TIMEOUT = 60.0  # s; far beyond what is needed, so that only a real failure meets it


def wait_until(condition, what, timeout=TIMEOUT, period=0.005):
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end or rospy.is_shutdown():
            raise AssertionError("waited in vain for " + what)
        time.sleep(period)
