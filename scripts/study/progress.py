"""A page for each trainee: times, drops, forces and drift over blocks and sessions, beside those of the group."""

import os
import re

import numpy as np

from .measures import OF
from .report import Report, number
from .study_data import SIMULATED
from .style import INK, PALE, finish, new_figure, save

SHOWN = ('completion_time', 'drops', 'grip_force_mean', 'release_drift')


def write_pages(blocks, output):
    """trainees/NAME.html for each who has more than one block."""
    for (participant, source), mine in blocks.groupby(['participant', 'source']):
        if mine['block'].nunique() < 2:
            continue
        folder = os.path.join(output, 'trainees')
        name = re.sub(r'[^A-Za-z0-9_.-]', '_', ('simulated_' if source == SIMULATED else '') + participant)
        others = blocks[(blocks['source'] == source) & (blocks['participant'] != participant)]
        path = _draw(mine, others, participant, source, os.path.join(folder, 'figures'), name)
        report = Report('Progress of ' + participant)
        if source == SIMULATED:
            report.text(source, 'simulated')
        report.figure(path, 'Progress over blocks')
        for condition, some in mine.groupby('condition'):
            report.table(condition, ['Session', 'Block'] + [_named(m) for m in SHOWN], _rows(some))
        report.write(os.path.join(folder, name + '.html'))


def _named(measure):
    return OF[measure].label + (' [%s]' % OF[measure].unit if OF[measure].unit else '')


def _rows(some):
    rows = []
    for (session, block), of_block in some.groupby(['session_number', 'block']):
        values = dict(zip(of_block['measure'], of_block['value']))
        rows.append([str(session), str(block)] + [number(values.get(measure, np.nan)) for measure in SHOWN])
    return rows


def _draw(mine, others, participant, source, folder, name):
    figure, panels = new_figure(len(SHOWN), 1.3 + 2.4 * len(SHOWN), 3.2)
    for axes, measure in zip(panels.flat, SHOWN):
        theirs = others[others['measure'] == measure].groupby('block')['value'].mean()
        axes.plot(theirs.index, theirs.values, color=PALE, marker='.')
        for _, some in mine[mine['measure'] == measure].groupby(['condition', 'session_number']):
            axes.plot(some['block'], some['value'], color=INK, marker='o', markersize=4)
        axes.set_title(_named(measure), loc='left', fontsize=8)
        axes.set_xlabel('block')
        axes.set_ylim(0, None)
    finish(figure, 'Progress of ' + participant, 'Dark: this person, a line for each session and condition. '
           'Pale: mean of all others.', source)
    return save(figure, folder, name)
