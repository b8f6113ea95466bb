"""ROS's time where /use_sim_time is set: it stands still until a test lets it go on, so that nothing hangs on how
long the machine takes. interaction_node goes on by itself after some time without a frame: here only when a test
wants it."""
import rospy
from rosgraph_msgs.msg import Clock

from waiting import wait_until

TICK = 1.0 / 30  # s; as often as the node goes on by itself
INSTANT = 1e-3  # s; nothing happens in it


class StandingClock:
    """The time of the nodes that listen to it, and of the hands' stamps, for one sender of hands. `shown` gives the
    stamp of what the test has last taken, to see whether the node keeps up."""

    def __init__(self, shown):
        self.now = self.stamp = rospy.Time(1000)
        self.shown = shown
        self.publisher = rospy.Publisher("/clock", Clock, queue_size=100, latch=True)
        self.publisher.publish(self.now)

    def next_stamp(self, period):
        """Of a frame that comes so long after the one before. The node's time goes on with the frame."""
        self.stamp += rospy.Duration(period)
        return self.stamp

    def keep_up(self):
        wait_until(lambda: self.shown() >= self.stamp, "what is shown at %s" % self.stamp.to_sec())

    def go_on(self, seconds=TICK):
        """Afterwards all is shown that was done before."""
        by = rospy.Duration(seconds)
        self.now, self.stamp = self.now + by, self.stamp + by
        self.publisher.publish(self.now)
        self.keep_up()

    def go_on_until(self, condition, what, longest=30.0):
        """`longest` is in the clock's time."""
        end = self.now + rospy.Duration(longest)
        while not condition():
            if self.now > end:
                raise AssertionError("waited in vain for " + what)
            self.go_on()
