"""Exact tests of ranks, and of who had any: with ties, and where all of one group differ from all of the other."""

import collections

import numpy as np
from scipy import stats

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
    if n == 0:
        return Share(0, 0, np.nan, np.nan, np.nan)
    low = stats.beta.ppf(0.025, k, n - k + 1) if k else 0.0
    high = stats.beta.ppf(0.975, k + 1, n - k) if k < n else 1.0
    return Share(k, n, k / n, float(low), float(high))


def fisher(a, b):
    """Fisher's exact test: the shares of two groups who had any differ."""
    a, b = share(a), share(b)
    if not a.n or not b.n:
        return np.nan
    return float(stats.fisher_exact([[a.had, a.n - a.had], [b.had, b.n - b.had]])[1])


def mcnemar(a, b):
    """McNemar's exact test: of the same participants, more had any under a than under b."""
    a, b = np.asarray(a, bool), np.asarray(b, bool)
    if not len(a):
        return np.nan
    only_a, only_b = int(np.sum(a & ~b)), int(np.sum(~a & b))
    return float(min(1.0, 2 * stats.binom.cdf(min(only_a, only_b), only_a + only_b, 0.5)))
