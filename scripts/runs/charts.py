"""Charts of an explanation, as SVG for a page."""

import io
import re

import matplotlib
matplotlib.use('Agg')
from matplotlib.backends.backend_svg import FigureCanvasSVG  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.ticker import StrMethodFormatter  # noqa: E402
import numpy  # noqa: E402

from .grip import FINGERS, PALM, utilisation  # noqa: E402

matplotlib.rcParams.update({'font.size': 8, 'axes.titlesize': 8, 'axes.titleweight': 'bold', 'axes.spines.top': False,
                            'axes.spines.right': False, 'svg.fonttype': 'none', 'svg.hashsalt': 'mr_hand_interaction'})

WIDTH = 9.6  # inches
CHART, STRIP, EDGE = 1.15, 0.2, 0.42  # heights of a chart, a strip's row, and what is around each
MAX_GAP = 0.1  # s; a curve with a longer gap is two
FINGER_COLOURS = ('#d55e00', '#0072b2', '#009e73', '#cc79a7', '#e69f00', '#555555')  # Okabe & Ito's
STATE_COLOURS = {'free': '#f0f0f0', 'contact': '#f3dfa2', 'hold': '#9fd6c2', 'slip': '#e69f00', 'drop': '#c5d3ea'}
STICKS, SLIPS, ASSIST, SHADE = '#9fd6c2', '#f0e442', '#d7c4e8', '#eee3f5'
GRASP_MARK, LOSS_MARK, JOINT_MARK, ASSIST_INK, INK = '#009e73', '#d55e00', '#0072b2', '#7b4ea3', '#333333'
MAX_UTILISATION, MAX_BEARABLE = 2.0, 5.0  # larger values are cut off
DRAWING = 2.35  # inches
JOINT_EVENTS = ('JOINT_LIMIT', 'DETENT', 'LATCH_OPEN')


class Chart:
    """Curves over time: (colour, times, values). The axis ends between `top` and `most`."""

    def __init__(self, title, curves, top, most=None, lines=()):
        self.title, self.curves, self.top, self.most, self.lines = title, curves, top, most, lines
        self.height = CHART

    def draw(self, axes, start, until):
        values = [0.0, self.top]
        for colour, times, curve in self.curves:
            times, curve = numpy.asarray(times, float), numpy.asarray(curve, float)
            kept = (times >= start) & (times <= until)
            times, curve = times[kept], curve[kept] if self.most is None else numpy.minimum(curve[kept], self.most)
            values += [value for value in (curve.min(), curve.max()) if numpy.isfinite(value)] if len(curve) else []
            gaps = numpy.flatnonzero(numpy.diff(times) > MAX_GAP) + 1
            axes.plot(numpy.insert(times, gaps, numpy.nan), numpy.insert(curve, gaps, numpy.nan), color=colour, linewidth=1.2)
        for value in self.lines:
            if min(values) <= value <= max(values):
                axes.axhline(value, color='#777777', linewidth=0.8, linestyle=':')
        axes.set_ylim(min(values), max(values) + 0.05 * (max(values) - min(values)))
        axes.locator_params(axis='y', nbins=4)
        axes.grid(True, color='#ededed')


class Strips:
    """Rows with coloured spans of time: (name, [(start, until, colour, label)])."""

    def __init__(self, title, rows):
        self.title, self.rows = title, rows
        self.height = STRIP * max(1, len(rows))

    def draw(self, axes, start, until):
        for y, (_, spans) in enumerate(self.rows):
            for begin, end, colour, label in spans:
                begin, end = max(begin, start), min(end, until)
                if end < begin:
                    continue
                axes.barh(y, max(end - begin, 5e-4 * (until - start)), left=begin, height=0.9, color=colour, linewidth=0)
                if (end - begin) / (until - start) > 0.013 * len(label):
                    axes.text(begin, y, ' ' + label, va='center', fontsize=7)
        axes.set_ylim(len(self.rows) - 0.5, -0.5)
        axes.set_yticks(range(len(self.rows)))
        axes.set_yticklabels([name for name, _ in self.rows])


def drawn(charts, start, until, marks=(), shades=()):
    """Charts over the same time, one below the other. `marks`: (time, colour) of lines across; `shades`: (start, until)."""
    until = max(until, start + 1e-3)
    heights = [chart.height + EDGE for chart in charts]
    figure = Figure(figsize=(WIDTH, sum(heights)))
    top = sum(heights)
    for chart, height in zip(charts, heights):
        top -= height
        axes = figure.add_axes([0.065, (top + 0.2) / sum(heights), 0.92, chart.height / sum(heights)])
        for begin, end in shades:
            if end > start and begin < until:
                axes.axvspan(max(begin, start), min(end, until), color=SHADE, linewidth=0)
        chart.draw(axes, start, until)
        for time, colour in marks:
            if start <= time <= until:
                axes.axvline(time, color=colour, linewidth=1.2, linestyle='--')
        axes.set_xlim(start, until)
        axes.set_title(chart.title, loc='left', pad=3)
        axes.xaxis.set_major_formatter(StrMethodFormatter('{x:.3g} s'))
    return _svg(figure)


def _svg(figure):
    """SVG without the header of a separate file."""
    FigureCanvasSVG(figure)
    text = io.StringIO()
    figure.savefig(text, format='svg')
    svg = text.getvalue()
    svg = re.sub(r'<metadata>.*?</metadata>', '', svg[svg.index('<svg'):], flags=re.DOTALL)
    return re.sub(r' xmlns(:\w+)?="[^"]*"', '', svg)


def spans_of(times, looks):
    """Spans of samples with the same look, (colour, label); None: no span."""
    spans, before = [], None
    for time, look in zip(times, looks):
        if before is not None:
            spans[-1][1] = time
        if look is not None and look != before:
            spans.append([time, time] + list(look))
        before = look
    return spans


def grip_charts(thing, start, until, whole):
    """Charts of the fingers on an object; if `whole`, also of its state, depths, margins and torque."""
    charts = []
    if whole:
        rows = [('', spans_of(thing.time, [(STATE_COLOURS[state], state) for state in thing.state]))]
        if thing.assisted.any():
            rows.append(('assist', spans_of(thing.time, [(ASSIST, 'grasp assist') if active else None
                                                         for active in thing.assisted])))
        charts.append(Strips('free, contact, hold, slip (all fingers slide), drop', rows))
    charts.append(Chart('normal force of each finger [N]', _of_fingers(thing, lambda touch: touch.normal), 0.1))
    charts.append(Chart('friction utilisation (dotted: 1, slipping; above 1, grasp assist or an edge carries the rest)',
                        _of_fingers(thing, utilisation), 1.2, MAX_UTILISATION, (1.0,)))
    if whole and thing.assisted.any():
        charts.append(Chart('force of grasp assist (violet) and of all contacts together [N]',
                            [(ASSIST_INK, thing.time, thing.assist), (INK, thing.time, thing.carried)], 0.1))
    rows = [(FINGERS[finger], spans_of(thing.time, [_stick_or_slip(touches, finger) for touches in thing.touches]))
            for finger in range(PALM + 1)]
    rows = [(name, spans) for name, spans in rows if any(span[1] >= start and span[0] <= until for span in spans)]
    if rows:
        charts.append(Strips('sticks (green) or slips (yellow), and on which face', rows))
    if whole:
        touched = numpy.array([bool(touches) for touches in thing.touches])

        def of_grip(values):
            return [(INK, thing.time[touched], numpy.abs(values[touched]))]
        charts += [
            Chart('depth of each finger [mm]', _of_fingers(thing, lambda touch: 1e3 * touch.depth), 1.0),
            Chart('friction margin for a straight pull [N]', of_grip(thing.margin), 0.1),
            Chart('safety factor: how many times the load (force and torque) friction can carry (dotted: 1, slipping; 5: or '
                  'more)', of_grip(thing.bearable), 2.0, MAX_BEARABLE, (1.0,)),
            Chart('torque about the line through the grip [N m]', of_grip(thing.torque), 1e-3)]
    return charts


def _of_fingers(thing, value):
    curves = [(colour, [], []) for colour in FINGER_COLOURS]
    for time, touches in zip(thing.time, thing.touches):
        for touch in touches:
            curves[touch.finger][1].append(time)
            curves[touch.finger][2].append(value(touch))
    return [curve for curve in curves if curve[1]]


def _stick_or_slip(touches, finger):
    for touch in touches:
        if touch.finger == finger:
            return (SLIPS if touch.slips else STICKS, touch.face)
    return None


def joint_chart(joint):
    limits = [limit for limit in (joint.lower, joint.upper) if numpy.isfinite(limit)]
    return Chart('position [%s] (dotted: limits; blue: %s)' % ('rad' if joint.turns else 'm', ', '.join(JOINT_EVENTS)),
                 [(INK, joint.time, joint.position)], 0.1 if joint.turns else 0.005, None, limits)


def hand_charts(hand):
    charts = [Chart('hand %d: speed of the palm [m/s] (shaded: not seen by the tracker, or no frame)' % hand.id,
                    [(INK, hand.time, hand.speed)], 0.1)]
    if (hand.confidence != 1.0).any():
        charts.append(Chart("hand %d: the tracker's confidence" % hand.id, [(JOINT_MARK, hand.time, hand.confidence)], 1.0, 1.0))
    return charts


def drawings(thing, hand, times):
    """Line drawings of hand and object at these times, from two sides."""
    figure = Figure(figsize=(2 * len(times) * (DRAWING + 0.05), DRAWING))
    for k, time in enumerate(times):
        i = thing.sample_at(time)
        for right in (0, 1):
            axes = figure.add_axes([(2 * k + right) / (2.0 * len(times)), 0.0, 0.49 / len(times), 1.0])
            extent = 0.06 + 2.0 * thing.radius
            axes.set_xlim(thing.position[i][right] - extent, thing.position[i][right] + extent)
            axes.set_ylim(thing.position[i][2] - extent, thing.position[i][2] + extent)
            _draw(axes, thing, i, hand, right, DRAWING * 72.0 / (2.0 * extent))
            axes.set_xticks([])
            axes.set_yticks([])
            axes.text(0.02, 0.94, '%.3g s, seen along %s%s' % (thing.time[i], 'yx'[right], '' if thing.half.any() else
                                                              '; circle: all of it'), transform=axes.transAxes, fontsize=7)
    return _svg(figure)


def _draw(axes, thing, i, hand, right, points_per_metre):
    place = thing.position[i]
    touching = {touch.finger for touch in thing.touches[i] if touch.hand_id == hand.id}
    sample = min(int(numpy.searchsorted(hand.time, thing.time[i] - 1e-6)), len(hand.time) - 1)
    phalanges = hand.phalanges[hand.phalanges['frame'] == hand.frame[sample]]
    for bone in phalanges.itertuples(index=False):
        start, end = (bone.sx, bone.sy, bone.sz), (bone.ex, bone.ey, bone.ez)
        axes.plot([start[right], end[right]], [start[2], end[2]], color=FINGER_COLOURS[min(int(bone.finger), PALM)],
                  alpha=0.8 if bone.finger in touching else 0.35, linewidth=2.0 * bone.radius * points_per_metre,
                  solid_capstyle='round')
    if not thing.half.any():
        angle = numpy.linspace(0.0, 2.0 * numpy.pi, 60)
        axes.plot(place[right] + thing.radius * numpy.cos(angle), place[2] + thing.radius * numpy.sin(angle), color='k',
                  linewidth=1.0)
        return
    corners = numpy.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * thing.half
    axis, w = thing.orientation[i][:3], thing.orientation[i][3]
    corners = place + corners + 2.0 * numpy.cross(axis, numpy.cross(axis, corners) + w * corners)
    for a in range(8):
        for b in (a ^ 1, a ^ 2, a ^ 4):
            if b > a:
                axes.plot(corners[[a, b], right], corners[[a, b], 2], color='k', linewidth=1.0)
