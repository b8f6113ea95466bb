"""Messages from a browser: hands in binary, all others in JSON. Independent of ROS."""

import json
import math
import struct

JOINTS = 25  # of a hand in the WebXR order: wrist, thumb (4), index, middle, ring, little (5 each)
SIDES = ('left', 'right')
POINTS = JOINTS * len(SIDES)  # left, then right
# Little-endian: the browser's time [ms]; x, y, z and the radius of each joint [m]; tracking state of each
HANDS = struct.Struct('<d%df%dB' % (4 * POINTS, POINTS))
TRACKED = 2  # 0: not, with NaN as its place; 1: inferred from the others
MAX_BYTES = 4096  # of a message
MAX_TIME = 1e13  # [ms]: a browser counts from the page's start, or from 1970
MAX_DISTANCE = 100.0  # [m] from the origin of the browser's space
MAX_RADIUS = 0.1  # [m] of a joint


class Refusal(Exception):
    """Error of a refused message: one line that says what is allowed."""


def read_hands(data):
    """Time [ms], the joints' numbers, and for each joint its confidence from 0 to 1."""
    if len(data) != HANDS.size:
        raise Refusal('a binary message of %d bytes; allowed: %d, two hands of %d joints' % (len(data), HANDS.size, JOINTS))
    time, *numbers = HANDS.unpack(data)
    numbers, flags = numbers[:4 * POINTS], numbers[4 * POINTS:]
    if not 0.0 <= time <= MAX_TIME:
        raise Refusal('time %g ms; allowed: 0 to %g' % (time, MAX_TIME))
    for i, number in enumerate(numbers):
        if i % 4 == 3 and not math.isnan(number) and not 0.0 <= number <= MAX_RADIUS:
            raise Refusal('radius %g m; allowed: 0 to %g, or NaN' % (number, MAX_RADIUS))
        if abs(number) > MAX_DISTANCE:  # NaN is not
            raise Refusal('a joint at %g m; allowed: at most %g, or NaN' % (number, MAX_DISTANCE))
    if max(flags) > TRACKED:
        raise Refusal('a joint tracked as %d; allowed: 0, 1, 2' % max(flags))
    return time, numbers, [flag / TRACKED for flag in flags]


def _no_constant(name):
    raise ValueError(name)


def _numbers(values, count, limit):
    fine = (isinstance(values, list) and len(values) == count and
            all(type(value) in (int, float) and abs(value) <= limit for value in values))
    return [float(value) for value in values] if fine else None


def read_text(text):
    """('pong', (number, time [ms])), ('hands', True or False) or ('place', position and unit quaternion)."""
    try:
        message = json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError):
        raise Refusal('a text that is not JSON; allowed: one object with pong, hands or place') from None
    if not isinstance(message, dict) or len(message) != 1:
        raise Refusal('not one key; allowed: one object with pong, hands or place')
    (key, value), = message.items()
    if key == 'pong':
        numbers = _numbers(value, 2, MAX_TIME)
        if numbers and numbers[1] >= 0.0:
            return key, (int(numbers[0]), numbers[1])
        raise Refusal('pong; allowed: the number of a ping and a time of 0 to %g ms' % MAX_TIME)
    if key == 'hands':
        if isinstance(value, bool):
            return key, value
        raise Refusal('hands; allowed: true or false')
    if key == 'place':
        numbers = _numbers(value, 7, MAX_DISTANCE)
        length = math.sqrt(sum(q * q for q in numbers[3:])) if numbers else 0.0
        if length > 0.5:
            return key, numbers[:3] + [q / length for q in numbers[3:]]
        raise Refusal('place; allowed: x, y, z of at most %g m and a quaternion x, y, z, w' % MAX_DISTANCE)
    raise Refusal('an unknown key; allowed: pong, hands, place')
