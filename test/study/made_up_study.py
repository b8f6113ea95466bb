"""Session folders with made-up numbers, for tests and pictures of the analysis. They say nothing about any system."""

import contextlib
import os
from unittest import mock

import numpy as np

from study.measures import OBJECTS, QUESTIONS
from study.session_folder import TRIALS

DRAWING = frozenset(('bars.draw_bars', 'distributions.draw_conditions', 'distributions.draw_ratings', 'learning.draw',
                     'progress._draw'))
KEYS = ('object', 'repetition', 'start')
HEADER = '''version: 1
participant: "{participant}"
group: {group}
handedness: {handedness}
condition: "{condition}"
gravity: {gravity}
seed: {seed}
session: {session}
task: {task}
simulated: {simulated}
started: 2024-05-06T10:00:00Z
order: [cube, flat_cuboid, long_cuboid]
software: "0.1.0"
'''


@contextlib.contextmanager
def undrawn(*drawn):
    """Files of figures are empty, except those of the functions `drawn`: drawing takes most of an analysis' time. For tests that
    look at no figure."""
    def draw(*arguments):
        folder, name = arguments[-2:]
        os.makedirs(folder, exist_ok=True)
        path = os.path.join(folder, name + '.svg')
        open(path, 'wb').close()
        return path
    with contextlib.ExitStack() as stack:
        for function in DRAWING.difference(drawn):
            stack.enter_context(mock.patch('study.' + function, draw))
        yield


def write_session(folder, participant='P01', group='beginner', condition='implicit', gravity=(0, 0, 0),
                  simulated=False, handedness='right', trials=(), ratings=(), seed=1, session=1, task='pick_and_place'):
    """`trials`: dicts with any of the columns, the rest empty; `ratings`: (question, score) pairs."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, 'session.yaml'), 'w') as file:
        file.write(HEADER.format(participant=participant, group=group, handedness=handedness, condition=condition,
                                 gravity=list(gravity), seed=seed, session=session, task=task, simulated=str(simulated).lower()))
    write_table(os.path.join(folder, 'trials.csv'), list(TRIALS), [
        dict({'trial': i + 1, 'object': 'cube', 'condition': condition, 'repetition': 1, 'result': 'completed'}, **row)
        for i, row in enumerate(trials)])
    write_table(os.path.join(folder, 'ratings.csv'), ['condition', 'question', 'score'], [
        {'condition': condition, 'question': question, 'score': score} for question, score in ratings])
    return folder


def write_table(path, columns, rows):
    with open(path, 'w') as file:
        for row in [dict(zip(columns, columns))] + list(rows):
            file.write(','.join(str(row.get(column, '')) for column in columns) + '\n')


def write_study(folder, participants=10, conditions=('implicit',), seed=1, repetitions=2, group_effect=0.0,
                object_effect=0.0, condition_effect=0.0, objects=OBJECTS, measures=tuple(TRIALS), **header):
    """Every second participant is a veteran. Effects are in standard deviations of a completion time. What is not
    among `measures` stays empty."""
    random, made = np.random.RandomState(seed), []
    for i in range(participants):
        veteran, person = i % 2 == 1, random.normal()
        for level, condition in enumerate(conditions):
            rows = [_trial(random, name, repetition, person - group_effect * veteran + object_effect * where
                           + condition_effect * level)
                    for repetition in range(1, repetitions + 1) for where, name in enumerate(objects)]
            rows = [{key: row[key] for key in row if key in KEYS or key in measures} for row in rows]
            scores = [(question, int(np.clip(round(random.normal(8 - condition_effect * level, 1.5)), 0, 10)))
                      for question in QUESTIONS]
            name = 'P%02d' % (i + 1)
            made.append(write_session(os.path.join(folder, '%s_%s' % (name, condition)), name,
                                      'veteran' if veteran else 'beginner', condition, trials=rows, ratings=scores,
                                      **header))
    return made


def _trial(random, name, repetition, slowness):
    time = max(3.0, 30 + 6 * (slowness + random.normal()))
    drops = random.poisson(max(0.1, 0.6 + 0.3 * slowness))
    manipulation, release = 0.4 * time, 0.1 * time
    return {'object': name, 'repetition': repetition, 'start': round(random.uniform(0, 600), 3),
            'completion_time': round(time, 3), 'manipulation_time': round(manipulation, 3),
            'maintenance_time': round(time - manipulation - release, 3), 'release_time': round(release, 3),
            'attempts': 1 + drops, 'drops': drops, 'path_length': round(1.2 + 0.2 * random.rand(), 3),
            'grip_force_mean': round(2 + random.rand(), 3), 'grip_force_max': round(4 + random.rand(), 3),
            'release_drift': round(0.02 + 0.02 * random.rand(), 4),
            'release_speed': round(0.01 + 0.01 * random.rand(), 4), 'tracking_losses': random.poisson(0.3)}
