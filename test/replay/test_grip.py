#!/usr/bin/python3
"""How many times a load friction could bear, beside closed forms."""

import unittest

import numpy

import pinching  # noqa: F401

from runs.grip import SCALE, load_factor

HALF, LIMIT = 0.02, 4.0  # m, N
EXACT = 1e-3  # of 1: what the iteration leaves


def bearable(force, torque, lever=0.0, more=(), about=(0, 0, 0)):
    """Of thumb and finger at the ends of an axis, each bearing 4 N, and of `more`: (place, normal, limit, lever)."""
    contacts = [((HALF, 0, 0), (1, 0, 0), LIMIT, lever), ((-HALF, 0, 0), (-1, 0, 0), LIMIT, lever)] + list(more)
    arm, normal, limit, levers = (numpy.array(column, float) for column in zip(*contacts))
    wrench = numpy.hstack([numpy.array(force, float), numpy.array(torque, float) / SCALE])[None]
    return load_factor(numpy.zeros(len(contacts), int), arm - numpy.array(about), normal, limit, levers, wrench)[0]


class GripTest(unittest.TestCase):
    def test_a_straight_load_is_shared_by_all_fingers(self):
        self.assertAlmostEqual(bearable((0, 0, -2.0), (0, 0, 0)), LIMIT, delta=4.0 * EXACT)

    def test_a_turn_across_the_grip_has_the_distance_of_the_fingers_as_its_lever(self):
        self.assertAlmostEqual(bearable((0, 0, 0), (0, 0, LIMIT * HALF)), 2.0, delta=2.0 * EXACT)

    def test_a_turn_about_the_grip_is_borne_by_the_patches_alone(self):
        self.assertLess(bearable((0, 0, 0), (0.01, 0, 0)), EXACT)
        self.assertAlmostEqual(bearable((0, 0, 0), (0.01, 0, 0), 0.005), 2.0 * LIMIT * 0.005 / 0.01, delta=4.0 * EXACT)

    def test_force_and_torque_together_are_less_than_either_alone(self):
        force, torque = 1.6 * LIMIT, 1.2 * LIMIT * HALF  # 0.8 and 0.6 of what is borne
        self.assertAlmostEqual(bearable((0, 0, force), (0, 0, 0)), 1.0 / 0.8, delta=2.0 * EXACT)
        # One finger bears 0.8 + 0.6 of the limit, the other 0.2.
        self.assertAlmostEqual(bearable((0, force, 0), (0, 0, torque)), 1.0 / 1.4, delta=2.0 * EXACT)
        # Across each other they add as the sides of a triangle do.
        self.assertAlmostEqual(bearable((0, 0, force), (0, 0, torque)), 1.0, delta=2.0 * EXACT)

    def test_a_load_along_the_push_is_not_friction_s(self):
        self.assertLess(bearable((1.0, 0, 0), (0, 0, 0), 0.01), EXACT)

    def test_where_the_load_is_taken_about_makes_no_difference(self):
        force, torque, away = (numpy.array(value) for value in ((0.5, 1.0, -2.0), (0.01, 0.02, 0.03), (0.3, -0.2, 0.1)))
        third = [((0, HALF, 0.01), (0, 1, 0), 3.0, 0.004)]
        here = bearable(force, torque, 0.004, third)
        self.assertAlmostEqual(bearable(force, torque - numpy.cross(away, force), 0.004, third, away), here, delta=0.01 * here)


if __name__ == '__main__':
    unittest.main()
