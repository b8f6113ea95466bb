"""All sessions together, checked against each other, as tables."""

import collections
import os

import pandas

from .measures import MEASURES, OF
from .session_folder import StudyError, TRIALS

PEOPLE, SIMULATED = 'people', 'simulated operators, no person took part'
HEAD = ['source', 'gravity_g', 'condition', 'participant', 'group', 'handedness']

# `trials` and `ratings` as they were read, with HEAD before their own columns; `cells` has the mean over repetitions
# of each measure for each participant, object and condition; `notes` tells what was left out and why.
StudyData = collections.namedtuple('StudyData', 'trials ratings cells notes')


def gather(sessions):
    _check_participants(sessions)
    notes = [note for session in sessions for note in session.notes]
    trials = _pooled(sessions, 'trials', list(TRIALS))
    ratings = _pooled(sessions, 'ratings', ['question', 'score'])
    if trials.empty and ratings.empty:
        raise StudyError('no trials and no ratings in %d sessions' % len(sessions))
    notes += _notes_on_trials(trials)
    silent = sorted({s.participant for s in sessions if not s.ratings and not s.simulated})
    if silent:
        notes.append('no ratings from %s' % ', '.join(silent))
    return StudyData(trials, ratings, _cells(trials), notes)


def _pooled(sessions, table, columns):
    rows = []
    for session in sessions:
        head = {'source': SIMULATED if session.simulated else PEOPLE, 'gravity_g': session.gravity,
                'participant': session.participant, 'group': session.group, 'handedness': session.handedness,
                'session': session.folder}
        rows += [dict(row, **head) for row in getattr(session, table)]
    return pandas.DataFrame(rows, columns=HEAD + [c for c in columns if c not in HEAD] + ['session'])


def _check_participants(sessions):
    """One group for each participant; one folder for what a participant did in a condition."""
    groups, folders = {}, {}
    for session in sessions:
        who = (session.participant, session.simulated)
        first = groups.setdefault(who, session)
        if first.group != session.group:
            raise StudyError("%s: participant '%s' is a %s here and a %s in %s" % (
                os.path.join(session.folder, 'session.yaml'), session.participant, session.group, first.group,
                os.path.join(first.folder, 'session.yaml')))
        for table in ('trials', 'ratings'):
            for condition in {row['condition'] for row in getattr(session, table)}:
                other = folders.setdefault(who + (session.gravity, table, condition), session.folder)
                if other != session.folder:
                    raise StudyError("%s: %s of participant '%s' in condition '%s' are also in %s" % (
                        os.path.join(session.folder, table + '.csv'), table, session.participant, condition,
                        os.path.join(other, table + '.csv')))


def _notes_on_trials(trials):
    notes = []
    for result, what in (('skipped', 'skipped: left out'), ('aborted', 'aborted: left out'),
                         ('timed_out', 'out of time: counted in attempts, drops, tracking losses and the share '
                                       'completed, left out of times, paths, forces and release')):
        some = trials[trials['result'] == result]
        if len(some):
            notes.append('%d of %d trials %s' % (len(some), len(trials), what))
    return notes


def _cells(trials):
    """Long table: HEAD, object, measure, value, trials (how many the mean is of)."""
    trials = trials.assign(completed=(trials['result'] == 'completed').astype(float))
    keys, tables = HEAD + ['object'], []
    for measure in MEASURES:
        rows = trials[trials['result'].isin(measure.trials)]
        values = pandas.to_numeric(rows[measure.name]).astype(float)
        rows = rows[keys].assign(value=values).dropna(subset=['value'])
        if rows.empty:
            continue
        means = rows.groupby(keys)['value'].agg(['mean', 'size']).reset_index()
        means = means.rename(columns={'mean': 'value', 'size': 'trials'})
        means.insert(len(keys), 'measure', measure.name)
        tables.append(means)
    # Numbers where there is none either: pandas 1.1 takes no mean of what might be anything.
    return pandas.concat(tables, ignore_index=True) if tables else pandas.DataFrame(
        columns=keys + ['measure', 'value', 'trials']).astype({'value': float, 'trials': int})


def parts(data):
    """People and simulated operators, and each gravity, are analysed apart: (source, gravity) pairs."""
    both = pandas.concat([data.trials[['source', 'gravity_g']], data.ratings[['source', 'gravity_g']]])
    return sorted(set(map(tuple, both.values)))


def of_part(table, part):
    return table[(table['source'] == part[0]) & (table['gravity_g'] == part[1])]


def label_of(part):
    source, gravity = part
    return '%g g' % gravity + (', simulated operators' if source == SIMULATED else '')


def file_label(part):
    source, gravity = part
    return ('simulated_' if source == SIMULATED else '') + '%gg' % gravity


def measures_in(cells):
    return [name for name in OF if name in set(cells['measure'])]
