#!/usr/bin/env python3
"""Draws a filters.csv: jitter of a still hand against lag of a moving one, a panel per input and frame rate, a line
per filter whose points are its settings."""

import collections
import csv
import sys

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.patheffects as patheffects
    import matplotlib.pyplot as plt
    import matplotlib.ticker as ticker
except ImportError:
    sys.exit('plot_filters.py: needs matplotlib (Debian: python3-matplotlib)')

# Okabe and Ito's palette, told apart by the colour-blind; each line has a marker of its own besides.
Style = collections.namedtuple('Style', 'colour marker name')
STYLES = {
    'none': Style('#000000', 'X', 'none'),
    'window': Style('#000000', 'o', 'window, F = 2 … 8'),
    'one_euro beta=10': Style('#E69F00', 'v', 'one_euro, beta 10'),
    'one_euro beta=100': Style('#D55E00', '^', 'one_euro, beta 100'),
    'constant_velocity agility=0': Style('#56B4E9', 's', 'constant_velocity, agility 0'),
    'constant_velocity agility=4': Style('#0072B2', 'D', 'constant_velocity, agility 4'),
    'constant_velocity agility=12': Style('#009E73', 'P', 'constant_velocity, agility 12'),
}
PAPER = 'window=3'
CAPTION = 'How steady and how late each filter shows the recorded hands'
FOOTNOTE = ('Jitter: rms of what is faster than 10 Hz while a joint is still. Lag: middle one of the moves of '
            'fingertips. Shaded: at most half the lag of F = 3 and no more jitter.')


def read(path):
    """Rows of each panel, by line."""
    panels = collections.OrderedDict()
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            panel = panels.setdefault((row['input'], row['frames_per_s']), collections.OrderedDict())
            panel.setdefault(row['series'], []).append(row)
    return panels


def place(row):
    return float(row['lag_ms']), float(row['jitter_mm'])


def label(axes, row, text, offset, align, colour='black'):
    axes.annotate(text, place(row), xytext=offset, textcoords='offset points', ha=align, va='center', fontsize=9,
                  color=colour, path_effects=[patheffects.withStroke(linewidth=3, foreground='white')])


def draw_panel(axes, lines):
    paper = next(row for row in lines['window'] if row['setting'] == PAPER)
    lag, jitter = place(paper)
    axes.axvspan(-2.0, 0.5 * lag, ymax=1.0, facecolor='none')
    axes.fill_between([-2.0, 0.5 * lag], 1e-4, jitter, color='#EEEEEE', linewidth=0)
    for series, rows in lines.items():
        style = STYLES[series]
        axes.plot(*zip(*map(place, rows)), color=style.colour, marker=style.marker, markersize=5, linewidth=1.4)
        for row in rows:
            if row['default'] == '1':
                axes.plot(*place(row), marker='o', markersize=13, markerfacecolor='none', color='black')
                label(axes, row, 'default', (10, -9), 'left')
    axes.plot(lag, jitter, marker='o', markersize=13, markerfacecolor='none', color='black')
    label(axes, paper, 'F = 3 (the paper)', (9, 8), 'left')
    label(axes, lines['none'][0], 'none', (8, 0), 'left')
    axes.set_yscale('log')
    axes.yaxis.set_major_formatter(ticker.FormatStrFormatter('%g'))
    axes.yaxis.set_minor_formatter(ticker.NullFormatter())
    values = [place(row) for rows in lines.values() for row in rows]
    axes.set_xlim(-1.5, min(40.0, 1.06 * max(x for x, _ in values)))
    axes.set_ylim(0.8 * min(y for _, y in values), 1.3 * max(y for _, y in values))


def main(arguments):
    if len(arguments) != 3:
        print('usage: plot_filters.py FILE.csv FILE.png', file=sys.stderr)
        return 2
    panels = read(arguments[1])
    figure, grid = plt.subplots(2, 2, figsize=(11, 8.6), dpi=84)
    figure.subplots_adjust(left=0.07, right=0.985, top=0.85, bottom=0.105, hspace=0.24, wspace=0.13)
    for axes, ((given, rate), lines) in zip(grid.flat, panels.items()):
        draw_panel(axes, lines)
        axes.set_title('%s, %s frames/s' % (given, rate), fontsize=11, loc='left')
        axes.set_xlabel('lag of a moving fingertip [ms]')
        axes.set_ylabel('jitter of a still joint [mm]')
    handles = [plt.Line2D([], [], color=style.colour, marker=style.marker, label=style.name)
               for style in STYLES.values()]
    figure.legend(handles=handles, loc='upper left', bbox_to_anchor=(0.06, 0.955), ncol=4, frameon=False, fontsize=9.5)
    figure.text(0.07, 0.97, CAPTION, fontsize=12, va='center')
    figure.text(0.07, 0.025, FOOTNOTE, fontsize=9.5, va='center')
    figure.savefig(arguments[2])
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv))
