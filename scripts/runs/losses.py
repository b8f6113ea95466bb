"""Finds each loss of a hold, or of an attempt to grasp, and its cause: the first that applies."""

import collections
import math

import numpy

from . import stay as evidence
from .grip import finger_text
from .stay import Stay
from .story import GRASP, KIND_OF_GRASP, KIND_OF_GRASP_END

MIN_ATTEMPT = 0.1  # s; shorter touches are no attempts to grasp
MIN_SLIDE = 0.02  # s; a shorter slide of all fingers is part of their separation
SLIPPERY = 0.4  # static friction below that of skin (docs/contact.md)
MAX_FRICTION = 2.0  # largest friction that a text recommends
SKIN_FRICTION = 0.8  # usual static friction of skin; if it would not have sufficed, normal force was too low
ASSIST_END = 0.15  # s; an assist that was active until this long before the end counts as ended
MIN_SPEED_GAIN = 0.02  # m/s; of a touch that is reported
MAX_BREAK = 0.06  # s; touches with a shorter break are one stay
BEFORE_LOSS = 0.15  # s from a picture to the loss
MAX_CHANGES = 10  # that a text names
SLIDE_MARGIN = 0.03  # s, by which an opening may begin after all fingers slide

# Events that end a hold whatever the fingers do: kind, cause, sentence.
ENDS = (('HAND_LOST', 'tracking_lost', 'the tracker lost the hand, which released it'),
        ('OUT_OF_BOUNDS', 'out_of_bounds', "it left the scene's bounds, and was reset to its start"),
        (evidence.JUMP, 'hand_jumped', 'the hand jumped, faster than tracking/max_speed, and released it'))

# The end of a hold, or of a contact of two fingers. Times in s, forces in N.
Loss = collections.namedtuple(
    'Loss', 'object hand_id grasped start until cause push load friction friction_needed push_needed bearable opened by text '
    'grasp_end frame assistance')
# A touch without a hold that made the object faster.
PassingTouch = collections.namedtuple('PassingTouch', 'object hand_id start until fingers speed')
# A moment for a picture.
Moment = collections.namedtuple('Moment', 'what object time loss place palm across radius frame')


def add_losses(story):
    """Adds losses, touches and the moments of pictures to a story."""
    for name in sorted(story.objects):
        thing = story.objects[name]
        first = last = None
        for i in range(len(thing.time)):
            if thing.is_with_hand(i):
                first, last = i if first is None else first, i
            elif first is not None and thing.time[i] - thing.time[last] > MAX_BREAK:
                _end_stay(thing, first, i - 1, story)
                first = None
    story.losses.sort(key=lambda loss: loss.until)
    story.touches.sort(key=lambda touch: touch.until)
    story.moments = _moments(story)


def _end_stay(thing, first, last, story):
    touched = last
    while touched > first and not thing.touches[touched] and not thing.impacts[touched]:
        touched -= 1
    if not thing.touches[touched] and not thing.impacts[touched]:
        return
    hand_id = thing.touches[touched][0].hand_id if thing.touches[touched] else thing.impact_hand[touched]
    if hand_id not in story.hands:
        return
    stay = Stay(thing, story.hands[hand_id], hand_id, first, touched, last)
    grasped = bool((thing.level[first:last + 1] == GRASP).any())
    attempt = (thing.time[touched] - thing.time[first] >= MIN_ATTEMPT
               and any(len(touches) >= 2 for touches in thing.touches[first:touched + 1]))
    if grasped or attempt:
        story.losses.append(_loss_of(stay, grasped, story))
    else:
        _add_touch(stay, story)


def _add_touch(stay, story):
    thing = stay.thing
    speed = numpy.linalg.norm(thing.velocity, axis=1)
    gained = speed[stay.last] - speed[max(stay.first - 1, 0)]
    if gained < MIN_SPEED_GAIN:
        return
    fingers = []
    for i in range(stay.first, stay.touched + 1):
        for finger in [touch.finger for touch in thing.touches[i]] + thing.impacts[i]:
            if finger not in fingers:
                fingers.append(finger)
    story.touches.append(PassingTouch(thing.name, stay.hand_id, thing.time[stay.first], thing.time[stay.touched], fingers, gained))


def _loss_of(stay, grasped, story):
    thing = stay.thing
    slid = evidence.slides_from(stay)
    push = evidence.total_normal_force(stay.touches(slid))
    load = evidence.carried_load(stay) if thing.joint else evidence.load_of(stay, story.gravity, max(slid - 5, stay.first))
    loss = Loss(
        object=thing.name, hand_id=stay.hand_id, grasped=grasped, start=thing.time[stay.first], until=thing.time[stay.touched],
        cause=None, push=push, load=load, friction=thing.static_friction,
        friction_needed=load / push if push > 0.0 else 0.0,
        push_needed=max(0.0, load / max(thing.static_friction, 1e-3) - push),
        bearable=thing.bearable[stay.window:stay.touched + 1].min(), opened=None, by='', text='', grasp_end=_grasp_end(stay, story),
        frame=int(thing.frame[stay.touched]), assistance=evidence.assistance_in(stay))
    cause, why, more = _cause_of(stay, loss, slid, story)
    loss = loss._replace(cause=cause, **more)
    return loss._replace(text=_story_of(loss, stay, why))


def _cause_of(stay, loss, first_slid, story):
    """Cause, sentence, and further fields of the loss."""
    thing, end, slid = stay.thing, stay.time(stay.touched), stay.time(first_slid)
    events = evidence.events_at_end(stay, story)
    for kind, cause, why in ENDS:
        if kind in events:
            return cause, why, {}
    impact, opening = evidence.strongest_impact(stay, story, first_slid), evidence.opening_of(stay)
    obstacle = None if thing.joint else evidence.obstacle_of(stay, story.gravity, first_slid, loss.load)
    # Fingers also slide along what a hand puts down.
    if opening and (obstacle or opening.begun <= slid + SLIDE_MARGIN) and not (impact and impact.time <= opening.clear):
        return 'hand_opened', 'the hand opened: its fingertips moved apart by %.3g mm, from %.2f s on' % (
            1e3 * opening.distance, opening.clear), {'opened': opening.clear}
    if impact:
        return 'impact', "'%s' hit it at %.2f s, with a momentum that changes its speed by %.3g m/s" % (
            impact.by, impact.time, impact.speed), {'by': impact.by}
    if evidence.was_unseen(stay):
        return 'tracking_lost', 'the tracker did not see the hand, which kept its pose', {}
    changes = evidence.changes_before(end if loss.grasp_end is None else min(end, loss.grasp_end), story)
    if changes:
        return 'changed', 'the running scene was changed shortly before, at %s' % _changes_text(changes), {}
    if obstacle:
        return 'blocked', 'a fixture or another object held it back with %.3g N while the hand moved on at %.3g m/s' % obstacle, {}
    if loss.assistance and loss.assistance.until > end - ASSIST_END:
        return 'assist_ended', 'contact alone did not hold it, and the grasp assist that supported it ended', {}
    if thing.joint:
        return 'too_little_force' if slid < end else 'not_known', (
            "it is on joint '%s', and the fingers carried %.3g N along the surfaces with a normal force of %.3g N"
            % (thing.joint, loss.load, loss.push)), {}
    if evidence.faces_were_wrong(stay):
        return 'wrong_faces', 'no two fingers opposed each other within friction (%s), so that no force could hold it' % (
            _faces_text(stay)), {}
    return _weakness(stay, loss, slid) + ({},)


def _changes_text(changes):
    earlier = len(changes) - MAX_CHANGES
    return '; '.join(changes[-MAX_CHANGES:]) + (' (and %d earlier)' % earlier if earlier > 0 else '')


def _weakness(stay, loss, slid):
    slippery = loss.friction < SLIPPERY and SKIN_FRICTION * loss.push >= loss.load
    weak = 'too_little_friction' if slippery else 'too_little_force'
    all_slid = stay.time(stay.touched) - slid >= MIN_SLIDE
    sliding = stay.thing.dynamic_friction * loss.push
    if all_slid and loss.push_needed <= 0.0 and sliding < loss.load:
        return weak, ('all fingers slid, from %.2f s on. Friction then carried %.3g N, and up to %.3g N while it stuck. A straight '
                      'pull took %.3g N, and rotation took more' % (slid, sliding, loss.friction * loss.push, loss.load))
    if loss.push_needed <= 0.0:
        return 'not_known', _remedy(loss)
    if not all_slid or loss.push <= 0.0:
        return 'not_known', ('it did not slide along the fingers, and the fingers did not open: it rotated, or was pushed out '
                             'between them')
    return weak, '%s. %s' % ('it is too slippery for that normal force' if slippery else 'it was held too weakly', _remedy(loss))


def _remedy(loss):
    text = ('The fingers applied a normal force of %.3g N in total and had to carry %.3g N along the surfaces; friction of %.3g '
            'carries up to %.3g N. ' % (loss.push, loss.load, loss.friction, loss.friction * loss.push))
    if loss.push_needed <= 0.0:
        return text + ('That is enough for a straight pull: it rotated, or was pushed out (friction could carry at least %.3g times '
                       'the force and torque together)' % loss.bearable)
    if loss.friction_needed > MAX_FRICTION:
        return text + 'It would be held with %.3g N more normal force' % loss.push_needed
    return text + 'It would be held with friction of %.3g, or %.3g N more normal force' % (loss.friction_needed, loss.push_needed)


def _story_of(loss, stay, why):
    text = '%s (%s from %.2f s) was %s at %.2f s: %s. %s%s' % (
        loss.object, 'held' if loss.grasped else 'pressed', loss.start, 'released' if loss.cause == 'hand_opened' else 'lost',
        loss.until, why, _slides_text(stay), _leaves_text(stay))
    if loss.assistance:
        start, until, force, share = loss.assistance
        text += (' Grasp assist (contact/grasp_assist) supported it from %.2f s to %.2f s with %.3g N on average, %.0f %% of what '
                 'acted on it.' % (start, until, force, 100 * share))
    if loss.grasp_end is not None:
        text += ' GRASP_END came at %.2f s, %s.' % (loss.grasp_end, _beside(loss.grasp_end - loss.until))
    return text


def _beside(delay):
    """Time of the event relative to the last touch, as text."""
    if abs(delay) < 0.005:
        return 'with the last touch'
    if delay < 0.0:
        return '%.2f s before the last touch: the fingers still touched it, but did not hold it' % -delay
    return '%.2f s after the last touch: a grasp ends with a short delay' % delay


def _grasp_end(stay, story):
    """Time of the stay's last GRASP_END, or None."""
    until = stay.time(stay.last) + MAX_BREAK
    times = [event.time for event in story.events if event.kind == KIND_OF_GRASP_END and event.object == stay.thing.name
             and stay.time(stay.first) <= event.time <= until]
    return times[-1] if times else None


def _slides_text(stay):
    """When each finger first slid in the window, in order."""
    first = {}
    for i in range(stay.window, stay.touched + 1):
        for touch in stay.touches(i):
            if touch.slips and touch.finger not in first:
                first[touch.finger] = '%s from %.2f s' % (finger_text(touch.finger), stay.time(i))
    return 'Fingers that slid before: %s.' % ', '.join(first.values()) if first else 'No finger slid before.'


def _leaves_text(stay):
    """When each finger touched last, in order."""
    last = {}
    for i in range(stay.window, stay.touched + 1):
        for touch in stay.touches(i):
            last[touch.finger] = stay.time(i)
    return ' Last touches: %s.' % ', then '.join(
        '%s at %.2f s' % (finger_text(finger), time) for time, finger in sorted((time, finger) for finger, time in last.items()))


def _faces_text(stay):
    """Faces in the frame, among the last ones, in which most fingers touched."""
    most = []
    for i in range(stay.window, stay.touched + 1):
        touches = stay.touches(i)
        most = touches if len(touches) >= len(most) else most
    return ', '.join('%s on %s' % (finger_text(touch.finger), touch.face) for touch in most)


def _moments(story):
    """At each grasp, shortly before each loss, and at it, in the order of time."""
    moments = [_moment('grasp', event.object, event.hand_id, event.time, None, story)
               for event in story.events if event.kind == KIND_OF_GRASP]
    for number, loss in enumerate(story.losses):
        moments.append(_moment('before_loss', loss.object, loss.hand_id, max(loss.start, loss.until - BEFORE_LOSS), number, story))
        moments.append(_moment('loss', loss.object, loss.hand_id, loss.until, number, story))
    moments = sorted((moment for moment in moments if moment), key=lambda moment: moment.time)
    return [moment._replace(loss=_loss_at(moment, story)) for moment in moments]


def _loss_at(moment, story):
    """A grasp belongs to the loss that ends it."""
    for number, loss in enumerate(story.losses):
        if loss.object == moment.object and loss.start <= moment.time <= loss.until:
            return number
    return moment.loss


def _moment(what, name, hand_id, time, loss, story):
    thing = story.objects.get(name)
    i = thing.sample_at(time) if thing else None
    if i is None:
        return None
    place = palm = thing.position[i]
    hand = story.hands.get(thing.touches[i][0].hand_id if thing.touches[i] else hand_id)
    if hand is not None:
        seen = numpy.flatnonzero(hand.time <= thing.time[i] + 1e-6)
        palm = hand.palm[seen[-1]] if len(seen) else palm
    across = sum(((-1.0 if touch.finger in (0, 5) else 1.0) * touch.outward for touch in thing.touches[i]), numpy.zeros(3))
    length = math.sqrt(across @ across)
    across = across / length if length > 0.1 else numpy.zeros(3)
    return Moment(what, name, thing.time[i], loss, place, palm, across, thing.radius, int(thing.frame[i]))
