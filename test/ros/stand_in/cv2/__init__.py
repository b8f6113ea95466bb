"""A stand-in for OpenCV's camera: black pictures, 30 a second. It is the clock of its launch too: a busy machine takes longer
for a picture, but finds none missing."""
import time

import numpy
import rospy
from rosgraph_msgs.msg import Clock

COLOR_BGR2RGB = 4
RATE = 30


class VideoCapture:
    def __init__(self, camera):
        self._opened, self._pictures = camera == 0, 0
        self._clock = rospy.Publisher('/clock', Clock, queue_size=10)

    def isOpened(self):
        return self._opened

    def read(self):
        self._pictures += 1
        now = rospy.Time(nsecs=10 ** 9 * self._pictures // RATE)
        while rospy.Time.now() < now:
            self._clock.publish(now)
            time.sleep(1.0 / RATE)
        return True, numpy.zeros((480, 640, 3), numpy.uint8)


def cvtColor(picture, code):
    assert code == COLOR_BGR2RGB
    return picture
