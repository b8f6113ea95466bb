#!/usr/bin/env python3
"""Draws a stability_map.csv: a panel per contact model, and in it a square per mass and step whose filling shows what
became of the cells of all stiffnesses, numbers of contacts and restitutions."""

import collections
import csv
import math
import sys

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.patheffects as patheffects
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit('plot_stability_map.py: needs matplotlib (Debian: python3-matplotlib)')

# Okabe and Ito's palette, told apart by the colour-blind; from the bottom of a square to its top.
OUTCOMES = collections.OrderedDict([
    ('stable', ('#56B4E9', 'stable')),
    ('let_go', ('#F0E442', 'lets go of what friction could hold')),
    ('ejected', ('#D55E00', 'ejects: faster than 1 m/s')),
    ('diverged', ('#000000', 'diverges: faster than 100 m/s')),
])
MODELS = ['implicit', 'seed', 'penetration', 'impulse', 'virtual_spring', 'soft_pad']
PHALANX_MASS = 0.01  # of virtual_spring, whose damper is critical for it [kg]
DAMPING = {  # of one fingertip [N s/m] by its stiffness, of the models that have a bound in closed form
    'seed': lambda stiffness: 0.0,
    'penetration': lambda stiffness: 0.0,
    'virtual_spring': lambda stiffness: 2.0 * math.sqrt(stiffness * PHALANX_MASS),
}
# Fingertips, their stiffness [N/m], and where on its line each bound is named [ms].
BOUNDS = [(2, 50.0, '2 × 50 N/m', 11.0), (20, 1e5, '20 × 10⁵ N/m', 2.2)]
MASS_TICKS = [(0.001, '1 g'), (0.01, '10 g'), (0.1, '100 g'), (1.0, '1 kg'), (10.0, '10 kg'), (100.0, '100 kg')]
STEP_TICKS = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0]
CAPTION = ('What becomes of a cube between fingertips. Each square is filled by its 75 cells: stiffness 50–10⁵ N/m × '
           '1–20 fingertips × restitution 0–1')
FOOTNOTE = ('Blue lines: the explicit bound for N fingertips of stiffness γ, step < 2/√(Nγ/m) (virtual_spring: its '
            'dampers counted in), which holds above the line')


def read(path):
    """Counts of outcomes by model, then by mass [kg] and step [ms]."""
    counts = collections.defaultdict(lambda: collections.defaultdict(collections.Counter))
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            place = (float(row['mass_kg']), 1e3 * float(row['step_s']))
            counts[row['model']][place][row['outcome']] += 1
    return counts


def edges(values):
    """Borders between values that are evenly spaced on a logarithmic axis."""
    ratio = math.sqrt(values[1] / values[0])
    return [values[0] / ratio] + [value * ratio for value in values]


def draw_squares(axes, counts):
    masses, steps = (sorted({place[i] for place in counts}) for i in (0, 1))
    below, left = edges(masses), edges(steps)
    for (mass, step), counted in counts.items():
        i, j = masses.index(mass), steps.index(step)
        height, total, done = below[i + 1] / below[i], sum(counted.values()), 0
        for outcome, (colour, _) in OUTCOMES.items():
            bottom = below[i] * height ** (done / total)
            done += counted[outcome]
            top = below[i] * height ** (done / total)
            axes.bar(left[j], top - bottom, left[j + 1] - left[j], bottom, align='edge', color=colour,
                     linewidth=0, antialiased=False)
    for edge in left:
        axes.axvline(edge, color='white', linewidth=0.8)
    for edge in below:
        axes.axhline(edge, color='white', linewidth=0.8)
    axes.set_xlim(left[0], left[-1])
    axes.set_ylim(below[0], below[-1])


def mass_at_bound(step, contacts, stiffness, damping):
    """Least mass that explicit springs and dampers of `contacts` fingertips hold still:
    step^2 sum k / m + 2 step sum b / m = 4."""
    return contacts * (step * step * stiffness + 2.0 * step * damping(stiffness)) / 4.0


def write_along(axes, text, step, mass_at):
    """Names a line where it passes `step`, turned as it runs there."""
    (x1, y1), (x2, y2) = (axes.transData.transform((at, mass_at(at))) for at in (0.98 * step, 1.02 * step))
    label = axes.annotate(text, (step, mass_at(step)), xytext=(0, 3), textcoords='offset points', fontsize=9,
                          ha='center', va='bottom', rotation=math.degrees(math.atan2(y2 - y1, x2 - x1)),
                          rotation_mode='anchor')
    label.set_path_effects([patheffects.withStroke(linewidth=3, foreground='white')])


def draw_bounds(axes, damping):
    first, last = axes.get_xlim()
    axes.autoscale(False)
    steps = [first * (last / first) ** (i / 200.0) for i in range(201)]
    for contacts, stiffness, text, place in BOUNDS:
        def mass_at(step):
            return mass_at_bound(1e-3 * step, contacts, stiffness, damping)
        masses = [mass_at(step) for step in steps]
        axes.plot(steps, masses, color='white', linewidth=4)
        axes.plot(steps, masses, color='#0072B2', linewidth=2)
        write_along(axes, text, place, mass_at)


def draw_legend(figure):
    x = 0.08
    for colour, text in OUTCOMES.values():
        figure.patches.append(plt.Rectangle((x, 0.925), 0.016, 0.02, transform=figure.transFigure, color=colour))
        x += 0.022
        figure.text(x, 0.935, text, fontsize=10, va='center')
        x += 0.03 + 0.0061 * len(text)


def draw_panel(axes, model, counts):
    axes.set_xscale('log')
    axes.set_yscale('log')
    axes.minorticks_off()
    axes.set_xticks(STEP_TICKS)
    axes.set_xticklabels(['%g' % step for step in STEP_TICKS])
    axes.set_yticks([mass for mass, _ in MASS_TICKS])
    axes.set_yticklabels([text for _, text in MASS_TICKS])
    draw_squares(axes, counts)
    if model in DAMPING:
        draw_bounds(axes, DAMPING[model])
    total = sum(sum(counted.values()) for counted in counts.values())
    stable = sum(counted['stable'] for counted in counts.values())
    axes.set_title('%s: %.3g %% stable' % (model, 100.0 * stable / total), fontsize=11, loc='left')


def main(arguments):
    if len(arguments) != 3:
        print('usage: plot_stability_map.py FILE.csv FILE.png', file=sys.stderr)
        return 2
    counts = read(arguments[1])
    figure, grid = plt.subplots(2, 3, figsize=(12, 8.4), dpi=84, sharex=True, sharey=True)
    figure.subplots_adjust(left=0.08, right=0.99, top=0.885, bottom=0.095, hspace=0.14, wspace=0.05)
    for axes, model in zip(grid.flat, MODELS):
        draw_panel(axes, model, counts[model])
    for axes in grid[:, 0]:
        axes.set_ylabel('mass of the cube')
    for axes in grid[1]:
        axes.set_xlabel('step [ms]')
    draw_legend(figure)
    figure.text(0.08, 0.965, CAPTION, fontsize=10.5, va='center')
    figure.text(0.08, 0.02, FOOTNOTE, fontsize=9, va='center')
    figure.savefig(arguments[2])
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv))
