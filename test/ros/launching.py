"""Launch files that a test starts itself."""
import os

import roslaunch.parent
import rospy

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


class Launch:
    """One of the package's launch files, until the end of the block. It runs in the test's process, because a process of its
    own takes most of a second of a processor to start."""

    def __init__(self, file, *arguments):
        self.file = os.path.join(PACKAGE, "launch", file), list(arguments)

    def __enter__(self):
        self.parent = roslaunch.parent.ROSLaunchParent(rospy.get_param("/run_id"), [self.file], show_summary=False,
                                                       sigint_timeout=30)
        self.parent.start()
        return self

    def has_ended(self):
        """A required node has ended, or all nodes have."""
        return not self.parent.pm.is_alive()

    def __exit__(self, *_):
        node = self.parent.server
        node.is_shutdown = True
        node.server.shutdown()  # or its thread would go on to wait, busily, at the closed socket
        self.parent.shutdown()
