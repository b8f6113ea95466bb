"""Runs a Python script of the package in a fork of the test, which has imported the script's libraries once: pandas and
matplotlib take a second of each new process, and a refused file a hundredth. A fork has the test's hash seed and imported
modules: what is tested about either needs a process of its own."""

import os
import runpy
import signal
import subprocess
import sys
import tempfile
import time

LIMIT = 120  # s, far beyond what any script takes


def run(path, *arguments):
    """The finished process: status and both outputs as text. Standard input is empty."""
    with tempfile.TemporaryFile('w+') as said, tempfile.TemporaryFile('w+') as complaint:
        sys.stdout.flush()
        sys.stderr.flush()
        child = os.fork()
        if child == 0:
            _be(path, arguments, said, complaint)
        status = _wait(child)
        for file in (said, complaint):
            file.seek(0)
        return subprocess.CompletedProcess([path, *arguments], status, said.read(), complaint.read())


def _wait(child):
    end = time.monotonic() + LIMIT
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
        if time.monotonic() > end:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            raise AssertionError('a script did not end within %d s' % LIMIT)
        time.sleep(0.005)


def _be(path, arguments, said, complaint):
    """In the child, and never back to the test."""
    code = 1
    try:
        with open(os.devnull) as nothing:
            os.dup2(nothing.fileno(), 0)
        os.dup2(said.fileno(), 1)
        os.dup2(complaint.fileno(), 2)
        sys.stdout, sys.stderr = open(1, 'w', closefd=False), open(2, 'w', closefd=False)
        sys.argv = [path, *arguments]
        try:
            runpy.run_path(path, run_name='__main__')
            code = 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
            if isinstance(end.code, str):
                print(end.code, file=sys.stderr)
        except BaseException:  # as the interpreter does with what nobody catches
            sys.excepthook(*sys.exc_info())
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)
