"""A stand-in for Ultraleap's Python bindings, with the classes and names that they document, as far as leapc_bridge uses
them. Its devices show the recordings that $LEAP_STAND_IN names, a JSON list of events, in seconds since a file of that name
with .go is there:

    {"at": s, "do": "device", "id": 1, "serial": "LP1"}      a device is plugged in, and plays "rows" from then on
    {"at": s, "do": "device lost", "id": 1}
    {"at": s, "do": "connection lost"}
    {"at": s, "do": "refuse", "until": s}                     the service does not answer before
"""
import contextlib
import enum
import json
import os
import threading
import time

FINGERS = ("thumb", "index", "middle", "ring", "pinky")
EPOCH = 5_000_000  # µs: the clock of the service counts from its own start
START, BEGUN = time.monotonic(), []


class LeapError(Exception):
    pass


class LeapTimeoutError(LeapError):
    pass


class HandType(enum.Enum):
    Left = 0
    Right = 1


class TrackingMode(enum.Enum):
    Desktop = 0
    HMD = 1
    ScreenTop = 2


def get_now():
    return EPOCH + int(1e6 * (time.monotonic() - START))


class Vector:
    """Millimetres where it is a place."""

    def __init__(self, values):
        self.x, self.y, self.z = values

    def __getitem__(self, index):
        return (self.x, self.y, self.z)[index]

    def __iter__(self):
        return iter((self.x, self.y, self.z))


class Fields:
    def __init__(self, **fields):
        self.__dict__.update(fields)


def place(row, name):
    return Vector([1e3 * float(row["%s_%s" % (name, axis)]) for axis in "xyz"])


def digit(row, finger):
    width = 1e3 * float(row[finger + "_width"])
    # Each bone a little thinner than the one before it, so that a test sees whose width it is.
    bones = [Fields(prev_joint=place(row, "%s_j%d" % (finger, b)), next_joint=place(row, "%s_j%d" % (finger, b + 1)),
                    width=width - b) for b in range(4)]
    return Fields(bones=bones, metacarpal=bones[0], proximal=bones[1], intermediate=bones[2], distal=bones[3],
                  is_extended=0)


def hand(row):
    digits = [digit(row, finger) for finger in FINGERS]
    zero = Vector((0.0, 0.0, 0.0))
    palm = Fields(position=place(row, "palm"), velocity=zero, normal=Vector((0.0, -1.0, 0.0)),
                  direction=Vector((0.0, 0.0, -1.0)), width=1e3 * float(row["palm_width"]))
    return Fields(id=int(row["hand_id"]), type=HandType.Left if row["is_left"] == "1" else HandType.Right,
                  confidence=float(row["confidence"]), visible_time=1_000_000, pinch_strength=0.5, grab_strength=0.25,
                  palm=palm, digits=digits, arm=Fields(prev_joint=zero, next_joint=place(row, "wrist"), width=60.0))


class Listener:
    def on_event(self, event):
        getattr(self, event.calls)(event)

    def on_error(self, error):
        pass

    def on_connection_event(self, event):
        pass

    def on_connection_lost_event(self, event):
        pass

    def on_device_event(self, event):
        pass

    def on_device_lost_event(self, event):
        pass

    def on_tracking_event(self, event):
        pass


class Device:
    def __init__(self, number, serial):
        self.id, self._serial, self._is_open = number, serial, False

    @contextlib.contextmanager
    def open(self):
        self._is_open = True
        try:
            yield self
        finally:
            self._is_open = False

    def get_info(self):
        if not self._is_open:
            raise LeapError("the device is not open")
        return Fields(serial=self._serial)


class Connection:
    def __init__(self, *, multi_device_aware=False, poll_timeout=1, response_timeout=10):
        if not multi_device_aware:
            raise LeapError("this stand-in has several devices")
        with open(os.environ["LEAP_STAND_IN"], encoding="utf-8") as file:
            self._events = json.load(file)
        self._listeners, self._subscribed, self._over = [], set(), threading.Event()

    def add_listener(self, listener):
        self._listeners.append(listener)

    def set_tracking_mode(self, mode):
        assert isinstance(mode, TrackingMode)

    def subscribe_events(self, device):
        if not device._is_open:
            raise LeapError("the device is not open")
        self._subscribed.add(device.id)

    @contextlib.contextmanager
    def open(self, *, auto_poll=True, timeout=10):
        if any(event["do"] == "refuse" and now() < event["until"] for event in self._events):
            raise LeapTimeoutError("Did not received expected event in time")
        thread = threading.Thread(target=self._poll)
        thread.start()
        try:
            yield self
        finally:
            self._over.set()
            thread.join()

    def _send(self, calls, **fields):
        for listener in self._listeners:
            listener.on_event(Fields(calls=calls, **fields))

    def _poll(self):
        begin, playing, at = now(), {}, 0
        self._send("on_connection_event")
        events = [event for event in self._events if event["do"] != "refuse"]
        while not self._over.wait(0.001):
            # What was there before is there again for a new connection.
            while at < len(events) and events[at]["at"] <= now():
                event, at = events[at], at + 1
                if event["do"] == "device":
                    playing[event["id"]] = [event["at"], list(event["rows"])]
                    self._send("on_device_event", device=Device(event["id"], event["serial"]))
                elif event["do"] == "device lost" and playing.pop(event["id"], None):
                    self._send("on_device_lost_event", device=Device(event["id"], ""))
                elif event["do"] == "connection lost" and event["at"] > begin:
                    self._send("on_connection_lost_event")
                    return
            for number, (since, rows) in playing.items():
                while rows and since + float(rows[0]["time_s"]) <= now():
                    row = rows.pop(0)
                    if number not in self._subscribed:
                        continue
                    self._send("on_tracking_event", metadata=Fields(device_id=number), tracking_frame_id=0, framerate=100.0,
                               timestamp=EPOCH + int(1e6 * (BEGUN[0] - START + since + float(row["time_s"]))),
                               hands=[hand(row)] if row["palm_x"] else [])


def now():
    if not BEGUN and os.path.exists(os.environ["LEAP_STAND_IN"] + ".go"):
        BEGUN.append(time.monotonic())
    return time.monotonic() - BEGUN[0] if BEGUN else -1.0
