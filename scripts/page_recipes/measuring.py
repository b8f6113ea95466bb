"""What the recipes share: programs to run, tables to read and to write, charts to draw."""
import collections
import csv
import io
import os
import subprocess
import sys
import tempfile

from page_figures import PACKAGE, chart_path

# `time`: of one core; `sources`: what the figures depend on, files and folders; `measure`: gives ({key: text}, {engine: version}) and
# draws `charts`, names of images.
Recipe = collections.namedtuple('Recipe', 'time sources measure charts', defaults=[()])
sys.path.insert(0, os.path.join(PACKAGE, 'benchmark'))  # tables and charts
PROGRAMS = os.path.join(PACKAGE, 'devel', 'lib', 'mr_hand_interaction')
LAWS = ['include/mr_hand_interaction/' + part for part in (
    'collision', 'configuration.h', 'integration', 'response', 'scene', 'simulation.h')] + ['src/' + module for module in (
        'collision', 'configuration', 'integration', 'joints', 'math', 'response', 'scene', 'simulation')]
CORE = LAWS + ['include/mr_hand_interaction/tracking', 'src/tracking', 'config/default.yaml', 'config/scenes']
PEOPLE = CORE + ['include/mr_hand_interaction/synthetic', 'src/synthetic', 'src/training', 'config/tasks', 'config/hands']  # simulated


class MeasurementError(Exception):
    pass


def run(program, *arguments):
    """Standard output of a program of the package, brought up to date by make."""
    path = os.path.join(PACKAGE, 'scripts', program)
    if not os.path.isfile(path):
        build(program)
        path = os.path.join(PROGRAMS, program)
    return output([path, *arguments])


def build(program):
    output(['make', '-C', os.path.join(PACKAGE, 'build', 'catkin'), program])


def output(command):
    """What a command prints, run in the package's folder."""
    try:
        done = subprocess.run(command, cwd=PACKAGE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)
    except OSError as error:
        raise MeasurementError('%s: %s' % (command[0], error.strerror)) from None
    if done.returncode != 0:
        raise MeasurementError('%s: %s' % (' '.join(command), ' '.join(done.stderr.split())[-300:]))
    return done.stdout


def draw(chart, script, source):
    """Draws a program's results by a script of benchmark/."""
    with tempfile.TemporaryDirectory() as folder:
        picture = os.path.join(folder, 'chart.png')
        output([sys.executable, os.path.join(PACKAGE, 'benchmark', script), source, picture])
        keep_chart(chart, picture)


def draw_printed(chart, script, printed):
    """Draws what a program printed."""
    with tempfile.NamedTemporaryFile('w', suffix='.csv', encoding='utf-8') as file:
        file.write(printed)
        file.flush()
        draw(chart, script, file.name)


def keep_chart(chart, picture):
    """Stores a drawn picture with 64 colours, a quarter of the bytes."""
    from PIL import Image  # which matplotlib needs, too
    with Image.open(picture) as drawn:
        drawn.convert('RGB').quantize(64, dither=0).save(os.path.join(PACKAGE, chart_path(chart)), optimize=True)


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


def rows_of_file(folder, name):
    with open(os.path.join(folder, name), encoding='utf-8') as file:
        return rows_of(file.read())


def table(head, rows):
    lines = ['| ' + ' | '.join(head) + ' |', '|---' * len(head) + '|']
    return '\n'.join(lines + ['| ' + ' | '.join(row) + ' |' for row in rows])
