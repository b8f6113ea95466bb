#!/usr/bin/env python3
"""What arrives where rviz is, of all that its display draws from: a line of JSON a second on standard output, until the input ends."""
import json
import sys
import threading

import rospy

from mr_hand_interaction.msg import ContactArray, HandFrame, InteractionEvent, ObjectStateArray, SceneDescription


class Viewer:
    def __init__(self):
        self.lock, self.seen = threading.Lock(), {}
        self.events = {value: name for name, value in vars(InteractionEvent).items() if name.isupper()}
        self.subscribers = [rospy.Subscriber("scene", SceneDescription, self.take_scene),
                            rospy.Subscriber("rendered_hands", HandFrame, self.take_hands, queue_size=10),
                            rospy.Subscriber("tracked_hands", HandFrame, lambda _: None, queue_size=10),
                            rospy.Subscriber("contacts", ContactArray, self.take_contacts, queue_size=10),
                            rospy.Subscriber("interaction_events", InteractionEvent, self.take_event),
                            rospy.Subscriber("objects", ObjectStateArray, self.take_objects)]

    def count(self, what, by=1):
        with self.lock:
            self.seen[what] = self.seen.get(what, 0) + by

    def take_scene(self, scene):
        for body in scene.bodies:
            self.count("shape of " + body.name, len(body.shapes))

    def take_hands(self, frame):
        self.count("pictures")
        self.count("hands", len(frame.hands))

    def take_contacts(self, message):
        self.count("contacts", len(message.contacts))
        self.count("forces", sum(contact.normal_force > 0.1 for contact in message.contacts))

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
