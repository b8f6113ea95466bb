"""Power, by simulated studies with a pilot's participants."""

import collections
import re

import numpy as np
import pandas

from . import exact, permutation
from .linear import Model
from .measures import CONDITIONS, GROUPS, OBJECTS, OF, in_order, is_tested
from .session_folder import find_sessions, read_session
from .study_data import gather, parts

DRAWN = 999  # arrangements: enough for p < 0.05
ALPHA = 0.05
SIZES = {'group': ('5v5', '10v10', '15v15', '20v20', '30v30'), 'condition': ('5', '10', '15', '20', '30')}


class Pilot:
    """The participants from whom studies are drawn. Raises ValueError for an analysis that they do not allow."""

    def __init__(self, given):
        self.given, self.cells = given, _cells(given)
        self.levels = in_order(self.cells[given.effect], GROUPS if given.effect == 'group' else CONDITIONS)
        if len(self.levels) != 2:
            raise ValueError('the pilot has %d levels of %s (%s); allowed: 2' % (
                len(self.levels), given.effect, ', '.join(self.levels)))
        if not 1 <= given.studies <= 100000:
            raise ValueError('--studies %d is not allowed; allowed: 1 to 100000' % given.studies)
        if given.ratio is not None:
            self.cells = _with_ratio(self.cells, given.effect, self.levels, given.ratio)
        self.sizes = [(size, _counts(size, given.effect)) for size in given.size or SIZES[given.effect]]

    def rows(self):
        """(size, studies, found, percent, lower and upper limit of its exact 95 % interval), each as soon as it is known."""
        studies = self.given.studies
        for size, counts in self.sizes:
            found = sum(self._p(counts, i) < ALPHA for i in range(studies))
            share = exact.share([True] * found + [False] * (studies - found))
            yield (size, studies, found, *[100 * x for x in (share.share, share.low, share.high)])

    def _p(self, counts, i):
        random = np.random.RandomState([self.given.seed, i])
        drawn = _drawn(self.cells, self.given.effect, self.levels, counts, random)
        before, permutation.DRAWN = permutation.DRAWN, DRAWN
        try:
            return _p(drawn, self.given.effect, self.levels, OF[self.given.measure])
        finally:
            permutation.DRAWN = before


def _cells(given):
    data = gather([read_session(folder) for folder in find_sessions(given.folders)])
    if len(parts(data)) != 1:
        raise ValueError('the pilot has people and simulated operators, or several gravities; allowed: one of each')
    cells = data.cells[(data.cells['measure'] == given.measure) & data.cells['condition'].map(is_tested).astype(bool)]
    if cells.empty:
        raise ValueError('the pilot has no values of ' + given.measure)
    return cells


def _with_ratio(cells, effect, levels, ratio):
    """Data with equal means of the levels, then scaled by `ratio`. Counts are thinned or repeated on average."""
    if not 0.01 <= ratio <= 100:
        raise ValueError('--ratio %g is not allowed; allowed: 0.01 to 100' % ratio)
    means = cells.groupby(effect)['value'].mean()
    if (means <= 0).any():
        raise ValueError('the pilot has a mean of 0: no ratio can be put to it')
    factor = {levels[0]: 1.0, levels[1]: ratio * means[levels[0]] / means[levels[1]]}
    return cells.assign(value=cells['value'] * cells[effect].map(factor))


def _counts(size, effect):
    match = re.fullmatch(r'(\d{1,4})v(\d{1,4})' if effect == 'group' else r'(\d{1,4})', size)
    if not match or min(map(int, match.groups())) < 2:
        raise ValueError("--size '%s' is not allowed; allowed: %s" % (size, '10v10' if effect == 'group' else '10'))
    return [int(text) for text in match.groups()]


def _drawn(cells, effect, levels, counts, random):
    """Participants with replacement; one that is drawn twice counts as two people."""
    pools = ([list(dict.fromkeys(cells[cells['group'] == level]['participant'])) for level in levels]
             if effect == 'group' else [list(dict.fromkeys(cells['participant']))])
    of_person = dict(list(cells.groupby('participant')))
    drawn = [of_person[pool[i]].assign(participant='%d.%d' % (k, j)) for k, (pool, count) in
             enumerate(zip(pools, counts)) for j, i in enumerate(random.randint(0, len(pool), count))]
    return pandas.concat(drawn, ignore_index=True)


def _p(cells, effect, levels, measure):
    if measure.kind == 'count':
        if effect == 'group':
            wide = cells.pivot_table(index=['group', 'participant'], columns='object', values='value')
            return permutation.several_groups(wide.values, wide.index.get_level_values('group'), profile=False)
        wide = cells.pivot_table(index='participant', columns=effect, values='value')
        return permutation.levels(wide.values)
    factors = collections.OrderedDict((name, in_order(cells[name], known)) for name, known in (
        ('group', GROUPS), ('object', OBJECTS), ('condition', CONDITIONS)))
    try:
        model = Model(cells, factors, logarithm=measure.kind == 'time' and bool((cells['value'] > 0).all()))
        return dict(model.effects())[(effect,)].p
    except (ValueError, KeyError, np.linalg.LinAlgError):
        return 1.0
