"""A run, from its tables: objects with their samples, hands, joints and events."""

import collections
import re

import numpy

from . import grip
from .demonstration import BONES, keypoints, put_bones
from .tables import vectors

LEVELS = ('none', 'hover', 'contact', 'grasp')
CONTACT, GRASP = 2, 3
MAX_HAND_SPEED = 12.0  # m/s; default of tracking/max_speed: a faster hand has jumped
KIND_OF_GRASP, KIND_OF_GRASP_END = 'GRASP_BEGIN', 'GRASP_END'

JointStory = collections.namedtuple('JointStory', 'name body turns lower upper time position')
Event = collections.namedtuple('Event', 'time kind object hand_id frame')
Change = collections.namedtuple('Change', 'time text')  # s, of the frame after which it was made; `text` has the time too


class ObjectStory:
    """An object's samples, one per frame in which it exists."""

    def __init__(self, name, body, table, contacts):
        self.name = name
        self.mass, self.static_friction, self.dynamic_friction, self.radius = (
            float(body[key]) for key in ('mass', 'static_friction', 'dynamic_friction', 'radius'))
        self.joint = body['joint']
        self.half = numpy.array([float(body[key]) for key in ('hx', 'hy', 'hz')])
        self.time, self.frame = table['time'].to_numpy(), table['frame'].to_numpy()
        self.position = vectors(table, ('px', 'py', 'pz'))
        self.orientation = vectors(table, ('qx', 'qy', 'qz', 'qw'))
        self.velocity = vectors(table, ('vx', 'vy', 'vz'))
        self.level = table['level'].to_numpy()
        self.assisted = table['assisted'].to_numpy() == 1
        assist = vectors(table, ('assist_fx', 'assist_fy', 'assist_fz'))
        self.assist = numpy.linalg.norm(assist, axis=1)  # force [N]
        self._add_contacts(contacts)
        self.force += assist
        self.state = self._states()

    def _add_contacts(self, contacts):
        sample = {frame: i for i, frame in enumerate(self.frame)}
        rows = numpy.array([sample.get(frame, -1) for frame in contacts['frame']], int)
        contacts, rows = contacts[rows >= 0], rows[rows >= 0]
        step = numpy.diff(self.time, prepend=self.time[:1])
        self.force = grip.summed(rows, grip.mean_forces(contacts, step[rows]), len(step))  # of hands and assist, by mean [N]
        touching = contacts['touching'].to_numpy() == 1
        held, held_rows = contacts[touching], rows[touching]
        self.touches = grip.touches_of(held, held_rows, self.orientation)
        self.carried = numpy.linalg.norm(grip.summed(held_rows, vectors(held, ('fx', 'fy', 'fz')), len(self.time)), axis=1)  # [N]
        self.torque = grip.torques(held, held_rows, len(self.time))
        self.margin, self.bearable = grip.margins(held, held_rows, self.position)
        self.impacts = [[] for _ in self.time]  # fingers that hit it and have separated
        self.impact_hand = {}  # hand, by sample
        hit = ~touching & vectors(contacts, ('jx', 'jy', 'jz')).any(axis=1)
        for row, finger, hand in zip(rows[hit], contacts['finger'][hit], contacts['hand_id'][hit]):
            if finger not in self.impacts[row]:
                self.impacts[row].append(int(finger))
            self.impact_hand[row] = int(hand)

    def _states(self):
        """free, contact, hold, slip (all fingers slide) or drop (free since it was held)."""
        states, before, before_level = [], 'free', 0
        for touches, level in zip(self.touches, self.level):
            if level == GRASP:
                state = 'slip' if all(touch.slips for touch in touches) else 'hold'
            elif touches or level == CONTACT:
                state = 'contact'
            elif before == 'free':
                state = 'free'
            else:
                state = 'drop' if before_level == GRASP or before == 'drop' else 'free'
            states.append(state)
            before, before_level = state, level
        return states

    def is_with_hand(self, i):
        return self.level[i] == GRASP or bool(self.touches[i]) or bool(self.impacts[i])

    def sample_at(self, time):
        """Index of the first sample from that time on, or None."""
        later = numpy.flatnonzero(self.time >= time - 1e-6)
        return int(later[0]) if len(later) else None


class HandStory:
    """A hand's samples, one per frame in which it exists."""

    def __init__(self, hand_id, palms, phalanges):
        self.id = hand_id
        self.time, self.frame = palms['time'].to_numpy(), palms['frame'].to_numpy()
        self.palm = vectors(palms, ('px', 'py', 'pz'))
        self.confidence = palms['confidence'].to_numpy()
        self.lost = palms['lost'].to_numpy() == 1
        step = numpy.diff(self.time)
        distance = numpy.linalg.norm(numpy.diff(self.palm, axis=0), axis=1)
        self.speed = numpy.concatenate([[0.0], numpy.where(step > 0.0, distance / numpy.where(step > 0.0, step, 1.0), 0.0)])
        self.phalanges = phalanges  # rows of hands.csv
        self.tips = self._tips()

    def _tips(self):
        """End of each finger's last bone, sample by finger; the centre of the palm counts as one."""
        tips = numpy.full((len(self.time), 6, 3), numpy.nan)
        tips[:, grip.PALM] = self.palm
        last = self.phalanges[self.phalanges['finger'] < grip.PALM].drop_duplicates(['frame', 'finger'], keep='last')
        sample = {frame: i for i, frame in enumerate(self.frame)}
        rows = [sample[frame] for frame in last['frame']]
        tips[rows, last['finger'].to_numpy(int)] = vectors(last, ('ex', 'ey', 'ez'))
        return tips

    def keypoints(self, frame):
        """The 21 joints in a frame, as exports have them (demonstration.keypoints); nan where unknown [m]."""
        rows = self.phalanges[(self.phalanges['frame'] == frame) & (self.phalanges['finger'] < grip.PALM)]
        bones = numpy.full((1, len(BONES), 6), numpy.nan)
        put_bones(rows, 0, bones)
        return keypoints(bones)[0]

    def spread(self, i, fingers):
        """Mean distance of these fingers' tips from their centre [m]."""
        tips = self.tips[i, fingers]
        tips = tips[~numpy.isnan(tips[:, 0])]
        return float(numpy.mean(numpy.linalg.norm(tips - tips.mean(axis=0), axis=1))) if len(tips) else 0.0


class Story:
    """The content of an explanation. losses.py adds losses, touches and moments."""

    def __init__(self, run):
        self.run = run
        self.times = run.frames['time'].to_numpy()
        self.max_hand_speed = run.parameter('tracking/max_speed', MAX_HAND_SPEED)
        self.gravity = vectors(run.frames, ('gx', 'gy', 'gz'))[-1] if len(run.frames) else numpy.zeros(3)
        bodies = run.bodies.drop_duplicates('name', keep='last').set_index('name')
        contacts = dict(list(run.contacts.groupby('object', sort=False)))
        self.objects = {name: ObjectStory(name, bodies.loc[name], table, contacts.get(name, run.contacts[:0]))
                        for name, table in run.objects.groupby('name')}
        phalanges = dict(list(run.phalanges.groupby('hand_id')))
        self.hands = {int(hand): HandStory(int(hand), palms, phalanges.get(hand, run.phalanges[:0]))
                      for hand, palms in run.palms.groupby('hand_id')}
        self.joints = self._joints(bodies)
        self.events = [Event(*row) for row in run.events[list(Event._fields)].itertuples(index=False)]
        self.changes = _changes(run.summary.get('live_run', {}).get('changes', ()))
        self.losses, self.touches, self.moments = [], [], []

    def _joints(self, bodies):
        joints = {}
        for name, table in self.run.joints.groupby('name'):
            for body in bodies.index[bodies['joint'] == name]:
                row = bodies.loc[body]
                joints[name] = JointStory(name, body, row['joint_kind'] == 'turning', float(row['lower']), float(row['upper']),
                                          table['time'].to_numpy(), table['position'].to_numpy())
        return joints


def _changes(lines):
    """Changes of the running scene, from lines such as '4.878 s: reset'."""
    found = [(re.match(r'(\d+\.\d+) s: ', str(line)), str(line)) for line in lines]
    return [Change(float(match.group(1)), line) for match, line in found if match]
