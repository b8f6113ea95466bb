"""A stand-in for OpenCV's camera: black pictures, 30 a second."""
import time

import numpy

COLOR_BGR2RGB = 4
RATE = 30.0


class VideoCapture:
    def __init__(self, camera):
        self._opened, self._next = camera == 0, time.monotonic()

    def isOpened(self):
        return self._opened

    def read(self):
        self._next += 1.0 / RATE
        time.sleep(max(0.0, self._next - time.monotonic()))
        return True, numpy.zeros((480, 640, 3), numpy.uint8)


def cvtColor(picture, code):
    assert code == COLOR_BGR2RGB
    return picture
