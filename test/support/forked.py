"""Runs a Python script of the package in a fork of the test, which has imported the script's libraries once: pandas and
matplotlib take a second of each new process, and a refused file a hundredth. A fork has the test's hash seed and imported
modules: what is tested about either needs a process of its own."""

import os
import runpy
import subprocess
import sys
import tempfile


def run(path, *arguments, typed=''):
    """The finished process: status and both outputs as text. `typed` is its standard input."""
    with tempfile.TemporaryFile('w+') as answers, tempfile.TemporaryFile('w+') as said, tempfile.TemporaryFile('w+') as complaint:
        answers.write(typed)
        answers.seek(0)
        sys.stdout.flush()
        sys.stderr.flush()
        child = os.fork()
        if child == 0:
            _be(path, arguments, answers, said, complaint)
        _, ended = os.waitpid(child, 0)  # run_python_tests.py ends what hangs
        status = -os.WTERMSIG(ended) if os.WIFSIGNALED(ended) else os.WEXITSTATUS(ended)
        for file in (said, complaint):
            file.seek(0)
        return subprocess.CompletedProcess([path, *arguments], status, said.read(), complaint.read())


def _be(path, arguments, answers, said, complaint):
    """In the child, and never back to the test."""
    code = 1
    try:
        for number, file in enumerate((answers, said, complaint)):
            os.dup2(file.fileno(), number)
        sys.stdin = open(0, closefd=False)
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
