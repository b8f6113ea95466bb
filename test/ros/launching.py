"""Launch files that a test starts itself."""
import signal
import subprocess


class Launch:
    """One of the package's launch files, until the end of the block."""

    def __init__(self, file, *arguments):
        self.command = ["roslaunch", "--sigint-timeout", "30", "mr_hand_interaction", file] + list(arguments)

    def __enter__(self):
        self.process = subprocess.Popen(self.command)
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(120)
