"""Where what is tested is; importing this makes `study` importable."""

import os
import sys

SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'scripts')
sys.dont_write_bytecode = True
sys.path.insert(0, SCRIPTS)


def script(name):
    return os.path.join(SCRIPTS, name)
