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
import pickle
import re
import sys

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

RATE = 30.0
LONGEST_LEAD = 30          # frames before a window
SHORTEST = 27              # frames
ANGLE = 0.05               # [rad]
LIFTED = 0.02              # [m]
CLOSED = 0.1               # [rad]
FILLING = 2.0              # of the hull, against the parts
PART_FILLING = 2.5         # of a part's hull, against the part
FURTHEST = 3.2             # that a joint may turn [rad]
PULP = 0.008               # MANO's tips lie on the skin: the bone ends so much before [m]
FINGERS = ['thumb', 'index', 'middle', 'ring', 'pinky']
# MANO's joints of a finger from the palm to the tip. The thumb's metacarpal begins at its base, as Leap has it.
CHAINS = {'thumb': [13, 13, 14, 15, 16], 'index': [None, 1, 2, 3, 17], 'middle': [None, 4, 5, 6, 18],
          'ring': [None, 10, 11, 12, 19], 'pinky': [None, 7, 8, 9, 20]}


class ArraysOnly(pickle.Unpickler):
    """Takes arrays, dictionaries and numbers: a capture that asks for anything else is refused."""
    ALLOWED = {('numpy.core.multiarray', '_reconstruct'), ('numpy', 'ndarray'), ('numpy', 'dtype')}

    def find_class(self, module, name):
        if (module, name) not in self.ALLOWED:
            raise pickle.UnpicklingError('holds a %s.%s; arrays alone are taken' % (module, name))
        return super().find_class(module, name)


def read_capture(path):
    with open(path, 'rb') as file:
        np.lib.format.read_magic(file)
        np.lib.format.read_array_header_1_0(file)
        return ArraysOnly(file).load().item()


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


def hull(points):
    """Vertices, triangles with outward normals, and of its even filling: centre, volume, inertia of 1 kg."""
    found = ConvexHull(points)
    numbers = {v: i for i, v in enumerate(found.vertices)}
    corners = points[found.vertices]
    triangles = np.array([[numbers[v] for v in simplex] for simplex in found.simplices])
    a, b, c = (corners[triangles[:, i]] for i in range(3))
    inward = np.einsum('ij,ij->i', np.cross(b - a, c - a), found.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    a, b, c = (corners[triangles[:, i]] for i in range(3))
    volumes = np.einsum('ij,ij->i', a, np.cross(b, c)) / 6
    centre = (volumes[:, None] * (a + b + c)).sum(axis=0) / 4 / volumes.sum()
    a, b, c = a - centre, b - centre, c - centre
    volumes = np.einsum('ij,ij->i', a, np.cross(b, c)) / 6
    total = a + b + c
    second = sum(np.einsum('i,ij,ik->jk', volumes / 20, x, x) for x in (a, b, c, total)) / volumes.sum()
    return corners, triangles, centre, volumes.sum(), np.trace(second) * np.eye(3) - second


def joints_of(hand):
    """{column prefix: place in world} of 21 MANO joints."""
    places = {'wrist': hand[0]}
    for finger in FINGERS:
        chain = [None if j is None else hand[j] for j in CHAINS[finger]]
        last = chain[4] - chain[3]
        chain[4] = chain[4] - PULP * last / np.linalg.norm(last)
        places.update({'%s_j%d' % (finger, j): place for j, place in enumerate(chain) if place is not None})
    return places


def to_device(place):
    """A device at the default mount has y up and z to the user."""
    return place[0], place[2], -place[1]


def write_hands(path, capture, frames):
    prefixes = ['palm', 'wrist'] + ['%s_j%d' % (finger, j) for finger in FINGERS for j in range(5)]
    with open(path, 'w', newline='') as file:
        writer = csv.writer(file)
        writer.writerow(['time_s', 'frame_id', 'hand_id', 'is_left'] + [p + '_' + a for p in prefixes for a in 'xyz'])
        for k, frame in enumerate(frames):
            for number, side in enumerate(('right', 'left')):
                places = joints_of(capture['world_coord']['joints.' + side][frame].astype(float))
                row = ['%.6f' % (k / RATE), frame, number + 1, number]
                for prefix in prefixes:
                    row += ['%.6f' % x for x in to_device(places[prefix])] if prefix in places else [''] * 3
                writer.writerow(row)


def write_object(path, capture, frames, first, articulated):
    params = capture['params']
    with open(path, 'w', newline='') as file:
        writer = csv.writer(file)
        writer.writerow('time_s free px py pz qx qy qz qw'.split() + ['angle'] * articulated)
        for k, frame in enumerate(frames):
            w, x, y, z = params['obj_quat'][frame]
            values = (*params['obj_trans'][frame], x, y, z, w) + (params['obj_arti'].ravel()[frame],) * articulated
            writer.writerow(['%.6f' % (k / RATE), int(frame >= first)] + ['%.9f' % v for v in values])


def link_of(folder, name, mesh_name, points, mass):
    """The URDF's link of a part, whose hull is written."""
    corners, triangles, centre, _, inertia = hull(points)
    with open(os.path.join(folder, mesh_name + '.obj'), 'w') as file:
        file.writelines('v %.9f %.9f %.9f\n' % tuple(corner) for corner in corners)
        file.writelines('f %d %d %d\n' % tuple(1 + triangle) for triangle in triangles)
    i = mass * inertia
    mesh = '<geometry><mesh filename="%s.obj"/></geometry>' % mesh_name
    return ('<link name="%s"><inertial><origin xyz="%.9f %.9f %.9f"/><mass value="%.6f"/>'
            '<inertia ixx="%.9g" ixy="%.9g" ixz="%.9g" iyy="%.9g" iyz="%.9g" izz="%.9g"/></inertial>'
            '<visual>%s</visual><collision>%s</collision></link>' %
            (name, *centre, mass, i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2], mesh, mesh))


def write_scene(folder, name, links, joint=''):
    with open(os.path.join(folder, name + '.urdf'), 'w') as file:
        file.write('<robot name="%s"><link name="world"/>%s<joint name="j" type="floating"><parent link="world"/>'
                   '<child link="thing"/></joint>%s</robot>\n' % (name, ''.join(links), joint))
    with open(os.path.join(folder, name + '.yaml'), 'w') as file:
        file.write('gravity: [0.0, 0.0, -9.81]\nbounds: {min: [-3, -3, -3], max: [3, 3, 4]}\n')


def write_closed(folder, name, thing, angle):
    write_scene(folder, name, [link_of(folder, 'thing', name, thing.vertices(angle), thing.mass)])


def write_hinged(folder, name, thing):
    links = [link_of(folder, link, name + '_' + part, points, mass) for link, part, points, mass in
             zip(('top', 'thing'), ('top', 'bottom'), thing.parts, thing.masses)]
    write_scene(folder, name, links[::-1],
                '<joint name="hinge" type="revolute"><parent link="thing"/><child link="top"/><axis xyz="0 0 -1"/>'
                '<limit lower="%g" upper="%g" effort="0" velocity="0"/></joint>' % (-CLOSED, FURTHEST))


def cut(path, objects, output, arguments):
    """Rows of windows.csv."""
    name = os.path.basename(path)[:-4]
    thing_name = name.split('_')[0]
    if not os.path.exists(os.path.join(objects, thing_name, 'top_watertight_tiny.obj')):
        print('%s: no mesh of %s in %s, left out' % (name, thing_name, objects), file=sys.stderr)
        return
    capture, thing = read_capture(path), Thing(objects, thing_name)
    if not (thing.has_nearly_convex_parts() if arguments.articulated else thing.is_nearly_convex()):
        print('%s: a hull of %s is too much larger than what it stands for, left out' % (name, thing_name), file=sys.stderr)
        return
    found = (articulated_windows(capture, thing, arguments.longest) if arguments.articulated else
             closed_windows(capture, thing))
    for number, (first, end) in enumerate(found):
        window = '%s_%s_%d' % (os.path.basename(os.path.dirname(path)), name, first)
        frames = range(max(0, first - LONGEST_LEAD), end)
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
