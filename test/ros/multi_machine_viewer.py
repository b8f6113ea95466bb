#!/usr/bin/env python3
"""What arrives where rviz is, of all that its display draws from: a line of JSON a second on standard output, until the input ends."""
import json
import sys
import threading

import rospy
from tf2_msgs.msg import TFMessage

from mr_hand_interaction.msg import InteractionEvent, RenderedView, SceneDescription


class Viewer:
    def __init__(self):
        self.lock, self.seen = threading.Lock(), {}
        self.events = {value: name for name, value in vars(InteractionEvent).items() if name.isupper()}
        self.subscribers = [rospy.Subscriber("scene", SceneDescription, self.take_scene),
                            rospy.Subscriber("rendered_view", RenderedView, self.take_view, queue_size=10),
                            rospy.Subscriber("/tf", TFMessage, lambda _: None, queue_size=10),
                            rospy.Subscriber("interaction_events", InteractionEvent, self.take_event)]

    def count(self, what, by=1):
        with self.lock:
            self.seen[what] = self.seen.get(what, 0) + by

    def take_scene(self, scene):
        for body in scene.bodies:
            self.count("shape of " + body.name, len(body.shapes))

    def take_view(self, view):
        self.count("pictures")
        self.count("hands", len(view.rendered_hands))
        self.count("contacts", len(view.contacts))
        self.count("forces", sum(contact.normal_force > 0.1 for contact in view.contacts))
        self.take_objects(view.objects)

    def take_event(self, event):
        self.count(self.events[event.kind])

    def take_objects(self, objects):
        for thing in objects:
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
