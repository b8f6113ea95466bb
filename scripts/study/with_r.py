"""Poisson and negative binomial mixed models of counts, by R: no Python library in Debian has them."""

import os
import shutil
import subprocess
import tempfile

import pandas

from .measures import OF, is_tested
from .session_folder import StudyError

PACKAGES = ('emmeans', 'glmmTMB')
WITHOUT = 'no Poisson or negative binomial mixed models of counts (rate models with random participants)'
LONGEST = 1800.0  # s


def missing():
    """What is missing of R and its packages; empty if nothing."""
    program = shutil.which('Rscript')
    if program is None:
        return 'Rscript (r-base-core)'
    lacking = [name for name in PACKAGES if subprocess.run(
        [program, '-e', 'if (!requireNamespace("%s", quietly = TRUE)) quit(status = 1)' % name],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=LONGEST).returncode != 0]
    return ', '.join('r-cran-' + name.lower() for name in lacking)


def models(cells):
    """A row for each effect. Raises StudyError if R fails."""
    with tempfile.TemporaryDirectory() as folder:
        given, made = os.path.join(folder, 'cells.csv'), os.path.join(folder, 'models.csv')
        _long(cells).to_csv(given, index=False, float_format='%.17g')
        script = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'count_models.R')
        try:
            done = subprocess.run(['Rscript', '--vanilla', script, given, made], stdout=subprocess.DEVNULL,
                                  stderr=subprocess.PIPE, universal_newlines=True, timeout=LONGEST)
        except subprocess.TimeoutExpired:
            raise StudyError('Rscript: took more than %g s' % LONGEST) from None
        if done.returncode != 0 or not os.path.exists(made):
            raise StudyError('Rscript: ' + ' '.join(done.stderr.split())[-300:])
        table = pandas.read_csv(made)
    return table.rename(columns={'condition_of': 'condition'})


def _long(cells):
    """Counts of each condition, and of all conditions together if there are several."""
    cells = cells[cells['measure'].map(lambda name: OF[name].kind) == 'count']
    tested = cells[cells['condition'].map(is_tested).astype(bool)]
    several = tested[tested.groupby(['source', 'gravity_g'])['condition'].transform('nunique') > 1]
    return pandas.concat([cells.assign(condition_of=cells['condition']), several.assign(condition_of='all')], ignore_index=True)
