#!/usr/bin/env python3
"""Draws what the program filters wrote: jitter of a still hand against lag of a moving one, a panel per input and frame
rate, a line per filter whose points are its settings; and the slip of a cube that a noisy hand holds."""

import collections
import csv
import os
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
STYLES = collections.OrderedDict([
    ('none', Style('#000000', 'X', 'none')),
    ('window', Style('#000000', 'o', 'window, F = 2, 3, 4, 5, 6, 8')),
    ('one_euro beta=10', Style('#E69F00', 'v', 'one_euro, beta 10, min_cutoff 0.5 to 8 Hz')),
    ('one_euro beta=100', Style('#D55E00', '^', 'one_euro, beta 100, min_cutoff 0.5 to 8 Hz')),
    ('constant_velocity agility=0', Style('#56B4E9', 's', 'constant_velocity, agility 0, acceleration 0.1 to 5')),
    ('constant_velocity agility=4', Style('#0072B2', 'D', 'constant_velocity, agility 4, acceleration 0.01 to 3')),
    ('constant_velocity agility=12', Style('#009E73', 'P', 'constant_velocity, agility 12, acceleration 0.01 to 3')),
])
PAPER = 'window=3'
CAPTION = 'How steady and how late each filter shows the recorded hands'
FOOTNOTE = ('Jitter: rms of what is faster than 10 Hz while a joint is still. Lag: the middle one of all moves of '
            'fingertips. Grey: no more jitter than F = 3 and at most half its lag. '
            'Slip: 0.0001 mm stands for less, too.')
LATEST = 26.0  # lag that is drawn [ms]
LEAST_SLIP = 1e-4  # what is less is drawn there [mm]


def read(path):
    """Rows of each panel, by line."""
    panels = collections.OrderedDict()
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            panels.setdefault((row['input'], row['frames_per_s']), []).append(row)
    return collections.OrderedDict((panel, by_series(rows)) for panel, rows in panels.items())


def place(row):
    return float(row['lag_ms']), float(row['jitter_mm'])


def label(axes, at, text, offset, colour='black'):
    axes.annotate(text, at, xytext=offset, textcoords='offset points', ha='left', va='center', fontsize=9, color=colour,
                  path_effects=[patheffects.withStroke(linewidth=3, foreground='white')])


def ring(axes, at, text, offset):
    axes.plot(*at, marker='o', markersize=13, markerfacecolor='none', color='black')
    label(axes, at, text, offset)


def draw_lines(axes, lines, place_of):
    for series, rows in lines.items():
        style = STYLES[series]
        axes.plot(*zip(*map(place_of, rows)), color=style.colour, marker=style.marker, markersize=5, linewidth=1.4)
        for row in rows:
            if row['default'] == '1':
                ring(axes, place_of(row), 'default', (9, -1))
            if row['setting'] == PAPER:
                ring(axes, place_of(row), 'F = 3 (the paper)', (9, 8))
    label(axes, place_of(lines['none'][0]), 'none', (8, 0))
    steep = 'one_euro beta=100'
    label(axes, place_of(lines[steep][0]), 'one_euro, beta 100', (8, 2), STYLES[steep].colour)


def scale(axes, places, ticks):
    axes.set_yscale('log')
    axes.yaxis.set_major_locator(ticker.LogLocator(subs=ticks))
    axes.yaxis.set_major_formatter(ticker.FormatStrFormatter('%g'))
    axes.yaxis.set_minor_locator(ticker.NullLocator())
    axes.set_xlim(-1.0, LATEST)
    heights = [y for x, y in places if x < LATEST]
    axes.set_ylim(0.8 * min(heights), 1.4 * max(heights))


def draw_recordings(axes, panel, lines):
    lag, jitter = place(next(row for row in lines['window'] if row['setting'] == PAPER))
    axes.fill_between([-2.0, 0.5 * lag], 1e-5, jitter, color='#E8E8E8', linewidth=0)
    draw_lines(axes, lines, place)
    scale(axes, [place(row) for rows in lines.values() for row in rows], (1.0, 2.0, 5.0))
    axes.set_title('%s, %s frames/s' % panel, fontsize=11, loc='left')
    axes.set_ylabel('jitter of a still joint [mm]')


def draw_held(axes, held, recorded):
    """Slip over the lag that the same setting has in the recordings with noise."""
    lags = {(row['series'], row['setting']): float(row['lag_ms']) for rows in recorded.values() for row in rows}

    def place_held(row):
        return lags[row['series'], row['setting']], max(LEAST_SLIP, float(row['true_slip_mm']))
    axes.axhline(0.05, color='#999999', linewidth=1, linestyle='--')
    axes.text(25.5, 0.055, 'asked for', fontsize=9, ha='right', va='bottom', color='#555555')
    draw_lines(axes, held, place_held)
    scale(axes, [place_held(row) for rows in held.values() for row in rows], (1.0,))
    axes.set_title('a cube held and swayed by a noisy hand, 120 frames/s', fontsize=11, loc='left')
    axes.set_ylabel('true slip [mm]')


def draw_key(axes):
    axes.axis('off')
    handles = [plt.Line2D([], [], color=style.colour, marker=style.marker, label=style.name)
               for style in STYLES.values()]
    axes.legend(handles=handles, loc='upper left', frameon=False, fontsize=10, labelspacing=0.9)


def by_series(rows):
    lines = collections.OrderedDict()
    for row in rows:
        lines.setdefault(row['series'], []).append(row)
    return lines


def main(arguments):
    if len(arguments) != 3:
        print('usage: plot_filters.py DIR FILE.png (DIR: where filters.csv and filters_held.csv are)', file=sys.stderr)
        return 2
    panels = read(os.path.join(arguments[1], 'filters.csv'))
    with open(os.path.join(arguments[1], 'filters_held.csv'), newline='') as file:
        held = by_series(csv.DictReader(file))
    figure, grid = plt.subplots(2, 3, figsize=(15, 8.2), dpi=76)
    figure.subplots_adjust(left=0.05, right=0.99, top=0.91, bottom=0.105, hspace=0.25, wspace=0.2)
    for axes, (panel, lines) in zip(grid[:, :2].flat, panels.items()):
        draw_recordings(axes, panel, lines)
    draw_held(grid[1, 2], held, panels['noise added', '99 to 116'])
    draw_key(grid[0, 2])
    for axes in grid.flat:
        axes.set_xlabel('lag of a moving fingertip [ms]')
    figure.text(0.05, 0.965, CAPTION, fontsize=12.5, va='center')
    figure.text(0.05, 0.025, FOOTNOTE, fontsize=10, va='center')
    figure.savefig(arguments[2])
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv))
