"""Forces of hands on an object in each frame: for each finger, and for all contacts together."""

import collections

import numpy
import pandas

from .tables import vectors

PALM = 5
FINGERS = ('thumb', 'index', 'middle', 'ring', 'little', 'palm')
PATCH_TORQUE = 2.0 / 3.0  # lever of a round patch under even pressure, over its radius
NO_LOAD = 1e9  # result without a load
SCALE = 0.03  # m; length that weighs rotation against translation
ITERATIONS = 150  # the gain is small after some dozens
SHARPER, SHARPEST = 0.9, 1e-6  # regularisation of directions that hardly move: factor per iteration, minimum
MIN_LOAD = 1e-9  # N
MIN_SPAN = 1e-3  # m, between thumb and fingers, for a line through the grip

# Contact of a finger or the palm with an object in a frame. Forces in N, depth in m; outward: unit vector, object to finger.
FingerContact = collections.namedtuple('FingerContact', 'hand_id finger normal tangential limit depth slips outward face')


def utilisation(touch):
    """Friction utilisation: tangential force over the friction limit."""
    return touch.tangential / touch.limit if touch.limit > 0.0 else 0.0


def finger_text(finger):
    return 'the ' + FINGERS[finger]


def touches_of(contacts, rows, orientation):
    """For each of the object's samples its touches, in the order of the contacts. `rows`: sample of each contact."""
    count = len(orientation)
    touches = [[] for _ in range(count)]
    keys = collections.OrderedDict()
    group = numpy.array([keys.setdefault(key, len(keys)) for key in zip(rows, contacts['hand_id'], contacts['finger'])], int)
    normal = contacts['normal_force'].to_numpy()
    outward = summed(group, numpy.maximum(normal, 1e-6)[:, None] * vectors(contacts, ('nx', 'ny', 'nz')), len(keys))
    outward /= numpy.maximum(numpy.linalg.norm(outward, axis=1), 1e-300)[:, None]
    forces = summed(group, vectors(contacts, ('normal_force', 'tangential_force', 'friction_limit')), len(keys))
    depth, sticks = numpy.zeros(len(keys)), numpy.zeros(len(keys), int)
    numpy.maximum.at(depth, group, contacts['depth'].to_numpy())
    numpy.add.at(sticks, group, 1 - contacts['slipping'].to_numpy())
    for i, (sample, hand_id, finger) in enumerate(keys):
        local = rotated_back(orientation[sample], outward[i])
        axis = int(numpy.argmax(numpy.abs(local)))
        face = ('-' if local[axis] < 0.0 else '+') + 'xyz'[axis]
        touches[sample].append(FingerContact(int(hand_id), int(finger), *map(float, forces[i]), float(depth[i]), not sticks[i],
                                     outward[i], face))
    return touches


def summed(group, values, count):
    """Sums of the rows of each group."""
    total = numpy.zeros((count, values.shape[1]))
    numpy.add.at(total, group, values)
    return total


def mean_forces(contacts, step):
    """Forces of contacts [N] with their impulses, as means over `step`: the time since the frame before, for each contact [s]."""
    step = numpy.where(step > 0.0, step, numpy.inf)[:, None]
    return vectors(contacts, ('fx', 'fy', 'fz')) + vectors(contacts, ('jx', 'jy', 'jz')) / step


def rotated_back(quaternion, vector):
    """From world into the frame of this orientation (x, y, z, w)."""
    axis, w = -quaternion[:3], quaternion[3]
    return vector + 2.0 * numpy.cross(axis, numpy.cross(axis, vector) + w * vector)


def torques(contacts, rows, count):
    """Torque of the hands' forces about the line through the grip, between thumb or palm and the other fingers [N m]."""
    point, force = vectors(contacts, ('x', 'y', 'z')), vectors(contacts, ('fx', 'fy', 'fz'))
    push = numpy.maximum(contacts['normal_force'].to_numpy(), 0.0)
    thumb = contacts['finger'].isin((0, PALM)).to_numpy()
    sides = []
    for side in (thumb, ~thumb):
        weight = summed(rows, (push * side)[:, None], count)
        sides.append((summed(rows, (push * side)[:, None] * point, count) / numpy.where(weight > 0.0, weight, 1.0), weight[:, 0]))
    (a, weight_a), (b, weight_b) = sides
    length = numpy.linalg.norm(b - a, axis=1)
    defined = (weight_a > 0.0) & (weight_b > 0.0) & (length >= MIN_SPAN)
    axis = numpy.where(defined[:, None], (b - a) / numpy.where(defined, length, 1.0)[:, None], 0.0)
    moment = numpy.cross(point - a[rows], force)
    return summed(rows, numpy.sum(axis[rows] * moment, axis=1)[:, None], count)[:, 0]


def margins(contacts, rows, position):
    """Friction margin for a straight pull [N]; and the largest factor on load and torque that friction can carry."""
    count = len(position)
    normal = vectors(contacts, ('nx', 'ny', 'nz'))
    along = vectors(contacts, ('fx', 'fy', 'fz')) + contacts['normal_force'].to_numpy()[:, None] * normal
    arm = vectors(contacts, ('x', 'y', 'z')) - position[rows]
    force = summed(rows, along, count)
    torque = summed(rows, numpy.cross(arm, along), count)
    limit = contacts['friction_limit'].to_numpy()
    margin = numpy.maximum(0.0, summed(rows, limit[:, None], count)[:, 0] - numpy.linalg.norm(force, axis=1))
    wrench = numpy.hstack([force, torque / SCALE])
    bearable = numpy.full(count, NO_LOAD)
    loaded = numpy.linalg.norm(wrench, axis=1) >= MIN_LOAD
    if loaded.any():
        number = numpy.cumsum(loaded) - 1  # of a loaded sample
        kept = loaded[rows]
        bearable[loaded] = load_factor(number[rows[kept]], arm[kept], normal[kept], limit[kept],
                                       PATCH_TORQUE * contacts['patch'].to_numpy()[kept], wrench[loaded])
    return margin, bearable


def load_factor(rows, arm, normal, limit, lever, wrench):
    """Factor on each wrench (force and torque) up to which friction carries it with the present normal forces.

    The upper bound theorem of plastic limit analysis (for grasps: Goyal, Ruina, Papadopoulos 1991): the minimum, over all
    motions of the object, of the largest power of friction over the power of the load. Found by iteration: the power of
    friction is replaced by a quadratic function with the same value and slope at the last motion."""
    places = pandas.Series(rows).groupby(rows).cumcount().to_numpy()
    shape = (len(wrench), places.max() + 1)
    slide = numpy.zeros(shape + (3, 6))  # velocity along the surface, from the motion
    turn = numpy.zeros(shape + (6,))  # spin about the normal
    limits, levers = numpy.zeros(shape), numpy.zeros(shape)
    tangent = numpy.eye(3) - normal[:, :, None] * normal[:, None, :]
    cross = numpy.zeros((len(arm), 3, 3))
    cross[:, 2, 1], cross[:, 0, 2], cross[:, 1, 0] = arm.T
    cross -= numpy.transpose(cross, (0, 2, 1))
    slide[rows, places] = numpy.concatenate([tangent, -tangent @ cross / SCALE], axis=2)
    turn[rows, places, 3:] = normal / SCALE
    limits[rows, places], levers[rows, places] = limit, lever

    def speeds(motion):
        return (numpy.linalg.norm((slide @ motion[:, None, :, None])[..., 0], axis=2),
                levers * numpy.abs((turn @ motion[:, :, None])[..., 0]))

    motion = wrench / numpy.sum(wrench ** 2, axis=1)[:, None]
    along, spin = speeds(motion)
    least, still = numpy.sum(limits * (along + spin), axis=1), 1.0
    rows_of_slide = slide.reshape(len(wrench), -1, 6)
    for _ in range(ITERATIONS):
        floor = (max(still, SHARPEST) * SCALE * numpy.linalg.norm(motion, axis=1))[:, None]
        weight = numpy.repeat(limits / numpy.maximum(along, floor), 3, axis=1)
        spin_weight = limits * levers ** 2 / numpy.maximum(spin, floor)
        matrix = (numpy.transpose(rows_of_slide * weight[:, :, None], (0, 2, 1)) @ rows_of_slide
                  + numpy.transpose(turn * spin_weight[:, :, None], (0, 2, 1)) @ turn)
        trace = numpy.trace(matrix, axis1=1, axis2=2)
        matrix += (1e-15 * (1e-9 + trace))[:, None, None] * numpy.eye(6)
        yielding = numpy.linalg.solve(matrix, wrench[:, :, None])[..., 0]
        motion = yielding / numpy.sum(yielding * wrench, axis=1)[:, None]
        along, spin = speeds(motion)
        least = numpy.fmin(least, numpy.sum(limits * (along + spin), axis=1))
        still *= SHARPER
    return least
