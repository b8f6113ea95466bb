#!/usr/bin/python3
"""When and where two runs part."""

import json
import math
import os
import tempfile
import unittest

import pinching  # noqa: F401

from runs.comparison import MOTION, TOLERANCE, compare, text_of
from runs.tables import RunError


def row(time, name, x, turn=0.0):
    return '%f,%s,%f,0,0,0,0,%f,1,0,0,0,0,0,0\n' % (time, name, x, turn)


class ComparisonTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.a, self.b = os.path.join(holder.name, 'a'), os.path.join(holder.name, 'b')

    def compare(self, first, second, tolerance=TOLERANCE):
        self.write(self.a, first)
        self.write(self.b, second)
        return compare(self.a, self.b, tolerance)

    @staticmethod
    def write(folder, rows, more=''):
        os.makedirs(folder, exist_ok=True)
        with open(os.path.join(folder, 'objects.csv'), 'w') as file:
            file.write(','.join(MOTION) + more + '\n' + rows)

    def test_the_same_rows_do_not_part(self):
        rows = row(0.0, 'cube', 0.0) + row(0.1, 'cube', 0.1)
        comparison = self.compare(rows, rows)
        self.assertEqual((comparison.objects, comparison.partings, comparison.near_misses, comparison.same_end),
                         (1, [], [], None))
        self.assertEqual(text_of(comparison), '1 of 1 objects within 1e-09 m and 1e-09 rad in every frame\n'
                         'objects: equal bits in every frame; the state at the end: not known of both runs\n')

    def test_objects_part_at_their_first_frame_that_differs(self):
        start = row(0.0, 'ball', 0.0) + row(0.0, 'cube', 1.0)
        ball, cube = self.compare(
            start + row(0.1, 'ball', 0.2) + row(0.1, 'cube', 1.0) + row(0.2, 'ball', 0.2) + row(0.2, 'cube', 1.5),
            start + row(0.1, 'ball', 0.2, 0.01) + row(0.1, 'cube', 1.0) + row(0.2, 'ball', 0.5) + row(0.2, 'cube', 1.25)).partings
        self.assertEqual((ball.object, ball.time, ball.distance), ('ball', 0.1, 0.0))  # by its turn
        self.assertAlmostEqual(ball.angle, 2.0 * math.atan(0.01), 12)
        self.assertAlmostEqual(ball.max_distance, 0.3, 12)
        self.assertEqual((cube.time, cube.place[0]), (0.2, 1.5))
        self.assertAlmostEqual(cube.distance, 0.25, 12)

    def test_what_differs_within_the_tolerance_does_not_part_and_is_told_as_other_bits(self):
        """7e-21 m beside the origin is rounding, and no parting."""
        start, tiny = row(0.0, 'cube', 0.0), '0.1,cube,7e-21,0,0,0,0,1e-12,1,0,0,0,0,0,0\n'
        near = self.compare(start + row(0.1, 'cube', 0.0), start + tiny)
        self.assertEqual(near.partings, [])
        (miss,) = near.near_misses
        self.assertEqual((miss.time, miss.max_distance), (0.1, 7e-21))
        self.assertAlmostEqual(miss.max_angle, 2e-12, 18)
        self.assertIn('cube: stays within the tolerance, but differs from 0.1 s', text_of(near))
        self.assertIn('objects: different bits; the state at the end: not known', text_of(near))
        later = self.compare(start + row(0.1, 'cube', 0.0) + row(0.2, 'cube', 0.5), start + tiny + row(0.2, 'cube', 0.7))
        self.assertEqual((len(later.partings), later.near_misses, later.partings[0].time), (1, [], 0.2))
        self.assertAlmostEqual(later.partings[0].distance, 0.2, 12)

    def test_the_tolerance_is_chosen_and_none_asks_for_the_last_digit(self):
        still, moved, turned = row(0.0, 'cube', 0.0), row(0.0, 'cube', 0.001), row(0.0, 'cube', 0.0, 0.001)
        faster = '0.000000,cube,0.000000,0,0,0,0,0.000000,1,0,0,0,0,0,1e-300\n'
        for other, tolerance, count in ((moved, (0.0011, 0.0), 0), (moved, (0.0009, 0.0), 1), (turned, (0.0, 0.0021), 0),
                                        (turned, (0.0, 0.0019), 1), (faster, TOLERANCE, 0), (faster, (0.0, 0.0), 1)):
            self.assertEqual(len(self.compare(still, other, tolerance).partings), count, (other, tolerance))

    def test_states_that_end_otherwise_are_told_where_objects_are_the_same(self):
        """Contacts and filters are no rows of objects.csv."""
        for folder, state_hash in ((self.a, '1'), (self.b, '2')):
            self.write(folder, row(0.0, 'cube', 0.0))
            with open(os.path.join(folder, 'summary.json'), 'w') as file:
                json.dump({'state_hash': state_hash}, file)
        comparison = compare(self.a, self.b)
        self.assertEqual((comparison.partings, comparison.same_end), ([], False))
        self.assertIn('equal bits in every frame; the state at the end: different bits', text_of(comparison))

    def test_a_place_that_is_no_number_parts_from_one_that_is(self):
        lost = '0,cube,nan,0,0,0,0,0,1,0,0,0,0,0,0\n'
        self.assertEqual(len(self.compare(row(0.0, 'cube', 0.0), lost).partings), 1)

    def test_a_frame_or_an_object_of_one_alone_is_told(self):
        first = row(0.0, 'cube', 0.0)
        self.assertEqual(len(self.compare(first, row(0.0, 'ball', 0.0)).partings), 2)
        self.assertEqual(self.compare(first + row(0.1, 'cube', 0.0), first).partings[0].why, 'one run ends')
        self.assertEqual(self.compare(row(0.1, 'cube', 0.0), row(0.2, 'cube', 0.0)).partings[0].why, 'a frame of one alone')

    def test_a_run_of_a_version_with_fewer_columns_is_compared_by_its_motion(self):
        self.write(self.a, row(0.0, 'cube', 0.0))
        self.write(self.b, row(0.0, 'cube', 0.0).replace('\n', ',7\n'), ',level')
        self.assertEqual(compare(self.a, self.b).near_misses, [])

    def test_what_is_no_run_is_refused_by_its_name(self):
        with self.assertRaisesRegex(RunError, 'none/objects.csv: No such file or directory; allowed: '):
            compare(os.path.join(self.a, 'none'), self.a)
        for rows, why in (('', r'^\S+objects.csv: is empty; allowed'), ('time,name\n0,cube\n', "has no column 'px'"),
                          (','.join(MOTION) + '\n' + row(0.0, 'cube', 0.0).replace('cube,0', 'cube,x'),
                           "objects.csv, line 2, px: 'x.000000' is no number; allowed: ")):
            os.makedirs(self.a, exist_ok=True)
            with open(os.path.join(self.a, 'objects.csv'), 'w') as file:
                file.write(rows)
            with self.assertRaisesRegex(RunError, why):
                compare(self.a, self.a)


if __name__ == '__main__':
    unittest.main()
