"""All sessions as tables, checked against each other."""

import collections
import os

import pandas

from .measures import MEASURES, OF
from .questions import NASA_TLX, SUS, derived
from .session_folder import ADDED, StudyError, TRIALS

PEOPLE, SIMULATED = 'people', 'simulated operators, no person took part'
PLACES = ['order', 'period', 'session_number']  # position of the trial in its session, and of the session among all
HEAD = ['source', 'gravity_g', 'condition', 'participant', 'group', 'handedness']

# `trials` and `ratings` as they were read, with HEAD before their own columns; `cells` has the mean over repetitions
# of each measure for each participant, object and condition; `notes` says what was left out and why.
StudyData = collections.namedtuple('StudyData', 'trials ratings cells notes')


def gather(sessions):
    sessions = _with_seeds(sessions)
    _check_tasks(sessions)
    _check_participants(sessions)
    periods = _periods(sessions)
    notes = [note for session in sessions for note in session.notes]
    for simulated in (False, True):
        tasks = sorted({s.task for s in sessions if s.simulated == simulated} - {''})
        if len(tasks) > 1:
            notes.append('the tasks differ between gravities: %s' % ', '.join(tasks))
    trials = _pooled(sessions, periods, 'trials', list(TRIALS) + list(ADDED) + PLACES)
    ratings = _with_scales(_pooled(sessions, periods, 'ratings', ['question', 'score']))
    if trials.empty and ratings.empty:
        raise StudyError('no trials and no ratings in %d sessions' % len(sessions))
    notes += _notes_on_trials(trials)
    silent = sorted({s.participant for s in sessions if not s.ratings and not s.simulated})
    if silent:
        notes.append('no ratings from %s' % ', '.join(silent))
    practice = (trials['repetition'] == 0).sum()
    if practice:
        notes.append('%d trials were practice: left out of all but the table of trials' % practice)
    return StudyData(trials, ratings, _cells(trials[trials['repetition'] != 0]), notes)


def _with_scales(ratings):
    """Replaces single questions by the scores of NASA-TLX and SUS."""
    if ratings.empty:
        return ratings
    rows = []
    for _, some in ratings.groupby(['session', 'condition'], sort=False):
        scores = dict(zip(some['question'], some['score']))
        head = some.iloc[0].to_dict()
        rows += [dict(head, question=question, score=score) for question, score in derived(scores).items()]
    single = ratings[~ratings['question'].isin(list(NASA_TLX) + list(SUS))]
    return pandas.DataFrame(single.to_dict('records') + rows, columns=ratings.columns)


def _with_seeds(sessions):
    """Distinguishes simulated operators by their seeds."""
    if len({s.seed for s in sessions if s.simulated}) < 2:
        return sessions
    return [s._replace(participant='%s seed %d' % (s.participant, s.seed)) if s.simulated else s for s in sessions]


def _check_tasks(sessions):
    """Checks that sessions that are analysed together have one task."""
    of_part = collections.defaultdict(dict)
    for session in sessions:
        if session.task:  # older sessions do not say
            of_part[session.simulated, session.gravity].setdefault(session.task, []).append(session.folder)
    for tasks in of_part.values():
        if len(tasks) > 1:
            raise StudyError('sessions of different tasks: %s; allowed: sessions of one task' % ', '.join(
                "'%s' (%s%s)" % (task, folders[0], ' and %d more' % (len(folders) - 1) if folders[1:] else '')
                for task, folders in sorted(tasks.items())))


def _periods(sessions):
    """Position of each session among those of its participant, from 1, by start time; nan if unknown."""
    of_person = collections.defaultdict(list)
    for session in sessions:
        of_person[session.participant, session.simulated].append(session)
    periods = {}
    for some in of_person.values():
        known = len({s.started for s in some} - {''}) == len(some)
        for place, session in enumerate(sorted(some, key=lambda s: (s.started, s.folder)), 1):
            periods[session.folder] = place if known else float('nan')
    return periods


def _pooled(sessions, periods, table, columns):
    rows = []
    for session in sessions:
        head = {'source': SIMULATED if session.simulated else PEOPLE, 'gravity_g': session.gravity,
                'participant': session.participant, 'group': session.group, 'handedness': session.handedness,
                'session': session.folder}
        place = {'period': periods[session.folder], 'session_number': session.session}
        rows += [dict(row, order=order, **place, **head) for order, row in enumerate(getattr(session, table), 1)]
    return pandas.DataFrame(rows, columns=HEAD + [c for c in columns if c not in HEAD] + ['session'])


def _check_participants(sessions):
    """Checks that each participant has one group, and one folder for each condition."""
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
                key = who + (session.gravity, table, condition, session.session)
                other = folders.setdefault(key, session.folder)
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
    """Long table: HEAD, object, measure, value, order and period (means too), trials (how many the mean is of)."""
    trials = trials.assign(completed=(trials['result'] == 'completed').astype(float))
    keys, tables = HEAD + ['object'], []
    for measure in MEASURES:
        rows = trials[trials['result'].isin(measure.trials)]
        values = pandas.to_numeric(rows[measure.name]).astype(float)
        rows = rows[keys + PLACES[:2]].assign(value=values).dropna(subset=['value'])
        if rows.empty:
            continue
        of_cells = rows.groupby(keys)
        means = of_cells[['value'] + PLACES[:2]].mean()
        means = means.assign(trials=of_cells.size()).reset_index()
        means.insert(len(keys), 'measure', measure.name)
        tables.append(means)
    # Numeric type also for empty columns: pandas 1.1 computes no mean of objects.
    return pandas.concat(tables, ignore_index=True) if tables else pandas.DataFrame(
        columns=keys + ['measure', 'value'] + PLACES[:2] + ['trials']).astype({'value': float, 'trials': int})


def parts(data):
    """People and simulated operators, and each gravity, are analysed apart: (source, gravity) pairs."""
    return sorted({tuple(row) for table in (data.trials, data.ratings) for row in table[['source', 'gravity_g']].values})


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
