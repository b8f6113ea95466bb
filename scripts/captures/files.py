"""Reads what capture sets are stored in, without running anything that is in it."""
import io
import json
import os
import pickle
import struct
import zipfile
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

POINT_TYPES = {'float': 'f4', 'float32': 'f4', 'double': 'f8', 'float64': 'f8', 'uchar': 'u1', 'uint8': 'u1', 'char': 'i1', 'int8': 'i1',
               'short': 'i2', 'ushort': 'u2', 'int': 'i4', 'int32': 'i4', 'uint': 'u4', 'uint32': 'u4'}
STORAGES = {'FloatStorage': 'f4', 'DoubleStorage': 'f8', 'HalfStorage': 'f2', 'LongStorage': 'i8', 'IntStorage': 'i4'}


class CaptureError(Exception):
    pass


class _Chumpy:
    """An array of MANO's model files, which are pickled with chumpy."""

    def __setstate__(self, state):
        self.values = state['x'] if 'x' in state else state.get('a')


def _tensor(storage, offset, size, stride, *_):
    return np.lib.stride_tricks.as_strided(storage[offset:], size, [step * storage.itemsize for step in stride]).copy()


def _storage(data):
    """A tensor's numbers, as torch.save has written them in its older format."""
    stream, found = io.BytesIO(data), {}
    for _ in range(3):
        Arrays(stream).load()  # magic number, version, system

    class Storages(Arrays):
        def persistent_load(self, key):
            found[key[2]] = np.dtype(STORAGES[key[1]])
            return key[2]
    wanted = Storages(stream).load()
    for key in Arrays(stream).load():
        count, = struct.unpack('<q', stream.read(8))
        found[key] = np.frombuffer(stream.read(count * found[key].itemsize), found[key])
    return found[wanted]


class Arrays(pickle.Unpickler):
    """Takes arrays, tensors, dictionaries and numbers. A file that asks for anything else is refused."""
    NUMPY = {'_reconstruct', 'ndarray', 'dtype', 'scalar'}

    def find_class(self, module, name):
        if module in ('numpy', 'numpy.core.multiarray', 'numpy._core.multiarray') and name in self.NUMPY:
            return super().find_class(module.replace('_core', 'core'), name)
        if (module, name) in (('collections', 'OrderedDict'), ('_codecs', 'encode')):  # the latter: bytes, in old pickles
            return super().find_class(module, name)
        if module.startswith('torch') and name in STORAGES:
            return name
        if module.split('.')[0] in ('chumpy', 'scipy'):
            return _Chumpy if module.startswith('chumpy') else _Sparse
        found = {'_rebuild_tensor_v2': _tensor, '_load_from_bytes': _storage}.get(name)
        if module.startswith('torch') and found:
            return found
        raise pickle.UnpicklingError('holds a %s.%s; allowed: arrays, tensors and dictionaries' % (module, name))


class _Sparse:
    """A scipy matrix by columns, of MANO's model files."""

    def __setstate__(self, state):
        self.values = np.zeros(state.get('_shape', state.get('shape')))
        for column, (start, end) in enumerate(zip(state['indptr'], state['indptr'][1:])):
            self.values[state['indices'][start:end], column] = state['data'][start:end]


def read_pickle(path):
    with open(path, 'rb') as file:
        return _checked(path, lambda: Arrays(file, encoding='latin1').load())


def read_npy(path):
    """An array, or the object that a .npy file holds."""
    with open(path, 'rb') as file:
        return _checked(path, lambda: _npy(file))


def read_npz(path):
    with zipfile.ZipFile(path) as archive:
        return {name[:-4]: _checked(path, lambda: _npy(io.BytesIO(archive.read(name)))) for name in archive.namelist()}


def _npy(file):
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, fortran, kind = read(file)
    if kind.hasobject:
        value = Arrays(file, encoding='latin1').load()
        return value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value
    values = np.frombuffer(file.read(), kind, int(np.prod(shape))).copy()
    return values.reshape(shape[::-1]).T if fortran else values.reshape(shape)


def _checked(path, read):
    try:
        return read()
    except (pickle.UnpicklingError, ValueError, KeyError, EOFError, AttributeError, struct.error, TypeError) as error:
        raise CaptureError('%s: %s' % (path, error)) from None


def read_points(path):
    """Vertices of a mesh: OBJ, PLY or GLB."""
    readers = {'.obj': _obj, '.ply': _ply, '.glb': _glb}
    ending = os.path.splitext(path)[1].lower()
    if ending not in readers:
        raise CaptureError('%s: not a mesh that is read; allowed: %s' % (path, ', '.join(readers)))
    with open(path, 'rb') as file:
        data = file.read()
    return _checked(path, lambda: readers[ending](data).astype(float))


def read_triangles(path):
    """Of an OBJ; none of other meshes."""
    if not path.endswith('.obj'):
        return np.empty((0, 3), int)
    with open(path, encoding='utf-8', errors='replace') as file:
        faces = [[int(corner.split('/')[0]) - 1 for corner in line.split()[1:]] for line in file if line.startswith('f ')]
    return np.array([(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)], int).reshape(-1, 3)


def read_masses(path):
    """{link: mass [kg]} of a URDF; none without the file."""
    if not os.path.exists(path):
        return {}
    return {link.get('name'): float(link.find('inertial/mass').get('value')) for link in ElementTree.parse(path).iter('link')
            if link.find('inertial/mass') is not None}


def _obj(data):
    return np.array([[float(x) for x in line.split()[1:4]] for line in data.decode('utf-8', 'replace').split('\n')
                     if line.startswith('v ')])


def _ply(data):
    end = data.index(b'end_header')
    header, body = data[:end].decode('ascii').split('\n'), data[data.index(b'\n', end) + 1:]
    fields, count, inside = [], 0, False
    for words in map(str.split, header):
        if words[:1] == ['element']:
            inside = words[1] == 'vertex'
            count = int(words[2]) if inside else count
        elif words[:1] == ['property'] and inside:
            fields.append((words[-1], POINT_TYPES[words[1]]))
    if 'format ascii 1.0' in '\n'.join(header):
        rows = np.array([line.split()[:len(fields)] for line in body.decode('ascii').split('\n')[:count]], float)
        names = [name for name, _ in fields]
        return rows[:, [names.index(axis) for axis in 'xyz']]
    order = '<' if 'little' in '\n'.join(header) else '>'
    rows = np.frombuffer(body, np.dtype([(name, order + kind) for name, kind in fields]), count)
    return np.column_stack([rows[axis] for axis in 'xyz'])


def _glb(data):
    length, = struct.unpack('<I', data[12:16])
    scene, binary = json.loads(data[20:20 + length]), data[28 + length:]
    return np.vstack([points @ turn.T + shift for mesh, turn, shift in _placed(scene) for points in _positions(scene, binary, mesh)])


def _placed(scene):
    """(mesh, linear part, shift) of each node with a mesh, in the scene; without nodes, of each mesh."""
    if 'nodes' not in scene:
        return [(mesh, np.eye(3), np.zeros(3)) for mesh in range(len(scene['meshes']))]
    children = {child for node in scene['nodes'] for child in node.get('children', [])}
    found, waiting = [], [(i, np.eye(4)) for i in range(len(scene['nodes'])) if i not in children]
    while waiting:
        number, parent = waiting.pop()
        node = scene['nodes'][number]
        own = np.reshape(node.get('matrix', np.eye(4)), (4, 4)).T.astype(float)  # glTF stores columns
        if 'matrix' not in node:
            own[:3, :3] = Rotation.from_quat(node.get('rotation', [0, 0, 0, 1])).as_matrix() * node.get('scale', [1, 1, 1])
            own[:3, 3] = node.get('translation', [0, 0, 0])
        placed = parent @ own
        waiting += [(child, placed) for child in node.get('children', [])]
        if 'mesh' in node:
            found.append((node['mesh'], placed[:3, :3], placed[:3, 3]))
    return found


def _positions(scene, binary, mesh):
    for primitive in scene['meshes'][mesh]['primitives']:
        accessor = scene['accessors'][primitive['attributes']['POSITION']]
        view = scene['bufferViews'][accessor['bufferView']]
        start = view.get('byteOffset', 0) + accessor.get('byteOffset', 0)
        step = view.get('byteStride', 12)
        rows = np.frombuffer(binary, 'u1', (accessor['count'] - 1) * step + 12, start)
        yield np.lib.stride_tricks.as_strided(rows, (accessor['count'], 12), (step, 1)).copy().view('<f4').astype(float)


def read_bvh(path):
    """Of a motion: names of its joints, in a parent's order before its children's; places (frames, 3) and rotations of each, in the
    file's unit; seconds a frame."""
    names, parents, offsets, channels, open_joints = [], [], [], [], []
    with open(path, encoding='utf-8') as file:
        for words in map(str.split, file):
            if words[:1] in (['ROOT'], ['JOINT'], ['End']):
                parents.append(open_joints[-1] if open_joints else None)
                open_joints.append(len(names))
                names.append(words[1])
                channels.append([])
            elif words[:1] == ['OFFSET']:
                offsets.append([float(x) for x in words[1:4]])
            elif words[:1] == ['CHANNELS']:
                channels[-1] = words[2:]
            elif words[:1] == ['}']:
                open_joints.pop()
            elif words[:2] == ['Frame', 'Time:']:
                seconds = float(words[2])
                break
        else:
            raise CaptureError('%s: no motion; a BVH is needed' % path)
        rows = np.array([[float(x) for x in line.split()] for line in file if line.strip()])
    places, turns, begin = [], [], 0
    for parent, offset, of in zip(parents, offsets, channels):
        values = dict(zip(of, rows[:, begin:begin + len(of)].T))
        begin += len(of)
        place = np.tile(np.array(offset), (len(rows), 1)) + np.array(
            [values.get(axis + 'position', np.zeros(len(rows))) for axis in 'XYZ']).T
        order = ''.join(name[0] for name in of if name.endswith('rotation'))  # upper case: about the axes that turn along
        turn = Rotation.from_euler(order, np.array([values[axis + 'rotation'] for axis in order]).T, degrees=True) if order else (
            Rotation.from_quat(np.tile([0, 0, 0, 1], (len(rows), 1))))
        places.append(place if parent is None else places[parent] + turns[parent].apply(place))
        turns.append(turn if parent is None else turns[parent] * turn)
    return names, places, turns, seconds
