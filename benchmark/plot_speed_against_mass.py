#!/usr/bin/env python3
"""Draws what speed_against_mass wrote: the speed that a hand gives to a cube, over the cube's mass."""

import collections
import csv
import os
import sys

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit('plot_speed_against_mass.py: needs matplotlib (Debian: python3-matplotlib)')

# Okabe and Ito's palette; each hand has a marker of its own besides.
STYLES = {'fingertip': ('#0072B2', 'o', 'fingertip (20 g)'), 'palm': ('#009E73', 's', 'palm (0.4 kg)'),
          'paper': ('#D55E00', '^', "paper's hand (unlimited)")}


def main(source, picture):
    hands = collections.OrderedDict()
    with open(source, newline='') as file:
        for row in csv.DictReader(file):
            hands.setdefault(row['hand'], []).append([float(row[key]) for key in ('mass_kg', 'impact_m_s', 'pushed_m_s')])
    figure, axes = plt.subplots(figsize=(8, 4.5))
    for hand, rows in hands.items():
        colour, marker, label = STYLES[hand]
        mass, impact, pushed = zip(*rows)
        axes.plot(mass, impact, color=colour, marker=marker, markevery=5, label=label)
        axes.plot(mass, pushed, color=colour, linestyle=':')
    axes.set_xscale('log')
    axes.set_yscale('log')
    axes.set_xlabel('mass of the cube [kg]')
    axes.set_ylabel('speed of the cube [m/s]')
    axes.set_title('A hand at 0.3 m/s meets a cube at rest. Lines: the impact alone. Dotted: pushed on for 0.4 s',
                   fontsize=9)
    axes.grid(True, alpha=0.3)
    axes.legend()
    figure.tight_layout()
    figure.savefig(picture, dpi=80)


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit('usage: %s CSV PNG' % os.path.basename(sys.argv[0]))
    main(sys.argv[1], sys.argv[2])
