"""Simulated operators under all contact models: the study of seed 1, and the registered one."""
import os
import shutil
import tempfile

from .measuring import PEOPLE, MeasurementError, Recipe, run, table

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
            if not pair['effect_name'].startswith('ratio'):
                raise MeasurementError('%s has no %s to divide by' % (model, measure))
            if pair['b'] != model:
                ratio = [1 / ratio[0], 1 / ratio[2], 1 / ratio[1]]
            p = min(1.0, FAMILY * float(pair['p']))
            return '%.2f (%.2f to %.2f)' % tuple(ratio), '%.2g' % p if p >= 1e-4 else '<1e-4'
    return '', ''


RECIPES = {
    'operators': Recipe('5 minutes', PEOPLE + ['scripts/study'], operators),
    'registered': Recipe('1 minute', PEOPLE + ['scripts/study'], registered),
}
