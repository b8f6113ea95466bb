"""Writes a demonstration as HDF5 with the field names of LeRobot's data sets, for robot learning. Needs h5py."""

import json

import h5py
import numpy

from .demonstration import POSE, keypoints

JOINTS = ['wrist'] + ['%s_%d' % (finger, joint) for finger in ('thumb', 'index', 'middle', 'ring', 'little') for joint in range(4)]


def write_hdf5(demonstration, path):
    """Writes one episode. The state is that of the hands, the environment's state that of the objects; the action is the next state."""
    count, state, names = len(demonstration.stamps), [], []
    for side, body in demonstration.hands.items():
        state += [body.pose, keypoints(body.bones).reshape(count, -1)]
        names += ['%s.palm.%s' % (side, name) for name in POSE]
        names += ['%s.%s.%s' % (side, joint, axis) for joint in JOINTS for axis in 'xyz']
    things, thing_names = [], []
    for name, body in demonstration.objects.items():
        things += [body.pose, body.held[:, None]]
        thing_names += ['%s.%s' % (name, column) for column in POSE + ('held',)]
    state, things = (numpy.hstack(parts) if parts else numpy.zeros((count, 0)) for parts in (state, things))
    follows = numpy.minimum(numpy.arange(count) + 1, count - 1)
    seconds = (demonstration.stamps - demonstration.stamps[0]) / 1e9
    fields = {
        'observation.state': (state, names), 'observation.environment_state': (things, thing_names), 'action': (state[follows], names),
        'timestamp': (seconds, None), 'frame_index': (numpy.arange(count), None), 'episode_index': (numpy.zeros(count, int), None),
        'index': (numpy.arange(count), None), 'task_index': (numpy.zeros(count, int), None),
        'next.done': (numpy.arange(count) == count - 1, None)}
    with h5py.File(path, 'w') as file:
        file.attrs['fps'] = (count - 1) / seconds[-1] if count > 1 else 0.0
        file.attrs['frame'] = 'world'
        file.attrs['events'] = json.dumps([[i, event] for i, told in enumerate(demonstration.events) for event in told])
        for name, (values, columns) in fields.items():
            kind = {'f': 'f4', 'i': 'i8', 'b': '?'}[values.dtype.kind]
            dataset = file.create_dataset(name, data=values.astype(kind))
            if columns is not None:
                dataset.attrs['names'] = columns
