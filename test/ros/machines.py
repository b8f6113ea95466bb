"""Machines on a network of their own: network namespaces on one switch. Nothing of it reaches the host's network."""
import json
import os
import shutil
import signal
import subprocess
import tempfile

NETWORK = "10.77.0."


def run(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                          timeout=30).stdout


def why_not():
    """Why there can be no machines here; None: there can."""
    if not shutil.which("ip"):
        return "iproute2 is not installed"
    name = "mrhi%d_try" % os.getpid()
    try:
        run("ip", "netns", "add", name)
    except subprocess.CalledProcessError as error:
        return "network namespaces cannot be made here: " + error.stderr.strip().splitlines()[-1]
    try:
        run("ip", "-n", name, "link", "add", "switch", "type", "bridge")
    except subprocess.CalledProcessError as error:
        return "a network namespace cannot have a switch here: " + error.stderr.strip().splitlines()[-1]
    finally:
        run("ip", "netns", "del", name)
    return None


class Machines:
    """Context of machines with these names; the ROS master is to be on the one named `master`."""

    def __init__(self, names, master):
        self.names, self.processes, self.folder = list(names), [], None
        self.address = {name: NETWORK + str(i + 1) for i, name in enumerate(self.names)}
        self.master = "http://%s:11311" % self.address[master]

    @staticmethod
    def space(name):
        return "mrhi%d_%s" % (os.getpid(), name)

    def ip(self, name, *arguments):
        return run("ip", "-n", self.space(name), *arguments)

    def __enter__(self):
        self.folder = tempfile.mkdtemp()
        try:
            self.connect()
        except BaseException:
            self.__exit__()
            raise
        return self

    def connect(self):
        for name in ["switch"] + self.names:
            run("ip", "netns", "add", self.space(name))
            self.ip(name, "link", "set", "lo", "up")
        self.ip("switch", "link", "add", "switch", "type", "bridge")
        self.ip("switch", "link", "set", "switch", "up")
        for i, name in enumerate(self.names):
            port = "port%d" % i
            self.ip(name, "link", "add", "eth0", "type", "veth", "peer", "name", port, "netns", self.space("switch"))
            self.ip("switch", "link", "set", port, "master", "switch", "up")
            self.ip(name, "address", "add", self.address[name] + "/24", "dev", "eth0")
            self.ip(name, "link", "set", "eth0", "up")

    def __exit__(self, *_):
        for process in reversed(self.processes):
            self.stop(process)
        for name in self.names + ["switch"]:
            subprocess.run(["ip", "netns", "del", self.space(name)], stderr=subprocess.DEVNULL, check=False)
        shutil.rmtree(self.folder)

    def start(self, name, *command, **options):
        """A program on a machine, with what ROS needs to know there."""
        environment = dict(os.environ, ROS_MASTER_URI=self.master, ROS_IP=self.address[name], ROS_LOG_DIR=self.folder)
        environment.pop("ROS_HOSTNAME", None)
        process = subprocess.Popen(("ip", "netns", "exec", self.space(name)) + command, env=environment,
                                   start_new_session=True, **options)
        self.processes.append(process)
        return process

    @staticmethod
    def stop(process):
        process.send_signal(signal.SIGINT)
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()

    def link(self, name, up):
        self.ip(name, "link", "set", "eth0", "up" if up else "down")

    def bytes_received(self, name):
        (link,) = json.loads(run("ip", "-n", self.space(name), "-json", "-statistics", "link", "show", "eth0"))
        return link["stats64"]["rx"]["bytes"]
