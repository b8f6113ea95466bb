"""Messages to browsers, from those of ROS: shapes once, and poses for each frame, in integers."""

import array
import base64
import json
import math
import time

MAX_FRAME = 5000  # bytes: the rest is sent with the next frame
MAX_CONTACTS = 30  # of a frame
STALE = 0.5  # [s]: older hands and contacts are dropped
LENGTH, DIRECTION, FORCE = 1e4, 1e3, 1e2  # whole numbers are 0.1 mm, 0.001 and 0.01 N
QUATERNION = 1e4
SPHERE, BOX, CYLINDER, CAPSULE, MESH = range(5)  # SceneShape's types
TYPES = 2, 1, 3, 'capsule', 11  # the equivalent marker types
GREY = 0.7, 0.7, 0.7, 1.0
BONES = 4  # of a finger: a phalanx is finger * 4 + bone


def _whole(scale, *numbers):
    return [round(scale * number) for number in numbers]


def _point(point):
    return _whole(LENGTH, point.x, point.y, point.z)


def _pose(pose):
    q = pose.orientation
    return _point(pose.position) + _whole(QUATERNION, q.x, q.y, q.z, q.w)


def _hand(hand):
    """Side, palm, width of the palm, wrist, then for each phalanx: which, start, end, radius, touching."""
    phalanges = [[BONES * p.finger + p.bone, *_point(p.start), *_point(p.end), round(LENGTH * p.radius), int(p.touching)]
                 for p in hand.phalanges]
    return [hand.side, _pose(hand.palm), round(LENGTH * hand.palm_width), _point(hand.wrist), phalanges]


def _contact(contact):
    """Place, normal, force, phase."""
    n, f = contact.normal, contact.force
    return [*_point(contact.position), *_whole(DIRECTION, n.x, n.y, n.z), *_whole(FORCE, f.x, f.y, f.z), contact.phase]


def _base64(numbers):
    return base64.b64encode(array.array('f', numbers).tobytes()).decode()


def _placed(type_, pose, scale, color):
    p, q = pose.position, pose.orientation
    return {'type': type_, 'pose': [p.x, p.y, p.z, q.x, q.y, q.z, q.w], 'scale': list(scale),
            'color': [round(part, 4) for part in color]}


def _scale(type_, size):
    if type_ == SPHERE:
        return 3 * [2.0 * size[0]]
    if type_ == CYLINDER:
        return [2.0 * size[0], 2.0 * size[0], size[1]]
    return size if type_ in (BOX, CAPSULE) else (1.0, 1.0, 1.0)


def _shape(shape):
    """A SceneShape as a marker, and a capsule by radius and length. A mesh without a colour is grey: its materials are not sent."""
    c = shape.color
    placed = _placed(TYPES[shape.type], shape.pose, _scale(shape.type, shape.size), (c.r, c.g, c.b, c.a) if c.a > 0 else GREY)
    if shape.type == MESH:
        corners = [shape.vertices[i] for i in shape.triangles]
        placed['points'] = _base64([number for p in corners for number in (p.x, p.y, p.z)])
    return placed


def _title(scene):
    g = math.sqrt(sum(part * part for part in (scene.gravity.x, scene.gravity.y, scene.gravity.z)))
    return '%s  |  %s  |  gravity: %s' % (scene.name, scene.model, '%.2f m/s2' % g if g > 0.0 else 'none')


def _marker(marker):
    s, c = marker.scale, marker.color
    shape = _placed(marker.type, marker.pose, (s.x, s.y, s.z), (c.r, c.g, c.b, c.a))
    if marker.points:
        shape['points'] = _base64([number for point in marker.points for number in (point.x, point.y, point.z)])
    if marker.colors:
        shape['colors'] = _base64([part for color in marker.colors for part in (color.r, color.g, color.b, color.a)])
    if marker.text:
        shape['text'] = marker.text
    return shape


def _text(kind, content):
    return json.dumps({kind: content}, separators=(',', ':'))


class Picture:
    """The latest state of everything. Callbacks of ROS write it; the server reads it."""

    def __init__(self):
        self.scene = _text('scene', {'title': '', 'bodies': []})
        self.training = _text('training', [])
        self._ids = {}  # of objects, by name
        self._objects = {}  # by id: version and entry
        self._version = 0
        self._hands, self._contacts = (0.0, []), (0.0, [])
        self._training_time = 0.0

    def _id(self, name):
        return self._ids.setdefault(name, len(self._ids))

    def take_scene(self, message):
        """scene: bodies, and for each its pose at the start, where a fixture stays."""
        bodies = []
        for body in message.bodies:
            pose = _pose(body.pose)
            bodies.append({'id': self._id(body.name), 'name': body.name, 'free': not body.fixed, 'pose': pose,
                           'shapes': [_shape(shape) for shape in body.visuals or body.shapes]})
            if body.is_operator:
                bodies[-1]['carries'] = _point(body.link)
        there = {body['id'] for body in bodies}
        self._objects = {id_: entry for id_, entry in self._objects.items() if id_ in there}
        self.scene = _text('scene', {'title': _title(message), 'bodies': bodies})

    def take_training(self, message):
        """training/markers: each array has all that is shown."""
        self._training_time = time.monotonic()
        self.training = _text('training', [dict(_marker(marker), ns=marker.ns) for marker in message.markers
                                           if marker.action == 0])

    def expire(self):
        """Drops the marks of a training_node that has ended."""
        if self._training_time and time.monotonic() - self._training_time > STALE:
            self._training_time, self.training = 0.0, _text('training', [])

    def take_hands(self, message):
        """rendered_hands."""
        self._hands = time.monotonic(), [_hand(hand) for hand in message.hands]

    def has_hands(self):
        """True if hands arrive; they complete a frame."""
        return time.monotonic() - self._hands[0] < STALE

    def take_contacts(self, message):
        self._contacts = time.monotonic(), [_contact(contact) for contact in message.contacts[:MAX_CONTACTS]]

    def take_objects(self, message):
        self._version += 1
        objects = dict(self._objects)  # a copy: another thread may be reading the old one
        for state in message.objects:
            id_ = self._id(state.name)
            entry = [id_, int(state.held) + int(state.held and state.assisted), *_pose(state.pose)]
            if objects.get(id_, (0, None))[1] != entry:
                objects[id_] = self._version, entry
        self._objects = objects

    def frame(self, sent):
        """Text of a frame for a viewer, of which `sent` holds the version of each object; it is brought up to date. Objects
        that moved, those that the viewer has waited for longest first, as far as the frame has room."""
        now = time.monotonic()
        fresh = [content if now - arrival < STALE else [] for arrival, content in (self._hands, self._contacts)]
        objects = self._objects
        text = _text('frame', [*fresh, []])
        room = MAX_FRAME - len(text)
        moved = sorted((sent.get(id_, 0), id_) for id_, (version, _) in objects.items() if version != sent.get(id_))
        entries = []
        for _, id_ in moved:
            version, entry = objects[id_]
            encoded = json.dumps(entry, separators=(',', ':'))
            room -= len(encoded) + 1
            if room < 0:
                break
            entries.append(encoded)
            sent[id_] = version
        return text[:-3] + ','.join(entries) + ']]}'
