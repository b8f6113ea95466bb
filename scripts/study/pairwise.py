"""Comparisons of two samples with effect sizes, and Bonferroni's correction over a family of them."""

import collections

import numpy as np
from scipy import stats
from statsmodels.stats.weightstats import DescrStatsW, ttest_ind

from . import exact, permutation

# `effect` is of the kind `effect_name`, with the 95 % interval from `low` to `high`; `difference` is a's mean (or
# median) less b's. nan: cannot be computed.
Comparison = collections.namedtuple('Comparison', 'test n_a n_b centre_a centre_b difference statistic df p '
                                                  'effect_name effect low high')
Comparison.__new__.__defaults__ = (np.nan, np.nan)


def independent(a, b):
    """Welch's t-test; Cohen's d with the pooled standard deviation."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    results = [np.nan] * 3
    if min(len(a), len(b)) > 1 and max(np.ptp(a), np.ptp(b)) > 0:
        results = ttest_ind(a, b, usevar='unequal')
    statistic, p, df = results
    return _of_means('Welch t', a, b, statistic, df, p, "Cohen's d", cohens_d(a, b) if p == p else np.nan)


def paired(a, b):
    """Student's paired t-test; d_z, the mean difference over the differences' standard deviation."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    results, effect = [np.nan] * 3, np.nan
    if len(a) > 1 and np.ptp(a - b) > 0:
        differences = DescrStatsW(a - b, ddof=1)
        results, effect = differences.ttest_mean(), differences.mean / differences.std
    statistic, p, df = results
    return _of_means('paired t', a, b, statistic, df, p, 'd_z', effect)


def counts_of_groups(a, b):
    """Permutation test; the effect is the ratio of the means, or their difference where b has only zeros."""
    return _of_counts(a, b, permutation.groups, permutation.effect_of_groups)


def counts_of_pairs(a, b):
    return _of_counts(a, b, permutation.pairs, permutation.effect_of_pairs)


def _of_counts(a, b, test, effect):
    a, b = np.asarray(a, float), np.asarray(b, float)
    p = test(a, b) if len(a) and len(b) else np.nan
    return _of_means('permutation', a, b, np.nan, np.nan, p, *effect(a, b))


def modelled(a, b, difference, logarithm):
    """`difference`: a contrast of a mixed model, or None; `a` and `b`: what there is to be seen of it."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    name = 'ratio of geometric means' if logarithm else 'difference'
    if difference is None:
        return _of_means('mixed model t', a, b, np.nan, np.nan, np.nan, name, np.nan)
    shown = np.exp if logarithm else float
    return _of_means('mixed model t', a, b, difference.estimate / difference.se, difference.df, difference.p, name,
                     *[float(shown(x)) for x in (difference.estimate, difference.low, difference.high)])


def cohens_d(a, b):
    pooled = ((len(a) - 1) * np.var(a, ddof=1) + (len(b) - 1) * np.var(b, ddof=1)) / (len(a) + len(b) - 2)
    return (np.mean(a) - np.mean(b)) / np.sqrt(pooled)


def signed_rank(a, b):
    """Wilcoxon's signed-rank test for paired ranks or ratings; the effect is the matched rank-biserial correlation."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    differences = a - b
    differences = differences[differences != 0]
    statistic = p = effect = np.nan
    if len(differences):
        ranks = stats.rankdata(np.abs(differences))
        effect = float(np.sum(np.sign(differences) * ranks) / np.sum(ranks))
        statistic = float(min(np.sum(ranks[differences > 0]), np.sum(ranks[differences < 0])))
        p = _signed_rank_p(ranks, statistic)
    elif len(a):
        p, effect = 1.0, 0.0
    return _of_medians('signed rank', a, b, statistic, p, effect)


def _signed_rank_p(ranks, smaller):
    """Exact, ties included: the share of all sign patterns with a rank sum as small; every one has the same chance."""
    doubled = np.rint(2 * ranks).astype(int)  # ranks of ties are halves
    ways = np.zeros(doubled.sum() + 1)
    ways[0] = 1.0
    for rank in doubled:
        ways[rank:] = (ways[rank:] + ways[:-rank]) / 2
        ways[:rank] /= 2
    return float(min(1.0, 2 * ways[:int(round(2 * smaller)) + 1].sum()))


def rank_sum(a, b):
    """Mann and Whitney's test for two groups, exact with ties; the effect is the rank-biserial correlation."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    statistic = p = effect = np.nan
    if len(a) and len(b):
        ranks = stats.rankdata(np.concatenate([a, b]))
        statistic = float(np.sum(ranks[:len(a)]) - len(a) * (len(a) + 1) / 2)
        effect = 2 * statistic / (len(a) * len(b)) - 1
        same = np.ptp(ranks) == 0
        p = 1.0 if same else exact.rank_sum_p(ranks, len(a))
    return _of_medians('rank sum', a, b, statistic, p, effect)


def bonferroni(p_values):
    """Each multiplied by how many there are, at most 1; those that could not be computed do not count."""
    p_values = np.asarray(p_values, float)
    return np.minimum(1.0, p_values * np.isfinite(p_values).sum())


def stars(p):
    """As in the paper's figures: * below 0.05, ** below 0.01, *** below 0.001."""
    return '*' * sum(p < level for level in (0.05, 0.01, 0.001))


def _of_means(test, a, b, *rest):
    centres = [float(np.mean(x)) if len(x) else np.nan for x in (a, b)]
    return Comparison(test, len(a), len(b), *centres, centres[0] - centres[1], *map(_plain, rest))


def _of_medians(test, a, b, statistic, p, effect):
    centres = [float(np.median(x)) if len(x) else np.nan for x in (a, b)]
    return Comparison(test, len(a), len(b), *centres, centres[0] - centres[1], statistic, np.nan, p,
                      'rank-biserial r', effect)


def _plain(value):
    return value if isinstance(value, str) else float(value)
