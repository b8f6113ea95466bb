"""Analysis of variance: participants in groups (between), each measured at every level of one factor (within)."""

import collections

import numpy as np
from scipy import stats

ALPHA = 0.05
TRUST_HUYNH_FELDT = 0.75  # above this Greenhouse-Geisser epsilon (Girden 1992)
ROUNDING = 1e-20  # of the sum of squares: a smaller fraction counts as no variation

# Mauchly's test and the estimates of epsilon; nan where the sample does not determine them.
Sphericity = collections.namedtuple('Sphericity', 'w chi_squared df p greenhouse_geisser huynh_feldt')

# A test of one effect; `name` is group, within or interaction. `p` is what to report: with the df multiplied by
# `epsilon` if sphericity is violated, by `correction`; the other p-values are always given.
Effect = collections.namedtuple('Effect', 'name ss df ss_error df_error f p epsilon correction p_uncorrected '
                                          'p_greenhouse_geisser p_huynh_feldt partial_eta_squared')

Anova = collections.namedtuple('Anova', 'effects sphericity n')


def mixed_anova(values, groups):
    """`values`: a row for each participant, a column for each level; `groups`: a label for each row.

    Groups of different sizes have equal weight in the test of the within factor (type III sums of squares). With one
    group or one level, effects that need more are left out. Raises ValueError if no error can be estimated.
    """
    values, groups = np.asarray(values, float), np.asarray(groups)
    if values.ndim != 2 or len(values) != len(groups) or not np.isfinite(values).all():
        raise ValueError('values must be a full table with a group for each row')
    labels, n, levels = np.unique(groups), len(values), values.shape[1]
    df_error = n - len(labels)
    if df_error < 1:
        raise ValueError('no group has two participants')
    design = np.column_stack([groups == label for label in labels]).astype(float)
    size = np.sum(values ** 2)
    effects, sphericity = [], None
    if len(labels) > 1:
        means = values.mean(axis=1, keepdims=True) * np.sqrt(levels)
        effects.append(_effect('group', _between(len(labels)), design, means, df_error, size, None))
    if levels > 1:
        contrasts = values @ _orthonormal_contrasts(levels)
        sphericity = _sphericity(_residuals(design, contrasts), df_error)
        everyone_alike = np.full((1, len(labels)), 1 / len(labels))
        effects.append(_effect('within', everyone_alike, design, contrasts, df_error, size, sphericity))
        if len(labels) > 1:
            effects.append(_effect('interaction', _between(len(labels)), design, contrasts, df_error, size,
                                   sphericity))
    return Anova(effects, sphericity, n)


def _orthonormal_contrasts(levels):
    """Columns that are orthogonal to the mean and to each other; results do not depend on the choice."""
    basis, _ = np.linalg.qr(np.column_stack([np.ones(levels), np.eye(levels)[:, 1:]]))
    return basis[:, 1:]


def _between(groups):
    return np.column_stack([np.ones(groups - 1), -np.eye(groups - 1)])


def _residuals(design, responses):
    coefficients = np.linalg.lstsq(design, responses, rcond=None)[0]
    return responses - design @ coefficients


def _effect(name, hypothesis, design, responses, df_error, size, sphericity):
    """The univariate test of hypothesis * coefficients = 0 over all responses together."""
    coefficients = np.linalg.lstsq(design, responses, rcond=None)[0]
    tested = hypothesis @ coefficients
    spread = hypothesis @ np.linalg.inv(design.T @ design) @ hypothesis.T
    ss = float(np.trace(tested.T @ np.linalg.solve(spread, tested)))
    ss_error = float(np.sum(_residuals(design, responses) ** 2))
    width = responses.shape[1]
    df, df_error = len(hypothesis) * width, df_error * width
    if ss_error <= ROUNDING * size:
        return Effect(name, ss, df, ss_error, df_error, np.nan, np.nan, 1.0, 'none', *[np.nan] * 4)
    f = (ss / df) / (ss_error / df_error)

    def p_of(epsilon):
        return float(stats.f.sf(f, epsilon * df, epsilon * df_error))

    gg, hf = (sphericity.greenhouse_geisser, sphericity.huynh_feldt) if sphericity else (1.0, 1.0)
    epsilon, correction = _choose_correction(sphericity, width)
    return Effect(name, ss, df, ss_error, df_error, f, p_of(epsilon), epsilon, correction, p_of(1.0), p_of(gg),
                  p_of(hf), ss / (ss + ss_error))


def _choose_correction(sphericity, width):
    if sphericity is None or width == 1 or sphericity.p >= ALPHA:
        return 1.0, 'none'
    if sphericity.greenhouse_geisser > TRUST_HUYNH_FELDT:
        return sphericity.huynh_feldt, 'Huynh-Feldt'
    return sphericity.greenhouse_geisser, 'Greenhouse-Geisser'  # also if the sample is too small for the test


def _sphericity(residuals, df_error):
    p = residuals.shape[1]
    if p == 1:
        return Sphericity(1.0, 0.0, 0, 1.0, 1.0, 1.0)
    covariance = residuals.T @ residuals / df_error
    trace, trace_of_square = np.trace(covariance), np.sum(covariance ** 2)
    if trace <= 0:
        return Sphericity(*[np.nan] * 3, np.nan, 1.0, 1.0)
    gg = min(1.0, trace ** 2 / (p * trace_of_square))
    # Huynh and Feldt's estimate with the error's degrees of freedom (Lecoutre 1991), valid for several groups too.
    below = p * (df_error - p * gg)
    hf = min(1.0, max(gg, ((df_error + 1) * p * gg - 2) / below)) if below > 0 else 1.0
    return Sphericity(*_mauchly(covariance, df_error), gg, hf)


def _mauchly(covariance, df_error):
    """W, chi-squared, df and p (Mauchly 1940; p with Box's second-order term, as in Anderson 2003, 10.7.4)."""
    p, n = len(covariance), df_error
    df = p * (p + 1) // 2 - 1
    w = np.linalg.det(covariance) / (np.trace(covariance) / p) ** p
    if n < p or not w > 0:
        return np.nan, np.nan, df, np.nan
    shrink = 1 - (2 * p * p + p + 2) / (6 * p * n)
    second = (p + 2) * (p - 1) * (p - 2) * (2 * p ** 3 + 6 * p * p + 3 * p + 2) / (288 * (p * n * shrink) ** 2)
    chi_squared = -n * shrink * np.log(w)
    first_tail, second_tail = stats.chi2.sf(chi_squared, df), stats.chi2.sf(chi_squared, df + 4)
    return float(w), float(chi_squared), df, float(min(1.0, first_tail + second * (second_tail - first_tail)))
