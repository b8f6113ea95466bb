#!/usr/bin/env python3
"""Cuts windows out of processed ARCTIC captures that `real_grasps --arctic` plays.

A window: for at least 0.9 s the object is closed (its joint keeps its angle within 0.05 rad, at most 0.1 rad from
closed), off the ground by 20 mm, and a hand is on it. The convex hull of both parts stands for the object; where that is
more than twice the parts' volume (the mixer), it is left out. Each is written with up to a second of what was before.

With --articulated: for at least 0.9 s the object is off the ground with a hand on it, whatever its joint does; a hull for
each part, and a free hinge between them. Where a hull is more than 2.5 times its part's volume, the object is left out.
--longest cuts these into sections.

In:  CAPTURES, a folder of */OBJECT_*.npy as DexMachina has them (world in metres, z up, 30 Hz: `joints.left/right`, 21
     MANO joints of each hand; `obj_trans`, `obj_quat` (w first), `obj_arti`), and OBJECTS, a folder that has
     OBJECT/{top,bottom}_watertight_tiny.obj and OBJECT/OBJECT.urdf (its masses).
Out: for each window NAME.csv (hands, the schema of docs/real_grasps.md, as a device at the default mount sees them),
     NAME_object.csv (pose of the object's link in world; free: 1 within the window; angle of its joint, if it has one),
     NAME.urdf, .yaml, .obj; windows.csv.
Needs numpy and scipy. The captures' licence is non-commercial: nothing of it belongs into a repository.
"""
import argparse
import csv
import glob
import math
import os
import re
import sys

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'scripts'))
from captures import windows  # noqa: E402
from captures.files import read_npy  # noqa: E402

RATE = 30.0
# MANO's joints from palm to tip, thumb first, with the tips last, as DexMachina has them.
ORDER = [0, 13, 14, 15, 16, 1, 2, 3, 17, 4, 5, 6, 18, 10, 11, 12, 19, 7, 8, 9, 20]
LONGEST_LEAD = 30          # frames before a window
SHORTEST = 27              # frames
ANGLE = 0.05               # [rad]
LIFTED = 0.02              # [m]
CLOSED = 0.1               # [rad]
FILLING = 2.0              # of the hull, against the parts
PART_FILLING = 2.5         # of a part's hull, against the part
FURTHEST = 3.2             # that a joint may turn [rad]


def read_mesh(path):
    """Vertices; volume."""
    with open(path) as file:
        lines = [line.split() for line in file]
    points = np.array([[float(x) for x in line[1:4]] for line in lines if line[:1] == ['v']])
    faces = np.array([[int(x.split('/')[0]) - 1 for x in line[1:4]] for line in lines if line[:1] == ['f']])
    a, b, c = (points[faces[:, i]] for i in range(3))
    return points, np.einsum('ij,ij->', a, np.cross(b, c)) / 6


class Thing:
    """An object of two parts; the top turns about -z of the bottom's frame."""

    def __init__(self, folder, name):
        meshes = [read_mesh(os.path.join(folder, name, part + '_watertight_tiny.obj')) for part in ('top', 'bottom')]
        self.parts, self.volumes = [points for points, _ in meshes], [volume for _, volume in meshes]
        with open(os.path.join(folder, name, name + '.urdf')) as file:
            text = file.read()
        masses = {link: float(mass) for link, mass in
                  re.findall(r'<link name="(\w+)">.*?<mass value="([^"]+)".*?</link>', text, re.DOTALL)}
        self.masses = [masses['top'], masses['bottom']]
        self.mass = sum(self.masses)

    def vertices(self, angle):
        return np.vstack([Rotation.from_rotvec([0, 0, -angle]).apply(self.parts[0]), self.parts[1]])

    def is_nearly_convex(self):
        return ConvexHull(self.vertices(0.0)).volume <= FILLING * sum(self.volumes)

    def has_nearly_convex_parts(self):
        return all(ConvexHull(points).volume <= PART_FILLING * volume
                   for points, volume in zip(self.parts, self.volumes))


def held_frames(capture, thing):
    """Whether the object is off the ground with a hand on it; angle of its joint."""
    params, world = capture['params'], capture['world_coord']
    angle = params['obj_arti'].ravel()
    turn = Rotation.from_quat(params['obj_quat'][:, [1, 2, 3, 0]])
    lowest = np.array([(turn[i].apply(thing.vertices(angle[i])) + params['obj_trans'][i])[:, 2].min()
                       for i in range(len(angle))])
    touched = (world['valid_contacts.left'] | world['valid_contacts.right']).any(axis=1)
    return (lowest > lowest[0] + LIFTED) & touched, angle


def runs(held, may_go_on):
    """[first, past the last) of each run of frames that are held, as long as may_go_on(first, frame)."""
    found, first = [], 0
    while first < len(held):
        end = first
        while end < len(held) and held[end] and may_go_on(first, end):
            end += 1
        if end - first >= SHORTEST:
            found.append((first, end))
        first = end if end - first >= SHORTEST else first + 1
    return found


def closed_windows(capture, thing):
    held, angle = held_frames(capture, thing)
    return runs(held & (angle < CLOSED), lambda first, frame: np.ptp(angle[first:frame + 1]) <= ANGLE)


def articulated_windows(capture, thing, longest):
    held, _ = held_frames(capture, thing)
    return runs(held, lambda first, frame: frame - first < longest * RATE)


def write_hands(path, capture, frames):
    hands = {side: capture['world_coord']['joints.' + side][frames].astype(float)[:, ORDER] for side in ('right', 'left')}
    windows.write_hands(path, np.arange(len(frames)) / RATE, hands)


def write_object(path, capture, frames, first, articulated):
    params = capture['params']
    windows.write_object(path, np.arange(len(frames)) / RATE, np.array(frames) >= first, params['obj_trans'][frames],
                         params['obj_quat'][frames][:, [1, 2, 3, 0]], params['obj_arti'].ravel()[frames] if articulated else None)


def write_closed(folder, name, thing, angle):
    windows.write_scene(folder, name, [windows.link_of(folder, 'thing', name, thing.vertices(angle), thing.mass)[0]])


def write_hinged(folder, name, thing):
    links = [windows.link_of(folder, link, name + '_' + part, points, mass)[0] for link, part, points, mass in
             zip(('top', 'thing'), ('top', 'bottom'), thing.parts, thing.masses)]
    windows.write_scene(folder, name, links[::-1],
                '<joint name="hinge" type="revolute"><parent link="thing"/><child link="top"/><axis xyz="0 0 -1"/>'
                '<limit lower="%g" upper="%g" effort="0" velocity="0"/></joint>' % (-CLOSED, FURTHEST))


def cut(path, objects, output, arguments):
    """Rows of windows.csv."""
    name = os.path.basename(path)[:-4]
    thing_name = name.split('_')[0]
    if not os.path.exists(os.path.join(objects, thing_name, 'top_watertight_tiny.obj')):
        print('%s: no mesh of %s in %s, left out' % (name, thing_name, objects), file=sys.stderr)
        return
    capture, thing = read_npy(path), Thing(objects, thing_name)
    if not (thing.has_nearly_convex_parts() if arguments.articulated else thing.is_nearly_convex()):
        print('%s: a hull of %s is too much larger than what it stands for, left out' % (name, thing_name), file=sys.stderr)
        return
    found = (articulated_windows(capture, thing, arguments.longest) if arguments.articulated else
             closed_windows(capture, thing))
    for number, (first, end) in enumerate(found):
        window = '%s_%s_%d' % (os.path.basename(os.path.dirname(path)), name, first)
        frames = list(range(max(0, first - LONGEST_LEAD), end))
        write_hands(os.path.join(output, window + '.csv'), capture, frames)
        write_object(os.path.join(output, window + '_object.csv'), capture, frames, first, arguments.articulated)
        if arguments.articulated:
            write_hinged(output, window, thing)
        else:
            write_closed(output, window, thing, float(capture['params']['obj_arti'].ravel()[first]))
        yield [window, int(number == 0), '%.3f' % ((end - 1 - first) / RATE), '%.3f' % thing.mass]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('captures')
    parser.add_argument('objects')
    parser.add_argument('--output', required=True)
    parser.add_argument('--articulated', action='store_true', help='objects whose joint moves, each of two parts')
    parser.add_argument('--longest', type=float, default=math.inf, help='of an articulated window [s]')
    arguments = parser.parse_args()
    os.makedirs(arguments.output, exist_ok=True)
    paths = sorted(glob.glob(os.path.join(arguments.captures, '**', '*.npy'), recursive=True))
    if not paths:
        sys.exit('arctic_windows.py: no .npy under ' + arguments.captures)
    with open(os.path.join(arguments.output, 'windows.csv'), 'w', newline='') as file:
        writer = csv.writer(file)
        writer.writerow(['window', 'first', 'seconds', 'mass_kg'])
        for path in paths:
            for row in cut(path, arguments.objects, arguments.output, arguments):
                writer.writerow(row)
                print(*row)


if __name__ == '__main__':
    main()
