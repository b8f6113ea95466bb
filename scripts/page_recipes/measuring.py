"""What the recipes share: programs to run, tables to read and to write."""
import collections
import csv
import io
import os
import subprocess

from page_figures import PACKAGE

# `time`: of one core; `sources`: what the figures depend on, files and folders; `measure`: gives ({key: text}, {engine: version}).
Recipe = collections.namedtuple('Recipe', 'time sources measure')
PROGRAMS = os.path.join(PACKAGE, 'devel', 'lib', 'mr_hand_interaction')
LAWS = ['src/collision', 'src/response', 'src/simulation', 'src/integration']
CORE = LAWS + ['src/tracking', 'config/default.yaml']


class MeasurementError(Exception):
    pass


def run(program, *arguments):
    """Standard output of a program of the package, brought up to date by make."""
    path = os.path.join(PACKAGE, 'scripts', program)
    if not os.path.isfile(path):
        _done(['make', '-C', os.path.join(PACKAGE, 'build', 'catkin'), program])
        path = os.path.join(PROGRAMS, program)
    return _done([path, *arguments])


def _done(command):
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)
    except OSError as error:
        raise MeasurementError('%s: %s' % (command[0], error.strerror)) from None
    if done.returncode != 0:
        raise MeasurementError('%s: %s' % (' '.join(command), ' '.join(done.stderr.split())[-300:]))
    return done.stdout


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


def rows_of_file(folder, name):
    with open(os.path.join(folder, name), encoding='utf-8') as file:
        return rows_of(file.read())


def table(head, rows):
    lines = ['| ' + ' | '.join(head) + ' |', '|---' * len(head) + '|']
    return '\n'.join(lines + ['| ' + ' | '.join(row) + ' |' for row in rows])
