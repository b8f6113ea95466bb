"""Calibration of the statistical tests."""
import collections

from .measuring import Recipe


def study():
    from study import calibration
    import scipy
    import statsmodels
    rows = calibration.table(('3v20', '8v22', '15v15'), 300, 1)
    return {'calibration': shortened(calibration.as_text(rows).strip())}, {
        'scipy': scipy.__version__, 'statsmodels': statsmodels.__version__}


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
        others = 'the other %d tests' if bold else 'all %d tests'
        lines += plain if len(plain) < 2 else [_range_of_tests(population, others, plain)]
    return '\n'.join(lines)


def _range_of_tests(population, label, rows):
    numbers = [[float(cell.strip(' *')) for cell in row.strip('|').split('|')[2:] if cell.strip()] for row in rows]
    return '| %s | %s | %s |' % (population, label % len(rows), ' | '.join(
        '%.1f to %.1f' % (min(column), max(column)) for column in zip(*numbers)))


RECIPES = {
    'study': Recipe('4 minutes', ['scripts/study/' + name for name in (
        'anova.py', 'calibration.py', 'exact.py', 'linear.py', 'mixed_model.py', 'pairwise.py', 'permutation.py')], study),
}
