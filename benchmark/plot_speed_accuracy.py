#!/usr/bin/env python3
"""Draws the charts of a speed_accuracy.csv beside it: per scene the error against the time per step and against the
real-time factor, a summary of Pareto fronts, and cost against the number of objects and contacts."""

import collections
import csv
import math
import os
import sys

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit('plot_speed_accuracy.py: needs matplotlib (Debian: python3-matplotlib)')

# Okabe and Ito's palette, told apart by the colour-blind; markers differ too.
STYLES = {
    'mr_hand_interaction': ('#D55E00', 'o'),
    'bullet_f32': ('#56B4E9', 's'),
    'bullet_f64': ('#0072B2', 'D'),
    'ode': ('#009E73', '^'),
    'dart': ('#CC79A7', 'v'),
    'simbody': ('#E69F00', 'P'),
    'mujoco': ('#000000', 'X'),
}
OTHER = ('#999999', '.')
LABELS = {'mr_hand_interaction': 'ours', 'bullet_f32': 'Bullet f32', 'bullet_f64': 'Bullet f64', 'ode': 'ODE',
          'dart': 'DART', 'simbody': 'Simbody', 'mujoco': 'MuJoCo'}
LINES = ['-', '--', '-.', ':', (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (7, 2)), (0, (3, 1, 1, 1))]
COST_PREFIX = 'cost_'
SMALLEST = 1e-12  # errors below are rounding; a logarithmic axis has no zero

Row = collections.namedtuple('Row', 'scene engine setting step time p99 error unit failed')


def read(path):
    with open(path, newline='') as file:
        return [Row(r['scene'], r['engine'], r['setting'], float(r['step_s']), float(r['us_per_step']),
                    float(r['us_per_step_p99']), abs(float(r['error'])), r['error_unit'], r['failed'] == '1')
                for r in csv.DictReader(file)]


def grouped(rows, key):
    groups = collections.OrderedDict()
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def label_of(engine, setting=None):
    name = LABELS.get(engine, engine)
    if setting is None:
        return name
    short = setting.replace('; default', '')
    return name + ': ' + (short if len(short) <= 42 else short[:40].rstrip('; ') + ' ...')


def floor_of(rows):
    """Where errors of zero are drawn."""
    positive = [max(r.error, SMALLEST) for r in rows if not r.failed and r.error > 0]
    return min(positive) if positive else SMALLEST


def spread(wanted, distance, low, high):
    """Places near the wanted ones (ascending) that keep their distance and, if there is room, lie in low..high."""
    places, at = [], low - distance
    for place in wanted:
        at = max(place, at + distance)
        places.append(at)
    at = high + distance
    for i in reversed(range(len(places))):
        at = min(places[i], at - distance)
        places[i] = at
    return places


def place_labels(axes, labels):
    """Writes labels at the curves' ends, moved apart where they would overlap."""
    axes.get_xlim(), axes.get_ylim()  # settles the limits
    to_pixels, distance = axes.transData.transform, 8.5 * axes.figure.dpi / 72.0
    labels = sorted(labels, key=lambda label: to_pixels(label[:2])[1])
    wanted = [to_pixels(label[:2])[1] for label in labels]
    places = spread(wanted, distance, axes.bbox.y0, axes.figure.bbox.y1 - 2 * distance)
    for (x, y, text, colour), place in zip(labels, places):
        axes.annotate(text, xy=(x, y), xytext=(axes.bbox.x1 + 24, place), xycoords='data',
                      textcoords='figure pixels', fontsize=6.5, color=colour, va='center', annotation_clip=False,
                      arrowprops={'arrowstyle': '-', 'color': colour, 'lw': 0.4, 'alpha': 0.6, 'shrinkB': 0,
                                  'relpos': (0, 0.5)})


def draw_failed(axes, rows, x_of):
    """Failed runs: crosses above the chart, at the time that they took."""
    for row in rows:
        if row.failed and row.time > 0:
            axes.plot([x_of(row)], [1.02], 'x', color=STYLES.get(row.engine, OTHER)[0], markersize=5, clip_on=False,
                      transform=axes.get_xaxis_transform())


def finish(axes, unit, x_label):
    axes.set_xscale('log')
    axes.set_yscale('log')
    axes.set_xlabel(x_label)
    axes.set_ylabel('error [%s]' % unit)
    if not any(line.get_xydata().size for line in axes.lines if line.get_transform() == axes.transData):
        axes.set_xlim(1e-1, 1e3), axes.set_ylim(1e-6, 1.0)
    axes.grid(True, which='major', color='0.9')
    for side in ('top', 'right'):
        axes.spines[side].set_visible(False)


def draw_curves(axes, rows, x_of):
    floor, labels = floor_of(rows), []
    for engine, of_engine in grouped(rows, lambda r: r.engine).items():
        colour, marker = STYLES.get(engine, OTHER)
        for i, (setting, curve) in enumerate(grouped(of_engine, lambda r: r.setting).items()):
            good = sorted((r for r in curve if not r.failed and r.time > 0), key=lambda r: r.step)
            if not good:
                continue
            x, y = [x_of(r) for r in good], [max(r.error, floor) for r in good]
            axes.plot(x, y, color=colour, marker=marker, markersize=3.5, linewidth=1.2, linestyle=LINES[i % len(LINES)])
            labels.append((x[-1], y[-1], label_of(engine, setting), colour))
    draw_failed(axes, rows, x_of)
    return labels


def time_of(row):
    return row.time


def real_time_factor(row):
    return 1e6 * row.step / row.time


def draw_scene(scene, rows, folder):
    figure, both = plt.subplots(1, 2, figsize=(14, 6), dpi=90, sharey=True)
    figure.subplots_adjust(left=0.06, right=0.8, top=0.87, bottom=0.1, wspace=0.06)
    draw_curves(both[0], rows, time_of)
    labels = draw_curves(both[1], rows, real_time_factor)
    finish(both[0], rows[0].unit, 'median time per step [µs], faster is left')
    finish(both[1], '', 'real-time factor [simulated s per s], faster is right')
    both[1].set_ylabel('')
    steps = sorted({r.step for r in rows})
    figure.suptitle('%s: a curve per engine and setting, a point per step of %.3g to %.3g ms; crosses on top: failed '
                    'runs, at the time that they took' % (scene.replace('_', ' '), 1e3 * steps[0], 1e3 * steps[-1]),
                    fontsize=10, x=0.06, ha='left')
    place_labels(both[1], labels)
    figure.savefig(os.path.join(folder, scene + '.png'))
    plt.close(figure)


def pareto(points):
    """Those that no other beats in both cost (less is better) and error."""
    front, best = [], math.inf
    for cost, error in sorted(points):
        if error < best:
            front.append((cost, error))
            best = error
    return front


def draw_summary(scenes, folder):
    """Pareto fronts over all settings and steps: error against computing time per simulated second."""
    columns = 5
    lines = math.ceil(len(scenes) / columns)
    figure, grid = plt.subplots(lines, columns, figsize=(4.0 * columns, 3.3 * lines), dpi=80, squeeze=False)
    for axes in grid.flat[len(scenes):]:
        axes.set_visible(False)
    for axes, (scene, rows) in zip(grid.flat, scenes.items()):
        floor = floor_of(rows)
        for engine, of_engine in grouped(rows, lambda r: r.engine).items():
            colour, marker = STYLES.get(engine, OTHER)
            front = pareto([(r.time / r.step * 1e-3, max(r.error, floor)) for r in of_engine
                            if not r.failed and r.time > 0])
            if not front:
                continue
            x, y = zip(*front)
            axes.plot(x, y, color=colour, marker=marker, markersize=4, linewidth=1.2, drawstyle='steps-post')
            axes.annotate(label_of(engine), (x[-1], y[-1]), xytext=(3, 3), textcoords='offset points', fontsize=7,
                          color=colour)
        finish(axes, rows[0].unit, 'ms per simulated second')
        axes.set_title(scene.replace('_', ' '), fontsize=9)
    figure.suptitle('Best of each engine over its settings and step sizes: lower left is better', fontsize=12)
    figure.tight_layout(rect=(0, 0, 1, 0.98))
    figure.savefig(os.path.join(folder, 'summary.png'))
    plt.close(figure)


def draw_cost(rows, folder):
    groups = grouped(rows, lambda r: r.scene.rsplit('_', 1)[0])
    for name, of_group in groups.items():
        shortest = min(r.step for r in of_group)
        figure, axes = plt.subplots(figsize=(9, 6), dpi=110)
        figure.subplots_adjust(left=0.1, right=0.66, top=0.9, bottom=0.1)
        labels = []
        at_step = [r for r in of_group if r.step == shortest and r.time > 0]
        for engine, of_engine in grouped(at_step, lambda r: r.engine).items():
            colour, marker = STYLES.get(engine, OTHER)
            for i, (setting, curve) in enumerate(grouped(of_engine, lambda r: r.setting).items()):
                good = sorted((int(r.scene.rsplit('_', 1)[1]), r.time) for r in curve if not r.failed)
                if not good:
                    continue
                x, y = zip(*good)
                axes.plot(x, y, color=colour, marker=marker, markersize=3.5, linewidth=1.2,
                          linestyle=LINES[i % len(LINES)])
                labels.append((x[-1], y[-1], label_of(engine, setting), colour))
                for row in curve:
                    if row.failed:
                        axes.plot([int(row.scene.rsplit('_', 1)[1])], [row.time], 'x', color=colour, markersize=6)
        finish(axes, '', 'fingertips on one plate' if name == 'cost_contacts' else 'objects')
        axes.set_ylabel('median time per step [µs]')
        axes.set_title('%s, step %.3g ms; crosses: failed' % (name.replace('_', ' '), 1e3 * shortest), fontsize=9,
                       loc='left')
        place_labels(axes, labels)
        figure.savefig(os.path.join(folder, name + '.png'))
        plt.close(figure)


def main(arguments):
    if len(arguments) != 2:
        print('usage: plot_speed_accuracy.py FILE.csv', file=sys.stderr)
        return 2
    rows, folder = read(arguments[1]), os.path.dirname(os.path.abspath(arguments[1]))
    scenes = grouped((r for r in rows if not r.scene.startswith(COST_PREFIX)), lambda r: r.scene)
    for scene, of_scene in scenes.items():
        draw_scene(scene, of_scene, folder)
    if scenes:
        draw_summary(scenes, folder)
    draw_cost([r for r in rows if r.scene.startswith(COST_PREFIX)], folder)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv))
