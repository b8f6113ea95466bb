"""The tables of the race in docs, made of what scripts/benchmark writes; scripts/figures --page engines."""
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
    Line('the same: true slip', 'pinch_swing_slip', STEP, 'mm'),
    Line('pinch, shaken 5 cm at 3 Hz', 'pinch_shake', STEP, 'mm'),
    Line('pinch, noisy hand of 120 Hz', 'pinch_noisy', STEP, 'mm'),
    Line('pinch, noisy hand of 1 kHz', 'pinch_noisy_1khz', STEP, 'mm'),
    Line('the same, one step per frame', 'pinch_noisy_1khz', FRAME, 'mm'),
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
MESHES = [
    Line('a box', 'pinch_swing', STEP, 'mm'),
    Line('972 triangles', 'pinch_swing_mesh_972', STEP, 'mm'),
    Line('10 092 triangles', 'pinch_swing_mesh_10092', STEP, 'mm'),
]
JOINTS = [
    Line('door', 'door_place', STEP, 'mm'),
    Line('door, 8.33 ms', 'door_place', FRAME, 'mm'),
    Line('valve', 'valve_place', STEP, 'mm'),
]
CROWD_ENGINES = (plot.OURS, 'jolt', 'box3d', 'ode', 'mujoco')
STIFF = 'implicit; stiffness 2000000'
HANDS = collections.OrderedDict([("ours, paper's hand", 'implicit'), ('shipped hand', 'implicit; shipped hand')])  # settings
STIFF_HANDS = collections.OrderedDict([("ours, paper's hand", 'implicit'), ('the same, 2 000 000 N/m', STIFF),
                                       ('shipped hand', 'implicit; shipped hand')])


def read(folder):
    times = plot.read_times(os.path.join(folder, 'step_times.csv'))
    return plot.read(os.path.join(folder, 'speed_accuracy.csv')), times


def number(value):
    text = '%.0f' % value if 10 <= value < 1e4 else '%.2g' % value
    return re.sub('e-0?', 'e-', text)


def cell(row):
    return '%s, %s' % (number(row.error if row.error > 1e-15 else 0), number(row.time))


def results(rows, lines=LINES, hands=HANDS):
    """Ours with these hands, the peer with the shortest step and the one with the smallest error, in each scene."""
    cells_of_lines = []
    for line in lines:
        of, ours = in_scene(rows, line.scene, line.step)
        peers = peers_that_hold(of)
        if not ours:
            continue
        best = [min(peers, key=key, default=None) for key in (
            lambda r: r.time, lambda r: (max(r.error, ROUNDING), r.time))]
        cells = ['' if line.scene in plot.UNMOVABLE and 'shipped' in hand else
                 'failed' if ours[hand].failed else cell(ours[hand]) for hand in hands.values()]
        cells_of_lines.append(['%s [%s]' % (line.label, line.unit), *cells, *(
            'failed' if peer is None else '%s %s' % (plot.label_of(peer.engine), cell(peer)) for peer in best)])
    return ['error, µs', *hands, 'fastest peer', 'most accurate peer'], cells_of_lines


def peers_that_hold(rows):
    return [r for r in rows if r.engine != plot.OURS and not r.failed]


def in_scene(rows, scene, step):
    """Rows, and ours by setting."""
    of = [r for r in rows if r.scene == scene and r.step == step and r.time > 0]
    return of, {r.setting: r for r in of if r.engine == plot.OURS}


def long_steps(rows):
    """The swung pinch at one step per frame: the most accurate peer, and ours with stiff contacts."""
    of, ours = in_scene(rows, 'pinch_swing', FRAME)
    peer = min(peers_that_hold(of), key=lambda r: (r.error, r.time))
    frame = ours['implicit; shipped hand; stiffness 2000000; whole frame']
    return '%s is off by %s mm in %s µs a step; ours at 2 000 000 N/m by %s mm in %s µs, with the shipped hand and its ' \
        'rendering by %s mm in %s µs' % (plot.label_of(peer.engine), *(
            number(value) for row in (peer, ours[STIFF], frame) for value in (row.error, row.time)))


def whole_frame(rows):
    """The swung pinch at 1 ms: our step, our frame, and the fastest peer's step."""
    of, ours = in_scene(rows, 'pinch_swing', STEP)
    peer = min(peers_that_hold(of), key=lambda r: r.time)
    return "%s µs and the whole frame %s µs; the fastest peer's step takes %s µs (%s)" % (
        *(number(row.time) for row in (ours['implicit'], ours['implicit; whole frame'], peer)), plot.label_of(peer.engine))


def crowds(rows, times):
    """Mean and maximum of a step, and the error, of each engine's fastest setting that did not fail."""
    engines = [engine for engine in CROWD_ENGINES if any(r.engine == engine for r in rows)]
    lines = []
    for label, scene in plot.CROWDS:
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


def slowest_crowd(rows, times):
    """Our mean step over the fastest engine's, in the crowd where this is largest."""
    ratios = []
    for _, scene in plot.CROWDS:
        best = {engine: times[(scene, engine, setting)][0] for engine in CROWD_ENGINES
                for setting in [plot.best_setting(times, rows, scene, engine)] if setting is not None}
        if plot.OURS in best:
            ratios.append(best[plot.OURS] / min(best.values()))
    return number(max(ratios))


def versions(rows):
    """{engine: version} of the peers."""
    return collections.OrderedDict((plot.label_of_engine(r.engine), r.version) for r in rows if r.engine != plot.OURS)


def described(versions_of, date):
    """One sentence of the page."""
    return '%s; measured on %s' % (', '.join('%s %s' % item for item in versions_of.items()), date)
