"""Bars of each object and group with stars, as the paper's figure 11."""

import numpy as np

from .measures import GROUPS, OBJECTS, OF, in_order, plain, shown, with_unit
from .style import INK, PALE, colours, finish, new_figure, panel_title, save

CAPTION = ('Bars: mean of the participants. Lines: 95 % confidence interval. Dots: participants. '
           'Mixed model or permutation, Bonferroni-corrected: * p < 0.05, ** p < 0.01, *** p < 0.001.')
ROOM = 0.09  # fraction of the axis for each bracket above the bars


def draw_bars(results, cells, measures, title, folder, name):
    """A panel for each measure; `results` and `cells` are those of one condition."""
    figure, panels = new_figure(len(measures), 4.6, 3.6)
    for axes, measure in zip(panels.flat, measures):
        bars, post_hoc, values = (t[t['measure'] == measure] for t in (results.bars, results.post_hoc, cells))
        _draw_panel(axes, measure, bars.assign(**{name: shown(measure, bars[name]) for name in ('mean', 'sd', 'ci95')}),
                    post_hoc, values.assign(value=shown(measure, values['value'])))
    source = cells['source'].iloc[0]
    finish(figure, title, CAPTION, source)
    return save(figure, folder, name)


def _draw_panel(axes, measure, bars, post_hoc, cells):
    groups, objects = in_order(bars['group'], GROUPS), in_order(bars['object'], OBJECTS)
    width, colour_of = 0.8 / len(groups), colours(groups)
    for row in bars[bars['n'] > 0].itertuples():
        x = objects.index(row.object) + (groups.index(row.group) - (len(groups) - 1) / 2) * width
        axes.bar(x, row.mean, 0.94 * width, color=colour_of[row.group][0], zorder=1)
        values = np.sort(cells[(cells['group'] == row.group) & (cells['object'] == row.object)]['value'])
        beside = x + width * _aside(values, cells['value'].max())
        axes.plot(beside, values, '.', color=colour_of[row.group][1], markersize=3.5, alpha=0.75, zorder=2, clip_on=False)
        axes.errorbar(x, row.mean, 0 if np.isnan(row.ci95) else row.ci95, color=INK, capsize=3, lw=1.2, zorder=3)
        axes.text(x, -0.015, '%s\nn = %d' % (row.group, row.n), ha='center', va='top', fontsize=7.5,
                  color=colour_of[row.group][1], transform=axes.get_xaxis_transform())
    axes.set_xticks(range(len(objects)))
    axes.set_xticklabels([plain(name) for name in objects])
    axes.tick_params(axis='x', length=0, pad=25)
    axes.set_xlim(-0.55, len(objects) - 0.45)
    panel_title(axes, with_unit(OF[measure]))
    top = max(cells['value'].max(), (bars['mean'] + bars['ci95'].fillna(0)).max(), 1e-9)
    _draw_brackets(axes, top, _brackets(post_hoc, groups, objects, width))
    axes.grid(axis='y', color='0.92', zorder=0)
    axes.set_axisbelow(True)


def _aside(values, top):
    """Horizontal offsets of dots from a bar's middle, in its widths, so that they are clear of the line there and of dots at
    almost the same height."""
    _, level, sizes = np.unique(np.round(40 * values / max(top, 1e-9)), return_inverse=True, return_counts=True)
    rank = np.arange(len(values)) - np.searchsorted(level, level)  # among the dots of a level; values are sorted
    step = np.minimum(0.1, 0.33 / np.ceil(sizes[level] / 2))
    return np.where(rank % 2, 1, -1) * (0.12 + step * (rank // 2))


def _brackets(post_hoc, groups, objects, width):
    """(level, from, to, stars) of the significant pairs: groups in the first level, objects in further ones."""
    found, level = [], 0
    post_hoc = post_hoc[post_hoc['at'] != 'all objects']
    for row in post_hoc[post_hoc['stars'] != ''].itertuples():
        if row.at != 'objects':
            middle = objects.index(row.at[len('at '):])
            ends = [middle + (groups.index(group) - (len(groups) - 1) / 2) * width for group in (row.a, row.b)]
            found.append((0, *ends, row.stars))
            level = 1
    for row in post_hoc[(post_hoc['stars'] != '') & (post_hoc['at'] == 'objects')].itertuples():
        found.append((level, objects.index(row.a) + 0.03, objects.index(row.b) - 0.03, row.stars))
        level += 1
    return found


def _draw_brackets(axes, top, brackets):
    levels = 1 + max([level for level, *_ in brackets], default=-1)
    scale = top / (1 - ROOM * (levels + 0.3))
    for level, start, end, stars in brackets:
        height = top + (level + 0.45) * ROOM * scale
        axes.plot([start, start, end, end], [height - 0.015 * scale, height, height, height - 0.015 * scale],
                  color=INK, lw=0.9)
        axes.text((start + end) / 2, height - 0.005 * scale, stars, ha='center', va='bottom', fontsize=9)
    axes.set_ylim(0, max(scale, top * 1.03))
    if top <= 1e-9:
        axes.set_ylim(0, 1)
        axes.text(0.5, 0.5, 'all 0', transform=axes.transAxes, ha='center', color=PALE)
