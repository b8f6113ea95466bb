"""The ratings' distributions, as the paper's figure 12, and the conditions side by side."""

import numpy as np

from .measures import CONDITIONS, GROUPS, OF, QUESTIONS, in_order, plain, shown, with_unit
from .questions import PAPER
from .style import INK, colours, finish, new_figure, panel_title, save
from .analysis import summary

HIGHEST_SCORE = PAPER['naturalness'].highest
COLOURS = dict(zip(QUESTIONS, ('#009E73', '#CC79A7')))
WORDS = {'naturalness': ('unnatural', 'natural'), 'efficiency': ('inefficient', 'efficient')}


def draw_ratings(ratings, title, folder, name):
    """A panel for each question, a row for each condition: the number of each score, and the median."""
    conditions = in_order(ratings['condition'], CONDITIONS)
    questions = [question for question in QUESTIONS if question in set(ratings['question'])]
    figure, panels = new_figure(len(questions), 4.6, 0.9 + 0.85 * len(conditions))
    for axes, question in zip(panels.flat, questions):
        for row, condition in enumerate(conditions):
            some = ratings[(ratings['question'] == question) & (ratings['condition'] == condition)]
            _draw_row(axes, len(conditions) - 1 - row, condition, some['score'].astype(float), COLOURS[question])
        axes.set_title(question.capitalize(), loc='left')
        axes.set_xlim(-0.6, HIGHEST_SCORE + 0.6)
        axes.set_xticks(range(HIGHEST_SCORE + 1))
        low, high = WORDS[question]
        axes.set_xlabel('extremely %s  \u2190  score  \u2192  extremely %s' % (low, high))
        axes.set_ylim(-0.15, len(conditions))
        axes.set_yticks([])
        axes.spines['left'].set_visible(False)
    finish(figure, title, 'Bars: share of the participants that gave the score. Triangle: median.',
           ratings['source'].iloc[0])
    return save(figure, folder, name)


def _draw_row(axes, base, condition, scores, colour):
    axes.axhline(base, color='0.8', lw=0.8)
    axes.text(-0.55, base + 0.72, '%s (n = %d)' % (plain(condition), len(scores)), fontsize=8.5, va='center')
    if scores.empty:
        return
    share = np.bincount(scores.astype(int), minlength=HIGHEST_SCORE + 1) / len(scores)
    axes.bar(range(HIGHEST_SCORE + 1), 0.6 * share / max(share.max(), 0.4), 0.86, bottom=base, color=colour)
    for value in np.flatnonzero(share):
        axes.text(value, base + 0.6 * share[value] / max(share.max(), 0.4) + 0.01, '%.0f %%' % (100 * share[value]),
                  ha='center', va='bottom', fontsize=6.5)
    axes.plot(scores.median(), base - 0.045, '^', color=INK, markersize=6, clip_on=False, zorder=4)


def draw_conditions(cells, measures, title, folder, name):
    """A panel for each measure, a row for each condition: mean and confidence interval of each group."""
    conditions = in_order(cells['condition'], CONDITIONS)
    figure, panels = new_figure(len(measures), 3.2, 0.9 + 0.5 * len(conditions), sharey=True)
    for axes, measure in zip(panels.flat, measures):
        of_measure = cells[cells['measure'] == measure]
        of_measure = of_measure.assign(value=shown(measure, of_measure['value']))
        groups = in_order(of_measure['group'], GROUPS)
        for i, group in enumerate(groups):
            _draw_group(axes, of_measure[of_measure['group'] == group], conditions, group,
                        0.64 / max(2, len(groups)) * ((len(groups) - 1) / 2 - i), colours(groups)[group],
                        named=axes is panels.flat[0])
        panel_title(axes, with_unit(OF[measure]))
        axes.set_ylim(-0.6, len(conditions) - 0.25)
        axes.set_yticks(range(len(conditions)))
        axes.set_yticklabels([plain(c) for c in reversed(conditions)])
        axes.tick_params(axis='y', length=0, labelsize=9)
        axes.set_xlim(0, None if measure != 'completed' else 1.02)
        axes.grid(axis='x', color='0.92')
        axes.set_axisbelow(True)
    finish(figure, title, 'Dots: mean of the participants. Lines: 95 % confidence interval.', cells['source'].iloc[0])
    return save(figure, folder, name)


def _draw_group(axes, cells, conditions, group, shift, colour, named):
    for row, condition in enumerate(reversed(conditions)):
        means = cells[cells['condition'] == condition].groupby('participant')['value'].mean()
        if means.empty:
            continue
        of = summary(means)
        ends = of['mean'] + np.nan_to_num(of['ci95']) * np.array([-1, 1])
        ends = np.clip(ends, 0, 1 if cells['measure'].iloc[0] == 'completed' else None)
        axes.errorbar(of['mean'], row + shift, xerr=np.abs(ends - of['mean'])[:, None], fmt='o', markersize=6,
                      color=colour[1], markerfacecolor=colour[0], capsize=2.5, lw=1.2, clip_on=False)
        if named and row == len(conditions) - 1:
            axes.annotate(group, (of['mean'], row + shift), xytext=(0, 6 if shift >= 0 else -6),
                          textcoords='offset points', ha='center', va='bottom' if shift >= 0 else 'top', fontsize=7.5,
                          color=colour[1])
