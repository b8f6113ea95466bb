#!/usr/bin/env python3
"""calibrate_mount: the fit, the recorder of touches and the file of points. test/ros has it with a driver."""
import importlib.machinery
import importlib.util
import os
import tempfile
import unittest

import numpy

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCRIPT = importlib.machinery.SourceFileLoader("calibrate_mount", os.path.join(PACKAGE, "scripts", "calibrate_mount"))
mount = importlib.util.module_from_spec(importlib.util.spec_from_loader(SCRIPT.name, SCRIPT))
SCRIPT.exec_module(mount)

# Four corners of a desk and the top of a box [m].
DESK = numpy.array([(-0.2, -0.1, 0.0), (0.2, -0.1, 0.0), (0.2, 0.15, 0.0), (-0.2, 0.15, 0.0), (0.05, 0.05, 0.12)])


class Device:
    """A pose in world."""

    def __init__(self, random):
        self.rotation = numpy.linalg.qr(random.normal(size=(3, 3)))[0]
        self.rotation *= numpy.linalg.det(self.rotation)
        self.place = random.normal(size=3)

    def sees(self, world):
        return (world - self.place) @ self.rotation

    def points(self, world):
        return [mount.Point("abcdefgh"[i], at, device=self.sees(at)) for i, at in enumerate(numpy.array(world))]


class FitTest(unittest.TestCase):
    def setUp(self):
        self.random = numpy.random.RandomState(1)
        self.device = Device(self.random)

    def refused(self, what, call, *arguments):
        with self.assertRaises(mount.Refusal) as caught:
            call(*arguments)
        self.assertIn(what, str(caught.exception))

    def test_exact_points_give_the_pose_back(self):
        """Three are enough, and points of a plane are no mirror image."""
        for _ in range(100):
            device = Device(self.random)
            for count in (3, 4, 5):
                found = mount.fit(device.sees(DESK[:count]), DESK[:count])
                numpy.testing.assert_allclose(found.place, device.place, atol=1e-13)
                numpy.testing.assert_allclose(found.rotation, device.rotation, atol=1e-13)
                self.assertLess(found.rms, 1e-13)
                self.assertGreaterEqual(found.quaternion[3], 0.0)

    def test_noise_leaves_the_residual_and_the_error_that_theory_has_for_it(self):
        """Of 3n coordinates six go into the pose: the squared residuals sum to sigma^2 chi^2(3n - 6) in the mean."""
        sigma, runs, free = 0.0005, 2000, 3 * len(DESK) - 6
        squares = centre_squares = 0.0
        for _ in range(runs):
            device = Device(self.random)
            found = mount.fit(device.sees(DESK) + self.random.normal(0.0, sigma, DESK.shape), DESK)
            squares += sum(found.residuals ** 2)
            centre = DESK.mean(0)
            centre_squares += sum((found.rotation @ device.sees(centre) + found.place - centre) ** 2)
        # Five standard deviations of the mean of chi^2 variables over the runs.
        self.assertAlmostEqual(squares / runs / (sigma ** 2 * free), 1.0, delta=5 * numpy.sqrt(2 / (free * runs)))
        self.assertAlmostEqual(centre_squares / runs / (3 * sigma ** 2 / len(DESK)), 1.0,
                               delta=5 * numpy.sqrt(2 / (3 * runs)))

    def test_too_few_points_and_points_on_one_line_are_refused(self):
        self.refused("2 points; at least three are needed, not on one line", mount.fit, DESK[:2], DESK[:2])
        line = numpy.array([(0, 0, 0), (0.1, 0.2, 0), (0.2, 0.4, 0), (0.3, 0.602, 0)])
        self.refused("lie on one line in world", mount.fit, self.device.sees(line), line)
        self.refused("lie on one line in the device's frame", mount.fit, line, DESK[:4])
        self.refused("one line", mount.fit, numpy.ones((3, 3)), numpy.ones((3, 3)))

    def test_mirrored_points_are_refused_also_with_noise(self):
        for _ in range(100):
            seen = Device(self.random).sees(DESK) * (-1, 1, 1) + self.random.normal(0.0, 0.001, DESK.shape) * (1, 0, 1)
            self.refused("mirrored", mount.fit, seen, DESK)

    def test_the_tip_stands_off_its_point_by_its_radius(self):
        points = self.device.points(DESK)
        for point in points:
            point.normal, point.radius = numpy.array((0.0, 0.0, 1.0)), 0.008
            point.device = self.device.sees(point.world + (0, 0, 0.008))
        numpy.testing.assert_allclose(mount.fit_mount(points).place, self.device.place, atol=1e-13)

    def test_a_large_residual_is_refused_with_the_worst_point(self):
        points = self.device.points(DESK[[0, 1, 2, 4]])
        points[1].device = self.device.sees(DESK[1] + (0, 0, 0.02))
        found = mount.fit_mount(points)
        mount.check_residual(points, found, found.rms)
        worst = "the residual is too large: rms %.1f mm, %.1f mm at %s; allowed: rms 1.0 mm" % (
            1e3 * found.rms, 1e3 * max(found.residuals), points[found.residuals.argmax()].name)
        self.refused(worst, mount.check_residual, points, found, 0.001)

    def test_a_point_that_is_wrong_is_named_though_anothers_residual_is_larger(self):
        """It is far out, where it turns the fit the most."""
        points = self.device.points([(0, 0, 0), (0.05, 0, 0), (0, 0.05, 0), (0.05, 0.05, 0.01), (1.0, 0.9, 0)])
        points[4].device = self.device.sees(points[4].world + (0, 0, 0.05))
        found = mount.fit_mount(points)
        self.assertNotEqual(found.residuals.argmax(), 4, "or this test shows nothing")
        self.refused("but 0.0 mm without e", mount.check_residual, points, found, 1e-4)

    def test_a_point_without_which_the_others_are_on_a_line_is_not_said_to_be_wrong(self):
        points = self.device.points([(0, 0, 0), (0.1, 0, 0), (0.2, 0, 0), (0.3, 0, 0), (0.1, 0.2, 0)])
        points[1].device = self.device.sees(points[1].world + (0, 0, 0.05))
        self.refused("but 0.0 mm without b", mount.check_residual, points, mount.fit_mount(points), 1e-4)


class TouchRecorderTest(unittest.TestCase):
    SAMPLES, RADIUS = 50, 0.008

    def setUp(self):
        self.random = numpy.random.RandomState(1)

    def recorder(self, count):
        return mount.TouchRecorder([mount.Point(str(i), (0.1 * i, 0, 0)) for i in range(count)], self.SAMPLES)

    def hold(self, recorder, at, frames, jitter=0.0002):
        """How many points it takes while the tip stays there, as jittery as a Leap's."""
        return sum(recorder.add(at + self.random.normal(0.0, jitter, 3), self.RADIUS) for _ in range(frames))

    def test_it_takes_the_mean_once_the_tip_has_held_still(self):
        recorder, place = self.recorder(2), numpy.array((0.1, 0.2, 0.0))
        self.assertEqual(self.hold(recorder, place, self.SAMPLES - 1), 0)
        self.assertEqual(self.hold(recorder, place, 1), 1)
        # Five standard deviations of a mean of three coordinates each.
        self.assertLess(numpy.linalg.norm(recorder.points[0].device - place), 5 * 0.0002 * numpy.sqrt(3 / self.SAMPLES))
        self.assertEqual(recorder.points[0].radius, self.RADIUS)
        self.assertIsNone(recorder.points[1].device)

    def test_a_tip_that_rests_where_it_was_is_not_the_next_point(self):
        recorder = self.recorder(2)
        self.assertEqual(self.hold(recorder, (0.0, 0.0, 0.0), 5 * self.SAMPLES), 1)
        self.assertEqual(self.hold(recorder, (0.01, 0.0, 0.0), 5 * self.SAMPLES), 0)
        self.assertEqual(self.hold(recorder, (0.05, 0.0, 0.0), 5 * self.SAMPLES), 1)
        self.assertTrue(recorder.done())
        self.assertFalse(recorder.add(numpy.array((0.2, 0.0, 0.0)), self.RADIUS))

    def test_a_moving_tip_is_not_taken(self):
        recorder = self.recorder(1)
        for i in range(500):  # 6 cm/s
            self.assertFalse(recorder.add(numpy.array((0.0005 * i, 0.0, 0.0)), self.RADIUS))
        self.assertEqual(self.hold(recorder, (1.0, 0.0, 0.0), 3 * self.SAMPLES, 0.005), 0)

    def test_a_lost_tip_begins_anew(self):
        recorder = self.recorder(1)
        self.assertEqual(self.hold(recorder, (0.0, 0.0, 0.0), self.SAMPLES - 1), 0)
        recorder.lose()
        self.assertEqual(self.hold(recorder, (0.0, 0.0, 0.0), self.SAMPLES - 1), 0)
        self.assertEqual(self.hold(recorder, (0.0, 0.0, 0.0), 1), 1)

    def test_points_that_it_could_not_tell_apart_are_refused(self):
        with self.assertRaisesRegex(mount.Refusal, "points a and b are 20 mm apart; allowed: at least 30 mm"):
            mount.TouchRecorder([mount.Point("a", (0, 0, 0)), mount.Point("b", (0, 0.02, 0))], self.SAMPLES)


class PointsFileTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.file = os.path.join(holder.name, "points.yaml")

    def read(self, text):
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(text)
        return mount.PointReader(self.file).points

    def test_only_world_is_needed(self):
        unnamed, shelf = self.read("points:\n  - {world: [1e-1, 0.2, 0.3]}\n  - {name: shelf, world: [1, 0, 0]}\n")
        self.assertEqual((unnamed.name, shelf.name), ("1", "shelf"))
        self.assertEqual(list(unnamed.world), [0.1, 0.2, 0.3])
        self.assertEqual(list(unnamed.tip()), list(unnamed.world))
        self.assertIsNone(unnamed.device)

    def test_what_is_written_is_read_back(self):
        point = mount.Point('left: "corner"', (-0.2, 0.1, 0.0), (0.0, 0.0, 1.0), (0.01, 0.2, -0.03), 0.0085)
        mount.write_points(self.file, [point])
        back, = mount.PointReader(self.file).points
        self.assertEqual((back.name, back.radius), (point.name, point.radius))
        for one, other in ((back.world, point.world), (back.normal, point.normal), (back.device, point.device)):
            self.assertEqual(list(one), list(other))

    def test_refusals_name_the_place_and_what_is_allowed(self):
        keys = "name, world, normal, device, radius"
        for text, refusal in (
                ("points:\n  - {world: [1, 2]}\n",
                 ":2: world: [1, 2] is not allowed; allowed: three finite numbers [x, y, z]"),
                ("points:\n  - {world: [.nan, 2, 3]}\n",
                 ":2: world: [.nan, 2, 3] is not allowed; allowed: three finite numbers [x, y, z]"),
                ("points:\n  - {name: a}\n", ":2: point a: world is missing"),
                ("points:\n  - {word: [1, 2, 3]}\n", ":2: unknown key 'word'; allowed: " + keys),
                ("points:\n  - {world: [1, 2, 3], radius: 8.5}\n",
                 ":2: radius: 8.5 is not allowed; allowed: a number from 0 to 0.03 [m]"),
                ("points:\n  - {world: [1, 2, 3], normal: [0, 0, 0]}\n",
                 ":2: normal: [0, 0, 0] is not allowed; allowed: a direction other than [0, 0, 0]"),
                ("places: []\n", ": no list named points"),
                ("points: [1]\n", ":1: point: 1 is not allowed; allowed: a map with " + keys),
                ("points: [\n", ":2: not YAML: ")):
            with self.assertRaises(mount.Refusal) as caught:
                self.read(text)
            self.assertTrue(str(caught.exception).startswith(self.file + refusal), caught.exception)


if __name__ == "__main__":
    unittest.main()
