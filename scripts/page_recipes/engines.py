"""Our speed and accuracy beside other engines."""
import os
import shutil
import sys
import tempfile

from page_figures import PACKAGE
from .measuring import LAWS, MeasurementError, Recipe, run, table

CHARTS = {'engines': {'summary': 'speed_accuracy', 'all': 'speed_accuracy_all', 'pinch_swing': 'pinch_swing'}}


def race(name, arguments, figures_of):
    """Races ours, Debian's engines, and those whose sources ENGINE_SOURCES names, such as --jolt DIR --box3d DIR."""
    sources = os.environ.get('ENGINE_SOURCES', '').split()
    if not sources:
        raise MeasurementError('ENGINE_SOURCES is empty; allowed: options of scripts/benchmark, such as --jolt DIR --box3d DIR')
    sys.path.insert(0, os.path.join(PACKAGE, 'benchmark'))
    import race_tables
    from PIL import Image  # which matplotlib needs, too
    folder = tempfile.mkdtemp()
    try:
        run('benchmark', '--output', folder, *arguments, *sources)
        rows, times = race_tables.read(folder)
        versions = race_tables.versions(rows)
        described = race_tables.described(versions, max(row.date for row in rows))
        for chart, image in CHARTS.get(name, {}).items():
            with Image.open(os.path.join(folder, chart + '.png')) as drawn:  # 64 colours take a quarter of the bytes
                drawn.convert('RGB').quantize(64, dither=0).save(
                    os.path.join(PACKAGE, 'docs', 'images', image + '.png'), optimize=True)
        return dict(figures_of(race_tables, rows, times), versions=described), versions
    finally:
        shutil.rmtree(folder)


def engines():
    return race('engines', ['--quick'], lambda tables, rows, times: {'results': table(*tables.results(rows))})


def crowds():
    return race('crowds', ['--full', '--scene', 'crowd'],  # --quick has but one crowd
                lambda tables, rows, times: {'crowds': table(*tables.crowds(rows, times))})


RECIPES = {
    'engines': Recipe('15 minutes', LAWS + ['benchmark/speed_accuracy'], engines),
    'crowds': Recipe('10 minutes', LAWS + ['benchmark/speed_accuracy'], crowds),
}
