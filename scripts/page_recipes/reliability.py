"""Latency of the running nodes, and hours of hands through the core. The latency wants two idle cores."""
import re

from .measuring import CORE, MeasurementError, Recipe, build, output, run, table

# A name for the table, and what latency.launch is given.
RUNS = (('`mixed`', ['scene:=mixed']), ('`mixed`', ['scene:=mixed', 'topics:=contacts haptics objects']), ('a pinch', []),
        ('`mixed`, markers, at most 60 a second', ['scene:=mixed', 'topics:=markers']),
        ('`mixed`, two hands', ['scene:=mixed', 'two_hands:=true', 'topics:=rendered_view']),
        ('`mixed`, 1000 a second', ['scene:=mixed', 'rate:=1000', 'topics:=rendered_view']),
        ('`mixed`, rviz draws in software', ['scene:=mixed', 'rviz:=true', 'topics:=rendered_view']))
LAUNCH = ('source scripts/setup; source_ros "$devel/setup.bash"; choose_master; LIBGL_ALWAYS_SOFTWARE=1 timeout 120 '
          'xvfb-run -a -s "-screen 0 960x600x24" roslaunch benchmark/latency/latency.launch "$@"')
ROW = re.compile(r'^\| (?:hand to )?(\S+) \| (\d+) of (\d+) \| \S+ \| (\S+) \| (\S+) \|', re.MULTILINE)


def latency():
    build('latency')
    return {'table': table(['run', 'relay [ms]', 'answer [ms]', 'µs a frame: node, relay'], [
        [name, *latency_row(output(['bash', '-c', LAUNCH, 'latency', *given]))] for name, given in RUNS])}, {}


def latency_row(printed):
    """Cells of the table from what the benchmark printed."""
    answers, cost = ROW.findall(printed), re.search(r'interaction_node (\d+) us, relay (\d+) us', printed)
    if len(answers) < 2 or not cost:
        raise MeasurementError('latency.launch printed no result: ' + ' '.join(printed.split())[-300:])
    relay = [float(time) for time in answers[0][3:]]

    def cell(topic, arrived, sent, *times):
        ratios = [float(time) / of_relay for time, of_relay in zip(times, relay)]
        lost = '' if arrived == sent else '; %s of %s frames' % (arrived, sent)
        return '`%s` %s, %s (%.2f, %.2f)%s' % (topic, *times, *ratios, lost)
    return '%s, %s' % answers[0][3:], '; '.join(cell(*answer) for answer in answers[1:]), '%s, %s' % cost.groups()


def soak():
    """The last hours of a day through the core, all of which have been compared with the first."""
    hours = [line.split() for line in run('soak', '--core', '24').split('\n') if re.match(r' +\d+ ', line)]
    spans = ['%s to %s' % (min(values, key=float), max(values, key=float))
             for values in ([hour[column] for hour in hours] for column in (2, 5))]
    return {'day': '%s hours (%.1f million frames) stay at %s MiB and %s µs a step (99th percentile)' % (
        hours[-1][0], 1e-6 * int(hours[-1][1]), *spans)}, {}


RECIPES = {
    'latency': Recipe('4 minutes, idle', ['src/nodes', 'src/rendering', 'src/ros', 'benchmark/latency'], latency),
    'soak': Recipe('15 minutes', [*CORE, 'benchmark/soak.cpp'], soak),
}
