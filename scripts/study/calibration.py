"""Studies without an effect, and how often the tests find one.

Times come from four mechanisms. `alike` is the mixed model itself with the same scatter at every object; `by object` has
the scatter that this project's own data have; `retries` is no such model: a trial is a movement and, after each drop,
another try, so that times are skewed and scatter by object and person; in `by group` the first group varies twice as
much as the second, which no test here allows for.
"""

import collections
import functools
import re

import numpy as np
import pandas
from scipy import stats

from . import exact, pairwise, permutation
from .anova import mixed_anova
from .linear import Model

DESIGNS = ('3v20', '4v26', '5v5', '8v22', '15v15')
DROPS = collections.OrderedDict([('rare', 0.1), ('frequent', 1.5)])  # mean of a trial
MISSING = 0.1
OBJECTS, CONDITIONS, GROUPS = ('cube', 'flat_cuboid', 'long_cuboid'), ('a', 'b'), ('beginner', 'veteran')
ALPHA = 0.05
DRAWN = 999  # arrangements of a permutation test: enough for p < 0.05, and ten times as fast
PERSON, WITH_OBJECT, WITH_CONDITION = 0.25, 0.1, 0.15  # standard deviations of the logarithm of a time
RESIDUAL = collections.OrderedDict([('alike', (0.2, 0.2, 0.2)), ('by object', (0.1, 0.2, 0.5)), ('retries', None),
                                    ('by group', (0.2, 0.2, 0.2))])
DROP = (0.05, 0.15, 0.4)  # probability that a try at each object ends in a drop, of a person of mean frailty
FRAILTY = 1.0  # shape of the gamma distribution of participants' own rates: some drop far more than others
COLUMNS = ('design', 'drops', 'outcome', 'test', 'studies', 'tested', 'significant', 'percent', 'low', 'high', 'verdict')


def table(designs, studies, seed):
    rows = []
    for design in designs:
        sizes = _sizes(design)
        counted = collections.OrderedDict()
        drawn, permutation.DRAWN = permutation.DRAWN, DRAWN
        try:
            for number in range(studies):
                _count(counted, sizes, np.random.RandomState([seed, number] + list(sizes)))
        finally:
            permutation.DRAWN = drawn
        rows += [_row(design, studies, *item) for item in counted.items()]
    return rows


def _sizes(design):
    match = re.fullmatch(r'(\d{1,3})v(\d{1,3})', design)
    sizes = [int(part) for part in match.groups()] if match else [0]
    if min(sizes) < 2:
        raise ValueError("design '%s' is not allowed; allowed: two numbers from 2 to 999, as 3v20" % design)
    return sizes


def _count(counted, sizes, random):
    for mechanism in RESIDUAL:
        for test, p in _of_times(_times(random, sizes, mechanism), mechanism):
            _add(counted, (mechanism, 'times', test), p)
    for drops, mean in DROPS.items():
        wide = _drops(random, sizes, mean)
        for test, p in _of_counts(wide, np.repeat(GROUPS, sizes)):
            _add(counted, (drops, 'drops', test), p)
    for test, p in _of_ratings(random, sizes):
        _add(counted, ('', 'ratings', test), p)


def _add(counted, key, p):
    tested, found = counted.get(key, (0, 0))
    counted[key] = (tested + bool(np.isfinite(p)), found + bool(p < ALPHA))


def _times(random, sizes, mechanism):
    """Of each participant, object and condition; a tenth is missing."""
    n = sum(sizes)
    if mechanism == 'retries':
        logarithms = np.log(_tries(random, n)) - _mean_of_retries()[:, None]
    else:
        person, things, systems = (scale * random.normal(size=shape) for scale, shape in (
            (PERSON, (n, 1, 1)), (WITH_OBJECT, (n, 3, 1)), (WITH_CONDITION, (n, 1, 2))))
        logarithms = person + things + systems + np.array(RESIDUAL[mechanism])[:, None] * random.normal(size=(n, 3, 2))
    if mechanism == 'by group':
        logarithms[:sizes[0]] *= 2
    values = np.exp(3.0 + logarithms)
    rows = [('P%03d' % i, GROUPS[int(i >= sizes[0])], thing, system, values[i, j, k])
            for i in range(n) for j, thing in enumerate(OBJECTS) for k, system in enumerate(CONDITIONS)]
    cells = pandas.DataFrame(rows, columns=['participant', 'group', 'object', 'condition', 'value'])
    return cells[random.rand(len(cells)) >= MISSING]


def _tries(random, n):
    """Seconds of each person, object and condition: a movement, and a try of 4 s in the mean after each drop."""
    speed = np.exp(PERSON * random.normal(size=(n, 1, 1)))
    chance = np.clip(np.array(DROP)[:, None] * random.gamma(2.0, 0.5, (n, 1, 1)), 0, 0.8)
    drops = random.geometric(1 - np.broadcast_to(chance, (n, 3, 2))) - 1
    return speed * (12 + random.gamma(4.0, 0.5, (n, 3, 2)) + random.gamma(np.maximum(2.0 * drops, 1e-9), 2.0))


@functools.lru_cache(None)
def _mean_of_retries():
    """Each object's mean logarithm, so that objects do not differ when it is taken off."""
    return np.log(_tries(np.random.RandomState(0), 200000)).mean(axis=(0, 2))


def _of_times(cells, mechanism):
    factors = collections.OrderedDict([('group', GROUPS), ('object', OBJECTS), ('condition', CONDITIONS)])
    model = Model(cells, factors, logarithm=True)
    for names, test in model.effects():
        if len(names) < 3:
            yield 'mixed model: ' + ' x '.join(names), test.p
            if len(names) == 1 and mechanism == 'alike':
                yield 'mixed model without small-sample correction: ' + names[0], float(
                    stats.chi2.sf(test.f / test.scale * test.df, test.df))
    yield 'mixed model: group at long cuboid', _of_groups(model, OBJECTS[2])
    yield 'mixed model, stars for groups at objects', _family(
        [_of_groups(model, thing) for thing in OBJECTS])
    if mechanism == 'by object':
        alike = Model(cells, factors, logarithm=True, scatters_alike=True)
        yield 'one residual variance for all objects: group at long cuboid', _of_groups(alike, OBJECTS[2])
    if mechanism == 'by group':
        means = cells.assign(value=np.log(cells['value'])).groupby(['group', 'participant'])['value'].mean()
        yield "classical: Welch's t, participants' means", pairwise.independent(*[means[group] for group in GROUPS]).p
    if mechanism != 'alike':
        return
    wide = cells.assign(value=np.log(cells['value'])).pivot_table(index=['group', 'participant'], columns='condition',
                                                                  values='value', aggfunc=['mean', 'size'])
    full = wide['mean'][(wide['size'] == len(OBJECTS)).all(axis=1)]
    labels = list(full.index.get_level_values('group'))
    if min(labels.count(group) for group in GROUPS) > 1:
        for effect in mixed_anova(full.values, labels).effects[:2]:
            yield 'classical, the complete alone: ' + effect.name.replace('within', 'condition'), effect.p


def _of_groups(model, thing):
    return model.difference({'group': GROUPS[0], 'object': thing}, {'group': GROUPS[1], 'object': thing}).p


def _drops(random, sizes, mean):
    """Of each participant at each object; nan: missing."""
    rates = mean * random.gamma(FRAILTY, 1 / FRAILTY, (sum(sizes), 1))
    counts = random.poisson(np.broadcast_to(rates, (sum(sizes), 3))).astype(float)
    counts[random.rand(*counts.shape) < MISSING] = np.nan
    return counts


def _of_counts(wide, labels):
    yield 'permutation: group', permutation.several_groups(wide, labels, profile=False)
    yield 'permutation: object', permutation.levels(wide)
    yield 'permutation: group x object', permutation.several_groups(wide, labels, profile=True)
    groups = [[_known(wide[labels == group, j]) for group in GROUPS] for j in range(wide.shape[1])]
    yield 'permutation, stars for groups at objects', _family([permutation.groups(*pair) for pair in groups])
    yield "Fisher's exact, stars for groups at objects", _family(
        [exact.fisher(pair[0] > 0, pair[1] > 0) for pair in groups])
    yield "classical: Welch's t, one object", pairwise.independent(*groups[0]).p
    yield "classical: Welch's t, stars for groups at objects", _family(
        [pairwise.independent(*pair).p for pair in groups])


def _known(values):
    return values[np.isfinite(values)]


def _of_ratings(random, sizes):
    scores = np.clip(np.rint(random.normal(7.5, 1.2, (sum(sizes), 2))), 0, 10)
    a, b = scores[:sizes[0], 0], scores[sizes[0]:, 0]
    yield 'rank sum, exact: group', pairwise.rank_sum(a, b).p
    yield 'signed rank, exact: condition', pairwise.signed_rank(scores[:, 0], scores[:, 1]).p
    same = np.ptp(np.concatenate([a, b])) == 0
    yield 'classical: rank sum, normal approximation', 1.0 if same else float(
        stats.mannwhitneyu(a, b, alternative='two-sided').pvalue)


def _family(p_values):
    """The least after Bonferroni's correction; nan if none could be tested."""
    corrected = pairwise.bonferroni(p_values)
    return np.nan if np.isnan(corrected).all() else float(np.nanmin(corrected))


def _row(design, studies, key, counts):
    drops, outcome, test = key
    tested, found = counts
    of = exact.share([True] * found + [False] * (studies - found))
    verdict = 'too many' if of.low > ALPHA else 'fewer' if of.high < ALPHA else 'within'
    return collections.OrderedDict(zip(COLUMNS, (
        design, drops, outcome, test, studies, tested, found, round(100 * of.share, 2), round(100 * of.low, 2),
        round(100 * of.high, 2), verdict)))


def as_text(rows):
    """A table in Markdown: a row for each test, a column for each design."""
    designs = list(collections.OrderedDict.fromkeys(row['design'] for row in rows))
    cells = collections.OrderedDict()
    for row in rows:
        mark = '**%.1f**' if row['verdict'] == 'too many' else '%.1f'
        cells.setdefault((row['outcome'], row['drops'], row['test']), {})[row['design']] = mark % row['percent']
    lines = ['| | | ' + ' | '.join(designs) + ' |', '|---' * (2 + len(designs)) + '|']
    for (outcome, drops, test), of_designs in cells.items():
        lines.append('| %s | %s | %s |' % (outcome + (', ' + drops if drops else ''), test, ' | '.join(
            of_designs.get(design, '') for design in designs)))
    return '\n'.join(lines) + '\n'
