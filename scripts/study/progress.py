"""A page for each trainee: times, drops, forces and drift over blocks and sessions, beside those of the group."""

import os
import re

import numpy as np

from .measures import CONDITIONS, OF, in_order, plain, shown, with_unit
from .report import Report, number
from .study_data import SIMULATED
from .style import INK, PALE, finish, new_figure, panel_title, save

SHOWN = ('completion_time', 'drops', 'grip_force_mean', 'release_drift')
STYLES = ('-', '--', ':', '-.')


def write_pages(blocks, output):
    """trainees/NAME.html for each person, and for each simulated operator with more than one block."""
    folder, taken = os.path.join(output, 'trainees'), set()
    for (participant, source), mine in blocks.groupby(['participant', 'source']):
        if source == SIMULATED and mine['block'].nunique() < 2:
            continue
        name = _free_name(('simulated_' if source == SIMULATED else '') + participant, taken)
        report = Report('Progress of ' + participant)
        if source == SIMULATED:
            report.text(source, 'simulated')
        for gravity, at in mine.groupby('gravity_g'):
            others = blocks[(blocks['source'] == source) & (blocks['participant'] != participant) &
                            (blocks['gravity_g'] == gravity)]
            title = 'Progress of %s at %g g' % (participant, gravity)
            path = _draw(at, others, title, source, os.path.join(folder, 'figures'), '%s_%gg' % (name, gravity))
            report.heading('%g g' % gravity)
            report.figure(path, title)
            for condition, some in at.groupby('condition'):
                report.table(condition, ['Session', 'Block'] + [with_unit(OF[m]) for m in SHOWN], _rows(some))
        report.write(os.path.join(folder, name + '.html'))


def _free_name(text, taken):
    """A valid file name that no other page has."""
    name = base = re.sub(r'[^A-Za-z0-9_.-]', '_', text)
    while name in taken:
        name = '%s_%d' % (base, len(taken))
    taken.add(name)
    return name


def _rows(some):
    rows = []
    for (session, block), of_block in some.groupby(['session_number', 'block']):
        values = dict(zip(of_block['measure'], of_block['value']))
        rows.append([str(session), str(block)] + [number(shown(measure, values.get(measure, np.nan))) for measure in SHOWN])
    return rows


def _draw(mine, others, title, source, folder, name):
    figure, panels = new_figure(len(SHOWN), 3.2, 2.9)
    conditions = in_order(mine['condition'], CONDITIONS)
    for axes, measure in zip(panels.flat, SHOWN):
        for i, condition in enumerate(conditions):
            style = STYLES[i % len(STYLES)]
            theirs = others[(others['measure'] == measure) & (others['condition'] == condition)]
            theirs = shown(measure, theirs.groupby('block')['value'].mean())
            axes.plot(theirs.index, theirs.values, color=PALE, linestyle=style, marker='.')
            own = mine[(mine['measure'] == measure) & (mine['condition'] == condition)]
            for _, some in own.groupby('session_number'):
                axes.plot(some['block'], shown(measure, some['value']), color=INK, linestyle=style, marker='o', markersize=4)
        panel_title(axes, with_unit(OF[measure]))
        axes.set_xlabel('block')
        axes.set_ylim(0, None)
    if len(conditions) > 1:
        axes.legend(handles=[axes.plot([], [], color=INK, linestyle=STYLES[i % len(STYLES)], label=plain(condition))[0]
                             for i, condition in enumerate(conditions)], fontsize=7, frameon=False)
    finish(figure, title, 'Dark: this person, a line for each session and condition. Pale: mean of all others under the same '
           'condition.', source)
    return save(figure, folder, name)
