"""Our speed and accuracy beside other engines."""
import os
import shutil
import sys
import tempfile

from page_figures import PACKAGE
from .measuring import LAWS, MeasurementError, Recipe, run, table

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


RECIPES = {
    'engines': Recipe('25 minutes', LAWS + ['benchmark/speed_accuracy'], engines),
}
