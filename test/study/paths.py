"""Where what is tested is; importing this makes `study` and `forked` importable."""

import os
import sys

SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'scripts')
sys.dont_write_bytecode = True
sys.path[:0] = [SCRIPTS, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'support')]


def script(name):
    return os.path.join(SCRIPTS, name)
