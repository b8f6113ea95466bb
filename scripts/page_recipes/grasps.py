"""Grasps of recorded and captured hands."""
import collections
import os
import re
import shutil
import tempfile

from .measuring import CORE, MeasurementError, Recipe, keep_chart, rows_of_file, run, table

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


def recorded_hands():
    folder = os.environ.get('MR_HAND_RECORDINGS')
    if not folder:
        raise MeasurementError('MR_HAND_RECORDINGS is empty; allowed: a folder of recorded hands')
    return folder


def peers():
    """Our models in several settings, and other engines, in the recorded hands; built as ENGINE_SOURCES says, if it is there."""
    import plot_real_grasps
    import race_tables
    with tempfile.TemporaryDirectory() as output:
        run('benchmark', '--output', output, '--real', recorded_hands(), *os.environ.get('ENGINE_SOURCES', '').split())
        keep_chart('real_grasps', os.path.join(output, 'real_grasps.png'))
        engines = plot_real_grasps.read_engines(output)
    versions = race_tables.versions(engines)
    return {'versions': race_tables.described(versions, engines[0].date)}, versions


def recordings():
    """Bodies put where the hands recorded in MR_HAND_RECORDINGS close."""
    folder = recorded_hands()
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
                leads = ','.join(LEADS) if (index, number) == (0, 0) else '1'
                listing = run('real_grasps', '--arctic', folder, '--lead', leads, '--list', '--output', output, *_settings(chosen))
                results[-1][1][label] = (output, listing)
        return captures_figures(results), {}
    finally:
        shutil.rmtree(scratch)


LEADS = '1', '0.3', '3', '10', 'clear'  # [s]; clear: since no hand touched the object
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
                 'leads': '; '.join('%s %s' % (lead if lead == 'clear' else lead + ' s', ' and '.join(
                     _share(of_first[lead, 'all'], limit) for limit in (50, 20))) for lead in LEADS[1:]),
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
    'captures': Recipe('5 minutes', CORE + ['src/replay', 'benchmark/real_grasps', 'scripts/captures'], captures),
    'peers': Recipe('20 minutes', CORE + ['src/replay', 'benchmark/real_grasps', 'benchmark/speed_accuracy/engines',
                                         'benchmark/plot_real_grasps.py'],
                    peers, ['real_grasps']),
    'recordings': Recipe('2 minutes', CORE + ['src/replay', 'benchmark/real_grasps'], recordings),
}
