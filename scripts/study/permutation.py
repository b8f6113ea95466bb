"""Tests that are right for any distribution: what could as well have been otherwise is counted.

All arrangements are gone through where they are few, else seeded random ones are drawn, so that the same data give the
same p-value. Whoever is exchanged keeps what is missing.
"""

import itertools
import math

import numpy as np

MOST_EXACT = 40000  # arrangements
DRAWN = 9999  # with the observed one: p is a multiple of 1 / 10000
BOOTSTRAPPED = 10000  # by code of our own: scipy.stats.bootstrap came with scipy 1.7, and Debian 11 has 1.6.0
SEED = 20231
CLOSE = 1e-9  # statistics that differ by rounding alone are as extreme as each other


def groups(a, b):
    """Two groups' means differ: p. The group's label could be anyone's."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    if len(a) < 1 or len(b) < 1 or len(a) + len(b) < 3:
        return np.nan
    values = np.concatenate([a, b])
    values = values - values.mean()
    n, exact = len(a), math.comb(len(values), len(a)) <= MOST_EXACT
    if exact:
        sums = values[np.array(list(itertools.combinations(range(len(values)), n)))].sum(axis=1)
    else:
        sums = np.concatenate([values[order[:, :n]].sum(axis=1) for order in _orders(len(values))])
    return _share(np.abs(sums), abs(values[:n].sum()), exact)


def pairs(a, b):
    """Two values of the same participants differ: p. Each could have had them the other way round."""
    differences = np.asarray(a, float) - np.asarray(b, float)
    differences = differences[differences != 0]
    if len(a) < 1:
        return np.nan
    if not len(differences):
        return 1.0
    exact = 2 ** len(differences) <= MOST_EXACT
    if exact:
        sums = np.array(list(itertools.product((1, -1), repeat=len(differences)))) @ differences
    else:
        random = np.random.RandomState(SEED)
        sums = np.concatenate([(random.randint(0, 2, (count, len(differences))) * 2 - 1) @ differences
                               for count in _portions(len(differences))])
    return _share(np.abs(sums), abs(differences.sum()), exact)


def levels(table):
    """Levels of a within factor differ (columns; nan: missing): p. Each participant's values could be of any level
    that the participant has."""
    centred, there = _of_levels(table)
    return _share(_drawn(centred, there), np.sum(centred.sum(axis=0) ** 2), False) if len(centred) else np.nan


def explained_by_levels(table):
    """Eta squared: the fraction of the variation within participants that the levels explain."""
    centred, there = _of_levels(table)
    return _fraction(np.sum(centred.sum(axis=0) ** 2 / np.maximum(there.sum(axis=0), 1)), centred)


def _of_levels(table):
    """Deviations from each participant's mean, 0 where missing; and what is there."""
    table = np.asarray(table, float)
    table = table[np.isfinite(table).sum(axis=1) > (1 if table.shape[1] > 1 else np.inf)]
    return np.nan_to_num(table - np.nanmean(table, axis=1, keepdims=True)), np.isfinite(table)


def _fraction(part, rows):
    whole = np.sum(rows ** 2)
    return float(part / whole) if whole > 0 else np.nan


def _drawn(centred, there):
    random, sums = np.random.RandomState(SEED), np.zeros((DRAWN, centred.shape[1]))
    for row, known in zip(centred, there):
        places = np.flatnonzero(known)
        order = np.argsort(random.rand(DRAWN, len(places)), axis=1)
        sums[:, places] += row[places][order]
    return np.sum(sums ** 2, axis=1)


def several_groups(table, labels, profile):
    """Groups differ over the columns of a table with missing values: p. `profile`: not in their levels but in how a
    participant's values differ between the columns (the interaction)."""
    rows, member = _of_groups(table, labels, profile)
    return _groups_of_rows(rows, member) if len(rows) else np.nan


def explained_by_groups(table, labels, profile):
    """Eta squared: the fraction of the variation between participants (`profile`: of their profiles) that groups explain."""
    rows, member = _of_groups(table, labels, profile)
    return _fraction(_between(rows, member), rows)


def _of_groups(table, labels, profile):
    """What is tested of each participant, and of which group each is; nothing where no test can be made."""
    table, labels = np.asarray(table, float), np.asarray(labels)
    known = np.isfinite(table).sum(axis=1) > (1 if profile else 0)
    table, labels = table[known], labels[known]
    names = np.unique(labels)
    if len(names) < 2 or len(table) < 3 or (profile and table.shape[1] < 2):
        return np.zeros((0, 1)), np.zeros((0, 1))
    centred = table - np.nanmean(table, axis=0)
    means = np.nanmean(centred, axis=1, keepdims=True)
    return np.nan_to_num(centred - means) if profile else means, (labels[:, None] == names).astype(float)


def _between(rows, member):
    return np.sum((member.T @ rows) ** 2 / member.sum(axis=0)[:, None])


def _groups_of_rows(rows, member):
    sizes = member.sum(axis=0)
    n = len(rows)
    exact = len(sizes) == 2 and math.comb(n, int(sizes[0])) <= MOST_EXACT
    if exact:
        first = np.zeros((math.comb(n, int(sizes[0])), n))
        chosen = np.array(list(itertools.combinations(range(n), int(sizes[0]))))
        first[np.arange(len(first))[:, None], chosen] = 1.0
        sums = first @ rows
        drawn = np.sum(sums ** 2, axis=1) / sizes[0] + np.sum((rows.sum(axis=0) - sums) ** 2, axis=1) / sizes[1]
    else:
        drawn = np.concatenate([
            np.sum(np.einsum('dng,np->dgp', member[order], rows, optimize=True) ** 2 / sizes[None, :, None], axis=(1, 2))
            for order in _orders(n)])
    return _share(drawn, _between(rows, member), exact)


def _orders(n):
    """Random orders of n, DRAWN altogether."""
    random = np.random.RandomState(SEED)
    for count in _portions(n):
        yield np.argsort(random.rand(count, n), axis=1)


def _portions(n):
    """How many to draw at once, so that there is memory for them."""
    most = max(1, 2000000 // n)
    return [min(most, DRAWN - first) for first in range(0, DRAWN, most)]


def _share(drawn, observed, exact):
    """Of the arrangements those that are as extreme; the observed one is among all of them, and added to a draw."""
    extreme = np.count_nonzero(drawn >= observed - CLOSE * max(1.0, abs(observed)))
    return float(extreme / len(drawn) if exact else (extreme + 1) / (len(drawn) + 1))


def effect_of_groups(a, b):
    """Mean of a over mean of b, or less it where it is 0: name, value, and the 95 % interval that resampled participants give."""
    return _effect(np.asarray(a, float), np.asarray(b, float), False)


def effect_of_pairs(a, b):
    """The same where a and b are of the same participants, who are resampled with both values."""
    return _effect(np.asarray(a, float), np.asarray(b, float), True)


def interval_of_mean(values):
    """The 95 % interval that resampled participants give."""
    random, values = np.random.RandomState(SEED), np.asarray(values, float)
    means = np.concatenate([values[random.randint(0, len(values), (100, len(values)))].mean(axis=1)
                            for _ in range(BOOTSTRAPPED // 100)])
    return tuple(float(limit) for limit in _percentiles(means))


def _effect(a, b, paired):
    if not len(a) or not len(b):
        return 'ratio of means', np.nan, np.nan, np.nan
    is_ratio = b.sum() != 0
    name, of = ('ratio of means', np.divide) if is_ratio else ('difference', np.subtract)
    random = np.random.RandomState(SEED)
    means = [_resampled(random, a, b, paired) for _ in range(BOOTSTRAPPED // 100)]
    with np.errstate(divide='ignore', invalid='ignore'):
        effects = of(*(np.concatenate(part) for part in zip(*means)))
    effects = effects[~np.isnan(effects)]
    low, high = _percentiles(effects) if _finite_enough(effects) else (np.nan, np.nan)
    return name, float(of(a.mean(), b.mean())), float(low), float(high)


def _finite_enough(effects):
    return len(effects) and np.isfinite(effects).mean() > 0.975


def _percentiles(effects):
    """Of a sorted list, without a mean of neighbours, one of which may be infinite."""
    effects = np.sort(effects)
    return [effects[int(round(share * (len(effects) - 1)))] for share in (0.025, 0.975)]


def _resampled(random, a, b, paired):
    """Means of 100 resamples of each."""
    of_a = random.randint(0, len(a), (100, len(a)))
    of_b = of_a if paired else random.randint(0, len(b), (100, len(b)))
    return a[of_a].mean(axis=1), b[of_b].mean(axis=1)
