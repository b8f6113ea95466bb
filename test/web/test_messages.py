"""What browsers send, fuzzed: each message is taken within its limits, or refused in one line that says what is allowed."""
import math
import os
import struct
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, 'scripts'))
from web import messages  # noqa: E402

try:
    from hypothesis import given, settings, strategies
except ImportError:
    raise unittest.SkipTest('hypothesis is not installed (Debian: python3-hypothesis)')

CASES = settings(max_examples=300, deadline=None, derandomize=True, database=None)
TIMES = strategies.floats(0.0, messages.MAX_TIME)
SMALL = strategies.floats(-0.0625, 0.0625, width=32) | strategies.just(math.nan)
JSON = strategies.recursive(strategies.none() | strategies.booleans() | strategies.integers() | strategies.floats() |
                            strategies.text(), lambda inner: strategies.lists(inner) |
                            strategies.dictionaries(strategies.sampled_from(['pong', 'hands', 'place']), inner))


def outcome(read, data):
    """What is read; None: refused in one line."""
    try:
        return read(data)
    except messages.Refusal as refusal:
        line = str(refusal)
        assert line.isprintable() and 'allowed: ' in line and len(line) < 300, line
        return None


class MessagesTest(unittest.TestCase):
    @CASES
    @given(strategies.binary(max_size=2 * messages.MAX_BYTES))
    def test_any_bytes_are_taken_or_refused(self, data):
        outcome(messages.read_hands, data)

    @CASES
    @given(strategies.binary(min_size=messages.HANDS.size, max_size=messages.HANDS.size), strategies.floats() | TIMES)
    def test_hands_of_any_numbers_are_within_limits_or_refused(self, data, time):
        read = outcome(messages.read_hands, struct.pack('<d', time) + data[8:])
        if read is not None:
            self.assertTrue(0.0 <= read[0] <= messages.MAX_TIME)
            self.assertFalse([number for number in read[1] if abs(number) > messages.MAX_DISTANCE])
            self.assertTrue(all(0.0 <= confidence <= 1.0 for confidence in read[2]))

    @CASES
    @given(TIMES, strategies.lists(SMALL, min_size=8, max_size=8), strategies.integers(0, 2))
    def test_hands_within_limits_keep_their_bits(self, time, places, flag):
        numbers, flags = 25 * [*places[:3], abs(places[3]), *places[4:7], abs(places[7])], 50 * [flag]
        data = struct.pack('<d200f50B', time, *numbers, *flags)
        read_time, read, confidences = messages.read_hands(data)
        self.assertEqual(struct.pack('<d200f50B', read_time, *read, *flags), data)
        self.assertEqual(confidences, [flag / 2 for flag in flags])

    @CASES
    @given(strategies.text(max_size=messages.MAX_BYTES))
    def test_any_text_is_refused(self, text):
        self.assertIsNone(outcome(messages.read_text, text))  # none of these is an object with a known key

    @CASES
    @given(JSON)
    def test_any_json_is_within_limits_or_refused(self, content):
        read = outcome(messages.read_text, messages.json.dumps(content))
        if read is not None:
            self.assertIn(read[0], ('pong', 'hands', 'place'))

    @CASES
    @given(strategies.lists(strategies.integers() | strategies.floats(), min_size=7, max_size=7))
    def test_a_place_is_finite_with_a_unit_quaternion_or_refused(self, numbers):
        read = outcome(messages.read_text, messages.json.dumps({'place': numbers}))
        if read is not None:
            self.assertAlmostEqual(sum(q * q for q in read[1][3:]), 1.0, places=9)
            self.assertLessEqual(max(map(abs, read[1][:3])), messages.MAX_DISTANCE)

    def test_deep_nesting_is_refused(self):
        self.assertIsNone(outcome(messages.read_text, '[' * 4000 + ']' * 4000))


if __name__ == '__main__':
    unittest.main()
