"""The clock of a browser beside the one of ROS: learned from questions and replies, through delay, drift and steps."""
import os
import random
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, 'scripts'))
from web.device_clock import DeviceClock  # noqa: E402

OFFSET = 1.7e9  # [s]: a browser counts from the page's start


def ask(clock, now, offset, there, back):
    """A question at ROS time `now`; the ways there and back take so long [s]."""
    clock.note(now, now + there + back, now + there - offset)


class DeviceClockTest(unittest.TestCase):
    def test_nothing_is_known_before_the_first_reply(self):
        self.assertIsNone(DeviceClock().to_ros(1.0))

    def test_it_is_right_to_half_the_shortest_round_trip(self):
        chance = random.Random(1)
        for _ in range(200):
            clock, now, shortest = DeviceClock(), OFFSET + 10.0, 1.0
            for _ in range(20):
                there, back = chance.expovariate(100.0), chance.expovariate(100.0)
                ask(clock, now, OFFSET, there, back)
                shortest, now = min(shortest, there + back), now + 0.5
            self.assertAlmostEqual(clock.round_trip, shortest, delta=1e-6)
            self.assertLessEqual(abs(clock.to_ros(30.0) - (OFFSET + 30.0)), 0.5 * shortest + 1e-6)

    def test_frames_keep_their_order_and_distance_while_the_clock_is_learned_and_drifts(self):
        chance, clock, drift, last = random.Random(2), DeviceClock(), 1e-4, None
        for k in range(72 * 60):
            now = OFFSET + k / 72.0
            offset = OFFSET - drift * k / 72.0
            if k % 36 == 0:
                ask(clock, now, offset, 0.002 + chance.expovariate(200.0), 0.002 + chance.expovariate(200.0))
            stamp = clock.to_ros(now - offset)
            if last is not None:
                self.assertAlmostEqual(stamp - last, 1 / 72.0, delta=0.002 / 72.0 + 1e-6)  # drift and what follows it
            last = stamp
            if k > 720:
                self.assertAlmostEqual(stamp, now, delta=0.006)  # 20 samples are 10 s old at most: 1 ms of drift

    def test_a_clock_that_steps_is_followed_at_once_when_the_old_samples_are_gone(self):
        clock, now = DeviceClock(), OFFSET
        for _ in range(20):
            ask(clock, now, OFFSET, 0.001, 0.001)
            now += 0.5
        clock.to_ros(now - OFFSET)
        for _ in range(20):
            ask(clock, now, OFFSET + 5.0, 0.001, 0.001)
            now += 0.5
        self.assertAlmostEqual(clock.to_ros(now - OFFSET - 5.0), now, delta=1e-6)


if __name__ == '__main__':
    unittest.main()
