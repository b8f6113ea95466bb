"""The schedule: balanced orders of conditions, days, and the command of each session."""

import collections
import csv
import datetime
import random
import re

from .measures import TRAINING

COLUMNS = ('participant', 'group', 'place', 'date', 'time', 'day', 'step', 'phase', 'condition', 'task', 'session', 'seed',
           'run', 'afterwards')
NAME = re.compile(r'[A-Za-z0-9][A-Za-z0-9_.-]{0,63}')
MOST = 1000


def rows(given):
    """Rows of the plan. Raises ValueError that says what is allowed."""
    groups = [_group(text) for text in given.group]
    for name in given.condition + [given.task]:
        _name(name)
    if len(set(given.condition)) < len(given.condition):
        raise ValueError('a condition is given twice; allowed: each once')
    if not 1 <= given.sessions <= 100 or not 0 <= given.days_between <= 365:
        raise ValueError('allowed: 1 to 100 sessions, 0 to 365 days between them')
    slots = [_time(text) for text in given.slots.split(',')]
    made, people = [], _people(groups)
    orders = _orders(people, given)
    for place, (participant, group) in enumerate(people):
        for day in range(1, given.sessions + 1):
            date = _date(given, place, day, len(slots))
            for step, (phase, condition) in enumerate(_steps(given, group, orders[participant], day), 1):
                made.append(_row(given, participant, group, place + 1, date, slots[place % len(slots)], day, step, phase,
                                 condition))
    return made


def _group(text):
    name, _, count = text.rpartition(':')
    if not count.isdigit() or not 1 <= int(count) <= MOST:
        raise ValueError("--group '%s' is not allowed; allowed: NAME:N, N from 1 to %d" % (text, MOST))
    return _name(name), int(count)


def _name(text):
    if not NAME.fullmatch(text):
        raise ValueError("'%s' is not allowed; allowed: a name of letters, digits, '_', '-' and '.'" % text)
    return text


def _time(text):
    try:
        return datetime.datetime.strptime(text.strip(), '%H:%M').strftime('%H:%M')
    except ValueError:
        raise ValueError("slot '%s' is not a time such as 09:30" % text) from None


def _people(groups):
    """Participants with numbers, groups in turn, so that groups do not differ in the time of the year."""
    left, people = collections.OrderedDict(groups), []
    while any(left.values()):
        for group in left:
            if left[group]:
                left[group] -= 1
                people.append(('P%02d' % (len(people) + 1), group))
    return people


def _orders(people, given):
    """Orders of conditions: within each group, each order of a balanced square equally often, shuffled by the seed."""
    orders = {}
    for group in dict.fromkeys(group for _, group in people):
        some = [participant for participant, of in people if of == group]
        square = balanced_square(given.condition) if given.procedure == 'counterbalanced' else [list(given.condition)]
        chosen = [square[i % len(square)] for i in range(len(some))]
        random.Random('%d %s' % (given.seed, group)).shuffle(chosen)
        orders.update(zip(some, chosen))
    return orders


def balanced_square(names):
    """Orders in which each name has each place, and follows each other, equally often (Williams 1949)."""
    n = len(names)
    first = [0] + [(i + 1) // 2 if i % 2 else n - i // 2 for i in range(1, n)]
    square = [[names[(place + shift) % n] for place in first] for shift in range(n)]
    return square if n % 2 == 0 else square + [list(reversed(order)) for order in square]


def _steps(given, group, order, day):
    """Phases of a session. In the paper's procedure, veterans first train with our system, on the first day."""
    if given.procedure == 'paper' and group == 'veteran' and day == 1:
        yield 'training', order[0]
    for condition in order:
        yield 'test', condition


def _date(given, place, day, slots):
    if given.first is None:
        return ''
    days = place // slots * given.sessions * max(1, given.days_between) + (day - 1) * given.days_between
    try:
        return (given.first + datetime.timedelta(days=days)).isoformat()
    except OverflowError:
        raise ValueError('--first %s is too late; allowed: what ends by the year 9999' % given.first) from None


def _row(given, participant, group, place, date, time, day, step, phase, condition):
    # A training phase is a separate condition, which the analysis does not compare with the tests.
    named = condition + TRAINING if phase == 'training' else condition
    command = ('roslaunch mr_hand_interaction training.launch participant:=%s group:=%s contact_model:=%s condition:=%s '
               'task:=%s session:=%d number:=%d seed:=%d' % (participant, group, condition, named, given.task, day, place,
                                                             given.seed))
    folder = '~/training/' + '_'.join([participant, named, given.task] + [str(day)] * (day > 1))
    asked = '' if phase == 'training' else 'rosrun mr_hand_interaction ask_ratings ' + folder
    return dict(zip(COLUMNS, (participant, group, place, date, time, day, step, phase, named, given.task, day, given.seed,
                              command, asked)))


def write(path, made):
    with open(path, 'w', newline='', encoding='utf-8') as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator='\n')
        writer.writeheader()
        writer.writerows(made)
