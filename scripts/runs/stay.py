"""An object's stay in a hand: the evidence from which losses.py derives why it ended."""

import collections
import math

import numpy

WINDOW = 0.6  # s before the last touch in which the cause is sought
BEFORE_SLIDE, IMPACT_MARGIN = 0.05, 0.02  # s from an impact to the slide or loss that it causes; from the last touch to an impact
MIN_IMPACT = 0.05  # m/s; smallest change of speed by another object, or a fixture, that counts
IMPACT_REACH = 0.02  # m between bounding spheres; s of the change of speed
JUMP = 'HAND_JUMP'  # beside the kinds of events
MIN_OPENING = 0.003  # m; mean distance of the fingertips from their centre, over the stay
MIN_BEGUN = 0.001  # m; smallest opening while the fingers still touch
CLEAR = 0.1  # fraction of the opening at which the hand counts as open
CATCH = 0.03  # s; fingers that stick for a shorter time still slide
CHANGE_REACH, CHANGE_DIGIT = 0.2, 0.0005  # s from a change of the scene to the loss that it causes; to which its time is rounded
SPAN = 0.02  # s before and after, for the palm's acceleration

Impact = collections.namedtuple('Impact', 'by time speed')
Opening = collections.namedtuple('Opening', 'begun clear distance')
Obstacle = collections.namedtuple('Obstacle', 'force speed')  # mean force against the hand's motion [N]; the hand's speed [m/s]
# First and last time [s]; mean force [N], and its share in the sum of it and of what all contacts together apply.
Assistance = collections.namedtuple('Assistance', 'start until force share')


class Stay:
    """Samples first to last of an object with a hand; they touch in `touched` for the last time."""

    def __init__(self, thing, hand, hand_id, first, touched, last):
        self.thing, self.hand, self.hand_id = thing, hand, hand_id
        self.first, self.touched, self.last = first, touched, last
        self.window = touched  # where the search for a cause begins
        while self.window > first and self.time(touched) - self.time(self.window - 1) <= WINDOW:
            self.window -= 1

    def time(self, i):
        return self.thing.time[i]

    def touches(self, i):
        """Contacts of this hand in a sample."""
        return [touch for touch in self.thing.touches[i] if touch.hand_id == self.hand_id]


def total_normal_force(touches):
    """Sum of the normal forces [N]."""
    return sum(max(touch.normal, 0.0) for touch in touches)


def events_at_end(stay, story):
    """Kinds of the events of hand and object, and JUMP, from the last touch to the next sample; none if the hold ended before."""
    thing, end = stay.thing, stay.touched
    since, until = stay.time(end) - 1e-6, stay.time(min(end + 1, len(thing.time) - 1)) + 1e-6
    if thing.level[end] < thing.level[stay.first:end + 1].max():
        return set()
    kinds = {event.kind for event in story.events if since <= event.time <= until
             and (event.object == thing.name or not event.object and event.hand_id == stay.hand_id)}
    return kinds | {JUMP} if _jumps(stay.hand, since, until, story.max_hand_speed) else kinds


def _jumps(hand, since, until, max_speed):
    """True if palm or a fingertip is faster than max_speed [m/s] from a frame with the hand to the next."""
    seen = numpy.flatnonzero(~hand.lost)
    times, distance = hand.time[seen], numpy.nanmax(numpy.linalg.norm(numpy.diff(hand.tips[seen], axis=0), axis=2), axis=1)
    fast = distance > max_speed * numpy.diff(times)
    return bool((fast & (times[1:] >= since) & (times[1:] <= until)).any())


def was_unseen(stay):
    """True if the tracker did not see the hand at the last touch."""
    hand = stay.hand
    return bool(hand.lost[numpy.abs(hand.time - stay.time(stay.touched)) < 1e-6].any())


def changes_before(end, story):
    """Texts of the changes of the running scene up to CHANGE_REACH before a hold's end [s], or with it."""
    return [change.text for change in story.changes if end - CHANGE_REACH <= change.time <= end + CHANGE_DIGIT]


def obstacle_of(stay, gravity, slid, load):
    """What held the object back more than its load did [N], while the hand moved on, from sample `slid` to the last touch; or None.
    Its force is the object's change of momentum less what hands, grasp assist and gravity gave."""
    thing, hand, back, most, behind = stay.thing, stay.hand, 0.0, 0.0, False
    samples = range(max(slid, 1), min(stay.touched + 1, len(thing.time) - 1) + 1)
    for i in samples:
        step, at = thing.time[i] - thing.time[i - 1], int(numpy.searchsorted(hand.time, thing.time[i] - 1e-9))
        if not 0 < at < len(hand.time) or hand.speed[at] <= 0.0:
            continue
        ahead = (hand.palm[at] - hand.palm[at - 1]) / _norm(hand.palm[at] - hand.palm[at - 1])
        change = thing.velocity[i] - thing.velocity[i - 1] - step * (gravity + thing.force[i] / thing.mass)
        back += max(0.0, -change @ ahead)
        behind |= thing.velocity[i] @ ahead < 0.5 * hand.speed[at]
        most = max(most, hand.speed[at])
    force = thing.mass * back / max(thing.time[samples[-1]] - thing.time[samples[0] - 1], 1e-9)
    return Obstacle(force, most) if behind and back >= MIN_IMPACT and force > load else None


def strongest_impact(stay, story, slid):
    """The strongest impact by an object that no hand touches, or None if none counts. Fingers slide from it on, or touch no more:
    the hold survived an earlier one."""
    worst = Impact('', 0.0, 0.0)
    for name in sorted(story.objects):
        if name != stay.thing.name:
            impact = _impact_by(stay, story.objects[name], story.gravity, stay.time(slid) - BEFORE_SLIDE)
            worst = impact if impact.speed > worst.speed else worst
    return worst if worst.speed >= MIN_IMPACT else None


def _impact_by(stay, other, gravity, since):
    ours, worst = stay.thing, Impact(other.name, 0.0, 0.0)
    end = stay.time(stay.touched)
    for i in numpy.flatnonzero((other.time >= since) & (other.time <= end + IMPACT_MARGIN)):
        if i == 0 or other.touches[i] or other.touches[i - 1]:
            continue
        our = int(numpy.searchsorted(ours.time, other.time[i]))
        if our == len(ours.time):
            continue
        change = other.velocity[i] - other.velocity[i - 1]
        reach = ours.radius + other.radius + IMPACT_REACH + _norm(change) * IMPACT_REACH
        if _norm(ours.position[our] - other.position[i]) > reach:
            continue
        speed = other.mass * _norm(change - gravity * (other.time[i] - other.time[i - 1])) / ours.mass
        worst = Impact(other.name, other.time[i], speed) if speed > worst.speed else worst
    return worst


def opening_of(stay):
    """Opening of a hand that began to open before the last touch, and continued."""
    hand, used = stay.hand, []
    for i in range(stay.window, stay.touched + 1):
        used += [touch.finger for touch in stay.touches(i) if touch.finger not in used]
    spreads = [(hand.time[i], hand.spread(i, used)) for i in numpy.flatnonzero(
        (hand.time >= stay.time(stay.window) - 1e-9) & (hand.time <= stay.time(stay.last) + 1e-9))]
    until = stay.time(min(stay.touched + 1, len(stay.thing.time) - 1)) + 1e-9
    before = []
    for time, spread in spreads:
        if time > until:
            break
        before.append((time, spread))
    if not before:
        return None
    least = 0
    for i, (_, spread) in enumerate(before):
        least = i if spread <= before[least][1] + 1e-5 else least
    begun, smallest = before[least]
    distance = before[-1][1] - smallest
    clear = begun
    for time, spread in before[least:]:
        clear = time if spread <= smallest + CLEAR * distance else clear
    if distance < MIN_BEGUN or spreads[-1][1] - smallest < MIN_OPENING:
        return None
    return Opening(begun, clear, distance)


def faces_were_wrong(stay):
    """True if in most frames no two fingers could hold a body between them: neither was within the other's friction cone."""
    limit, good, bad = -math.cos(2.0 * math.atan(stay.thing.static_friction)), 0, 0
    for i in range(stay.window, stay.touched + 1):
        outward = [touch.outward for touch in stay.touches(i)]
        if len(outward) < 2:
            continue
        opposed = any(a @ b <= limit for n, a in enumerate(outward) for b in outward[n + 1:])
        good, bad = good + opposed, bad + (not opposed)
    return bad > good


def slides_from(stay):
    """First sample from which all fingers slide to the end, except for short catches; the end if they do not."""
    start = stay.touched
    for i in range(stay.touched, stay.window - 1, -1):
        # Not by the friction utilisation: assist and edges carry more than the limit.
        if all(touch.slips for touch in stay.touches(i)):
            start = i
        if stay.time(start) - stay.time(i) > CATCH:
            break
    return start


def carried_load(stay):
    """Largest tangential force that the fingers applied [N]; they do not carry a body on a joint."""
    return max(sum(touch.tangential for touch in stay.touches(i)) for i in range(stay.window, stay.touched + 1))


def load_of(stay, gravity, start):
    """Largest tangential force that the object required [N]: weight, and its acceleration."""
    most = 0.0
    for i in range(start, stay.touched + 1):
        touches = stay.touches(i)
        if touches:
            outward = max(touches, key=lambda touch: touch.normal).outward
            load = stay.thing.mass * (_acceleration(stay.hand, stay.time(i)) - gravity)
            most = max(most, _norm(load - (load @ outward) * outward))
    return most


def _acceleration(hand, time):
    """Acceleration of the palm over twice SPAN [m/s^2]; 0 without samples."""
    before = numpy.flatnonzero(hand.time <= time - SPAN + 1e-6)
    at, after = (numpy.flatnonzero(hand.time >= start - 1e-6) for start in (time, time + SPAN))
    if not (len(before) and len(at) and len(after)):
        return numpy.zeros(3)
    before, at, after = before[-1], at[0], after[0]
    a, b = hand.time[at] - hand.time[before], hand.time[after] - hand.time[at]
    if a <= 0.0 or b <= 0.0:
        return numpy.zeros(3)
    return ((hand.palm[after] - hand.palm[at]) / b - (hand.palm[at] - hand.palm[before]) / a) / (0.5 * (a + b))


def assistance_in(stay):
    """How grasp assist supported the object, or None."""
    active = stay.first + numpy.flatnonzero(stay.thing.assisted[stay.first:stay.touched + 1])
    if not len(active):
        return None
    assist, carried = stay.thing.assist[active].sum(), stay.thing.carried[active].sum()
    return Assistance(stay.time(active[0]), stay.time(active[-1]), assist / len(active), assist / max(assist + carried, 1e-12))


def _norm(vector):
    return math.sqrt(vector @ vector)
