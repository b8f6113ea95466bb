#!/usr/bin/env python3
"""interaction_node: what hand_frame brings about in objects, contacts, events, markers, tf, diagnostics, services."""
import math
import os
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from std_srvs.srv import SetBool, Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from mr_hand_interaction.msg import Contact, ContactArray, HandFrame, InteractionEvent, ObjectStateArray, Phalanx, RenderedView

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from pointing_hand import FACE, HEIGHT, PERIOD, RADIUS, SPEED, frame, hand, push_tips  # noqa: E402
from standing_clock import INSTANT, StandingClock  # noqa: E402
from waiting import wait_until  # noqa: E402

RESTITUTION = 0.3  # the default
Event = InteractionEvent


class InteractionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("interaction_test")
        cls.rendered, cls.contacts, cls.objects, cls.views, cls.events = {}, {}, {}, {}, []
        cls.now, cls.transforms, cls.layers, cls.counts, cls.reported = None, {}, set(), {}, rospy.Time()
        cls.shown = rospy.Time()
        cls.clock = StandingClock(lambda: cls.shown)
        cls.subscribers = [
            rospy.Subscriber("rendered_hands", HandFrame, cls.take_rendered),
            rospy.Subscriber("contacts", ContactArray, cls.take_contacts),
            rospy.Subscriber("rendered_view", RenderedView, cls.take_view),
            rospy.Subscriber("objects", ObjectStateArray, cls.take_objects),
            rospy.Subscriber("interaction_events", InteractionEvent, cls.take_event),
            rospy.Subscriber("/tf", TFMessage, cls.take_transforms),
            rospy.Subscriber("markers", MarkerArray, cls.take_markers),
            rospy.Subscriber("rack/markers", MarkerArray, cls.take_markers),
            rospy.Subscriber("/diagnostics", DiagnosticArray, cls.take_diagnostics)]
        cls.hands = rospy.Publisher("hand_frame", HandFrame, queue_size=10)
        wait_until(lambda: cls.hands.get_num_connections() > 0, "a subscriber of hand_frame")
        wait_until(lambda: all(s.get_num_connections() > 0 for s in cls.subscribers), "publishers")
        cls.reset_service = rospy.ServiceProxy("interaction_node/reset", Trigger)
        cls.pause_service = rospy.ServiceProxy("interaction_node/pause", SetBool)
        cls.reset_service.wait_for_service(60.0)
        cls.pause_service.wait_for_service(60.0)
        cls.clock.keep_up()
        cls.greet()

    @classmethod
    def greet(cls):
        """A publisher may count a subscriber as one a moment later than the other way round."""
        def answered():
            cls.send()
            cube_placed = any(name == "cube" for _, name in list(cls.transforms))
            return cls.rendered and cls.contacts and cls.objects and cube_placed
        wait_until(answered, "an answer to a frame")
        cls.clock.keep_up()

    @classmethod
    def take_rendered(cls, message):
        cls.rendered[message.header.stamp] = message

    @classmethod
    def take_contacts(cls, message):
        cls.contacts[message.header.stamp] = message.contacts

    @classmethod
    def take_view(cls, message):
        cls.views[message.header.stamp] = message

    @classmethod
    def take_objects(cls, message):
        cls.now = message.objects[0]
        cls.objects[message.header.stamp] = message.objects[0]
        cls.shown = message.header.stamp

    @classmethod
    def take_event(cls, message):
        cls.events.append(message)

    @classmethod
    def take_transforms(cls, message):
        for transform in message.transforms:
            cls.transforms[(transform.header.stamp, transform.child_frame_id)] = transform

    @classmethod
    def take_markers(cls, message):
        cls.layers.update(marker.ns for marker in message.markers)

    @classmethod
    def take_diagnostics(cls, message):
        for status in message.status:
            if status.name == "interaction_node: interaction":
                cls.counts.update({value.key: float(value.value) for value in status.values})
                cls.reported = message.header.stamp

    def setUp(self):
        self.assertTrue(self.reset_service().success)
        self.clock.go_on(INSTANT)
        self.assertEqual(self.now.pose.position.x, 0.0)
        type(self).begin = self.clock.stamp

    @classmethod
    def send(cls, *hands, frame_id="world", stamp=None):
        stamp = stamp or cls.clock.next_stamp(PERIOD)
        cls.hands.publish(frame(stamp, *hands, frame_id=frame_id))
        return stamp

    def answer(self, *hands):
        """The stamp of a frame that has been sent and taken."""
        stamp = self.send(*hands)
        wait_until(lambda: stamp in self.rendered and stamp in self.contacts and stamp in self.objects,
                   "the answer to a frame")
        return stamp

    def push(self, begin=-0.10, end=0.02):
        """Stamps of the frames in which the finger pushes along +x, from `begin` to `end`."""
        return [self.answer(hand(tip)) for tip in push_tips(begin, end)]

    def test_a_view_is_all_of_its_frame_in_one_message(self):
        for stamp in self.push():
            wait_until(lambda: stamp in self.views, "the view of a frame")
            view = self.views[stamp]
            self.assertEqual(view.rendered_hands, self.rendered[stamp].hands)
            self.assertEqual([tracked.id for tracked in view.tracked_hands], [shown.id for shown in view.rendered_hands])
            self.assertEqual(view.objects[0], self.objects[stamp])
            self.assertEqual(view.contacts, self.contacts[stamp])
        self.assertTrue(any(self.contacts[stamp] for stamp in self.views if stamp in self.contacts), "the finger has pushed")

    def settled_counts(self):
        """Counts come once a second: those of everything that has been answered so far."""
        self.clock.go_on(INSTANT)
        wait_until(lambda: self.reported >= self.clock.now, "diagnostics")
        return dict(self.counts)

    def events_here(self):
        """Those of this test: there may still come some of the one before."""
        return [event for event in list(self.events) if event.header.stamp > self.begin]

    def kinds(self):
        return [event.kind for event in self.events_here()]

    def test_a_pushed_cube_flies_on_no_faster_than_newton_allows(self):
        stamps = self.push()
        cube = self.objects[stamps[-1]]
        self.assertEqual(cube.name, "cube")
        self.assertAlmostEqual(cube.mass, 0.1)
        self.assertGreater(cube.pose.position.x, 0.005)
        self.assertGreater(cube.twist.linear.x, 0.5 * SPEED)
        # The finger's speed comes out of a filter: a tenth is for its ripple.
        self.assertLess(cube.twist.linear.x, 1.1 * (1.0 + RESTITUTION) * SPEED)
        self.assertAlmostEqual(cube.pose.position.y, 0.0, delta=1e-3)
        self.assertAlmostEqual(cube.pose.position.z, HEIGHT, delta=1e-3)

    def test_contacts_say_where_and_which_way_the_finger_pushes(self):
        stamps = self.push()
        touches = [touch for stamp in stamps for touch in self.contacts[stamp]]
        self.assertTrue(touches, "no contact")
        for touch in touches:
            self.assertEqual((touch.object, touch.hand_id), ("cube", 7))
            self.assertEqual((touch.finger, touch.bone), (Phalanx.INDEX, Phalanx.DISTAL))
            self.assertAlmostEqual(touch.normal.x, -1.0, delta=0.05)
            self.assertGreaterEqual(touch.impulse.x, 0.0)
            self.assertGreaterEqual(touch.force.x, -1e-9)
        self.assertEqual(touches[0].phase, Contact.IMPULSE)
        self.assertAlmostEqual(touches[0].position.x, FACE, delta=SPEED * PERIOD)
        impulse = sum(touch.impulse.x for touch in touches)
        both = 0.1 * 0.02 / (0.1 + 0.02)  # kg, of the cube and a fingertip against each other
        self.assertGreater(impulse, 0.5 * both * SPEED)

    def test_events_come_in_order(self):
        self.push()
        for _ in range(10):
            self.answer(hand(-0.2))
        self.clock.go_on_until(lambda: Event.HAND_LOST in self.kinds(), "the hand given up, with no frames coming")
        kinds = self.kinds()
        order = [Event.HAND_FOUND, Event.HOVER_BEGIN, Event.CONTACT_BEGIN, Event.CONTACT_END, Event.HOVER_END,
                 Event.HAND_LOST]
        first = [kinds.index(kind) for kind in order[:3]]
        last = [len(kinds) - kinds[::-1].index(kind) for kind in order[3:]]
        self.assertEqual(first + last, sorted(first + last), kinds)
        self.assertNotIn(Event.GRASP_BEGIN, kinds, "one finger cannot grasp")
        for begin, end in ((Event.HOVER_BEGIN, Event.HOVER_END), (Event.CONTACT_BEGIN, Event.CONTACT_END)):
            self.assertEqual(kinds.count(begin), kinds.count(end), kinds)
        for event in self.events_here():
            self.assertEqual(event.hand_id, 7)
            named = event.kind not in (Event.HAND_FOUND, Event.HAND_LOST)
            self.assertEqual(event.object, "cube" if named else "")

    def test_rendered_hand_is_the_tracked_one_when_free_and_never_in_the_cube(self):
        far = self.rendered[self.answer(hand(-0.3))].hands[0]
        self.assertFalse(far.phalanges[0].touching)
        self.assertAlmostEqual(far.phalanges[0].end.x, -0.3 - RADIUS, delta=1e-9)
        for stamp in self.push():
            tip = self.rendered[stamp].hands[0].phalanges[0].end.x + RADIUS
            # Half a millimetre is what a rendered phalanx may be in an object anywhere.
            self.assertLess(tip, self.objects[stamp].pose.position.x + FACE + 5e-4)

    def squeeze(self, depth=0.008):
        """Two fingers close on the cube from either side until each is that deep inside."""
        for tip in push_tips(FACE - 0.02, FACE + depth):
            self.answer(hand(tip), hand(-tip, hand_id=8, way=-1.0))

    def test_every_layer_of_markers_is_published(self):
        # The ghost is there only where the hand is shown elsewhere than it is tracked: one finger alone drives the
        # cube off before it is a millimetre inside, two cannot.
        wanted = {"hand", "ghost", "capsules", "objects", "fixtures", "contacts", "friction", "forces", "newtons",
                  "share", "shadows", "text"}
        def squeezed():
            self.setUp()
            self.squeeze()
            self.clock.go_on(1.0)  # all is shown again in that time, however early the first was
            return wanted <= self.layers
        wait_until(squeezed, "all layers")

    def test_object_has_a_frame_in_world(self):
        stamp = self.push()[-1]
        wait_until(lambda: (stamp, "cube") in self.transforms, "the transform")
        transform = self.transforms[(stamp, "cube")]
        self.assertEqual(transform.header.frame_id, "world")
        self.assertEqual(transform.transform.translation.x, self.objects[stamp].pose.position.x)

    def test_reset_puts_the_object_back(self):
        self.push()
        self.assertGreater(self.now.pose.position.x, 0.0)
        self.assertTrue(self.reset_service().success)
        self.clock.go_on(INSTANT)
        self.assertEqual(self.now.pose.position.x, 0.0)
        self.assertEqual(self.now.twist.linear.x, 0.0)
        self.assertEqual(self.now.pose.orientation.w, 1.0)

    def test_pause_stops_and_resume_goes_on(self):
        self.push()
        before = self.settled_counts()["frames dropped while paused"]
        self.assertTrue(self.pause_service(True).success)
        self.send(hand(-0.2))
        wait_until(lambda: self.counts["frames dropped while paused"] == before + 1, "the count")
        position, seen = self.now.pose.position.x, len(self.objects)
        self.clock.go_on_until(lambda: len(self.objects) > seen + 5, "objects, which are shown while paused")
        self.assertEqual(self.now.pose.position.x, position)
        self.assertGreater(self.now.twist.linear.x, 0.0)
        self.assertTrue(self.pause_service(False).success)
        self.clock.go_on_until(lambda: self.now.pose.position.x > position, "the cube flying on")

    def assert_refused(self, reason, *hands, later=None, **options):
        key = "rejected: " + reason
        before = self.settled_counts()
        self.answer(hand(-0.2))  # a stream's interval is that of its last two frames: two that follow closely
        cube = self.objects[self.answer(hand(-0.2))]
        if later is not None:
            options["stamp"] = self.clock.stamp + rospy.Duration(later)
        self.send(*hands, **options)
        wait_until(lambda: self.counts.get(key, 0.0) == before.get(key, 0.0) + 1, key)
        good = self.answer(hand(-0.2))
        self.assertTrue(math.isfinite(self.objects[good].pose.position.x))
        self.assertEqual(self.objects[good].pose, cube.pose)
        self.assertEqual(len(self.rendered[good].hands), 1)

    def test_bad_frames_are_counted_and_the_good_stays(self):
        self.answer(hand(-0.2))
        broken = hand(-0.2)
        broken.phalanges[0].end.y = float("nan")
        self.assert_refused("unusable hand", broken)
        twice = hand(-0.2)
        twice.phalanges.append(twice.phalanges[0])
        self.assert_refused("unusable hand", twice)
        self.assert_refused("wrong frame", hand(-0.2), frame_id="leap_hands")

    def test_a_stamp_that_is_no_time_is_refused_and_the_next_frame_is_taken(self):
        for seconds in (4294967295, 4000000000):
            self.assert_refused("stamp out of range", hand(0.0), stamp=rospy.Time(seconds))

    def test_a_lone_frame_of_another_time_is_left_out(self):
        self.assert_refused("stamp far ahead", hand(0.0), later=0.4)
        self.assert_refused("stamp far ahead", hand(0.0), later=5.0)
        self.assert_refused("stamp not increasing", hand(0.0), later=-5.0)

    def test_a_stamp_that_repeats_is_refused(self):
        stamp = self.answer(hand(-0.2))
        self.assert_refused("stamp not increasing", hand(0.0), stamp=stamp)


if __name__ == "__main__":
    rostest.rosrun("mr_hand_interaction", "interaction", InteractionTest)
