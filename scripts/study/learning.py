"""Learning over blocks (repetitions) and sessions, and retention after a break."""

import collections

import numpy as np
import pandas

from . import mixed_model, permutation
from .measures import CONDITIONS, MEASURES, OF, in_order, shown, with_unit
from .style import INK, colours, finish, new_figure, panel_title, save

CURVES = ('completion_time', 'drops', 'grip_force_mean', 'release_drift')
COLUMNS = ('source', 'gravity_g', 'condition', 'group', 'session', 'block', 'measure', 'n', 'mean', 'sd')
SLOPES = ('source', 'gravity_g', 'condition', 'measure', 'test', 'scale', 'effect', 'n', 'values', 'estimate', 'low', 'high',
          'df', 'p')


def blocks(trials):
    """A row for each participant, condition, session and block, with each measure's mean over the objects. `block`
    continues over the sessions."""
    parts = []
    keys = ['source', 'gravity_g', 'condition', 'group', 'participant', 'session_number', 'repetition']
    for measure in MEASURES:
        if measure.name not in trials.columns:
            continue
        some = trials[trials['result'].isin(measure.trials) & (trials['repetition'] != 0)]
        values = pandas.to_numeric(some[measure.name]).astype(float)
        of_objects = some[keys].assign(value=values, measure=measure.name).dropna(subset=['value'])
        if len(of_objects):
            parts.append(of_objects.groupby(keys + ['measure'])['value'].mean().reset_index())
    if not parts:
        return pandas.DataFrame(columns=keys + ['measure', 'value', 'block'])
    table = pandas.concat(parts, ignore_index=True)
    places = sorted(set(zip(table['session_number'], table['repetition'])))
    number = {place: i for i, place in enumerate(places, 1)}
    return table.assign(block=[number[place] for place in zip(table['session_number'], table['repetition'])])


def curves(table):
    """Mean and standard deviation over the participants of each block."""
    rows = []
    keys = ['source', 'gravity_g', 'condition', 'group', 'session_number', 'block', 'measure']
    for key, some in table.groupby(keys):
        values = some['value'].values
        rows.append(dict(zip(COLUMNS, key + (len(values), values.mean(),
                                             values.std(ddof=1) if len(values) > 1 else np.nan))))
    return pandas.DataFrame(rows, columns=COLUMNS)


def slopes(table):
    """For each condition and measure: the change with each doubling of the blocks (a power law of practice), and the change
    from the last block of a session to the first of the next (retention). Times as ratios; counts by permutation."""
    rows = []
    for key, some in table.groupby(['source', 'gravity_g', 'condition', 'measure']):
        if some['block'].nunique() < 2 or some['participant'].nunique() < 2:
            continue
        if OF[key[3]].kind == 'count':
            rows += [dict(zip(SLOPES, key[:4] + row)) for row in _of_counts(some)]
            continue
        logarithm = OF[key[3]].kind == 'time' and bool((some['value'] > 0).all())
        for effect, contrast, used in _contrasts(some, logarithm):
            shown = np.exp if logarithm else float
            rows.append(dict(zip(SLOPES, key[:4] + (
                'mixed model t', 'ratio' if logarithm else 'difference', effect, used['participant'].nunique(), len(used),
                *[float(shown(x)) for x in (contrast.estimate, contrast.low, contrast.high)], contrast.df, contrast.p))))
    return pandas.DataFrame(rows, columns=SLOPES)


def _columns(some):
    """(effect, rows, predictor that increases by 1)."""
    yield 'each doubling of blocks', some, np.log2(some['block'].values.astype(float))
    sessions = sorted(some['session_number'].unique())
    for before, after in zip(sessions, sessions[1:]):
        last = some[some['session_number'] == before]['block'].max()
        first = some[some['session_number'] == after]['block'].min()
        pair = some[some['block'].isin((last, first))]
        yield ('retention: first of session %d after last of %d' % (after, before), pair,
               (pair['block'] == first).values.astype(float))


def _contrasts(some, logarithm):
    for effect, used, column in _columns(some):
        yield from _fitted(effect, used, column, logarithm)


def _of_counts(some):
    """Each participant's slope; without learning, its sign is random. The interval is from resampled participants."""
    for effect, used, column in _columns(some):
        of_person = [_slope(column[rows], used['value'].values[rows])
                     for rows in used.reset_index(drop=True).groupby('participant').indices.values()]
        own = np.array([slope for slope in of_person if np.isfinite(slope)])
        if len(own) < 2:
            continue
        low, high = permutation.interval_of_mean(own)
        yield ('permutation', 'difference', effect, len(own), len(used), float(own.mean()), low, high, np.nan,
               permutation.pairs(own, np.zeros(len(own))))


def _slope(x, y):
    spread = x - x.mean()
    return np.nan if not np.any(spread) else float(spread @ y / (spread @ spread))


def _fitted(effect, some, column, logarithm):
    values = np.log(some['value'].values) if logarithm else some['value'].values
    try:
        model = mixed_model.fit(values, np.column_stack([np.ones(len(some)), column]), some['participant'].values,
                                {'participant': np.zeros(len(some))})
        yield effect, mixed_model.contrast(model, [0.0, 1.0]), some
    except (ValueError, np.linalg.LinAlgError):
        return


def draw(table, title, source, folder, name):
    """Learning curves: a panel for each measure, a line for each condition and group, a gap between sessions."""
    measures = [measure for measure in CURVES if measure in set(table['measure'])]
    figure, panels = new_figure(len(measures), 3.2, 2.9)
    groups, conditions = sorted(set(table['group'])), in_order(table['condition'], CONDITIONS)
    hues, styles = colours(groups), ('-', '--', ':', '-.')
    for axes, measure in zip(panels.flat, measures):
        for group in groups:
            for i, condition in enumerate(conditions):
                some = table[(table['measure'] == measure) & (table['group'] == group) & (table['condition'] == condition)]
                for _, session in some.groupby('session'):
                    axes.errorbar(session['block'], shown(measure, session['mean']),
                                  shown(measure, session['sd'] / np.sqrt(session['n'])).fillna(0), color=hues[group][1],
                                  linestyle=styles[i % len(styles)], marker='o', markersize=3, capsize=2)
        panel_title(axes, with_unit(OF[measure]))
        axes.set_xlabel('block')
        axes.set_ylim(0, None)
    lines = [axes.plot([], [], color=hues[group][1], label=group)[0] for group in groups]
    lines += [axes.plot([], [], color=INK, linestyle=styles[i % len(styles)], label=condition)[0]
              for i, condition in enumerate(conditions)]
    axes.legend(handles=lines, fontsize=7, frameon=False)
    finish(figure, title, 'Mean of the participants and its standard error. Lines end where a session ends.', source)
    return save(figure, folder, name)


def of_people(table):
    """{(participant, simulated): blocks}, for the page of each."""
    people = collections.OrderedDict()
    for (participant, source), some in table.groupby(['participant', 'source']):
        people[participant, source] = some
    return people
