#!/usr/bin/env python3
"""What arrives where rviz is: a line of JSON a second on standard output, until the input ends."""
import json
import sys
import threading

import rospy
from visualization_msgs.msg import Marker, MarkerArray

from mr_hand_interaction.msg import InteractionEvent, ObjectStateArray


class Viewer:
    def __init__(self):
        self.lock, self.seen = threading.Lock(), {}
        self.events = {value: name for name, value in vars(InteractionEvent).items() if name.isupper()}
        self.subscribers = [rospy.Subscriber("view/markers", MarkerArray, self.take_markers, queue_size=10),
                            rospy.Subscriber("interaction_events", InteractionEvent, self.take_event),
                            rospy.Subscriber("objects", ObjectStateArray, self.take_objects)]

    def count(self, what, by=1):
        with self.lock:
            self.seen[what] = self.seen.get(what, 0) + by

    def take_markers(self, array):
        self.count("pictures")
        for layer in {marker.ns for marker in array.markers if marker.action == Marker.ADD}:
            self.count("layer " + layer)

    def take_event(self, event):
        self.count(self.events[event.kind])

    def take_objects(self, message):
        for thing in message.objects:
            if thing.held:
                self.count("held " + thing.name)
            if thing.pose.position.z > 0.27:
                self.count("lifted " + thing.name)

    def tell(self):
        with self.lock:
            seen, self.seen = self.seen, {}
        print(json.dumps(seen), flush=True)


def main():
    rospy.init_node("viewer", disable_signals=True)
    viewer = Viewer()
    ended = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
    while not ended.wait(1.0):
        viewer.tell()


if __name__ == "__main__":
    main()
