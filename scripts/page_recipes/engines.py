"""Our speed and accuracy beside other engines, and how far crowds are cut short."""
import os
import shutil
import tempfile

from .measuring import CORE, LAWS, MeasurementError, Recipe, draw_printed, keep_chart, rows_of, run, table

RACE = ['benchmark/speed_accuracy', 'benchmark/plot_speed_accuracy.py']
CHARTS = {'engines': {'speed_accuracy': 'summary', 'speed_accuracy_all': 'all', 'pinch_swing': 'pinch_swing'},
          'crowds': {'crowds': 'crowds'}}  # of the race, by the names of our images


def race(name, arguments, figures_of):
    """Races ours, Debian's engines, and those whose sources ENGINE_SOURCES names, such as --jolt DIR --box3d DIR."""
    sources = os.environ.get('ENGINE_SOURCES', '').split()
    if not sources:
        raise MeasurementError('ENGINE_SOURCES is empty; allowed: options of scripts/benchmark, such as --jolt DIR --box3d DIR')
    import race_tables
    folder = tempfile.mkdtemp()
    try:
        run('benchmark', '--output', folder, *arguments, *sources)
        rows, times = race_tables.read(folder)
        versions = race_tables.versions(rows)
        described = race_tables.described(versions, max(row.date for row in rows))
        for chart, drawn in CHARTS[name].items():
            keep_chart(chart, os.path.join(folder, drawn + '.png'))
        return dict(figures_of(race_tables, rows, times), versions=described), versions
    finally:
        shutil.rmtree(folder)


def engines():
    return race('engines', ['--quick'], lambda tables, rows, times: {
        'results': table(*tables.results(rows)), 'meshes': table(*tables.results(rows, tables.MESHES)),
        'joints': table(*tables.results(rows, tables.JOINTS, tables.STIFF_HANDS)), 'long_steps': tables.long_steps(rows),
        'whole_frame': tables.whole_frame(rows)})


def crowds():
    return race('crowds', ['--full', '--scene', 'crowd'],  # --quick has none
                lambda tables, rows, times: {'crowds': table(*tables.crowds(rows, times)), 'slowest': tables.slowest_crowd(rows, times)})


def cut_short():
    """How far a step's budget leaves our solver off the converged one."""
    printed = run('crowds', '--cut-short')
    draw_printed('cut_short', 'plot_cut_short.py', printed)
    return cut_short_figures(rows_of(printed)), {}


def cut_short_figures(rows):
    heaps = {int(row['bodies_to']): 100 * float(row['relative']) for row in rows if row['scene'] == 'heap'}
    large = [share for bodies, share in heaps.items() if bodies > 16]
    at_rest = '%.0e' % max(float(row['off_m_s']) for row in rows if row['scene'] == 'block')
    return {'error': 'at most %s m/s at rest, %.1f %% of the change of velocity where up to 16 bodies land on each other, and '
                     '%.0f to %.0f %% where more do' % (at_rest.replace('e-0', 'e-'), heaps[16], min(large), max(large))}


RECIPES = {
    'engines': Recipe('15 minutes', CORE + ['src/rendering'] + RACE, engines, list(CHARTS['engines'])),
    'crowds': Recipe('30 minutes', LAWS + RACE, crowds, list(CHARTS['crowds'])),
    'cut_short': Recipe('2 minutes', LAWS + ['benchmark/crowds', 'benchmark/plot_cut_short.py'], cut_short, ['cut_short']),
}
