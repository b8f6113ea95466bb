"""An explanation as JSON, and the sentences on its run as a whole."""

import math

from .grip import FINGERS, utilisation
from .losses import add_losses
from .story import Story

MAX_BEARABLE = 1e3  # times the load; larger factors are not shown


def explained(run):
    story = Story(run)
    add_losses(story)
    return story


def facts_of(summary):
    """Sentences on the run as a whole."""
    frames, live = summary['frames'], summary.get('live_run')
    facts = ["Scene '%s', gravity [%g, %g, %g] m/s^2, contact model %s, version %s; %d frame%s, %.2f s." % (
        summary['scene'], *summary['gravity'], summary['contact_model'], summary['version'], frames, '' if frames == 1 else 's',
        summary['simulated_seconds'])]
    rejected = ''.join(', %d: %s' % (count, reason) for reason, count in sorted(summary['rejected'].items()))
    facts.append('Frames lost: %d by a queue on the way to the simulation%s.' % (live['lost_by_queue'] if live else 0, rejected))
    if live:
        facts.append(_live_fact(live))
    parameters = ', '.join('%s: %s' % item for item in sorted(summary['parameters'].items()))
    if parameters:
        facts.append('Parameters that are not the default: %s.' % parameters)
    facts += ['Not known: %s.' % what for what in summary['not_known']]
    return facts + ['Changed at %s.' % change for change in (live['changes'] if live else ())]


def _live_fact(live):
    if live['overridden']:
        return 'Differs from the recording: %s.' % '; '.join(live['overridden'])
    if live['parts_at'] is not None:
        return 'Diverges from the live run at %.2f s.' % live['parts_at']
    return 'Identical to the live run: %d of %d recorded states are equal.' % (live['same'], live['compared'])


def as_json(story):
    """Numbers rounded to 1e-6: the tables have all digits."""
    return _rounded({
        'input': story.run.summary['input'],
        'facts': facts_of(story.run.summary),
        'losses': [_loss(loss) for loss in story.losses],
        'touches': [{'object': touch.object, 'hand_id': touch.hand_id, 'from': touch.start, 'until': touch.until,
                     'fingers': [FINGERS[finger] for finger in touch.fingers], 'speed': touch.speed} for touch in story.touches],
        'moments': [dict(moment._asdict(), place=list(moment.place), palm=list(moment.palm), across=list(moment.across), keypoints={
            str(hand.id): hand.keypoints(moment.frame).tolist() for _, hand in sorted(story.hands.items()) if moment.frame in hand.frame})
                    for moment in story.moments],
        'events': [{'time': event.time, 'kind': event.kind, 'object': event.object, 'hand_id': event.hand_id}
                   for event in story.events],
        'joints': [{'name': joint.name, 'object': joint.body, 'unit': 'rad' if joint.turns else 'm', 'lower': joint.lower,
                    'upper': joint.upper, 'samples': [{'time': time, 'position': position}
                                                      for time, position in zip(joint.time, joint.position)]}
                   for _, joint in sorted(story.joints.items())],
        'objects': [_object(thing) for _, thing in sorted(story.objects.items())],
        'hands': [{'id': hand.id, 'samples': [
            {'time': time, 'speed': speed, 'confidence': confidence, 'lost': bool(lost)}
            for time, speed, confidence, lost in zip(hand.time, hand.speed, hand.confidence, hand.lost)]}
                  for _, hand in sorted(story.hands.items())]})


def _loss(loss):
    fields = {'object': loss.object, 'hand_id': loss.hand_id, 'grasped': loss.grasped, 'from': loss.start, 'until': loss.until,
            'cause': loss.cause, 'push': loss.push, 'load': loss.load, 'friction': loss.friction,
            'friction_needed': loss.friction_needed, 'push_needed': loss.push_needed}
    if loss.opened is not None:
        fields['opened'] = loss.opened
    if loss.by:
        fields['by'] = loss.by
    if loss.assistance:
        fields['assist'] = loss.assistance._asdict()
    return dict(fields, text=loss.text, grasp_end=loss.grasp_end)


def _object(thing):
    return {'name': thing.name, 'mass': thing.mass, 'static_friction': thing.static_friction,
            'dynamic_friction': thing.dynamic_friction, 'joint': thing.joint or None, 'line': _stretches(thing),
            'fingers': [_finger(time, touch) for time, touches in zip(thing.time, thing.touches) for touch in touches],
            'grip': [{'time': thing.time[i], 'torque': thing.torque[i], 'margin': thing.margin[i],
                      'bearable': thing.bearable[i] if thing.bearable[i] < MAX_BEARABLE else None,
                      'helped': bool(thing.assisted[i]), 'assist': thing.assist[i]} for i, touches in enumerate(thing.touches) if touches]}


def _stretches(thing):
    """Spans of time in which the object's state stays the same."""
    parts = []
    for time, state in zip(thing.time, thing.state):
        if parts and parts[-1]['state'] == state:
            parts[-1]['until'] = time
            continue
        if parts:
            parts[-1]['until'] = time
        parts.append({'state': state, 'from': time, 'until': time})
    return parts


def _finger(time, touch):
    return {'time': time, 'hand_id': touch.hand_id, 'finger': FINGERS[touch.finger], 'normal_force': touch.normal,
            'tangential_force': touch.tangential, 'friction_limit': touch.limit, 'share': utilisation(touch),
            'slips': bool(touch.slips), 'depth': touch.depth, 'face': touch.face}


def _rounded(value):
    if isinstance(value, dict):
        return {name: _rounded(member) for name, member in value.items()}
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, int) or value == int(value if math.isfinite(value) else 0):
        return int(value) if math.isfinite(value) else None
    return round(float(value), 6) if math.isfinite(value) else None
