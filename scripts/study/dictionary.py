"""The data dictionary: meaning, unit and allowed values of each column of each table."""

import pandas

from .demographics import CHOICES
from .measures import OF
from .questions import ALL, SCALES, scale_of

COMMON = {
    'source': ('people, or simulated operators', ''), 'gravity_g': ('strength of gravity', 'g'),
    'condition': ("the system, as the session's header says; all: over all conditions", ''),
    'participant': ('who', ''), 'group': ('group of participants', ''), 'handedness': ('right, left, unknown', ''),
    'object': ('what was handled', ''), 'measure': ('name of the measure; each has a row here', ''),
    'unit': ('of the values', ''), 'n': ('participants', ''), 'mean': ('over participants', "the measure's"),
    'sd': ('standard deviation over participants', "the measure's"),
    'ci95': ("half the width of the mean's 95 % confidence interval", "the measure's"),
    'quantity': ('measure or question', ''), 'within': ('factor within participants', ''),
    'effect': ('factor or interaction; in tables of pairs the size of the effect', ''),
    'test': ('how it was tested', ''), 'scale': ('logarithm, as it is; ratio, difference', ''),
    'values': ('how many went in', ''), 'statistic': ("F, t, or the rank statistic", ''),
    'df': ('degrees of freedom', ''), 'df_error': ("the error's degrees of freedom", ''), 'p': ('p-value', ''),
    'terms': ('fixed effects of the model, with its covariates', ''),
    'variances': ('variance components of the model', "the scale's, squared"),
    'at': ('where the pair is compared: at an object, objects, conditions, all objects', ''),
    'a': ('first of the pair', ''), 'b': ('second of the pair', ''), 'n_a': ('participants of a', ''),
    'n_b': ('participants of b', ''), 'had_a': ('participants of a who had any', ''),
    'had_b': ('participants of b who had any', ''), 'low_a': ("exact 95 % interval of a's share, lower limit", ''),
    'high_a': ("exact 95 % interval of a's share, upper limit", ''),
    'low_b': ("exact 95 % interval of b's share, lower limit", ''),
    'high_b': ("exact 95 % interval of b's share, upper limit", ''),
    'centre_a': ('mean (ratings: median) of a', "the measure's"), 'centre_b': ('the same of b', "the measure's"),
    'difference': ('centre_a less centre_b', "the measure's"), 'comparisons': ('in the family', ''),
    'p_bonferroni': ('p times comparisons, at most 1', ''), 'stars': ('* below 0.05, ** 0.01, *** 0.001', ''),
    'effect_name': ('what the effect is: ratio, difference, d, d_z, rank-biserial r', ''),
    'low': ('95 % interval, lower limit', ''), 'high': ('95 % interval, upper limit', ''),
    'f': ('F', ''), 'epsilon': ('factor of the degrees of freedom', ''), 'correction': ('of sphericity', ''),
    'p_uncorrected': ('without correction', ''), 'p_greenhouse_geisser': ('with that correction', ''),
    'p_huynh_feldt': ('with that correction', ''), 'partial_eta_squared': ('effect size: fraction of the variation that the effect explains', ''),
    'w': ("Mauchly's W", ''), 'chi_squared': ('its approximation', ''),
    'greenhouse_geisser': ('epsilon', ''), 'huynh_feldt': ('epsilon', ''), 'question': ('name of the question', ''),
    'median': ('of the scores', ''), 'quartile_1': ('of the scores', ''), 'quartile_3': ('of the scores', ''),
    'trial': ("the trial's number in its session", ''), 'repetition': ('of this object; 0: practice', ''),
    'result': ('completed, skipped, timed_out, aborted', ''), 'start': ("since the session's start", 's'),
    'attempts': ('the old name of grasps', ''), 'order': ('place of the trial in its session, from 1', ''),
    'period': ("place of the session among the participant's, by its start, from 1", ''),
    'session_number': ('of this participant, condition and task, from 1', ''), 'session': ('folder, or its number', ''),
    'block': ('repetitions counted on over sessions, from 1', ''), 'estimate': ('of the effect', ''),
    'value': ('of the measure or answer', "the measure's"), 'age': ('at the first session', 'years'),
    'consent': ('given in writing', ''), 'consent_form': ('name and version of the form', ''),
    'consent_time': ('when it was noted, UTC', ''), 'table': ('file without .csv', ''), 'column': ('in that table', ''),
    'touches': ('times that a hand began to touch an object or a fixture', ''),
    'arrival_speed': ("of the last goal rest's body as it first came within the tolerance", 'm/s'),
    'misplacement': ("distance of that body from the goal's position as the goal was achieved", 'm'),
    'misalignment': ("angle of that body from the goal's orientation as the goal was achieved", 'rad'),
    'operator_speed': ("of the operator's body at the trial's end", 'm/s'),
    'operator_spin': ("of the operator's body at the trial's end", 'rad/s'),
    'meaning': ('of the column', ''), 'completed': ('1: completed', ''),
}


def table(tables):
    """Rows for each column of `tables`, then for each measure and question."""
    rows = []
    for name, frame in tables.items():
        rows += [dict(table=name, column=column, **_of(column)) for column in frame.columns]
    rows += [dict(table='data_dictionary', column=column, **_of(column)) for column in COLUMNS]
    rows += [{'table': 'measures', 'column': m.name, 'meaning': m.label + '; counts from trials ' + ', '.join(m.trials),
              'unit': m.unit} for m in OF.values()]
    rows += [{'table': 'questions', 'column': name, 'meaning': asked.text, 'unit': scale_of(name)}
             for name, asked in ALL.items()]
    rows += [{'table': 'questions', 'column': name, 'meaning': 'scale', 'unit': unit} for name, unit in SCALES.items()]
    return pandas.DataFrame(rows, columns=COLUMNS)


COLUMNS = ('table', 'column', 'meaning', 'unit')


def _of(column):
    if column in OF and column != 'completed':
        return {'meaning': OF[column].label, 'unit': OF[column].unit}
    if column in CHOICES and column != 'handedness':
        return {'meaning': ', '.join(CHOICES[column]), 'unit': ''}
    meaning, unit = COMMON.get(column, ('', ''))
    return {'meaning': meaning, 'unit': unit}
