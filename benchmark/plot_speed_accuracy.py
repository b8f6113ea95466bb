#!/usr/bin/env python3
"""Draws the charts of a speed_accuracy.csv (and of the step_times.csv beside it): summary.png, the panels that carry the
message; all.png, the same of every scene; crowds.png; per scene the error against the time per step and against the
real-time factor; and cost against the number of objects and contacts."""

import collections
import csv
import math
import os
import sys
import textwrap

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
    import matplotlib.ticker
except ImportError:
    sys.exit('plot_speed_accuracy.py: needs matplotlib (Debian: python3-matplotlib)')

# Okabe and Ito's palette, told apart by the colour-blind; markers differ too.
STYLES = {
    'mr_hand_interaction': ('#D55E00', 'o'),
    'mr_hand_interaction, shipped': ('#8B4513', 'o'),
    'bullet_f32': ('#56B4E9', 's'),
    'bullet_f64': ('#0072B2', 'D'),
    'ode': ('#009E73', '^'),
    'dart': ('#CC79A7', 'v'),
    'simbody': ('#E69F00', 'P'),
    'mujoco': ('#000000', 'X'),
    'jolt': ('#882255', 'p'),
    'box3d': ('#44AA99', 'h'),
    'physx': ('#76B900', '*'),
}
OTHER = ('#999999', '.')
LABELS = {'mr_hand_interaction': "ours, paper's hand, step", 'mr_hand_interaction, shipped': 'ours, shipped hand, whole frame',
          'bullet_f32': 'Bullet f32', 'bullet_f64': 'Bullet f64', 'ode': 'ODE', 'dart': 'DART', 'simbody': 'Simbody', 'mujoco': 'MuJoCo', 'jolt': 'Jolt', 'box3d': 'Box3D', 'physx': 'PhysX'}
LINES = ['-', '--', '-.', ':', (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (7, 2)), (0, (3, 1, 1, 1))]
OURS, SHIPPED = 'mr_hand_interaction', 'mr_hand_interaction, shipped'
COST_PREFIX, CROWD_PREFIX = 'cost_', 'crowd_'
# What carries the message: scene, its title, what is wrong where it is high.
PANELS = [('pinch_swing', 'a pinched cube, swung: displacement'), ('pinch_noisy', 'the same, noisy hand of 120 Hz'),
          ('pinch_noisy_1khz', 'the same, noisy hand of 1 kHz'), ('slap_speed', 'slap: speed'), ('free_rotation_energy', 'free rotation: energy'),
          ('recording', "a person's recorded hand: displacement"), ('scripted_hand', 'a scripted, noisy hand: displacement')]
UNMOVABLE = ('slap_speed', 'slap_spin', 'recording', 'scripted_hand')  # the reference is a hand that nothing moves: not the shipped one
CROWDS = [('8 dice dropped', 'crowd_heap_8'), ('50 cubes dropped', 'crowd_heap_50'),
          ('a wall of 48 bricks falls', 'crowd_wall_48'), ('the same, steps of 8.33 ms', 'crowd_wall_48_frame'),
          ('a hand pushes 50 blocks', 'crowd_push_50'),
          ('50 cubes at rest, gaps of 20 µm', 'crowd_block_50'), ('50 of them, no gaps', 'crowd_flush_50'),
          ('200 of them, gaps of 5 µm', 'crowd_close_200'), ('200 of them, no gaps', 'crowd_flush_200'),
          ('the same, steps of 8.33 ms', 'crowd_flush_200_frame'), ('1000 of them, gaps of 20 µm', 'crowd_block_1000'),
          ('1000 of them, no gaps', 'crowd_flush_1000')]
SMALLEST_CROWD = 1e-6  # [mm]
SMALLEST = 1e-12  # errors below are rounding; a logarithmic axis has no zero

Row = collections.namedtuple('Row', 'scene engine setting step time p99 error unit failed version date')


def read(path):
    with open(path, newline='') as file:
        return [Row(r['scene'], r['engine'], r['setting'], float(r['step_s']), float(r['us_per_step']),
                    float(r['us_per_step_p99']), abs(float(r['error'])), r['error_unit'], r['failed'] == '1', r.get('engine_version', ''), r.get('date', ''))
                for r in csv.DictReader(file)]


def grouped(rows, key):
    groups = collections.OrderedDict()
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def by_curve(rows):
    """By engine; ours with the shipped hand is a curve of its own, of whole frames with the rendered hand."""
    def key(row):
        return SHIPPED if row.engine == OURS and 'shipped hand' in row.setting else row.engine
    return grouped((r for r in rows if r.engine != OURS or ('whole frame' in r.setting) == ('shipped hand' in r.setting)), key)


def footnote(rows):
    """Engines with their versions, and when they ran."""
    versions = collections.OrderedDict((label_of_engine(r.engine), r.version) for r in rows)
    return '%s. %s' % (', '.join(('%s %s' % item).strip() for item in versions.items()),
                       ' to '.join(sorted({min(r.date for r in rows), max(r.date for r in rows)})))


def label_of_engine(engine):
    return 'ours' if engine == OURS else LABELS.get(engine, engine)


def label_of(engine, setting=None):
    if setting is None:
        return LABELS.get(engine, engine)
    return label_of_engine(engine) + ': ' + setting.replace('; default', '')


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
    to_pixels, distance = axes.transData.transform, 8.0 * axes.figure.dpi / 72.0
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


def plain(axes):
    axes.grid(True, which='major', color='0.9')
    for side in ('top', 'right'):
        axes.spines[side].set_visible(False)


def finish(axes, unit, x_label):
    axes.set_xscale('log')
    axes.set_yscale('log')
    axes.set_xlabel(x_label)
    axes.set_ylabel('error [%s]' % unit)
    if not any(line.get_xydata().size for line in axes.lines if line.get_transform() == axes.transData):
        axes.set_xlim(1e-1, 1e3), axes.set_ylim(1e-6, 1.0)
    low, high = axes.get_ylim()
    if high < 20.0 * low:  # no decades to write
        axes.yaxis.set_minor_formatter(matplotlib.ticker.FormatStrFormatter('%g'))
        axes.yaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter('%g'))
    plain(axes)


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
    figure, both = plt.subplots(1, 2, figsize=(17, 6.5), dpi=90, sharey=True)
    figure.subplots_adjust(left=0.05, right=0.69, top=0.87, bottom=0.1, wspace=0.06)
    draw_curves(both[0], rows, time_of)
    labels = draw_curves(both[1], rows, real_time_factor)
    finish(both[0], rows[0].unit, 'median time per step [µs], faster is left')
    finish(both[1], '', 'real-time factor [simulated s per s], faster is right')
    both[1].set_ylabel('')
    steps = sorted({r.step for r in rows})
    figure.suptitle('%s: a curve per engine and setting, a point per step of %.3g to %.3g ms; crosses on top: failed '
                    'runs, at the time that they took' % (scene.replace('_', ' '), 1e3 * steps[0], 1e3 * steps[-1]),
                    fontsize=10, x=0.05, ha='left')
    place_labels(both[1], labels)
    figure.text(0.05, 0.01, footnote(rows), fontsize=7, color='#555555')
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


def style_of(engine):
    colour, marker = STYLES.get(engine, OTHER)
    ours = engine in (OURS, SHIPPED)
    return {'color': colour, 'marker': marker, 'markersize': 4.5, 'linewidth': 2.2 if ours else 1.4, 'zorder': 3 if ours else 2}


def draw_front(axes, rows):
    """The best of each engine over its settings and steps: error against computing time per simulated second."""
    floor = floor_of(rows)
    for engine, of_engine in by_curve(rows).items():
        front = pareto([(r.time / r.step * 1e-3, max(r.error, floor)) for r in of_engine if not r.failed and r.time > 0])
        if front:
            axes.plot(*zip(*front), drawstyle='steps-post', label=label_of(engine), **style_of(engine))
    finish(axes, rows[0].unit, 'ms per simulated second')


def read_times(path):
    """Mean and maximum step time [us] by crowd, engine and setting. A crowd has one step."""
    if not os.path.exists(path):
        return {}
    with open(path, newline='') as file:
        return {(r['scene'], r['engine'], r['setting']): (float(r['us_mean']), float(r['us_max']))
                for r in csv.DictReader(file) if r['scene'].startswith(CROWD_PREFIX)}


def of_crowd(row, scene):
    return row.scene == scene or row.scene in (scene + '_sunk', scene + '_unrest')


def best_setting(times, rows, scene, engine):
    """The setting with the least mean time in a crowd, of those that did not fail there; None if all did."""
    failed = {r.setting for r in rows if r.failed and r.engine == engine and of_crowd(r, scene)}
    good = {s: mean for (c, e, s), (mean, _) in times.items()
            if (c, e) == (scene, engine) and s not in failed and (e != OURS or s == 'implicit')}
    return min(good, key=good.get, default=None)


def crowd_error(rows, scene, engine, setting):
    """How deep a corner was below the floor, or how far a body at rest moved [mm]."""
    return next(r.error for r in rows if r.engine == engine and r.setting == setting and r.scene in (scene, scene + '_sunk'))


def draw_crowd_panel(axes, times, rows, value_of, unit):
    """A curve per engine over the crowds, at its best setting in each."""
    crowds = [(scene, label) for label, scene in CROWDS if any(scene == ran for ran, _, _ in times)]
    for engine in collections.OrderedDict.fromkeys(engine for _, engine, _ in times):
        best = [(i, scene, best_setting(times, rows, scene, engine)) for i, (scene, _) in enumerate(crowds)]
        points = [(i, value_of(scene, engine, setting)) for i, scene, setting in best if setting is not None]
        if points:
            axes.plot(*zip(*points), **style_of(engine), label=label_of_engine(engine))
    axes.set_yscale('log')
    axes.set_xticks(range(len(crowds)))
    axes.set_xticklabels([label for _, label in crowds], rotation=35, ha='right', fontsize=8)
    axes.set_ylabel(unit)
    plain(axes)


def draw_panels(panels, columns, size, heading, rows, file):
    """Panels (title, function that draws it) of a size [inch] with one legend, and versions and date below."""
    lines = math.ceil(len(panels) / columns)
    width, height = size[0] * columns, size[1] * lines + 1.3
    figure, grid = plt.subplots(lines, columns, figsize=(width, height), dpi=80, squeeze=False)
    legend = collections.OrderedDict()
    for axes in grid.flat[len(panels):]:
        axes.set_visible(False)
    for axes, (name, draw) in zip(grid.flat, panels):
        draw(axes)
        axes.set_title(name, fontsize=10, loc='left')
        for handle, label in zip(*axes.get_legend_handles_labels()):
            legend.setdefault(label, handle)
    figure.legend(legend.values(), legend.keys(), loc='upper center', ncol=6, fontsize=9, frameon=False, title=heading)
    figure.text(0.01, 0.05 / height, textwrap.fill(footnote(rows), int(16 * width)), fontsize=8, color='#555555')
    figure.tight_layout(rect=(0, 0.4 / height, 1, 1 - 0.85 / height))
    figure.savefig(file)
    plt.close(figure)


def draw_fronts(scenes, folder):
    """The best of each engine, lower left is better: the panels of PANELS that were run, and every scene, the appendix."""
    def panel(scene, title):
        return title, lambda axes: draw_front(axes, [
            r for r in scenes[scene] if scene not in UNMOVABLE or 'shipped hand' not in r.setting])
    rows = [r for of_scene in scenes.values() for r in of_scene]
    heading = 'Best of each engine over its settings and step sizes: lower left is better'
    chosen = [panel(scene, title) for scene, title in PANELS if scene in scenes]
    if chosen:
        draw_panels(chosen, min(2, len(chosen)), (6.0, 4.0), heading, rows, os.path.join(folder, 'summary.png'))
    draw_panels([panel(scene, scene.replace('_', ' ')) for scene in scenes], min(5, len(scenes)), (4.0, 3.0), heading,
                rows, os.path.join(folder, 'all.png'))


def draw_crowds(times, rows, folder):
    draw_panels([
        ('mean time of a step', lambda axes: draw_crowd_panel(axes, times, rows, lambda *crowd: times[crowd][0], 'time [µs]')),
        ('depth below the floor, or movement at rest', lambda axes: draw_crowd_panel(
            axes, times, rows, lambda *crowd: max(crowd_error(rows, *crowd), SMALLEST_CROWD), 'error [mm]'))],
                2, (6.0, 4.8), 'Fastest setting of each engine that did not fail: lower is better', rows, os.path.join(folder, 'crowds.png'))


def draw_cost(rows, folder):
    groups = grouped(rows, lambda r: r.scene.rsplit('_', 1)[0])
    for name, of_group in groups.items():
        shortest = min(r.step for r in of_group)
        figure, axes = plt.subplots(figsize=(12, 6.5), dpi=100)
        figure.subplots_adjust(left=0.08, right=0.53, top=0.9, bottom=0.1)
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
        figure.text(0.09, 0.01, footnote(of_group), fontsize=6, color='#555555')
        figure.savefig(os.path.join(folder, name + '.png'))
        plt.close(figure)


def main(arguments):
    if len(arguments) != 2:
        print('usage: plot_speed_accuracy.py FILE.csv', file=sys.stderr)
        return 2
    rows, folder = read(arguments[1]), os.path.dirname(os.path.abspath(arguments[1]))
    scenes = grouped((r for r in rows if not r.scene.startswith((COST_PREFIX, CROWD_PREFIX))), lambda r: r.scene)
    for scene, of_scene in scenes.items():
        draw_scene(scene, of_scene, folder)
    if scenes:
        draw_fronts(scenes, folder)
    times = read_times(os.path.join(folder, 'step_times.csv'))
    if times:
        draw_crowds(times, [r for r in rows if r.scene.startswith(CROWD_PREFIX)], folder)
    draw_cost([r for r in rows if r.scene.startswith(COST_PREFIX)], folder)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv))
