"""Simulated operators in gloves, and afloat."""
import os
import shutil
import tempfile

from page_figures import PACKAGE
from .measuring import PEOPLE, Recipe, run, table

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


RECIPES = {
    'afloat': Recipe('2 minutes', PEOPLE, afloat),
    'gloves': Recipe('1 minute', PEOPLE, gloves),
}
