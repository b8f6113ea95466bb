"""Offset of a browser's clock to ROS time."""

import collections

SAMPLES = 20  # the one with the shortest round trip counts
DRIFT = 1e-3  # largest rate of the offset [s/s]: faster than clocks drift, too slow to reorder frames
STEP = 0.05  # [s]: a larger change of the offset is applied at once


class DeviceClock:
    """Estimates the offset as NTP does: a reply was sent halfway between question and arrival, to half a round trip."""

    def __init__(self):
        self._samples = collections.deque(maxlen=SAMPLES)
        self.offset = None  # [s], of ROS time to the device's; None: not known yet
        self._last = 0.0

    def note(self, asked, arrived, device):
        """ROS time of question and arrival, and the device's in between [s]."""
        self._samples.append((arrived - asked, 0.5 * (asked + arrived) - device))

    @property
    def round_trip(self):
        return min(self._samples)[0] if self._samples else None

    def to_ros(self, device):
        """[s]; None before the first reply."""
        if not self._samples:
            return None
        best = min(self._samples)[1]
        if self.offset is None or abs(best - self.offset) > STEP:
            self.offset = best
        else:
            follow = DRIFT * max(0.0, device - self._last)
            self.offset += max(-follow, min(follow, best - self.offset))
        self._last = device
        return device + self.offset
