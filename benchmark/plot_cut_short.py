#!/usr/bin/env python3
"""Draws what crowds --cut-short wrote: what a crowd's step costs over its number of bodies, and by how much its budget
leaves velocities off."""

import collections
import csv
import os
import sys

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit('plot_cut_short.py: needs matplotlib (Debian: python3-matplotlib)')

# Okabe and Ito's palette; each line has a marker of its own besides.
STYLES = {'heap': ('#D55E00', 'o', 'falling and landing'), 'block': ('#0072B2', 's', 'touching at rest, first 50 ms')}
PANELS = [('us', 'us_p99', 'CPU time of a crowd in a step [µs]'),
          ('off_m_s', 'off_m_s_p90', 'velocity off the converged one [m/s]')]


def read(path):
    scenes = collections.OrderedDict()
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            scenes.setdefault(row['scene'], []).append({key: float(row[key]) for key in row if key != 'scene'})
    return scenes


def draw(axes, scenes, middle, high, label):
    for scene, rows in scenes.items():
        colour, marker, name = STYLES[scene]
        bodies = [row['bodies_to'] for row in rows]
        axes.plot(bodies, [row[middle] for row in rows], color=colour, marker=marker, label=name)
        axes.plot(bodies, [row[high] for row in rows], color=colour, linestyle=':')
    axes.set_xscale('log', base=2)
    axes.set_yscale('log')
    axes.set_xlabel('bodies of the crowd, at most')
    axes.set_title(label)
    axes.legend(loc='lower right')
    axes.grid(True, alpha=0.3)


def main(source, picture):
    scenes = read(source)
    figure, panels = plt.subplots(1, 2, figsize=(11, 4.5))
    for axes, panel in zip(panels, PANELS):
        draw(axes, scenes, *panel)
    figure.text(0.01, 0.01, 'Lines: the middle one of all crowds of that size. Dotted: 99 % of costs, 90 % of errors, '
                'are below.', fontsize=8)
    figure.tight_layout(rect=(0, 0.03, 1, 1))
    figure.savefig(picture, dpi=80)


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit('usage: %s CSV PNG' % os.path.basename(sys.argv[0]))
    main(sys.argv[1], sys.argv[2])
