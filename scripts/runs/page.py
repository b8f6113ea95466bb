"""The page of an explanation: one HTML file that needs no other."""

import os

import jinja2
import numpy

from . import charts
from .explanation import facts_of
from .grip import FINGERS, finger_text
from .losses import BEFORE_LOSS
from .story import KIND_OF_GRASP

LOOK_BACK, MARGIN = 1.0, 0.1  # s before and after a loss
AROUND = 0.5  # s before the first and after the last touch of an object
GAP_FACTOR = 3.0  # times the usual time between frames
MIN_MOTION = 1e-3  # of a joint, m or rad
MAX_TOUCHES = 20


def page_of(story):
    folder = os.path.dirname(os.path.abspath(__file__))
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(folder), autoescape=True, trim_blocks=True,
                                     lstrip_blocks=True)
    touched = [thing for _, thing in sorted(story.objects.items()) if any(thing.touches)]
    moved, still = [], []
    for _, joint in sorted(story.joints.items()):
        (moved if numpy.abs(joint.position - joint.position[0]).max() > MIN_MOTION else still).append(joint)
    return environment.get_template('explain.html').render(
        story=story, facts=facts_of(story.run.summary), fingers=list(zip(FINGERS, charts.FINGER_COLOURS)),
        finger_text=finger_text, max_touches=MAX_TOUCHES, grasp_mark=charts.GRASP_MARK, loss_mark=charts.LOSS_MARK,
        losses=[_loss(loss, number, story) for number, loss in enumerate(story.losses)],
        objects=[_object(thing, story) for thing in touched],
        untouched=', '.join(sorted(set(story.objects) - {thing.name for thing in touched})),
        joints=[_joint(joint, story) for joint in moved], still=', '.join(joint.name for joint in still),
        hands=[charts.drawn(charts.hand_charts(hand), hand.time[0], hand.time[-1], (), _shades(story))
               for _, hand in sorted(story.hands.items())])


def _shades(story):
    """Times without frames, and without a hand that the tracker has lost."""
    steps = numpy.diff(story.times)
    gaps = numpy.flatnonzero(steps > GAP_FACTOR * numpy.sort(steps)[len(steps) // 2]) if len(steps) else []
    shades = [(story.times[i], story.times[i + 1]) for i in gaps]
    for _, hand in sorted(story.hands.items()):
        shades += [span[:2] for span in charts.spans_of(hand.time, [('lost',) if lost else None for lost in hand.lost])]
    return shades


def _marks(name, story):
    return ([(event.time, charts.GRASP_MARK) for event in story.events
             if event.object == name and event.kind == KIND_OF_GRASP]
            + [(loss.until, charts.LOSS_MARK) for loss in story.losses if loss.object == name])


def _loss(loss, number, story):
    thing, hand = story.objects[loss.object], story.hands[loss.hand_id]
    start, until = max(loss.start - MARGIN, loss.until - LOOK_BACK), min(thing.time[-1], loss.until + MARGIN)
    return {'told': loss, 'pictures': [i for i, moment in enumerate(story.moments) if moment.loss == number],
            'charts': charts.drawn(charts.grip_charts(thing, start, until, False), start, until, _marks(loss.object, story),
                                   _shades(story)),
            'drawings': charts.drawings(thing, hand, (max(loss.start, loss.until - BEFORE_LOSS), loss.until))}


def _object(thing, story):
    touched = [time for time, touches in zip(thing.time, thing.touches) if touches]
    start, until = max(thing.time[0], touched[0] - AROUND), min(thing.time[-1], touched[-1] + AROUND)
    return {'told': thing, 'start': start, 'until': until, 'end': story.times[-1],
            'pictures': [i for i, moment in enumerate(story.moments) if moment.object == thing.name and moment.loss is None],
            'charts': charts.drawn(charts.grip_charts(thing, start, until, True), start, until, _marks(thing.name, story),
                                   _shades(story))}


def _joint(joint, story):
    displacement = joint.position - joint.position[0]
    farthest = int(numpy.argmax(numpy.abs(displacement)))
    events = [event for event in story.events if event.object == joint.body and event.kind in charts.JOINT_EVENTS]
    return {'told': joint, 'most': _motion(joint, displacement[farthest]), 'at': joint.time[farthest],
            'end': _motion(joint, displacement[-1]), 'events': events,
            'chart': charts.drawn([charts.joint_chart(joint)], joint.time[0], joint.time[-1],
                                  _marks(joint.body, story) + [(event.time, charts.JOINT_MARK) for event in events],
                                  _shades(story))}


def _motion(joint, by):
    return '%.3g rad (%.3g degrees)' % (by, numpy.degrees(by)) if joint.turns else '%.3g mm' % (1e3 * by)
