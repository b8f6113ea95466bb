"""Runs that reports are tried on: replays of a hand of two fingers that takes a cube, and tables written by hand. Importing this
makes `runs` and `study` importable."""

import csv
import os
import subprocess
import sys

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCRIPTS = os.path.join(PACKAGE, 'scripts')
sys.dont_write_bytecode = True
sys.path.insert(0, SCRIPTS)

from study import program  # noqa: E402

program.find_built_modules()

from runs.explanation import explained  # noqa: E402
from runs.tables import COLUMNS, Run  # noqa: E402

REPLAY = os.path.join(PACKAGE, 'devel', 'lib', 'mr_hand_interaction', 'replay')
LIMIT = 120  # s, far beyond what any run takes
RATE, HALF, MASS, STIFFNESS = 120.0, 0.025, 0.2, 2000.0  # Hz, m, kg, N/m
CLOSED, MOVES, RISE_TIME = 0.3, 0.6, 0.8  # s
PEAK = 10.0 / 3.0 ** 0.5 / RISE_TIME ** 2  # highest acceleration of a rise of a metre [1/s^2]
RADIUS, LENGTH = 0.008, 0.025  # m, of a fingertip
NEVER = 1e9  # s
SETTINGS = ('filter/type=none', 'hand/strength=unlimited', 'hand/palm_strength=unlimited', 'hand/pad=0')

SUMMARY = {'input': '', 'scene': 'cube', 'frames': 1, 'simulated_seconds': 0.5, 'gravity': [0, 0, 0], 'contact_model': 'implicit',
           'version': '0', 'rejected': {}, 'parameters': {}, 'not_known': [], 'state_hash': '0'}
URDF = '''<?xml version="1.0"?>
<robot name="pinch"><link name="world"/>%s</robot>'''
CEILING = '''<link name="ceiling"><collision><geometry><box size="1 1 0.02"/></geometry></collision></link>
<joint name="world_to_ceiling" type="fixed"><parent link="world"/><child link="ceiling"/><origin xyz="0 0 %g"/></joint>'''
BODY = '''<link name="%(name)s"><inertial><mass value="%(mass)g"/><inertia ixx="%(inertia)g" ixy="0" ixz="0" iyy="%(inertia)g" iyz="0"
izz="%(inertia)g"/></inertial><collision><geometry>%(shape)s</geometry></collision></link>
<joint name="world_to_%(name)s" type="floating"><parent link="world"/><child link="%(name)s"/><origin xyz="0 %(y)g 0"/></joint>'''


def replay_is_built():
    return os.access(REPLAY, os.X_OK)


def replay(*arguments):
    return subprocess.run([REPLAY] + list(arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                          timeout=LIMIT)


def script(name, *arguments, **options):
    return subprocess.run([os.path.join(SCRIPTS, name)] + list(arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=LIMIT, **options)


def smooth(time, duration):
    """Minimum-jerk motion from 0 to 1."""
    x = min(max(time / duration, 0.0), 1.0)
    return x ** 3 * (10.0 + x * (-15.0 + 6.0 * x))


class Attempt:
    """Two fingers take a cube of 0.2 kg, and from 0.6 s on carry it up."""

    friction = 0.8
    overlap = 0.002  # of each finger [m]; a normal force of 2000 N/m times that
    rise = 0.3  # that the cube is carried up within RISE_TIME [m]
    opens_at = jumps_at = NEVER  # s; the jump is by 0.3 m
    unseen = missing = (NEVER, NEVER)  # s; from when to when frames have no hand, and there are no frames
    ceiling = bound = 9.0  # m; height of a plate, upper end of the scene's bounds
    adjacent = False  # faces side by side
    ball_speed = 0.0  # of 1 kg, which meets the cube after half a second, along y
    until = 1.8  # s

    def __init__(self, **changes):
        for name, value in changes.items():
            getattr(self, name)
            setattr(self, name, value)

    def fingers(self, time):
        """[(finger, middle of the axis, direction of the axis)]"""
        gap = -self.overlap - (0.01 + self.overlap) * (smooth(time, CLOSED) - 1.0) + 0.03 * smooth(time - self.opens_at, 0.3)
        reach = HALF + gap + RADIUS
        if self.adjacent:
            return [(1, (reach, 0.0, 0.0), (0, 1, 0)), (0, (0.0, reach, 0.0), (1, 0, 0))]
        return [(1, (reach, 0.0, 0.0), (0, 1, 0)), (0, (-reach, 0.0, 0.0), (0, 1, 0))]

    def offset(self, time):
        pushed = 0.3 * smooth(time - 0.2, 1.2) if self.adjacent else 0.0  # the cube before it [m]
        return (-pushed, -pushed - 0.3 * (time >= self.jumps_at), self.rise * smooth(time - MOVES, RISE_TIME))

    def replay(self, folder, *arguments):
        """Writes scene and bag, replays them, and gives the folder of the tables."""
        scene, bag, output = (os.path.join(folder, name) for name in ('pinch.urdf', 'pinch.bag', 'out'))
        self._write_scene(scene)
        self._write_bag(bag)
        settings = [word for setting in SETTINGS for word in ('--set', setting)]
        twist = ['--object-twist', 'ball,0,%g,0,0,0,0' % self.ball_speed] if self.ball_speed else []
        done = replay('--scene', scene, '--input', bag, '--output', output, *settings, *twist, *arguments)
        if done.returncode:
            raise RuntimeError(done.stderr)
        return output

    def story(self, folder):
        return explained(Run(self.replay(folder)))

    def _write_scene(self, path):
        inertia = MASS * (2.0 * HALF) ** 2 / 6.0
        bodies = BODY % {'name': 'object', 'mass': MASS, 'inertia': inertia, 'y': 0.0, 'shape': '<box size="%g %g %g"/>'
                         % ((2.0 * HALF,) * 3)}
        if self.ball_speed:
            bodies += BODY % {'name': 'ball', 'mass': 1.0, 'inertia': 0.4 * 0.02 ** 2, 'y': -0.5 * self.ball_speed,
                              'shape': '<sphere radius="0.02"/>'}
        with open(path, 'w') as file:
            file.write(URDF % (bodies + CEILING % self.ceiling))
        with open(path[:-len('urdf')] + 'yaml', 'w') as file:
            file.write('bounds: {min: [-9, -9, -9], max: [9, 9, %g]}\nmaterials:\n  object: {static_friction: %r, '
                       'dynamic_friction: %r, stiffness: %g}\n' % (self.bound, self.friction, 0.75 * self.friction, STIFFNESS))

    def _write_bag(self, path):
        import genpy
        import rosbag
        from geometry_msgs.msg import Point, Pose, Quaternion
        from mr_hand_interaction.msg import Hand, HandFrame, Phalanx
        with rosbag.Bag(path, 'w') as bag:
            for i in range(int(self.until * RATE) + 1):
                time = i / RATE
                if self.missing[0] <= time < self.missing[1]:
                    continue
                stamp = genpy.Time(*divmod(int(round(1e9 * time)) + 1000000000, 1000000000))
                frame = HandFrame()
                frame.header.stamp, frame.header.frame_id = stamp, 'world'
                if not self.unseen[0] <= time < self.unseen[1]:
                    offset = self.offset(time)
                    hand = Hand(id=1, side=Hand.RIGHT, confidence=1.0)
                    hand.palm = Pose(Point(*(a + b for a, b in zip((0.0, 0.0, -0.1), offset))), Quaternion(w=1.0))
                    for finger, middle, axis in self.fingers(time):
                        start, end = ([m + o + sign * 0.5 * LENGTH * a for m, o, a in zip(middle, offset, axis)]
                                      for sign in (-1, 1))
                        hand.phalanges.append(Phalanx(finger=finger, bone=3, start=Point(*start), end=Point(*end), radius=RADIUS))
                    frame.hands.append(hand)
                bag.write('/hand_frame', frame, stamp)


def write_tables(folder, **tables):
    """Tables of rows as dictionaries; what is not given of a row is 0 or empty, and tables that are not given have none."""
    os.makedirs(folder, exist_ok=True)
    texts = {'name', 'object', 'kind', 'joint', 'joint_kind'}
    for name, columns in COLUMNS.items():
        with open(os.path.join(folder, name), 'w', newline='') as file:
            writer = csv.DictWriter(file, columns)
            writer.writeheader()
            for row in tables.get(name[:-len('.csv')], ()):
                writer.writerow(dict({column: '' if column in texts else 0 for column in columns}, **row))
