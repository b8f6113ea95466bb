"""Stability of contact models by mass, stiffness, contacts and step."""
import os
import tempfile

from .measuring import LAWS, Recipe, draw, rows_of_file, run, table

OVERLAP, SWAY, FRICTION = 0.002, 9.0, 0.8  # of stability_map: how deep fingertips press [m]; acceleration at most [m/s^2]
OUTCOMES = ('stable', 'let_go', 'ejected', 'diverged')


def stability():
    with tempfile.TemporaryDirectory() as folder:
        run('stability_map', '--output', folder)
        draw('stability_map', 'plot_stability_map.py', os.path.join(folder, 'stability_map.csv'))
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


RECIPES = {
    'stability': Recipe('3 minutes', LAWS + ['benchmark/stability_map.cpp', 'test/support/stability_map.h', 'benchmark/plot_stability_map.py'], stability, ['stability_map']),
}
