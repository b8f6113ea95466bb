"""Exact tests of ranks, and of who had any: with ties, and where all of one group differ from all of the other."""

import collections

import numpy as np
from scipy import stats
from statsmodels.stats import contingency_tables
from statsmodels.stats.proportion import proportion_confint

# How many of `n` had any, and the exact (Clopper and Pearson's) 95 % interval of their share.
Share = collections.namedtuple('Share', 'had n share low high')


def rank_sum_p(ranks, size):
    """Two-sided: the share of all ways to choose `size` of the ranks with a sum as far from the mean. Exact with ties."""
    doubled = np.rint(2 * np.asarray(ranks)).astype(int)  # ranks of ties are halves
    ways = np.zeros((size + 1, doubled.sum() + 1))
    ways[0, 0] = 1.0
    for count, rank in enumerate(doubled):
        for k in range(min(size, count + 1), 0, -1):
            ways[k, rank:] += ways[k - 1, :ways.shape[1] - rank]
    sums = np.arange(ways.shape[1]) - size * doubled.sum() / len(doubled)
    observed = abs(doubled[:size].sum() - size * doubled.sum() / len(doubled))
    return float(min(1.0, ways[size][np.abs(sums) >= observed - 1e-9].sum() / ways[size].sum()))


def share(had):
    had = np.asarray(had, bool)
    n, k = len(had), int(had.sum())
    return Share(k, n, *(k / n, *proportion_confint(k, n, method='beta')) if n else [np.nan] * 3)


def fisher(a, b):
    """Fisher's exact test: the shares of two groups who had any differ."""
    if not len(a) or not len(b):
        return np.nan
    return float(stats.fisher_exact([[np.sum(had), len(had) - np.sum(had)] for had in (a, b)])[1])


def mcnemar(a, b):
    """McNemar's exact test: of the same participants, more had any under a than under b."""
    a, b = np.asarray(a, bool), np.asarray(b, bool)
    if not len(a):
        return np.nan
    only_a, only_b = np.sum(a & ~b), np.sum(~a & b)  # statsmodels gives more than 1 where they are equal
    return min(1.0, float(contingency_tables.mcnemar([[0, only_a], [only_b, 0]], exact=True).pvalue))
