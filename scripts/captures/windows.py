"""Cuts windows in which a hand carries the object, and writes what real_grasps and replay play."""
import csv
import os

import numpy as np
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.transform import Rotation

FINGERS = ('thumb', 'index', 'middle', 'ring', 'pinky')
LEAD, SHORTEST = 1.0, 0.9  # seconds before a window, and that it lasts
CLOSED, KEPT = 0.1, 0.05   # of a hinge: at most so far from closed, and so much it moves within a window [rad]
FURTHEST = 3.2             # that a hinge turns [rad]
GAP, BRIDGED = 0.02, 0.05  # of a hull from the mesh [m], and the fraction of its surface that may be farther
SAMPLES = 20000            # points on a surface: some 3 mm apart on a laptop
LIFTED, NEAR = 0.02, 0.012  # metres: above where it lay; of a joint from the object's hull
PULP = 0.008               # tips lie on the skin: the bone ends so much before [m]


def runs(flags, times, longest=float('inf'), angles=None):
    """[first, end) of each run of frames that lasts long enough, in sections of at most `longest` seconds, in which a hinge keeps
    its angle, if `angles` are given."""
    found, first = [], 0
    while first < len(flags):
        end = first
        while end < len(flags) and flags[end] and times[end] - times[first] < longest and (
                angles is None or np.ptp(angles[first:end + 1]) <= KEPT):
            end += 1
        long_enough = end > first and times[end - 1] - times[first] >= SHORTEST
        if long_enough:
            found.append((first, end))
        first = end if long_enough else first + 1
    return found


def carried(capture, parts):
    """For each frame: the object is above where it lay, and a joint is at the hull of one of its `parts`, (poses, points)."""
    held, lowest = np.zeros(len(capture.times), bool), np.full(len(capture.times), np.inf)
    for poses, points in parts:
        hull = ConvexHull(points)
        corners = points[hull.vertices]
        turned = np.einsum('fij,vj->fvi', poses[:, :3, :3], corners) + poses[:, None, :3, 3]
        lowest = np.minimum(lowest, turned[:, :, 2].min(axis=1))
        for joints in capture.hands.values():
            local = np.einsum('fji,fkj->fki', poses[:, :3, :3], joints - poses[:, None, :3, 3])
            beyond = (local @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=2)
            with np.errstate(invalid='ignore'):
                held |= (beyond < NEAR).any(axis=1)
    flags = held & (lowest > np.percentile(lowest, 5) + LIFTED)
    if capture.ranges is not None:
        inside = np.zeros(len(flags), bool)
        for first, end in capture.ranges:
            inside[first:end] = True
        flags &= inside
    return flags


def bridged(points, triangles):
    """Fraction of the surface of a mesh's hull that is farther than GAP from the mesh: what the hull bridges."""
    mesh = _on_surface(points, triangles)
    return (cKDTree(mesh).query(_on_surface(points, ConvexHull(points).simplices))[0] > GAP).mean()


def _on_surface(points, triangles):
    """Points evenly on a surface, the same each time."""
    random = np.random.RandomState(1)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    some = random.choice(len(triangles), SAMPLES, p=areas / areas.sum())
    u, v = random.rand(2, SAMPLES, 1)
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return a[some] + u * (b - a)[some] + v * (c - a)[some]


def turned_top(points, angle):
    """The top of an object on a hinge, in the frame of its bottom."""
    return Rotation.from_rotvec([0, 0, -angle]).apply(points)


def columns():
    return ['palm', 'wrist'] + ['%s_j%d' % (finger, j) for finger in FINGERS for j in range(5)]


def schema_joints(joints):
    """{column: place} of 21 joints, from palm to tip; what is not there has none. The thumb's metacarpal begins at its base."""
    found = {'wrist': joints[0]}
    for i, finger in enumerate(FINGERS):
        chain = np.array(joints[1 + 4 * i:5 + 4 * i])
        before = next((place for place in (chain[2], chain[1], chain[0], joints[0]) if np.isfinite(place).all()), chain[3])
        last = chain[3] - before
        chain[3] = chain[3] - PULP * last / max(np.linalg.norm(last), 1e-9)
        found.update({'%s_j%d' % (finger, j + 1): place for j, place in enumerate(chain)})
    found['thumb_j0'] = found['thumb_j1']
    return {name: place for name, place in found.items() if np.isfinite(place).all()}


def to_device(place):
    """A device at the default mount has y up and z to the user."""
    return place[0], place[2], -place[1]


def write_hands(path, times, hands):
    """`hands`: {side: places of 21 joints in each frame}."""
    with open(path, 'w', newline='', encoding='utf-8') as file:
        writer = csv.writer(file)
        writer.writerow(['time_s', 'frame_id', 'hand_id', 'is_left'] + [name + '_' + axis for name in columns() for axis in 'xyz'])
        for frame, time in enumerate(times):
            for number, side in enumerate(('right', 'left')):
                places = schema_joints(hands[side][frame]) if side in hands else {}
                if 'wrist' not in places and len(places) < 5:
                    continue
                row = ['%.6f' % (time - times[0]), frame, number + 1, number]
                for name in columns():
                    row += ['%.6f' % x for x in to_device(places[name])] if name in places else [''] * 3
                writer.writerow(row)


def write_object(path, times, free, places, quaternions, angles=None):
    """`quaternions`: x y z w; `angles`: of a hinge [rad], if it has one."""
    with open(path, 'w', newline='', encoding='utf-8') as file:
        writer = csv.writer(file)
        writer.writerow('time_s free px py pz qx qy qz qw'.split() + ['angle'] * (angles is not None))
        for i, time in enumerate(times):
            values = (*places[i], *quaternions[i]) + ((angles[i],) if angles is not None else ())
            writer.writerow(['%.6f' % (time - times[0]), int(free[i])] + ['%.9f' % value for value in values])


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


def link_of(folder, name, mesh_name, points, mass=None, density=None):
    """The URDF's link of a part, whose hull is written, and its mass: as given, or of its filling at a density."""
    corners, triangles, centre, volume, inertia = hull(points)
    mass = mass if mass is not None else density * volume
    with open(os.path.join(folder, mesh_name + '.obj'), 'w', encoding='utf-8') as file:
        file.writelines('v %.9f %.9f %.9f\n' % tuple(corner) for corner in corners)
        file.writelines('f %d %d %d\n' % tuple(1 + triangle) for triangle in triangles)
    i = mass * inertia
    mesh = '<geometry><mesh filename="%s.obj"/></geometry>' % mesh_name
    link = ('<link name="%s"><inertial><origin xyz="%.9f %.9f %.9f"/><mass value="%.6f"/>'
            '<inertia ixx="%.9g" ixy="%.9g" ixz="%.9g" iyy="%.9g" iyz="%.9g" izz="%.9g"/></inertial>'
            '<visual>%s</visual><collision>%s</collision></link>' %
            (name, *centre, mass, i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2], mesh, mesh))
    return link, mass


def write_scene(folder, name, links):
    """Of a body, or of two: `thing`, and `top` on a hinge."""
    joint = '' if len(links) == 1 else (
        '<joint name="hinge" type="revolute"><parent link="thing"/><child link="top"/><axis xyz="0 0 -1"/>'
        '<limit lower="%g" upper="%g" effort="0" velocity="0"/></joint>' % (-CLOSED, FURTHEST))
    with open(os.path.join(folder, name + '.urdf'), 'w', encoding='utf-8') as file:
        file.write('<robot name="%s"><link name="world"/>%s<joint name="j" type="floating"><parent link="world"/>'
                   '<child link="thing"/></joint>%s</robot>\n' % (name, ''.join(links), joint))
    with open(os.path.join(folder, name + '.yaml'), 'w', encoding='utf-8') as file:
        file.write('gravity: [0.0, 0.0, -9.81]\nbounds: {min: [-3, -3, -3], max: [3, 3, 4]}\n')
