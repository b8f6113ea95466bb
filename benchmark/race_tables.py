"""The tables of docs/speed_accuracy.md, made of what scripts/benchmark writes; scripts/figures --page engines."""
import collections
import os
import re

import plot_speed_accuracy as plot

ROUNDING = 1e-12
STEP, FRAME = 0.001, 0.008333333  # [s]

# Label, scene, step, unit, as in the page's table.
Line = collections.namedtuple('Line', 'label scene step unit')
LINES = [
    Line('pinch, swung 10 cm at 0.5 Hz', 'pinch_swing', STEP, 'mm'),
    Line('the same, one step per frame of 8.33 ms', 'pinch_swing', FRAME, 'mm'),
    Line('pinch, shaken 5 cm at 3 Hz', 'pinch_shake', STEP, 'mm'),
    Line('pinch, noisy hand of 120 Hz', 'pinch_noisy', STEP, 'mm'),
    Line('pinch, noisy hand of 1 kHz', 'pinch_noisy_1khz', STEP, 'mm'),
    Line('creep at 1 g', 'creep_1g', STEP, 'µm/s'),
    Line('slap: speed', 'slap_speed', STEP, '%'),
    Line('plates missed, one step per frame', 'plate', FRAME, '%'),
    Line('sliding to a stop', 'sliding', STEP, '%'),
    Line('bouncing: energy', 'bouncing', STEP, '%'),
    Line('27 elastic balls: energy', 'elastic_energy', STEP, '%'),
    Line('stack of three at 1 g', 'stack', STEP, 'mm'),
    Line('ball caught: speed left', 'catch', STEP, 'm/s'),
    Line('recorded hand', 'recording', STEP, 'mm'),
    Line('scripted hand', 'scripted_hand', STEP, 'mm'),
    Line('1000 cubes far apart', 'cost_far_1000', STEP, 'mm'),
    Line('1000 cubes near each other', 'cost_near_1000', STEP, 'mm'),
    Line('1000 cubes on a floor', 'cost_touching_1000', STEP, 'mm'),
]
CROWDS = [('8 dice dropped', 'crowd_heap_8'), ('50 cubes dropped', 'crowd_heap_50'),
          ('a wall of 48 bricks falls', 'crowd_wall_48'), ('a hand pushes 50 blocks', 'crowd_push_50'),
          ('50 cubes at rest, gaps of 20 µm', 'crowd_block_50'), ('50 of them, no gaps', 'crowd_flush_50'),
          ('200 of them, gaps of 5 µm', 'crowd_close_200'), ('1000 of them, gaps of 20 µm', 'crowd_block_1000')]
CROWD_ENGINES = (plot.OURS, 'jolt', 'box3d', 'ode', 'mujoco')
HANDS = ('implicit', 'implicit; shipped hand')


def read(folder):
    times = plot.read_times(os.path.join(folder, 'step_times.csv'))
    return plot.read(os.path.join(folder, 'speed_accuracy.csv')), times


def number(value):
    text = '%.0f' % value if 10 <= value < 1e4 else '%.2g' % value
    return re.sub('e-0?', 'e-', text)


def cell(row):
    return '%s, %s' % (number(row.error if row.error > 1e-15 else 0), number(row.time))


def results(rows):
    """Ours with either hand, the peer with the shortest step and the one with the smallest error, in each scene."""
    lines = []
    for line in LINES:
        of = [r for r in rows if r.scene == line.scene and r.step == line.step and r.time > 0]
        ours = {r.setting: r for r in of if r.engine == plot.OURS}
        peers = [r for r in of if r.engine != plot.OURS and not r.failed]
        if not ours:
            continue
        best = [min(peers, key=key, default=None) for key in (
            lambda r: r.time, lambda r: (max(r.error, ROUNDING), r.time))]
        hands = HANDS if line.scene not in plot.UNMOVABLE else HANDS[:1]
        cells = ['failed' if ours[hand].failed else cell(ours[hand]) for hand in hands]
        lines.append(['%s [%s]' % (line.label, line.unit), *cells, *[''] * (2 - len(hands)), *(
            'failed' if peer is None else '%s %s' % (plot.label_of(peer.engine), cell(peer)) for peer in best)])
    return ['error, µs', "ours, paper's hand", 'shipped hand', 'fastest peer', 'most accurate peer'], lines


def crowds(rows, times):
    """Mean and maximum of a step, and the error, of each engine's fastest setting that did not fail."""
    engines = [engine for engine in CROWD_ENGINES if any(r.engine == engine for r in rows)]
    lines = []
    for label, scene in CROWDS:
        if not any(plot.of_crowd(row, scene) for row in rows):
            continue
        cells = []
        for engine in engines:
            best = plot.best_setting(times, rows, scene, engine)
            ran = any(r.engine == engine and plot.of_crowd(r, scene) for r in rows)
            cells.append(('failed' if ran else 'not run') if best is None else '%s, %s; %s' % (
                *('%.2g' % time if time < 10 else '%.0f' % time for time in times[(scene, engine, best)]),
                number(plot.crowd_error(rows, scene, engine, best))))
        lines.append([label, *cells])
    return ['mean, maximum [µs]; error [mm]', *map(plot.label_of_engine, engines)], lines


def versions(rows):
    """{engine: version} of the peers."""
    return collections.OrderedDict((plot.label_of_engine(r.engine), r.version) for r in rows if r.engine != plot.OURS)


def described(versions_of, date):
    """One sentence of the page."""
    return '%s; measured on %s' % (', '.join('%s %s' % item for item in versions_of.items()), date)
