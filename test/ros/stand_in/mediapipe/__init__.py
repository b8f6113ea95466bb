"""A stand-in for MediaPipe's hand landmarker with the names that its tasks API documents. Once the file $MEDIAPIPE_STAND_IN
exists (CSV, 30 Hz, in the Leap's frame), it finds the next row in each picture, as a camera sees it that stands at $CAMERA, in
that frame, and looks along its -y: from above, x right, z down."""
import csv
import enum
import math
import os

FINGERS = ("thumb", "index", "middle", "ring", "pinky")
FIELD_OF_VIEW, WIDTH, HEIGHT = 60.0, 640, 480


class Fields:
    def __init__(self, **fields):
        self.__dict__.update(fields)


class ImageFormat(enum.Enum):
    SRGB = 1


class Image:
    def __init__(self, image_format, data):
        assert image_format is ImageFormat.SRGB
        self.width, self.height = data.shape[1], data.shape[0]


class RunningMode(enum.Enum):
    IMAGE = 1
    VIDEO = 2
    LIVE_STREAM = 3


def camera_joints(row):
    """In the camera's optical frame."""
    x0, y0, z0 = (float(value) for value in os.environ["CAMERA"].split())

    def place(name):
        x, y, z = (float(row["%s_%s" % (name, axis)]) for axis in "xyz")
        return x - x0, z - z0, y0 - y
    return [place("wrist")] + [place("%s_j%d" % (finger, j)) for finger in FINGERS for j in range(1, 5)]


class HandLandmarker:
    def __init__(self, options):
        assert options.running_mode is RunningMode.VIDEO
        self._rows, self._last = None, -1

    @classmethod
    def create_from_options(cls, options):
        return cls(options)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def detect_for_video(self, image, timestamp_ms):
        if timestamp_ms <= self._last:
            raise ValueError("Input timestamp must be monotonically increasing.")
        self._last = timestamp_ms
        if self._rows is None and os.path.isfile(os.environ["MEDIAPIPE_STAND_IN"]):
            with open(os.environ["MEDIAPIPE_STAND_IN"], encoding="utf-8") as lines:
                self._rows = list(csv.DictReader(lines))
        row = self._rows.pop(0) if self._rows else None
        if row is None or not row["palm_x"]:
            return Fields(hand_landmarks=[], hand_world_landmarks=[], handedness=[])
        joints = camera_joints(row)
        middle = [sum(values) / len(joints) for values in zip(*joints)]
        focal = 0.5 * WIDTH / math.tan(math.radians(0.5 * FIELD_OF_VIEW))
        image_landmarks = [Fields(x=0.5 + focal * x / z / WIDTH, y=0.5 + focal * y / z / HEIGHT, z=0.0) for x, y, z in joints]
        world = [Fields(x=x - middle[0], y=y - middle[1], z=z - middle[2]) for x, y, z in joints]
        return Fields(hand_landmarks=[image_landmarks], hand_world_landmarks=[world],
                      handedness=[[Fields(category_name="Right", score=0.75)]])


class HandLandmarkerOptions(Fields):
    pass


class BaseOptions(Fields):
    pass


tasks = Fields(BaseOptions=BaseOptions,
               vision=Fields(HandLandmarker=HandLandmarker, HandLandmarkerOptions=HandLandmarkerOptions,
                             RunningMode=RunningMode))
