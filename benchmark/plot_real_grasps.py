#!/usr/bin/env python3
"""Draws real_grasps.png beside a real_grasps.csv (and the real_grasps_arctic.csv beside it, if there is one): the share
of bodies that are still in the hand as it opens against how hard its fingers press. engines.csv has the versions."""

import collections
import csv
import os
import sys

import plot_speed_accuracy as race

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit('plot_real_grasps.py: needs matplotlib (Debian: python3-matplotlib)')

# Okabe and Ito's palette, told apart by the colour-blind; markers differ too.
STYLES = {
    'implicit': ('#D55E00', 'o'), "implicit, the paper's hand": ('#882255', 'p'), 'soft_pad': ('#E69F00', 'h'), 'virtual_spring': ('#CC79A7', 'v'),
    'seed': ('#999999', '<'), 'penetration': ('#666666', '>'),
    'bullet_f32': ('#56B4E9', 's'), 'bullet_f64': ('#0072B2', 'D'), 'ode': ('#009E73', '^'), 'mujoco': ('#000000', 'X'),
}
OTHER = ('#F0E442', 'P')
TITLES = {
    'pinch20': 'pinch: cube 20 mm, 30 g', 'pinch30': 'pinch: cube 30 mm, 60 g', 'pinch40': 'pinch: cube 40 mm, 100 g',
    'grab_sphere60': 'grab: sphere 60 mm', 'grab_sphere80': 'grab: sphere 80 mm', 'grab_cube60': 'grab: cube 60 mm',
    'grab_cube80': 'grab: cube 80 mm', 'arctic': 'captured objects, 1 g',
}
Engine = collections.namedtuple('Engine', 'engine version date')
LEAST_FORCE = 0.1  # [N]; where forces that no engine tells, or none, are drawn


def read(path):
    if not os.path.exists(path):
        return []
    with open(path, newline='') as file:
        return list(csv.DictReader(file))


def read_engines(folder):
    return [Engine(**row) for row in read(os.path.join(folder, 'engines.csv'))]


def family(row):
    """What shares a colour and a line: one of our models, or an engine."""
    return row['setting'].split(';')[0] if row['engine'] == race.OURS else row['engine']


def points(rows, share, low, high):
    """{family: [(force, share, low, high)]}, by force."""
    families = {}
    for row in rows:
        force = max(float(row['force_p90_N']), LEAST_FORCE)
        families.setdefault(family(row), []).append((force, share(row), low(row), high(row)))
    return {name: sorted(values) for name, values in families.items()}


def closings_of(rows, name):
    chosen = [r for r in rows if r['row'] == name and r['object'] == 'all' and int(r['events'])]
    return points(chosen, lambda r: int(r['carried']) / int(r['events']), lambda r: float(r['carried_low']),
                  lambda r: float(r['carried_high']))


def windows_of(rows):
    chosen = [r for r in rows if r['split'] == 'all' and r['lead'] == '1']
    return points(chosen, lambda r: float(r['within_50mm']), lambda r: float(r['within_50mm_low']),
                  lambda r: float(r['within_50mm_high']))


def draw(axes, families, title):
    for name, values in families.items():
        colour, marker = STYLES.get(name, OTHER)
        forces, shares, lows, highs = zip(*values)
        ours = name.split(',')[0] in ('implicit', 'soft_pad', 'virtual_spring', 'seed', 'penetration')
        axes.errorbar(forces, [100 * s for s in shares],
                      yerr=[[100 * max(0.0, s - l) for s, l in zip(shares, lows)], [100 * max(0.0, h - s) for s, h in zip(shares, highs)]],
                      color=colour, marker=marker, markersize=5, linewidth=1.2 if ours else 0, elinewidth=0.6, capsize=2,
                      label=race.label_of_engine(name))
    axes.set_xscale('log')
    axes.set_ylim(-3, 103)
    axes.set_title(title, fontsize=9)
    axes.axvspan(LEAST_FORCE, 15, color='#009E73', alpha=0.07, linewidth=0)
    axes.grid(True, linewidth=0.3)


def main():
    if len(sys.argv) != 2:
        sys.exit('usage: plot_real_grasps.py real_grasps.csv')
    rows = read(sys.argv[1])
    arctic = read(sys.argv[1][:-4] + '_arctic.csv')
    panels = [(name, closings_of(rows, name)) for name in TITLES if any(r['row'] == name for r in rows)]
    if arctic:
        panels.append(('arctic', windows_of(arctic)))
    columns = min(4, max(1, len(panels)))
    lines = max(1, -(-len(panels) // columns))
    figure, grid = plt.subplots(lines, columns, figsize=(3.4 * columns, 3.0 * lines + 0.8), squeeze=False)
    handles = {}
    for axes, (name, families) in zip(grid.flat, panels):
        draw(axes, families, TITLES[name])
        for handle, label in zip(*axes.get_legend_handles_labels()):
            handles.setdefault(label, handle)
    for axes in list(grid.flat)[len(panels):]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_ylabel('in the hand as it opens [%]')
    for axes in grid[-1]:
        axes.set_xlabel('force of a finger, p90 [N]')
    figure.legend(handles.values(), handles.keys(), loc='lower center', ncol=10, fontsize=8, frameon=False, bbox_to_anchor=(0.5, 0.03))
    engines = read_engines(os.path.dirname(sys.argv[1]))
    if engines:
        figure.text(0.01, 0.01, race.footnote(engines), fontsize=8, color='#555555')
    figure.tight_layout(rect=(0, 0.09, 1, 1))
    figure.savefig(sys.argv[1][:-4] + '.png', dpi=110)


if __name__ == '__main__':
    main()
