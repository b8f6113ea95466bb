"""A run as a demonstration for further use: objects, hands and events at common times, as one CSV and as a bag with only
standard messages."""

import numpy
import pandas

from .grip import FINGERS, PALM, mean_forces, summed
from .tables import vectors, write_text

SIDES = ('left', 'right')
POSE = ('px', 'py', 'pz', 'qx', 'qy', 'qz', 'qw')
WRENCH = ('fx', 'fy', 'fz', 'tx', 'ty', 'tz')
BONES = [(finger, bone) for finger in range(PALM) for bone in range(4)]
MIN_BONE = 1e-6  # m; some trackers give the thumb a metacarpal without length


class Body:
    """Poses of an object or a hand by frame, NaN where it is missing; for an object also wrench and held, for a hand bones."""

    def __init__(self, count):
        self.pose = numpy.full((count, 7), numpy.nan)
        # Force of all hands [N] and torque about the centre of mass [N m]: means since the frame before, with impulses.
        self.wrench = numpy.zeros((count, 6))
        self.held = numpy.zeros(count, int)
        self.bones = numpy.full((count, len(BONES), 6), numpy.nan)  # start and end [m]

    def is_there(self):
        return ~numpy.isnan(self.pose[:, 0])

    def between(self, before, after, fraction, unit):
        """At times between two frames; held is that of the frame before. `unit`: orientations are normalised."""
        body = Body(len(before))
        body.pose, body.held, body.bones = (values[before].copy() for values in (self.pose, self.held, self.bones))
        both = self.is_there()[before] & self.is_there()[after] & (fraction > 0.0)
        a, b, t = before[both], after[both], fraction[both][:, None]
        body.pose[both, :3] += t * (self.pose[b, :3] - self.pose[a, :3])
        body.pose[both, 3:] = _slerp(self.pose[a, 3:], self.pose[b, 3:], t)
        if unit:
            body.pose[both, 3:] /= numpy.linalg.norm(body.pose[both, 3:], axis=1)[:, None]
        start = numpy.where(numpy.isnan(self.bones[a]), self.bones[b], self.bones[a])
        body.bones[both] = start + t[:, :, None] * (self.bones[b] - start)
        return body


def _slerp(a, b, t):
    """The shorter rotation from one orientation to another."""
    dot = numpy.sum(a * b, axis=1)[:, None]
    angle = numpy.arccos(numpy.minimum(numpy.abs(dot), 1.0))
    near = numpy.abs(dot) >= 1.0 - numpy.finfo(float).eps
    sine = numpy.where(near, 1.0, numpy.sin(angle))
    scale_a = numpy.where(near, 1.0 - t, numpy.sin((1.0 - t) * angle) / sine)
    scale_b = numpy.where(near, t, numpy.sin(t * angle) / sine)
    return scale_a * a + numpy.where(dot < 0.0, -scale_b, scale_b) * b


def _means(wrench, stamps, times):
    """Means of a wrench since the time before, from its means since the stamp before: the integral stays the same."""
    integral = numpy.cumsum(wrench * numpy.diff(stamps, prepend=stamps[0])[:, None], axis=0)
    integral = numpy.column_stack([numpy.interp(times, stamps, column) for column in integral.T])
    return numpy.vstack([wrench[:1], numpy.diff(integral, axis=0) / numpy.diff(times)[:, None]])


class Demonstration:
    """Bodies by frame; the frames since the recording's stamps last began anew."""

    def __init__(self, stamps, objects, hands, events):
        self.stamps, self.objects, self.hands, self.events = stamps, objects, hands, events

    def at_rate(self, rate):
        """The same at even times, so many per second: positions on straight lines between frames, rotations the shortest
        way; events at the first time after them."""
        stamps = numpy.arange(self.stamps[0], self.stamps[-1] + 1, int(round(1e9 / rate)))
        after = numpy.searchsorted(self.stamps, stamps)
        before = numpy.where(self.stamps[after] == stamps, after, after - 1)
        step = numpy.maximum(self.stamps[after] - self.stamps[before], 1)
        fraction = (stamps - self.stamps[before]) / step
        objects = {name: body.between(before, after, fraction, False) for name, body in self.objects.items()}
        for name, body in objects.items():
            body.wrench = _means(self.objects[name].wrench, self.stamps, stamps)
        events, told = [], 0
        for count in numpy.searchsorted(self.stamps, stamps, side='right'):
            events.append([event for frame in self.events[told:count] for event in frame])
            told = count
        return Demonstration(
            stamps, objects, {side: body.between(before, after, fraction, True) for side, body in self.hands.items()}, events)

    def table(self):
        columns = {'time': (self.stamps - self.stamps[0]) / 1e9}
        for name, body in self.objects.items():
            _add(columns, name + '.', POSE, body.pose)
            there = body.is_there()
            _add(columns, name + '.', WRENCH + ('held',), numpy.where(
                there[:, None], numpy.column_stack([body.wrench, body.held]), numpy.nan))
        for side, body in self.hands.items():
            _add(columns, side + '.palm.', POSE, body.pose)
            _add(columns, side + '.wrist.', 'xyz', keypoints(body.bones)[:, 0])
            for i, (finger, bone) in enumerate(BONES):
                _add(columns, '%s.%s_%d.' % (side, FINGERS[finger], bone), 'xyz', body.bones[:, i, 3:])
        columns['events'] = ['; '.join(events) for events in self.events]
        return pandas.DataFrame(columns)


def _add(columns, before, names, values):
    columns.update((before + name, values[:, i]) for i, name in enumerate(names))


def demonstration_of(run):
    stamps = run.frames['stamp'].to_numpy()
    begins = numpy.flatnonzero(numpy.diff(stamps) <= 0)
    first = int(begins[-1]) + 1 if len(begins) else 0
    count, step = len(stamps) - first, numpy.diff(stamps[first:], prepend=stamps[first]) / 1e9

    def since(table):
        """Rows of the frames that count, and their place among these."""
        kept = table[table['frame'] >= first]
        return kept, kept['frame'].to_numpy(int) - first

    objects, hands = {}, {}
    table, _ = since(run.objects)
    contacts, _ = since(run.contacts)
    for name, rows in table.groupby('name'):
        objects[name] = _object(since(rows), since(contacts[contacts['object'] == name]), step)
    palms, _ = since(run.palms.drop_duplicates(['frame', 'side']))
    for side in sorted(palms['side'].unique()):
        hands[SIDES[side]] = _hand(since(palms[palms['side'] == side]), since(run.phalanges), count)
    events = [[] for _ in range(count)]
    kept, rows = since(run.events)
    for row, kind, name in zip(rows, kept['kind'], kept['object']):
        events[row].append(kind + (' ' + name if name else ''))
    return Demonstration(stamps[first:], objects, hands, events)


def _object(table, contacts, step):
    """`step`: time since the frame before [s]."""
    body, (rows, place), (touches, contact_place) = Body(len(step)), table, contacts
    body.pose[place] = vectors(rows, POSE)
    body.held[place] = rows['held'].to_numpy()
    force = mean_forces(touches, step[contact_place])
    arm = vectors(touches, ('x', 'y', 'z')) - body.pose[contact_place, :3]
    by_pad = touches['torque'].to_numpy()[:, None] * vectors(touches, ('nx', 'ny', 'nz'))
    body.wrench = summed(contact_place, numpy.hstack([force, numpy.cross(arm, force) + by_pad]), len(step))
    return body


def _hand(palms, phalanges, count):
    body, (rows, place), (bones, bone_place) = Body(count), palms, phalanges
    body.pose[place] = vectors(rows, POSE)
    hand = numpy.full(count, -1)
    hand[place] = rows['hand_id'].to_numpy()
    kept = (bones['hand_id'].to_numpy() == hand[bone_place]) & (bones['finger'].to_numpy() < PALM)
    put_bones(bones[kept], bone_place[kept], body.bones)
    return body


def put_bones(phalanges, places, bones):
    """Rows of hands.csv into bones (frames, 20, 6): start and end of each [m]."""
    bones[places, 4 * phalanges['finger'].to_numpy() + phalanges['bone'].to_numpy()] = vectors(
        phalanges, ('sx', 'sy', 'sz', 'ex', 'ey', 'ez'))


def keypoints(bones):
    """(frames, 21, 3) [m]: wrist, then the four joints of each finger from the palm to its tip, thumb first: the order of MediaPipe
    and MANO. The wrist is where the metacarpals of the four fingers begin, in their middle."""
    starts = bones[:, 4::4, :3]
    there = ~numpy.isnan(starts)
    wrist = numpy.where(there, starts, 0.0).sum(axis=1) / numpy.where(there.any(axis=1), there.sum(axis=1), numpy.nan)
    return numpy.concatenate([wrist[:, None], bones[:, :, 3:]], axis=1)


def joint_angles(bones):
    """{name: angle [rad]} between the bones at each joint of a hand, 0 where it is straight: index_1 to index_3."""
    angles = {}
    for i, (finger, bone) in enumerate(BONES):
        if bone == 0 or numpy.isnan(bones[[i - 1, i], 0]).any():
            continue
        u, v = (bones[k, 3:] - bones[k, :3] for k in (i - 1, i))
        if min(numpy.linalg.norm(u), numpy.linalg.norm(v)) >= MIN_BONE:
            angles['%s_%d' % (FINGERS[finger], bone)] = float(numpy.arctan2(numpy.linalg.norm(numpy.cross(u, v)), u @ v))
    return angles


def write_csv(demonstration, path):
    write_text(path, demonstration.table().to_csv(index=False, float_format='%.12g'))
