"""How the figures of each page are measured: programs to run, texts to make of what they write."""
import collections
import csv
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile

from page_figures import PACKAGE

# `time`: of one core; `sources`: what the figures depend on, files and folders; `measure`: gives ({key: text}, {engine: version}).
Recipe = collections.namedtuple('Recipe', 'time sources measure')
PROGRAMS = os.path.join(PACKAGE, 'devel', 'lib', 'mr_hand_interaction')
LAWS = ['src/collision', 'src/response', 'src/simulation', 'src/integration']
CORE = LAWS + ['src/tracking', 'config/default.yaml']

FILTER_SOURCES = ['src/tracking/%s' % name for name in (
    'constant_velocity_filter.cpp', 'hand_filter.cpp', 'hand_filter.h', 'none_filter.cpp', 'one_euro_filter.cpp', 'tracker.cpp',
    'window_filter.cpp')]


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


def contact():
    benefits, costs = run('ablation').split('\n\nA step of scene (a): ')
    instructions, costs = costs.split(' instructions', 1)
    costs = re.findall(r'^\| (`\w+`) \| .*\(([-+][\d.]+) %\) \|', costs, re.MULTILINE)
    tiers = collections.OrderedDict()
    for line in run('geometry_tiers').split('\n'):
        found = re.match(r'(.{18}) +([-\d.]+) +([-\d.]+) +([-\d.]+) +([-\d.]+)$', line)
        if found:
            tiers.setdefault(found.group(1).strip(), []).append([float(x) for x in found.groups()[1:]])
    return {
        'refinements': benefits.strip(),
        'instructions': _range_of(costs, instructions),
        'tiers': ', '.join('%s %.2f mm (%.1f)' % (name, sides[0][0], sides[0][3] / next(
            some for n, some in tiers.items() if n.startswith('capsule'))[0][3]) for name, sides in tiers.items()),
    }, {}


def _range_of(costs, instructions):
    least, most = sorted(costs, key=lambda cost: float(cost[1]))[::len(costs) - 1]
    return '%s %% (%s) to %s %% (%s) of %s instructions' % (least[1], least[0], most[1], most[0], instructions)


FILTERS = collections.OrderedDict([
    ('none', 'none'), ('window=3', '`window`, F = 3'), ('one_euro', '`one_euro`, beta 100, min_cutoff 2'),
    ('default', '`constant_velocity`, default'), ('agility', 'the same, agility 12')])


def _filter_name(row):
    if row['default'] == '1':
        return 'default'
    if row['series'] == 'none' or row['setting'] == 'window=3':
        return row['series'] if row['series'] == 'none' else 'window=3'
    if row['series'] == 'one_euro beta=100' and re.search(r'min_cutoff=2(\D|$)', row['setting']):
        return 'one_euro'
    same = re.search(r'acceleration=0\.1(\D|$)', row['setting'])
    return 'agility' if row['series'] == 'constant_velocity agility=12' and same else None


def filters():
    with tempfile.TemporaryDirectory() as folder:
        run('filters', '--output', folder)
        recorded, held = rows_of_file(folder, 'filters.csv'), rows_of_file(folder, 'filters_held.csv')
    lines = []
    for panel in dict.fromkeys((row['input'], row['frames_per_s']) for row in recorded):
        of_panel = {_filter_name(row): row for row in recorded if (row['input'], row['frames_per_s']) == panel}
        lines.append(['**%s, %s frames/s**' % panel] + [''] * 4)
        for name, label in FILTERS.items():
            row = {key: value for key, value in of_panel[name].items()}
            lines.append([label, '%.3f' % float(row['jitter_mm']),
                          '%.1f (%.1f)' % (abs(round(float(row['lag_ms']), 1)), float(row['lag_p90_ms'])),
                          *['%.2f' % float(row[key]) for key in ('moving_error_mm', 'still_error_mm')]])
    of_held = {_filter_name(row): row for row in held}
    grasps = rows_of(run('noisy_grasps', 'grasp_cube'))
    return {
        'recorded': table(['', 'jitter [mm]', 'lag [ms]', 'error moving [mm]', 'error still [mm]'], lines),
        'held': table(['', 'true slip [mm]', 'displacement [mm]', "cube's jitter [mm]"], [
            [label] + ['%.3f' % float(of_held[name][key]) for key in ('true_slip_mm', 'displacement_mm', 'jitter_mm')]
            for name, label in FILTERS.items()]),
        'grasps': _grasps(grasps),
    }, {}


def _grasps(rows):
    rows = [row for row in rows if float(row['dropped']) == 0]
    columns = list(dict.fromkeys((row['where'], row['frames_per_s']) for row in rows))
    cells = {(row['correlation'], row['noise_mm'], row['where'], row['frames_per_s']): row for row in rows}
    lines = [['%g mm%s' % (float(noise), ', correlation %g' % float(correlation) if float(correlation) else '')] + [
        '%(held_estimated)s (%(held_fixed)s)' % cells[(correlation, noise, *column)] for column in columns]
             for correlation in dict.fromkeys(row['correlation'] for row in rows)
             for noise in dict.fromkeys(row['noise_mm'] for row in rows)]
    return table(['noise'] + ['%s, %.0f Hz' % (where, float(rate)) for where, rate in columns],
                 [line for line in lines if set(line[1:]) != {'100 (100)'}])


def study():
    from study import calibration
    import scipy
    import statsmodels
    rows = calibration.table(('3v20', '8v22', '15v15'), 300, 1)
    return study_figures(rows), {'scipy': scipy.__version__, 'statsmodels': statsmodels.__version__}


def study_figures(rows):
    from study import calibration
    return {'calibration': shortened(calibration.as_text(rows).strip())}


def shortened(text):
    """The table with a row for tests that have no bold number, and one for many that have, each with their range."""
    head, line, *rows = text.split('\n')
    populations = collections.OrderedDict()
    for row in rows:
        populations.setdefault(row.split('|')[1].strip(), []).append(row)
    lines = [head, line]
    for population, tests in populations.items():
        bold = [row for row in tests if '**' in row]
        plain = [row for row in tests if row not in bold]
        lines += bold if len(bold) < 4 else [_range_of_tests(population, '%d tests, above 5 %%', bold)]
        lines += plain if len(plain) < 2 else [_range_of_tests(population, 'the other %d tests', plain)]
    return '\n'.join(lines)


def _range_of_tests(population, label, rows):
    numbers = [[float(cell.strip(' *')) for cell in row.strip('|').split('|')[2:] if cell.strip()] for row in rows]
    return '| %s | %s | %s |' % (population, label % len(rows), ' | '.join(
        '%.1f to %.1f' % (min(column), max(column)) for column in zip(*numbers)))


MODELS = ('implicit', 'seed', 'soft_pad', 'virtual_spring', 'penetration')


def operators():
    """Operators 1 to 30 of seed 1 under all models that hold, at 0 g and 1 g."""
    folder = tempfile.mkdtemp()
    try:
        chosen = [word for model in MODELS for word in ('--model', model)]
        run('simulated_study', '--output', os.path.join(folder, 'study'), '--seed', '1', *chosen)
        return operators_figures(os.path.join(folder, 'study')), {}
    finally:
        shutil.rmtree(folder)


PAPER = {'seed': ('51.7 ± 19.4', '0.9 ± 0.3'), 'soft_pad': ('101.6 ± 58.0', '2.2 ± 2.9')}  # its Table 1; CLAP's place


def _table_1(comparison, pairs, trials):
    lines = [['the paper', system, *PAPER[model], '', ''] for system, model in (('theirs', 'seed'), ('CLAP', 'soft_pad'))]
    for gravity in ('0', '1'):
        for model in PAPER:
            of = {row['quantity']: row for row in comparison if (row['gravity_g'], row['condition']) == (gravity, model)}
            drops = sum(int(float(row['drops'] or 0)) for row in trials
                        if (row['gravity_g'], row['condition']) == (gravity, model))
            pair = next(row for row in pairs if row['gravity_g'] == gravity and row['condition'] == 'all'
                        and row['measure'] == 'completion_time' and {row['a'], row['b']} == set(PAPER))
            effect = [float(pair[key]) for key in ('effect', 'low', 'high')]
            if pair['a'] != 'seed':
                effect = [1 / effect[0], 1 / effect[2], 1 / effect[1]]
            lines.append([gravity + ' g', '`%s`' % model, *['%.*f ± %.*f' % (
                digits, float(of[name]['mean']), digits, float(of[name]['sd'])) for name, digits in (
                    ('completion_time', 1), ('manipulation_drops', 2))], '%d' % drops,
                '%.2f (%.2f to %.2f)' % tuple(effect) if model == 'seed' else ''])
    return table(['', 'system', 'time [s]', 'attempts', 'all drops, sum', 'time over `soft_pad` (95 % interval)'], lines)


def _rows(frame):
    return [dict(row, gravity_g='%g' % row['gravity_g']) for row in frame.to_dict('records')]


def operators_figures(folder):
    from study import analysis, measures, session_folder, study_data
    data = study_data.gather([session_folder.read_session(path) for path in session_folder.find_sessions([folder])])
    found = analysis.analyse(data._replace(cells=data.cells[data.cells['measure'].isin(measures.MAIN)]))
    comparison, trials, pairs = (_rows(frame) for frame in (found.comparison, data.trials, found.post_hoc))
    lines = []
    for gravity in ('0', '1'):
        for model in MODELS:
            of = {row['quantity']: row for row in comparison if (row['gravity_g'], row['condition']) == (gravity, model)}
            some = [row for row in trials if (row['gravity_g'], row['condition']) == (gravity, model)]
            if not some:
                continue
            drops = ['%d' % sum(int(float(row['drops'] or 0)) for row in some if row['object'] == name)
                     for name in ('cube', 'flat_cuboid', 'long_cuboid')]
            time, attempts = of['completion_time'], of['manipulation_drops']
            lines.append([gravity + ' g', '`%s`' % model, '%.1f ± %.1f (± %.1f)' % tuple(
                float(time[key]) for key in ('mean', 'sd', 'ci95')),
                          '%.2f ± %.2f' % (float(attempts['mean']), float(attempts['sd'])), *drops,
                          '%d' % sum(row['result'] == 'completed' for row in some)])
    return {'seed_1': table(['', '', 'time [s], mean ± sd (± 95 %)', 'drops while manipulated, mean ± sd',
                             'drops: cube', 'flat', 'long', 'completed of %d' % len(some)], lines),
            'table_1': _table_1(comparison, pairs, trials)}


def people():
    """What the tests of simulated operators print of six on whom nothing was chosen."""
    return people_figures(run('test_operators', '--gtest_filter=*OperatorReaches*:*OperatorSwings*:*OperatorHolds*:*OperatorSees*')), {}


def people_figures(printed):
    def found(pattern):
        return [[float(number) for number in match.groups()] for match in re.finditer(pattern, printed)]

    def span(numbers, form):
        return form % min(numbers) + ' to ' + form % max(numbers)
    widest, grips = (sum(found(pattern), []) for pattern in (r'widest at (\d+) %', r', \w+: grip ([\d.]+) N'))
    swings = sorted(found(r'load ([\d.]+) N, r ([\d.]+), margin (\d+) %'))
    (aside,), (further,) = (found(r'a leap of 12 cm %s: noticed after ([\d.]+) s, reach longer by ([\d.]+) s' % way)
                            for way in ('aside', 'further'))
    return {
        'widest': span(widest, '%.0f') + ' %', 'grip': span(grips, '%.1f') + ' N',
        'correlation': 'r = ' + span([r for _, r, _ in swings], '%.2f'),
        'margin': '%.0f %% at %.1f N of load, %.0f %% at %.0f N' % (swings[0][2], swings[0][0], swings[-1][2], swings[-1][0]),
        'leap': 'after %.2f s; the reach takes %.2f s longer (12 cm aside), %.2f s (further)' % (aside[0], aside[1], further[1]),
    }


REGISTERED = ('implicit', 'seed', 'virtual_spring', 'soft_pad'), ('flat_cuboid', 'long_cuboid')
FAMILY = 6  # comparisons: three models, two gravities


def registered():
    """What simulated_study wrote for each seed, in the folder that REGISTERED_STUDY names."""
    folder = os.environ.get('REGISTERED_STUDY')
    if not folder:
        raise MeasurementError('REGISTERED_STUDY is empty; allowed: a folder with what simulated_study wrote for each seed')
    from study import analysis, session_folder, study_data
    models, objects = REGISTERED
    sessions = [session_folder.read_session(path) for path in session_folder.find_sessions([folder])]
    data = study_data.gather([s._replace(trials=[row for row in s.trials if row['object'] in objects]) for s in sessions])
    pairs = _rows(analysis.analyse(data._replace(
        cells=data.cells[data.cells['measure'].isin(['drops', 'completion_time'])])).post_hoc)
    lines = []
    for gravity in ('0', '1'):
        for model in models:
            some = data.trials[(data.trials['gravity_g'] == float(gravity)) & (data.trials['condition'] == model)]
            compared = [pair for pair in pairs if (pair['gravity_g'], pair['condition'], {pair['a'], pair['b']}) == (
                gravity, 'all', {models[0], model})]
            lines.append([gravity + ' g', '`%s`' % model, '%d' % some['drops'].sum()] + [
                cell for name in ('drops', 'completion_time') for cell in _ratio_to(model, name, compared)])
    corrected = 'p × %d' % FAMILY
    return {'comparison': table(['', '', 'drops', 'ratio of drops', corrected, 'of times', corrected], lines)}, {}


def _ratio_to(model, measure, pairs):
    """Of the first model to this one, and its corrected p."""
    for pair in pairs:
        if pair['measure'] == measure:
            ratio = [float(pair[key]) for key in ('effect', 'low', 'high')]
            if pair['b'] != model:
                ratio = [1 / ratio[0], 1 / ratio[2], 1 / ratio[1]]
            p = min(1.0, FAMILY * float(pair['p']))
            return '%.2f (%.2f to %.2f)' % tuple(ratio), '%.2g' % p if p >= 1e-4 else '<1e-4'
    return '', ''


GLOVE = os.path.join(PACKAGE, 'config', 'hands', 'eva_glove.yaml')
GLOVED_HANDS = (('bare', 1.0), ('unpressurised glove (60 % of the strength)', 0.6), ('pressurised glove (20 %)', 0.2))


def gloves():
    """Operators 1 to 30 of seed 1 at 0 g, bare and in the glove of the file, with pressure and without."""
    import yaml
    with open(GLOVE, encoding='utf-8') as file:
        glove = yaml.safe_load(file)['hand']
    folder, lines = tempfile.mkdtemp(), []
    try:
        for index, (label, strength) in enumerate(GLOVED_HANDS):
            worn = dict(glove, **{key: glove[key] * strength / 0.2 for key in ('strength', 'palm_strength')})
            chosen = [word for key, value in worn.items() for word in ('--set', 'hand/%s=%g' % (key, value))]
            output = os.path.join(folder, str(index))
            run('simulated_study', '--output', output, '--model', 'implicit', '--gravity', '0', *(chosen if index else ()))
            lines.append([label] + _of_hand(output))
    finally:
        shutil.rmtree(folder)
    return {'hands': table(['hand', 'completed; drops', 'time [s]', 'mean grip [N]', 'largest grip [N]',
                            'drift after release [mm]'], lines)}, {}


def _trials_in(folder):
    from study import session_folder, study_data
    return study_data.gather([session_folder.read_session(path) for path in session_folder.find_sessions([folder])]).trials


def _of_hand(folder):
    trials = _trials_in(folder)
    cells = ['%d of %d; %d' % ((trials['result'] == 'completed').sum(), len(trials), trials['drops'].astype(float).sum())]
    return cells + _means(trials, ('completion_time', 1, 1), ('grip_force_mean', 1, 1), ('grip_force_max', 1, 1),
                          ('release_drift', 1000, 1))


def _means(trials, *measures):
    """Of each measure, times a scale, with some decimals: mean and 95 % interval over operators."""
    from study.analysis import summary
    cells = []
    for name, scale, decimals in measures:
        found = summary(scale * trials[name].dropna().astype(float).groupby(trials['participant']).mean())
        cells.append('%.*f ± %.*f' % (decimals, found['mean'], decimals, found['ci95']) if found['n'] else '')
    return cells


FLOATING_TASKS = ('rail', 'dock', 'throw', 'hatch_0g')


def afloat():
    """Ten beginners and ten veterans of seed 1 at the tasks for people who float."""
    folder, lines = tempfile.mkdtemp(), []
    try:
        for task, *options in [(task,) for task in FLOATING_TASKS] + [('hatch_0g', '--free-hands')]:
            output = os.path.join(folder, '_'.join([task, *options]))
            run('simulated_study', '--output', output, '--task', task, '--model', 'implicit', '--gravity', '0',
                '--operators', '1-20', '--group-size', '10', *options)
            trials = _trials_in(output)
            done = trials[trials['result'] == 'completed']
            lines.append('`%s`%s %s, in %s s' % (task, ' with both hands free' if options else '', ' and '.join(
                '%d' % (done['group'] == group).sum() for group in ('beginner', 'veteran')), *_means(done, ('completion_time', 1, 1))))
    finally:
        shutil.rmtree(folder)
    return {'tasks': '; '.join(lines)}, {}


OVERLAP, SWAY, FRICTION = 0.002, 9.0, 0.8  # of stability_map: how deep fingertips press [m]; acceleration at most [m/s^2]
OUTCOMES = ('stable', 'let_go', 'ejected', 'diverged')


def stability():
    with tempfile.TemporaryDirectory() as folder:
        run('stability_map', '--output', folder)
        cells = rows_of_file(folder, 'stability_map.csv')
    for cell in cells:
        cell.update({key: float(value) for key, value in cell.items() if key not in ('model', 'outcome')})
    models = list(dict.fromkeys(cell['model'] for cell in cells))
    of = {model: [cell for cell in cells if cell['model'] == model] for model in models}
    steps = sorted(set(cell['step_s'] for cell in cells))
    grips = [sum(map(_is_grip, some)) for some in of.values()]
    return {
        'models': table(['model', *(outcome.replace('_', ' ') for outcome in OUTCOMES), 'grips held of %d' % grips[0],
                         'stable at %s ms' % ' / '.join('%.2g' % (1e3 * step) if step < 0.01 else '%.1f' % (1e3 * step)
                                                        for step in (steps[0], steps[3], steps[-1]))], [
            ['`%s`' % model, *(_percent(some, lambda cell, outcome=outcome: cell['outcome'] == outcome) for outcome in OUTCOMES),
             '%d' % sum(_is_grip(cell) and cell['outcome'] == 'stable' for cell in some),
             ' / '.join('%.0f' % (100 * _stable([cell for cell in some if cell['step_s'] == step])[1])
                        for step in (steps[0], steps[3], steps[-1])) + ' %'] for model, some in of.items()]),
        'springs': _bounded(of['seed'], _beyond_springs),
        'dampers': _bounded(of['virtual_spring'], _beyond_dampers),
    }, {}


def _percent(cells, is_so):
    share = 100 * sum(map(is_so, cells)) / len(cells)
    return '%.0f %%' % share if share in (0, 100) else '%.1f %%' % share


def _stable(cells):
    count = sum(cell['outcome'] == 'stable' for cell in cells)
    return count, count / len(cells)


def _bounded(cells, is_beyond):
    several = [cell for cell in cells if cell['contacts'] >= 2]
    beyond, within = ([cell for cell in several if is_beyond(cell) == which] for which in (True, False))
    return '%d of %d cells beyond it are stable, %.0f %% of %d within it' % (
        _stable(beyond)[0], len(beyond), 100 * _stable(within)[1], len(within))


def _is_grip(cell):
    """Friction carries the cube at twice the sway's acceleration."""
    pressing = 2 * (cell['contacts'] // 2)
    return pressing > 0 and FRICTION * pressing * cell['stiffness_n_m'] * OVERLAP >= 2 * cell['mass_kg'] * SWAY


def _beyond_springs(cell):
    return cell['step_s'] > 2 / (cell['contacts'] * cell['stiffness_n_m'] / cell['mass_kg']) ** 0.5


def _beyond_dampers(cell):
    stiffness = cell['contacts'] * cell['stiffness_n_m']
    damping = cell['contacts'] * 2 * (cell['stiffness_n_m'] * 0.010) ** 0.5
    return cell['step_s'] ** 2 * stiffness + 2 * cell['step_s'] * damping > 4 * cell['mass_kg']


RACE_CHARTS = {'summary': 'speed_accuracy', 'all': 'speed_accuracy_all', 'pinch_swing': 'pinch_swing'}


def engines():
    """Ours, Debian's engines, and those whose sources ENGINE_SOURCES names, such as --jolt DIR --box3d DIR."""
    sources = os.environ.get('ENGINE_SOURCES', '').split()
    if not sources:
        raise MeasurementError('ENGINE_SOURCES is empty; allowed: options of scripts/benchmark, such as --jolt DIR --box3d DIR')
    folder = tempfile.mkdtemp()
    try:
        quick, crowds = os.path.join(folder, 'quick'), os.path.join(folder, 'crowds')
        run('benchmark', '--quick', '--output', quick, *sources)
        run('benchmark', '--full', '--scene', 'crowd', '--output', crowds, *sources)  # --quick has but one crowd
        return engines_figures([quick, crowds], folder)
    finally:
        shutil.rmtree(folder)


def engines_figures(runs, folder):
    """Of folders that scripts/benchmark wrote. Their charts, drawn in `folder`, become the page's."""
    sys.path.insert(0, os.path.join(PACKAGE, 'benchmark'))
    import race_tables
    race_tables.merge(runs, folder)
    rows, times = race_tables.read(folder)
    versions = race_tables.versions(rows)
    for chart, name in RACE_CHARTS.items():
        shutil.copyfile(os.path.join(folder, chart + '.png'), os.path.join(PACKAGE, 'docs', 'images', name + '.png'))
    return {'versions': race_tables.described(versions, max(row.date for row in rows)),
            'results': table(*race_tables.results(rows)), 'crowds': table(*race_tables.crowds(rows, times))}, versions


HANDS = collections.OrderedDict([  # settings of real_grasps, from the defaults to the paper's hand
    ('defaults', {}), ('assist alone', {'hand/strength': 'unlimited', 'hand/palm_strength': 'unlimited', 'hand/pad': '0'}),
    ("a person's hand alone", {'contact/grasp_assist': 'false'})])
HANDS["neither: the paper's hand"] = dict(HANDS['assist alone'], **HANDS["a person's hand alone"])


def _settings(chosen):
    return [word for key, value in chosen.items() for word in ('--set', '%s=%s' % (key, value))]


def _interval(units, at_least_wilson=False):
    """95 % interval of a share, in per cent, by resampling independent units' (successes, trials)."""
    import numpy
    from statsmodels.stats.proportion import proportion_confint
    units = numpy.array(units, float)
    drawn = units[numpy.random.RandomState(1).randint(0, len(units), (10000, len(units)))].sum(axis=1)
    ends = numpy.percentile(drawn[:, 0] / numpy.maximum(drawn[:, 1], 1e-9), (2.5, 97.5))
    if at_least_wilson:
        wilson = proportion_confint(*units.sum(axis=0), method='wilson')
        ends = min(ends[0], wilson[0]), max(ends[1], wilson[1])
    return '%.0f to %.0f' % (100 * ends[0], 100 * ends[1])


BODIES = collections.OrderedDict([
    ('pinch20', 'pinch 20 mm'), ('pinch30', '30 mm'), ('pinch40', '40 mm'), ('grab_sphere60', 'grab sphere 60 mm'),
    ('grab_sphere80', '80 mm'), ('grab_cube60', 'cube 60 mm'), ('grab_cube80', '80 mm')])
PINCHES, GRABS = tuple(BODIES)[:3], tuple(BODIES)[3:]
PASSES = ('pass_sphere40', 'pass_cube40'), ('pass_sphere60', 'pass_cube60')  # at 0 g, and at 1 g on a column
IN_PLACE = 10.0  # [mm]
SEEDS = 4  # of a tracker's noise


def recordings():
    """Bodies put where the hands recorded in MR_HAND_RECORDINGS close."""
    folder = os.environ.get('MR_HAND_RECORDINGS')
    if not folder:
        raise MeasurementError('MR_HAND_RECORDINGS is empty; allowed: a folder of recorded hands')
    scratch, played = tempfile.mkdtemp(), collections.OrderedDict()
    try:
        for label, chosen in list(HANDS.items()) + [('`seed`, 100 N/m', {'contact_model': 'seed'})]:
            run('real_grasps', '--output', scratch, *_settings(chosen), folder)
            played[label] = (rows_of_file(scratch, 'real_grasps_events.csv'), rows_of_file(scratch, 'real_grasps.csv'))
        noisy = collections.OrderedDict()
        for rate in (30, 60, 120):
            for noise in (0, 1, 3, 5):
                run('real_grasps', '--only', ','.join(PINCHES), '--noise', str(noise), '--rate', str(rate), '--seeds', str(SEEDS),
                    '--output', scratch, folder)
                noisy[rate, noise] = rows_of_file(scratch, 'real_grasps_events.csv')
        return recordings_figures(played, noisy), {}
    finally:
        shutil.rmtree(scratch)


def recordings_figures(played, noisy):
    """Of {setting: (closings, rows)} and of {(rate, noise): closings}."""
    defaults = played['defaults'][0]
    return {
        'hands': table([''] + ['%s (of %s)' % (label, _row(played['defaults'][1], name)['events']) for name, label in BODIES.items()], [
            [label] + [_held_and_force(rows, name) for name in BODIES] for label, (_, rows) in played.items()]),
        'sums': table(['', 'default hand', "the paper's hand"], [
            [label] + [_held(played[hand][0], names) for hand in ('defaults', "neither: the paper's hand")]
            for label, names in (('pinch, cubes of 20 to 40 mm', PINCHES), ('grab, of 60 and 80 mm', GRABS))]),
        'in_place': ' and '.join(_held([row for row in defaults if float(row['early_mm']) < IN_PLACE], names)
                                 for names in (PINCHES, GRABS)),
        'open_hands': ' and '.join(_held(defaults, names) for names in PASSES),
        'noisy': table(['', 'no noise', '1 mm', '3 mm', '5 mm'], [['%d Hz' % rate] + [
            '%.0f' % (_count(noisy[rate, noise], PINCHES)[0] / SEEDS)
            for noise in (0, 1, 3, 5)] for rate in dict.fromkeys(rate for rate, _ in noisy)]),
    }


def _count(events, names):
    some = [row['held'] == '1' for row in events if row['row'] in names]
    return sum(some), len(some)


def _held(events, names):
    units = collections.OrderedDict()
    for row in events:
        if row['row'] in names:
            units.setdefault(row['recording'], []).append(row['held'] == '1')
    return '%d of %d (%s %%)' % (*_count(events, names), _interval(
        [(sum(held), len(held)) for held in units.values()], at_least_wilson=True))


def _row(rows, name):
    return next(row for row in rows if (row['row'], row['object']) == (name, 'all'))


def _held_and_force(rows, name):
    row = _row(rows, name)
    return row['held'] + (', %.0f N' % float(row['force_p90_N']) if name in PINCHES else '')


def captures():
    """Windows of captures, in the folders that CAPTURE_WINDOWS names, as scripts/import_captures writes them; the first in all settings."""
    folders = os.environ.get('CAPTURE_WINDOWS', '').split()
    if not folders:
        raise MeasurementError('CAPTURE_WINDOWS is empty; allowed: folders that scripts/import_captures wrote')
    scratch, results = tempfile.mkdtemp(), []
    try:
        for index, folder in enumerate(folders):
            results.append([folder, collections.OrderedDict()])
            for number, (label, chosen) in enumerate(HANDS.items() if index == 0 else [('defaults', {})]):
                output = os.path.join(scratch, '%d_%d' % (index, number))
                os.makedirs(output)
                leads = '1,0.3' if (index, number) == (0, 0) else '1'
                listing = run('real_grasps', '--arctic', folder, '--lead', leads, '--list', '--output', output, *_settings(chosen))
                results[-1][1][label] = (output, listing)
        return captures_figures(results), {}
    finally:
        shutil.rmtree(scratch)


CHOSEN_ON = r's1_(ketchup|laptop|notebook|waffleiron)_use_01_|s2_notebook_use_02_'  # what the defaults were chosen on
SETS = {'artigrasp': 'ARCTIC', 'dexmachina': 'ARCTIC', 'manipnet': 'ManipNet'}


def captures_figures(results):
    """Of [windows, {setting: (output of real_grasps, what it said)}] of each set."""
    sets = []
    for folder, settings in results:
        windows = rows_of_file(folder, 'windows.csv')
        output, listing = settings['defaults']
        of = {split: row for (lead, split), row in _splits(output).items() if lead == '1'}
        rigid = _splits(output)['', 'all']
        people, things = ({row[key] for row in windows} for key in ('person', 'object'))
        hinge = re.search(r'windows lead 1 .*hinge within 10 degrees 50 mm (\d+) %', listing)
        sets.append([SETS.get(windows[0]['set'], os.path.basename(folder.rstrip(os.sep))) + (', with hinges' if hinge else ''),
                     '%d (%s)' % (len(windows), of['all']['captures']), '%d, %d' % (len(people), len(things)),
                     _share(of['all'], 50) + ('; hinge within 10° too: %s %%' % hinge.group(1) if hinge else ''),
                     _share(of['all'], 20), _newtons(of['all']),
                     _share(rigid, 20),
                     '%s (%s to %s)' % re.search(r'rigid hand.*?([-+]\d+) points \(([-+]\d+) to ([-+]\d+)\)', listing).groups()])
    first = results[0][1]
    shares = [(label, _splits(output)['1', 'all']) for label, (output, _) in first.items() if label != 'defaults']
    rigid = [('`rigid`', _splits(first['defaults'][0])['', 'all'])]
    of_first = _splits(first['defaults'][0])
    splits = {split: row for (lead, split), row in of_first.items() if lead == '1'}
    return dict({'sets': table(['set', 'windows (captures)', 'people, objects', 'within 50 mm', 'within 20 mm', 'p90', '`rigid`: 20 mm',
                                'difference, points'], sets),
                 'chosen': _chosen(first['defaults'][1].split('windows lead 1 ')[0]),
                 'short_lead': ' and '.join(_share(of_first['0.3', 'all'], limit) for limit in (50, 20)),
                 'settings': '; '.join('%s %.0f %% and %.0f %%%s' % (
                     label, 100 * float(row['within_50mm']), 100 * float(row['within_20mm']),
                     '' if label == '`rigid`' else ', ' + _newtons(row)) for label, row in shares + rigid)},
                **{kind: ', '.join('%s %s' % (split.split(' ', 1)[1], _share(row, 50))
                                   for split, row in sorted(splits.items(), key=lambda item: -float(item[1]['within_50mm']))
                                   if split.startswith(kind)) for kind in ('person', 'object')})


def _chosen(listing):
    """Of windows that --list named: those that the defaults were chosen on, and the others."""
    windows = re.findall(r'^(\w+)_\d+ +(\d+) frames of.*within 50 mm +(\d+) %.*within 20 mm +(\d+) %', listing, re.MULTILINE)
    parts = []
    for chosen, label in ((True, 'the %d that the defaults were chosen on'), (False, 'the other %d')):
        captures = collections.OrderedDict()
        for name, *numbers in windows:
            if bool(re.match(CHOSEN_ON, name + '_')) == chosen:
                captures.setdefault(name, []).append([int(number) for number in numbers])
        shares = []
        for limit in (1, 2):
            units = [(sum(row[0] * row[limit] / 100 for row in rows), sum(row[0] for row in rows)) for rows in captures.values()]
            held, of = map(sum, zip(*units))
            shares.append('%.0f %% (%s)' % (100 * held / of, _interval(units)))
        parts.append('%s and %s in %s' % (*shares, label % sum(map(len, captures.values()))))
    return ', '.join(parts)


def _splits(folder):
    return {(row['lead'], row['split']): row for row in rows_of_file(folder, 'real_grasps_arctic.csv')}


def _share(row, millimetres):
    return '%.0f %% (%.0f to %.0f)' % tuple(100 * float(row['within_%dmm%s' % (millimetres, end)]) for end in ('', '_low', '_high'))


def _newtons(row):
    return '%.0f N' % float(row['force_p90_N'])


RECIPES = {
    'afloat': Recipe('2 minutes', CORE + ['src/synthetic', 'src/training', 'config/scenes', 'config/tasks'], afloat),
    'captures': Recipe('5 minutes', CORE + ['benchmark/real_grasps', 'scripts/captures'], captures),
    'contact': Recipe('5 minutes', CORE + ['benchmark/ablation', 'benchmark/geometry_tiers.cpp', 'modelling'], contact),
    'engines': Recipe('25 minutes', LAWS + ['benchmark/speed_accuracy'], engines),
    'filters': Recipe('15 minutes', FILTER_SOURCES + ['benchmark/filters', 'benchmark/noisy_grasps.cpp'], filters),
    'gloves': Recipe('1 minute', CORE + ['src/synthetic', 'src/training', 'config/hands'], gloves),
    'operators': Recipe('5 minutes', CORE + ['src/synthetic', 'src/training'], operators),
    'people': Recipe('1 minute', ['src/synthetic', 'test/operators'], people),
    'recordings': Recipe('2 minutes', CORE + ['benchmark/real_grasps'], recordings),
    'registered': Recipe('1 minute', ['scripts/study/analysis.py', 'scripts/study/study_data.py'], registered),
    'stability': Recipe('3 minutes', ['src/collision', 'src/response', 'benchmark/stability_map.cpp', 'test/support/stability_map.h'],
                        stability),
    'study': Recipe('4 minutes', ['scripts/study/' + name for name in (
        'calibration.py', 'exact.py', 'linear.py', 'mixed_model.py', 'pairwise.py', 'permutation.py')], study),
}
