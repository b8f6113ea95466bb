#!/usr/bin/env python3
"""Captures in the layouts of published sets, made up here, become windows with the hands and objects that are in them."""
import csv
import json
import os
import pickle
import shutil
import struct
import subprocess
import sys
import tempfile
import types
import unittest
import warnings
from collections import OrderedDict

import numpy as np
import yaml
from scipy import sparse
from scipy.spatial.transform import Rotation

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(PACKAGE, 'scripts'))
from captures.files import Arrays, CaptureError, read_pickle, read_points  # noqa: E402
from captures.layouts import TIPS_LAST  # noqa: E402
from captures.mano import Mano, ORDER, PARENTS  # noqa: E402
from captures.umetrack import UmeTrack  # noqa: E402

FRAMES, LIES = 90, 30  # of a capture; of these the object lies still
EDGE = 0.06            # of the cube [m]
RANDOM = np.random.RandomState(3)


class Ch:
    """Pickles as chumpy's arrays do."""
    __module__, __qualname__ = 'chumpy.ch', 'Ch'

    def __init__(self, values):
        self.x = values

    def __getstate__(self):
        return {'x': self.x}


class Tensor:
    """Pickles as torch's tensors do."""

    def __init__(self, values):
        self.values = np.ascontiguousarray(values, '<f4')

    def __reduce__(self):
        torch = sys.modules['torch._utils']
        stride = tuple(step // 4 for step in self.values.strides)
        return torch._rebuild_tensor_v2, (Storage(self.values), 0, self.values.shape, stride, False, OrderedDict())


class Storage:
    def __init__(self, values):
        self.values = values

    def __reduce__(self):
        stored = b''.join(pickle.dumps(part, 2) for part in (119547037146038801333356, 1001, {'little_endian': True}))

        class Pickler(pickle.Pickler):
            def persistent_id(self, value):
                return ('storage', sys.modules['torch'].FloatStorage, '7', 'cpu', count, None) if value is Storage else None
        import io
        count, stream = self.values.size, io.BytesIO()
        Pickler(stream, 2).dump(Storage)
        stored += stream.getvalue() + pickle.dumps(['7'], 2) + struct.pack('<q', count) + self.values.tobytes()
        return sys.modules['torch.storage']._load_from_bytes, (stored,)


def stand_in_modules():
    """chumpy and torch as far as a pickle names them; neither has to be installed."""
    for name in ('chumpy', 'chumpy.ch', 'torch', 'torch._utils', 'torch.storage'):
        sys.modules.setdefault(name, types.ModuleType(name))
    sys.modules['chumpy.ch'].Ch = Ch
    for module, name in (('torch._utils', '_rebuild_tensor_v2'), ('torch.storage', '_load_from_bytes')):
        def function(*_):
            raise AssertionError('is run by the importer')
        function.__module__, function.__qualname__, function.__name__ = module, name, name
        setattr(sys.modules[module], name, function)
    sys.modules['torch'].FloatStorage = type('FloatStorage', (), {'__module__': 'torch'})


def pickled(path, value):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'wb') as file:
        pickle.dump(value, file, 2)


def saved(path, **arrays):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    np.savez(path, **arrays)


def text(path, content):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w') as file:
        file.write(content)


def cube(scale=1.0):
    h = scale * EDGE / 2
    return np.array([[x, y, z] for x in (-h, h) for y in (-h, h) for z in (-h, h)])


FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))  # of the cube


def write_obj(path, scale=1.0, faces=()):
    text(path, ''.join('v %.6f %.6f %.6f\n' % tuple(v) for v in cube(scale)) +
         ''.join('f %s\n' % ' '.join(str(1 + corner) for corner in face) for face in faces))


@unittest.skipUnless(hasattr(Rotation, 'as_matrix'), 'scipy is older than 1.4')
class MadeUp(unittest.TestCase):
    def setUp(self):
        stand_in_modules()
        self.root = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.root)
        self.set, self.mano, self.output = (os.path.join(self.root, name) for name in ('set', 'mano', 'windows'))
        for side in ('RIGHT', 'LEFT'):
            bones = RANDOM.normal(size=(778, 3)) * 0.03
            pickled(os.path.join(self.mano, 'MANO_%s.pkl' % side), {
                'v_template': bones, 'shapedirs': Ch(RANDOM.normal(size=(778, 3, 10)) * 0.002),
                'J_regressor': sparse.csc_matrix((np.ones(16), (range(16), range(5, 165, 10))), (16, 778)),
                'hands_components': np.linalg.qr(RANDOM.normal(size=(45, 45)))[0], 'hands_mean': np.full(45, 0.1)})
        self.model = Mano(self.mano, 'right')
        # The cube lies, then goes up by 0.1 m and turns; the tip of the index goes with a corner of it.
        rise = np.clip((np.arange(FRAMES) - LIES) / (FRAMES - LIES), 0, 1)
        self.places = np.column_stack([0.2 + 0 * rise, 0.1 + 0 * rise, 0.03 + 0.1 * rise])
        self.turns = Rotation.from_rotvec(np.outer(rise, [0.2, 0.1, 0.4]))
        self.betas, self.turn = RANDOM.normal(size=10), Rotation.from_rotvec([0.3, -0.2, 0.5])
        self.touched = self.places + self.turns.apply([EDGE / 2, 0, 0])

    def translations(self, pose, **options):
        """That bring the tip of the index to where it touches."""
        tips = self.model.joints(Rotation.from_quat([self.turn.as_quat()] * FRAMES), np.tile(pose, (FRAMES, 1)), np.zeros((FRAMES, 3)),
                                 **options)[:, 8]
        return self.touched - tips

    def run_program(self, layout, *more):
        return subprocess.run([os.path.join(PACKAGE, 'scripts', 'import_captures'), layout, self.set, '--output', self.output,
                               '--mano', self.mano, *more], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)

    def check(self, layout, *more):
        """One window, in which the tip and the cube are where they were put, to the microns of the files."""
        done = self.run_program(layout, *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = self.rows('windows.csv')
        self.assertEqual(len(rows), 1, done.stdout + done.stderr)
        name = rows[0]['window']
        self.assertAlmostEqual(float(rows[0]['mass_kg']), 300 * EDGE ** 3, delta=1e-3)
        placed = self.rows(name + '_object.csv')
        first = FRAMES - len(placed)
        self.assertGreater(sum(row['free'] == '1' for row in placed), 27)
        self.assertEqual(placed[0]['free'], '0')
        for i, row in enumerate(placed):
            np.testing.assert_allclose([float(row[key]) for key in ('px', 'py', 'pz')], self.places[first + i], atol=2e-6)
            turn = Rotation.from_quat([float(row[key]) for key in ('qx', 'qy', 'qz', 'qw')])
            self.assertLess((turn * self.turns[first + i].inv()).magnitude(), 1e-5)
        hands = [row for row in self.rows(name + '.csv') if row['is_left'] == '0']
        self.assertEqual(len(hands), len(placed))
        for i, row in enumerate(hands):
            known = next(name for name in ('index_j3', 'index_j2', 'index_j1', 'wrist') if row[name + '_x'])
            before, tip = (np.array([float(row['%s_%s' % (name, axis)]) for axis in 'xyz']) for name in (known, 'index_j4'))
            to_tip = (tip - before) / np.linalg.norm(tip - before)
            x, y, z = tip + 0.008 * to_tip  # the skin, in the device's axes
            np.testing.assert_allclose([x, -z, y], self.touched[first + i], atol=5e-6)
        with open(os.path.join(self.output, name + '.urdf')) as file:
            self.assertRegex(file.read(), '<mesh filename="%s(_thing)?.obj"/>' % name)
        return rows[0]

    def rows(self, name):
        with open(os.path.join(self.output, name), newline='') as file:
            return list(csv.DictReader(file))


class Layouts(MadeUp):
    def test_arctic(self):
        pose = RANDOM.normal(size=45) * 0.2
        moved = np.column_stack([np.zeros(FRAMES), self.turns.as_rotvec(), 1000 * self.places])
        right = {'rot': np.tile(self.turn.as_rotvec(), (FRAMES, 1)), 'pose': np.tile(pose, (FRAMES, 1)), 'shape': self.betas,
                 'trans': self.translations(pose + self.model.mean, betas=self.betas)}
        folder = os.path.join(self.set, 'raw_seqs', 's01')
        os.makedirs(folder)
        np.save(os.path.join(folder, 'box_grab_01.object.npy'), moved)
        np.save(os.path.join(folder, 'box_grab_01.mano.npy'), {'right': right, 'left': dict(right, trans=right['trans'] + 1)})
        write_obj(os.path.join(self.set, 'meta', 'object_vtemplates', 'box', 'mesh.obj'), 1000)
        row = self.check('arctic')
        self.assertEqual((row['person'], row['object'], row['set']), ('s01', 'box', 'arctic'))

    def test_grab(self):
        template = np.asarray(self.model.template) * 1.1
        text(os.path.join(self.set, 'tools', 's1_rhand.ply'), 'ply\nformat ascii 1.0\nelement vertex 778\nproperty float x\nproperty '
             'float y\nproperty float z\nend_header\n' + ''.join('%.9g %.9g %.9g\n' % tuple(v) for v in template))
        parts = RANDOM.normal(size=24) * 0.2
        pose = parts @ self.model.components[:24]
        hand = {'vtemp': 'tools/s1_rhand.ply', 'params': {
            'global_orient': np.tile(self.turn.as_rotvec(), (FRAMES, 1)), 'hand_pose': np.tile(parts, (FRAMES, 1)),
            'transl': self.translations(pose, template=template)}}
        write_obj(os.path.join(self.set, 'tools', 'cube.obj'))
        saved(os.path.join(self.set, 'grab', 's1', 'cube_lift_1.npz'), obj_name='cube', framerate=30.0, rhand=hand,
              lhand=dict(hand, params=dict(hand['params'], transl=hand['params']['transl'] + 1)), object={
                  'object_mesh': 'tools/cube.obj', 'params': {'transl': self.places, 'global_orient': self.turns.inv().as_rotvec()}})
        self.assertEqual(self.check('grab')['person'], 's1')

    def test_hocap(self):
        parts = RANDOM.normal(size=45) * 0.2
        rows = np.column_stack([np.tile(self.turn.as_rotvec(), (FRAMES, 1)), np.tile(parts, (FRAMES, 1)),
                                self.translations(parts @ self.model.components, betas=self.betas)])
        folder = os.path.join(self.set, 'subject_1', '20231022_190534')
        text(os.path.join(folder, 'meta.yaml'), yaml.safe_dump({'object_ids': ['G01_1'], 'mano_sides': ['right'], 'subject_id': 'subject_1'}))
        text(os.path.join(self.set, 'calibration', 'mano', 'subject_1', 'mano.yaml'), yaml.safe_dump({'betas': self.betas.tolist()}))
        np.save(os.path.join(folder, 'poses_m.npy'), np.array([rows, np.full_like(rows, -1)]))
        np.save(os.path.join(folder, 'poses_o.npy'), np.column_stack([self.turns.as_quat(), self.places])[None])
        write_obj(os.path.join(self.set, 'models', 'G01_1', 'cleaned_mesh_10000.obj'))
        self.check('hocap')

    def test_hot3d(self):
        parts = RANDOM.normal(size=15) * 0.2
        pose = parts @ self.model.components[:15] + self.model.mean
        places, quaternion = self.translations(pose, betas=self.betas), self.turn.as_quat()[[3, 0, 1, 2]].tolist()
        folder = os.path.join(self.set, 'P0001_4bf4e21a')
        text(os.path.join(folder, 'mano_hand_pose_trajectory.jsonl'), ''.join(json.dumps({'timestamp_ns': i * 33333333, 'hand_poses': {
            '1': {'wrist_xform': {'q_wxyz': quaternion, 't_xyz': places[i].tolist()}, 'pose': parts.tolist(), 'betas': self.betas.tolist()}}})
            + '\n' for i in range(FRAMES)))
        text(os.path.join(folder, 'dynamic_objects.csv'), 'object_uid,timestamp[ns],t_wo_x[m],t_wo_y[m],t_wo_z[m],q_wo_w,q_wo_x,q_wo_y,q_wo_z\n'
             + ''.join('37787722328019,%d,%s\n' % (i * 33333333, ','.join('%.9f' % x for x in (*self.places[i], *self.turns[i].as_quat()[[3, 0, 1, 2]])))
                       for i in range(FRAMES)))
        self.write_glb(os.path.join(self.set, 'object_models', '37787722328019.glb'))
        self.check('hot3d')

    def umetrack(self, wrist, places, thumb=0.0):
        """A set of HOT3D with the angles of UmeTrack: of a left hand whose thumb alone is bent."""
        landmarks = np.zeros((21, 3))
        landmarks[[6, 7, 0]] = [[30, 20, 0], [60, 20, 0], [90, 20, 0]]  # the thumb's, along x
        landmarks[1] = [100, 0, 0]  # tip of the index
        rest = np.zeros((22, 3))
        rest[:4] = [[10, 20, 0], [20, 20, 0], [30, 20, 0], [60, 20, 0]]
        bones = np.ones((21, 3), int)
        bones[[6, 7, 0, 1]] = [[2, 2, 2], [3, 3, 3], [4, 4, 4], [7, 7, 7]]
        folder = os.path.join(self.set, 'P0001_4bf4e21a')
        text(os.path.join(folder, 'umetrack_hand_user_profile.json'), json.dumps({'hand_model': {
            'joint_rotation_axes': np.tile([0, 0, 1.0], (22, 1)).tolist(), 'joint_rest_positions': rest.tolist(),
            'landmark_rest_positions': landmarks.tolist(), 'landmark_rest_bone_indices': bones.tolist(),
            'landmark_rest_bone_weights': np.tile([1.0, 0, 0], (21, 1)).tolist()}}))
        angles = [0.0, 0.0, thumb] + 19 * [0.0]
        text(os.path.join(folder, 'umetrack_hand_pose_trajectory.jsonl'), ''.join(json.dumps({
            'timestamp_ns': i * 33333333, 'hand_poses': {key: {'wrist_xform': {
                'q_wxyz': wrist.as_quat()[[3, 0, 1, 2]].tolist(), 't_xyz': place.tolist()}, 'joint_angles': angles} for key in '01'}}) + '\n'
            for i, place in enumerate(places)))
        return folder

    def test_hot3d_by_umetrack_s_hand_without_mano(self):
        folder = self.umetrack(self.turn, self.touched - self.turn.apply([-0.1, 0, 0]))  # the profile's x is mirrored for a right hand
        text(os.path.join(folder, 'dynamic_objects.csv'), 'object_uid,timestamp[ns],t_wo_x[m],t_wo_y[m],t_wo_z[m],q_wo_w,q_wo_x,q_wo_y,q_wo_z\n'
             + ''.join('37787722328019,%d,%s\n' % (i * 33333333, ','.join('%.9f' % x for x in (*self.places[i], *self.turns[i].as_quat()[[3, 0, 1, 2]])))
                       for i in range(FRAMES)))
        self.write_glb(os.path.join(self.set, 'object_models', '37787722328019.glb'), 1000, [
            {'children': [1], 'scale': [0.001] * 3}, {'mesh': 0}])
        shutil.rmtree(self.mano)
        self.check('hot3d')

    def test_a_joint_of_umetrack_s_hand_turns_what_is_beyond_it(self):
        folder = self.umetrack(Rotation.identity(), np.zeros((1, 3)), np.pi / 2)
        hand = UmeTrack(os.path.join(folder, 'umetrack_hand_user_profile.json'))
        for side, sign in (('left', 1), ('right', -1)):
            thumb = hand.joints(side, Rotation.identity(1), [[0.0, 0.0, np.pi / 2] + 19 * [0.0]], np.zeros((1, 3)))[0, 1:5]
            np.testing.assert_allclose(thumb, np.array([[10, 20, 0], [30, 20, 0], [30, 50, 0], [30, 80, 0]]) * [sign, 1, 1] / 1000, atol=1e-12)

    def write_glb(self, path, scale=1, nodes=None):
        vertices = cube(scale).astype('<f4').tobytes()
        scene = {'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}], 'accessors': [{'bufferView': 0, 'count': 8}],
                 'bufferViews': [{'byteLength': len(vertices)}]}
        scene = json.dumps(dict(scene, nodes=nodes) if nodes else scene).encode()
        scene += b' ' * (-len(scene) % 4)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'wb') as file:
            file.write(b'glTF' + struct.pack('<IIII', 2, 28 + len(scene) + len(vertices), len(scene), 0x4E4F534A) + scene +
                       struct.pack('<II', len(vertices), 0x004E4942) + vertices)

    def test_arctic_s_objects_of_two_parts_as_others_have_them(self):
        """Both parts are the same cube, closed. ArtiGrasp's first frame is blank."""
        joints = np.empty((FRAMES, 21, 3))
        joints[:, TIPS_LAST] = self.joints()
        turned = np.column_stack([np.full(FRAMES, 0.01), self.turns.as_rotvec(), 1000 * self.places])
        for part in ('top', 'bottom'):
            for folder in ('', 'arctic'):
                write_obj(os.path.join(self.set, folder, 'box', part + '_watertight_tiny.obj'), 1.0, FACES)
        text(os.path.join(self.set, 'arctic', 'box', 'box.urdf'), '<robot name="box">' + ''.join(
            '<link name="%s"><inertial><mass value="%g"/></inertial></link>' % (part, 300 * EDGE ** 3 / 2) for part in ('top', 'bottom')) + '</robot>')
        shutil.copy(os.path.join(self.set, 'arctic', 'box', 'box.urdf'), os.path.join(self.set, 'box', 'box.urdf'))
        folder = os.path.join(self.set, 'arctic', 'box', 's1')
        os.makedirs(folder)
        np.save(os.path.join(folder, 'box_use_01.object.npy'), turned)
        hands = os.path.join(self.set, 'mano_double')
        for name in ('s1', 'ee/s1'):
            os.makedirs(os.path.join(hands, name))
        of_hand = {'trans': joints[:, 0] - [0.09, 0.006, 0.006]}
        np.save(os.path.join(hands, 's1', 'box_use_01.mano.npy'), {'right': of_hand, 'left': of_hand})
        blank = joints.copy()
        blank[0] = joints[0] - joints[0, 0]
        for side in 'rl':
            np.save(os.path.join(hands, 'ee', 's1', 'box_use_01_%s.npy' % side), blank)
        row = self.check('artigrasp')
        self.assertEqual((row['person'], row['object']), ('s1', 'box'))
        os.makedirs(os.path.join(self.set, 'processed', 's01'))
        np.save(os.path.join(self.set, 'processed', 's01', 'box_use_01.npy'), {
            'world_coord': {'joints.right': joints, 'joints.left': joints}, 'params': {
                'obj_trans': self.places, 'obj_quat': self.turns.as_quat()[:, [3, 0, 1, 2]], 'obj_arti': turned[:, :1]}})
        self.check('dexmachina')
        row = self.check('dexmachina', '--articulated')
        with open(os.path.join(self.output, row['window'] + '.urdf')) as file:
            self.assertIn('<axis xyz="0 0 -1"/>', file.read())
        self.assertAlmostEqual(float(self.rows(row['window'] + '_object.csv')[0]['angle']), 0.01, delta=1e-9)

    def test_a_hull_that_bridges_a_gap_is_left_out(self):
        self.write_table({0: 'wrist', 7: 'index_dip', 8: 'index_tip', 6: 'index_pip', 5: 'index_mcp', 4: 'thumb_tip'})
        write_obj(os.path.join(self.set, 'P1.obj'), 1.0, FACES)
        self.check('table')
        write_obj(os.path.join(self.set, 'P1.obj'), 1.0, FACES[:2])  # two plates, 60 mm apart
        self.assertIn('the hull does not stand for P1', self.run_program('table').stderr)

    def test_manipnet(self):
        """Hands of a wrist and straight fingers of 0.4, 0.3 and 0.2 dm; the tips are where bones end on average."""
        bones = ''.join('JOINT %s_%s\n{\nOFFSET %g 0 0\nCHANNELS 3 Yrotation Xrotation Zrotation\n' % (finger, bone, length)
                        + ('End Site\n{\nOFFSET 0 0 0\n}\n}\n}\n}\n' if bone == 'DIP' else '')
                        for finger in ('THUMB', 'INDEX', 'MIDDLE', 'RING', 'PINKY') for bone, length in (('MCP', 0.4), ('PIP', 0.3), ('DIP', 0.2)))
        tip = np.array([0.09 + 0.02 * 0.88, 0, 0])  # of the index, from the wrist [m]
        wrists, up = self.touched - self.turn.apply(tip), Rotation.from_rotvec([-np.pi / 2, 0, 0])  # y up in the files

        def motion(path, name, joints, places, turns, more):
            with warnings.catch_warnings():
                warnings.simplefilter('ignore')  # gimbal lock: one of the angles is arbitrary, the rotation is not
                angles = (up * turns).as_euler('YXZ', degrees=True)
            rows = np.column_stack([10 * up.apply(places), angles, np.zeros((FRAMES, more))])
            text(path, 'HIERARCHY\nROOT %s\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation\n%s}\n'
                 'MOTION\nFrames: %d\nFrame Time: 0.0333333\n' % (name, joints, FRAMES) + ''.join(' '.join('%.9f' % x for x in row) + '\n' for row in rows))
        folder = os.path.join(self.set, 'cube1')
        for side, apart in (('right', 0.0), ('left', 1.0)):
            motion(os.path.join(folder, side + 'Hand.bvh'), 'WRIST', bones, wrists + apart, Rotation.from_quat([self.turn.as_quat()] * FRAMES), 45)
        motion(os.path.join(folder, 'cube.bvh'), 'cube', 'End Site\n{\nOFFSET 0 0 0\n}\n', self.places, self.turns, 0)
        write_obj(os.path.join(self.set, 'ObjectModel', 'Primitive', 'cube.obj'), 10, FACES)
        self.check('manipnet', '--up', 'y')

    def at_wrist(self, pose):
        """Translations where these are the wrist's place."""
        return self.translations(pose, betas=self.betas, wrist_at_translation=True)

    def test_oakink2_with_tensors_and_without_torch(self):
        pose = RANDOM.normal(size=45) * 0.2
        turns = np.vstack([self.turn.as_quat(), Rotation.from_rotvec(pose.reshape(15, 3)).as_quat()])[:, [3, 0, 1, 2]]
        places, frames = self.at_wrist(pose), [4 * i for i in range(FRAMES)]
        hand = {frame: {key + name: Tensor(value[None]) for key in ('rh__', 'lh__') for name, value in (
            ('pose_coeffs', turns), ('tsl', places[i] + (key == 'lh__')), ('betas', self.betas))} for i, frame in enumerate(frames)}
        poses = np.tile(np.eye(4), (FRAMES, 1, 1))
        poses[:, :3, :3], poses[:, :3, 3] = self.turns.as_matrix(), self.places
        pickled(os.path.join(self.set, 'anno_preview', 'scene_01__A001++seq.pkl'), {
            'mocap_frame_id_list': frames, 'obj_list': ['O02@0001'], 'raw_mano': hand,
            'obj_transf': {'O02@0001': dict(zip(frames, poses))}})
        write_obj(os.path.join(self.set, 'object_repair', 'align_ds', 'O02@0001', 'scan.obj'))
        self.check('oakink2')

    def test_taco_with_tensors_and_without_torch(self):
        pose = RANDOM.normal(size=45) * 0.2
        folder, places = os.path.join('(stir, spoon, bowl)', '20231105_019'), self.at_wrist(pose)
        for side in ('right', 'left'):
            pickled(os.path.join(self.set, 'Hand_Poses', folder, side + '_hand.pkl'), {'%05d' % (i + 1): {
                'hand_pose': Tensor(np.concatenate([self.turn.as_rotvec(), pose])), 'hand_trans': Tensor(places[i] + (side == 'left'))}
                for i in range(FRAMES)})
            pickled(os.path.join(self.set, 'Hand_Poses', folder, side + '_hand_shape.pkl'), {'hand_shape': self.betas.astype('f4')})
        poses = np.tile(np.eye(4), (FRAMES, 1, 1))
        poses[:, :3, :3], poses[:, :3, 3] = self.turns.as_matrix(), self.places
        os.makedirs(os.path.join(self.set, 'Object_Poses', folder))
        np.save(os.path.join(self.set, 'Object_Poses', folder, 'tool_017.npy'), poses)
        write_obj(os.path.join(self.set, 'Object_Models', '017_cm.obj'), 100)
        self.assertEqual(self.check('taco')['object'], '017')

    def joints(self):
        return self.model.joints(Rotation.from_quat([self.turn.as_quat()] * FRAMES), np.zeros((FRAMES, 45)),
                                 self.translations(np.zeros(45)))

    def test_dexycb_in_the_world_of_the_table_s_tag(self):
        camera = Rotation.from_rotvec([2.0, 0.3, -0.4])
        tag, serial = np.column_stack([camera.as_matrix(), [0.1, 0.2, 0.9]]), np.column_stack([np.eye(3), [0, 0, 0]])
        text(os.path.join(self.set, 'calibration', 'extrinsics_20200702', 'extrinsics.yml'), yaml.safe_dump({'master': '836212060125', 'extrinsics': {
            'apriltag': tag.ravel().tolist(), '836212060125': serial.ravel().tolist()}}))
        folder = os.path.join(self.set, '20200709-subject-01', '20200709_141754')
        text(os.path.join(folder, 'meta.yml'), yaml.safe_dump({'extrinsics': '20200702', 'mano_sides': ['right'], 'ycb_grasp_ind': 1,
                                                               'ycb_ids': [2, 1], 'num_frames': FRAMES}))
        joints = camera.apply(self.joints().reshape(-1, 3)).reshape(FRAMES, 21, 3) + tag[:, 3]
        for i in range(FRAMES):
            pose = np.column_stack([camera.as_matrix() @ self.turns[i].as_matrix(), camera.apply(self.places[i]) + tag[:, 3]])
            saved(os.path.join(folder, '836212060125', 'labels_%06d.npz' % i), joint_3d=joints[i][None], pose_y=np.array([pose * 0, pose]))
        for name in ('002_master_chef_can', '003_cracker_box'):
            write_obj(os.path.join(self.set, 'models', name, 'textured_simple.obj'))
        self.assertEqual(self.check('dexycb')['object'], '002_master_chef_can')

    def write_table(self, names):
        os.makedirs(self.set, exist_ok=True)
        with open(os.path.join(self.set, 'P1_hands.csv'), 'w', newline='') as file:
            writer = csv.writer(file)
            writer.writerow(['time_s', 'side'] + [name + '_' + axis for name in names.values() for axis in 'xyz'])
            for i, joints in enumerate(self.joints()):
                writer.writerow([i / 30, 'right'] + ['%.9f' % x for j in names for x in joints[j]])
        with open(os.path.join(self.set, 'P1_object.csv'), 'w', newline='') as file:
            writer = csv.writer(file)
            writer.writerow('time_s px py pz qx qy qz qw'.split())
            writer.writerows([i / 30, *self.places[i], *self.turns[i].as_quat()] for i in range(FRAMES))
        write_obj(os.path.join(self.set, 'P1.obj'))

    def test_a_table_of_openxr_joints_of_mediapipe_s_of_a_few_markers_and_of_tips_alone(self):
        openxr = {1 + 4 * f + b: '%s_%s' % (finger, bone) for f, finger in enumerate(('thumb', 'index', 'middle', 'ring', 'little'))
                  for b, bone in enumerate(('metacarpal', 'proximal', 'distal', 'tip') if f == 0 else ('proximal', 'intermediate', 'distal', 'tip'))}
        mediapipe = {1 + 4 * f + b: '%s_%s' % (finger, bone) for f, finger in enumerate(('thumb', 'index', 'middle', 'ring', 'pinky'))
                     for b, bone in enumerate(('cmc', 'mcp', 'ip', 'tip') if f == 0 else ('mcp', 'pip', 'dip', 'tip'))}
        markers = {j: mediapipe[j] for j in (4, 5, 6, 7, 8, 12)}
        tips = {j: mediapipe[j] for j in (4, 8, 12)}
        for names in ({0: 'wrist', **openxr}, {0: 'wrist', **mediapipe}, {0: 'wrist', **markers}, {0: 'wrist', **tips}):
            self.write_table(names)
            self.check('table')

    def test_another_axis_up(self):
        self.places, self.touched = (np.column_stack([p[:, 0], p[:, 2], -p[:, 1]]) for p in (self.places, self.touched))
        turn = Rotation.from_rotvec([-np.pi / 2, 0, 0])
        self.turns = turn * self.turns
        self.write_table({0: 'wrist', 7: 'index_dip', 8: 'index_tip', 6: 'index_pip', 5: 'index_mcp', 4: 'thumb_tip'})
        back = turn.inv()
        self.places, self.touched, self.turns = back.apply(self.places), back.apply(self.touched), back * self.turns
        self.check('table', '--up', 'y')

    def test_mistakes_are_one_line(self):
        os.makedirs(self.set)
        for layout, words in (('grab', 'no grab/s*/*.npz; allowed: the folder that holds grab and tools'), ('taco', 'no Hand_Poses')):
            done = self.run_program(layout)
            self.assertEqual((done.returncode, done.stderr.count('\n')), (1, 1))
            self.assertIn(words, done.stderr)
        self.test_hocap()
        shutil.rmtree(self.mano)
        self.assertIn('--mano: no ' + self.mano, self.run_program('hocap').stderr)


class Kinematics(MadeUp):
    """Not by the importer's own words: a bone that turns takes along what hangs on it, and nothing else."""

    def test_a_joint_turns_what_is_beyond_it(self):
        pose = np.zeros((1, 45))
        still = self.model.joints(Rotation.identity(1), pose, np.zeros((1, 3)))[0]
        pose[0, 3:6] = [0, 0, np.pi / 2]  # the index's middle joint, the second of MANO's
        bent = self.model.joints(Rotation.identity(1), pose, np.zeros((1, 3)))[0]
        moved = np.linalg.norm(bent - still, axis=1) > 1e-9
        self.assertEqual(list(np.flatnonzero(moved)), [7, 8])  # its last joint and tip
        x, y, z = still[8] - still[6]
        np.testing.assert_allclose(bent[8] - bent[6], [-y, x, z], atol=1e-12)
        self.assertEqual(sorted(ORDER), list(range(21)))
        self.assertEqual(PARENTS.count(0), 5)

    def test_a_pickle_that_would_run_something_is_refused(self):
        path = os.path.join(self.root, 'bad.pkl')
        pickled(path, {'a': print})
        with self.assertRaisesRegex(CaptureError, 'bad.pkl: holds a __builtin__.print; allowed: arrays'):
            read_pickle(path)
        self.assertTrue(issubclass(Arrays, pickle.Unpickler))

    def test_meshes_of_other_kinds_are_refused_by_name(self):
        with self.assertRaisesRegex(CaptureError, 'allowed: .obj, .ply, .glb'):
            read_points('thing.fbx')


if __name__ == '__main__':
    unittest.main()
