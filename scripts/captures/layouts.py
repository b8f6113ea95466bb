"""The layouts of published capture sets, each read into captures: joints of hands and the pose of an object over time.

Where a set holds MANO's parameters, `mano(side)` gives the model. Poses are in the set's world, with z up unless said.
"""
import collections
import csv
import glob
import json
import os
import re

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from .files import CaptureError, read_bvh, read_npy, read_npz, read_pickle
from .umetrack import UmeTrack

# `hands`: {side: (frames, 21, 3)} in MANO's order from palm to tip, nan where not seen; `poses`: (frames, 4, 4) of the object;
# `mesh`: its file, `scale` its unit in metres; `ranges`: [first, end) frames that may be cut, or None for all. An object on a
# hinge has `angles` [rad], 0 where it is closed, and `mesh` is (top, bottom): the top turns about -z of the bottom, whose pose is given.
Capture = collections.namedtuple('Capture', 'name person thing times hands poses mesh scale ranges angles')
Capture.__new__.__defaults__ = (1.0, None, None)
SIDES = ('right', 'left')
TIPS_LAST = [0, 13, 14, 15, 16, 1, 2, 3, 17, 4, 5, 6, 18, 10, 11, 12, 19, 7, 8, 9, 20]  # of MANO's joints, then the tips from the thumb on


def _poses(rotations, places):
    found = np.tile(np.eye(4), (len(places), 1, 1))
    found[:, :3, :3], found[:, :3, 3] = rotations.as_matrix(), places
    return found


def _folders(root, pattern, of_what):
    found = sorted(glob.glob(os.path.join(glob.escape(root), pattern), recursive=True))
    if not found:
        raise CaptureError("%s: no %s; allowed: %s" % (root, pattern, of_what))
    return found


def arctic(root, mano, models):
    """raw_seqs/PERSON/NAME.object.npy and .mano.npy, meta/object_vtemplates/OBJECT/mesh.obj; millimetres; 30 Hz. The object is
    rigid where its joint is closed."""
    for path in _folders(root, '**/*.object.npy', 'the folder that raw_seqs is in'):
        moved, fitted = np.asarray(read_npy(path), float), read_npy(path.replace('.object.npy', '.mano.npy'))
        name = os.path.basename(path)[:-len('.object.npy')]
        hands = {}
        for side in SIDES:
            of = fitted[side]
            model = mano(side)
            hands[side] = model.joints(Rotation.from_rotvec(of['rot']), np.asarray(of['pose']) + model.mean, of['trans'],
                                       np.ravel(of['shape']))
        closed = np.abs(moved[:, 0]) < 0.1
        yield Capture('%s_%s' % (os.path.basename(os.path.dirname(path)), name), os.path.basename(os.path.dirname(path)),
                      name.split('_')[0], np.arange(len(moved)) / 30.0, hands,
                      _poses(Rotation.from_rotvec(moved[:, 1:4]), moved[:, 4:7] / 1000.0),
                      os.path.join(models or os.path.join(root, 'meta', 'object_vtemplates'), name.split('_')[0], 'mesh.obj'),
                      0.001, _runs(closed))


def _hinged(root, name, person, joints, rotations, places, angles):
    """A capture of ARCTIC's objects of two parts, by the meshes that ArtiGrasp and DexMachina have."""
    thing = name.split('_')[0]
    meshes = tuple(os.path.join(root, thing, part + '_watertight_tiny.obj') for part in ('top', 'bottom'))
    return Capture('%s_%s' % (person, name), person, thing, np.arange(len(places)) / 30.0,
                   {side: np.asarray(of, float)[:, TIPS_LAST] for side, of in joints.items()}, _poses(rotations, places), meshes,
                   angles=np.ravel(angles))


def artigrasp(root, mano, models):
    """ARCTIC as ArtiGrasp has it: arctic/OBJECT/sN/NAME.object.npy (millimetres), mano_double/sN/NAME.mano.npy (`trans`) and
    mano_double/ee/sN/NAME_{r,l}.npy, the joints in the world; 30 Hz. Its first frames are blank: the wrist is not where it should be."""
    for path in _folders(root, 'arctic/*/s*/*.object.npy', 'the folder that arctic and mano_double are in'):
        person, name = path.split(os.sep)[-2], os.path.basename(path)[:-len('.object.npy')]
        files = {side: os.path.join(root, 'mano_double', 'ee', person, '%s_%s.npy' % (name, side[0])) for side in SIDES}
        fitted = os.path.join(root, 'mano_double', person, name + '.mano.npy')
        if not all(map(os.path.exists, (fitted, *files.values()))):
            continue  # a stand-in of s5, by a network
        moved, data, joints = np.asarray(read_npy(path), float), read_npy(fitted), {}
        for side, file in files.items():
            joints[side] = np.asarray(read_npy(file), float)[:len(moved)]
            beyond = joints[side][:, 0] - np.asarray(data[side]['trans'], float)[:len(joints[side])]
            joints[side][np.abs(beyond - np.median(beyond, axis=0)).max(axis=1) > 1e-3] = np.nan
        count = min(len(moved), *map(len, joints.values()))
        yield _hinged(models or os.path.join(root, 'arctic'), name, person, {side: of[:count] for side, of in joints.items()},
                      Rotation.from_rotvec(moved[:count, 1:4]), moved[:count, 4:7] / 1000.0, moved[:count, 0])


def dexmachina(root, mano, models):
    """ARCTIC as DexMachina has it: processed/sNN/NAME.npy (`joints.right`, `.left`, `obj_trans`, `obj_quat` with w first, `obj_arti`);
    30 Hz."""
    for path in _folders(root, 'processed/s*/*.npy', 'the folder that processed and the objects are in'):
        data = read_npy(path)
        of, world = data['params'], data['world_coord']
        yield _hinged(models or root, os.path.basename(path)[:-4], path.split(os.sep)[-2],
                      {side: world['joints.' + side] for side in SIDES},
                      Rotation.from_quat(np.asarray(of['obj_quat'])[:, [1, 2, 3, 0]]), np.asarray(of['obj_trans'], float), of['obj_arti'])


def _runs(flags):
    ends = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(flags, int), [0]])))
    return list(zip(ends[::2], ends[1::2]))


def dexycb(root, mano, models):
    """DATE-subject-NN/TIME/meta.yml and SERIAL/labels_NNNNNN.npz (joint_3d, pose_y in a camera's frame); the world is the tag on
    the table, by calibration/extrinsics_ID/extrinsics.yml; 30 Hz."""
    for path in _folders(root, '*-subject-*/*/meta.yml', 'the folder that holds the subjects and calibration'):
        folder = os.path.dirname(path)
        with open(path, encoding='utf-8') as file:
            meta = yaml.safe_load(file)
        with open(os.path.join(root, 'calibration', 'extrinsics_%s' % meta['extrinsics'], 'extrinsics.yml'), encoding='utf-8') as file:
            placed = yaml.safe_load(file)['extrinsics']
        serial = next(name for name in sorted(os.listdir(folder)) if name in placed)
        to_world = np.linalg.inv(_matrix(placed['apriltag'])) @ _matrix(placed[serial])
        labels = [read_npz(label) for label in _folders(os.path.join(folder, serial), 'labels_*.npz', 'labels of each frame')]
        joints = np.array([label['joint_3d'].reshape(21, 3) for label in labels], float)
        joints[(joints == -1).all(axis=(1, 2))] = np.nan
        joints = joints @ to_world[:3, :3].T + to_world[:3, 3]
        held = int(meta['ycb_grasp_ind'])
        poses = np.tile(np.eye(4), (len(labels), 1, 1))
        poses[:, :3] = [label['pose_y'][held] for label in labels]
        number = int(meta['ycb_ids'][held])
        found = sorted(glob.glob(os.path.join(models or os.path.join(root, 'models'), '*')))
        if number > len(found):
            raise CaptureError('%s: object %d of models/, which has %d; allowed: the 21 models of YCB' % (path, number, len(found)))
        thing = os.path.basename(found[number - 1])
        yield Capture(re.sub(r'\W', '_', os.path.relpath(folder, root)), folder.split(os.sep)[-2], thing, np.arange(len(labels)) / 30.0,
                      {meta['mano_sides'][0]: joints}, to_world @ poses, os.path.join(found[number - 1], 'textured_simple.obj'))


def _matrix(numbers):
    return np.vstack([np.reshape(numbers, (3, 4)), [0, 0, 0, 1]])


def hocap(root, mano, models):
    """subject_N/DATE_TIME/meta.yaml (or .json), poses_m.npy (2, frames, 51), poses_o.npy (objects, frames, 7; quaternion first,
    x y z w); calibration/mano/SUBJECT/mano.yaml, models/OBJECT/cleaned_mesh_10000.obj; 30 Hz."""
    for path in _folders(root, 'subject_*/*/meta.*', 'the folder that holds the subjects, calibration and models'):
        folder, meta = os.path.dirname(path), _yaml(path)
        person = folder.split(os.sep)[-2]
        calibrated = os.path.join(root, 'calibration', 'mano', meta.get('subject_id', person), 'mano' + os.path.splitext(path)[1])
        betas, of_hands, of_things = _yaml(calibrated)['betas'], read_npy(os.path.join(folder, 'poses_m.npy')), read_npy(
            os.path.join(folder, 'poses_o.npy'))
        hands = {}
        for side, rows in zip(SIDES, of_hands):
            if side not in meta['mano_sides']:
                continue
            seen = ~(rows == -1).all(axis=1)
            model, hands[side] = mano(side), np.full((len(rows), 21, 3), np.nan)
            hands[side][seen] = model.joints(Rotation.from_rotvec(rows[seen, :3]), model.pose(rows[seen, 3:48], mean=False),
                                             rows[seen, 48:], betas)
        for thing, rows in zip(meta['object_ids'], of_things):
            yield Capture('%s_%s_%s' % (person, os.path.basename(folder), thing), person, thing, np.arange(len(rows)) / 30.0, hands,
                          _poses(Rotation.from_quat(rows[:, :4]), rows[:, 4:]),
                          os.path.join(models or os.path.join(root, 'models'), thing, 'cleaned_mesh_10000.obj'))


def _yaml(path):
    with open(path, encoding='utf-8') as file:
        return yaml.safe_load(file)  # JSON is YAML


def hot3d(root, mano, models):
    """SEQUENCE/dynamic_objects.csv and umetrack_hand_pose_trajectory.jsonl (wrist_xform, joint_angles; 0: left, 1: right) with
    umetrack_hand_user_profile.json, or mano_hand_pose_trajectory.jsonl (pose of 15 components, betas); MODELS/UID.glb."""
    for path in _folders(root, '*/dynamic_objects.csv', 'the folder of the sequences'):
        folder = os.path.dirname(path)
        profile = os.path.join(folder, 'umetrack_hand_user_profile.json')
        kind = 'umetrack' if os.path.exists(profile) else 'mano'
        with open(os.path.join(folder, kind + '_hand_pose_trajectory.jsonl'), encoding='utf-8') as file:
            lines = [json.loads(line) for line in file if line.strip()]
        stamps = [line['timestamp_ns'] for line in lines]
        of_hand, hands = [line['hand_poses'] for line in lines], {}
        for side, key in zip(SIDES, '10'):
            seen = [i for i, hand in enumerate(of_hand) if key in hand]
            if not seen:
                continue
            some = [of_hand[i][key] for i in seen]
            turn = Rotation.from_quat(np.array([hand['wrist_xform']['q_wxyz'] for hand in some], float)[:, [1, 2, 3, 0]])
            places, hands[side] = [hand['wrist_xform']['t_xyz'] for hand in some], np.full((len(lines), 21, 3), np.nan)
            if kind == 'umetrack':
                hands[side][seen] = UmeTrack(profile).joints(side, turn, [hand['joint_angles'] for hand in some], places)
            else:
                model = mano(side)
                hands[side][seen] = model.joints(turn, model.pose([hand['pose'] for hand in some], mean=True), places,
                                                 next(hand['betas'] for hand in some if 'betas' in hand))
        with open(path, newline='', encoding='utf-8') as file:
            rows = list(csv.DictReader(file))
        for thing in sorted({row['object_uid'] for row in rows}):
            at = {int(row['timestamp[ns]']): [float(row[key]) for key in (
                'q_wo_x', 'q_wo_y', 'q_wo_z', 'q_wo_w', 't_wo_x[m]', 't_wo_y[m]', 't_wo_z[m]')] for row in rows if row['object_uid'] == thing}
            both = [i for i, stamp in enumerate(stamps) if stamp in at]
            values = np.array([at[stamps[i]] for i in both])
            name = os.path.basename(folder)
            yield Capture('%s_%s' % (name, thing), name.split('_')[0], thing, (np.array(stamps, float)[both] - stamps[both[0]]) / 1e9,
                          {side: joints[both] for side, joints in hands.items()}, _poses(Rotation.from_quat(values[:, :4]), values[:, 4:]),
                          os.path.join(models or os.path.join(root, 'object_models'), thing + '.glb'))


def oakink2(root, mano, models):
    """anno_preview/SEQUENCE.pkl: raw_mano by frame (quaternions w first), obj_transf; object_repair/align_ds/OBJECT/*; 120 Hz."""
    for path in _folders(root, 'anno_preview/*.pkl', 'the folder that holds anno_preview'):
        data, hands = read_pickle(path), {}
        frames = sorted(data['mocap_frame_id_list'])
        for side, key in zip(SIDES, ('rh', 'lh')):
            turns = np.array([np.reshape(data['raw_mano'][f][key + '__pose_coeffs'], (16, 4)) for f in frames], float)[:, :, [1, 2, 3, 0]]
            hands[side] = mano(side).joints(
                Rotation.from_quat(turns[:, 0]), Rotation.from_quat(turns[:, 1:].reshape(-1, 4)),
                np.array([np.ravel(data['raw_mano'][f][key + '__tsl']) for f in frames], float),
                np.ravel(data['raw_mano'][frames[0]][key + '__betas']), wrist_at_translation=True)
        name = os.path.splitext(os.path.basename(path))[0]
        for thing in data['obj_list']:
            folder = os.path.join(models or os.path.join(root, 'object_repair', 'align_ds'), thing)
            mesh = [file for file in sorted(glob.glob(os.path.join(folder, '*'))) if file.endswith(('.obj', '.ply'))]
            yield Capture('%s_%s' % (name, thing), name.split('__')[1] if '__' in name else name, thing,
                          np.array(frames, float) / 120.0 - frames[0] / 120.0, hands,
                          np.array([data['obj_transf'][thing][f] for f in frames], float), mesh[0] if mesh else folder + '/*.obj')


def taco(root, mano, models):
    """Hand_Poses/TRIPLET/SEQUENCE/{right,left}_hand.pkl and _hand_shape.pkl, Object_Poses/TRIPLET/SEQUENCE/{tool,target}_NUMBER.npy,
    Object_Models/NUMBER_cm.obj (centimetres); 30 Hz. Persons are not named."""
    for folder in _folders(root, 'Hand_Poses/*/*', 'the folder that holds Hand_Poses'):
        hands = {}
        for side in SIDES:
            data = read_pickle(os.path.join(folder, side + '_hand.pkl'))
            rows = [data[key] for key in sorted(data)]
            pose = np.array([np.ravel(row['hand_pose']) for row in rows], float)
            hands[side] = mano(side).joints(
                Rotation.from_rotvec(pose[:, :3]), pose[:, 3:48], np.array([np.ravel(row['hand_trans']) for row in rows], float),
                np.ravel(read_pickle(os.path.join(folder, side + '_hand_shape.pkl'))['hand_shape']), wrist_at_translation=True)
        triplet, sequence = folder.split(os.sep)[-2:]
        for path in _folders(os.path.join(root, 'Object_Poses', glob.escape(triplet), sequence), '*.npy', 'poses of tool and target'):
            number, poses = re.sub(r'.*_|\.npy$', '', os.path.basename(path)), np.asarray(read_npy(path), float)
            count = min(len(poses), len(hands['right']))
            yield Capture(re.sub(r'\W+', '_', '%s_%s_%s' % (triplet, sequence, number)), '', number, np.arange(count) / 30.0,
                          {side: joints[:count] for side, joints in hands.items()}, poses[:count],
                          os.path.join(models or os.path.join(root, 'Object_Models'), number + '_cm.obj'), 0.01)


def grab(root, mano, models):
    """grab/sN/NAME.npz: rhand, lhand (24 components, about the flat hand) and object (axis-angle of the transposed rotation);
    vtemp and object_mesh are paths below ROOT; 120 Hz."""
    for path in _folders(root, 'grab/s*/*.npz', 'the folder that holds grab and tools'):
        data, hands = read_npz(path), {}
        for side, key in zip(SIDES, ('rhand', 'lhand')):
            of, model = data[key]['params'], mano(side)
            template = _points_of(root, data[key]['vtemp'])
            hands[side] = model.joints(Rotation.from_rotvec(of['global_orient']), model.pose(of['hand_pose'], mean=False), of['transl'],
                                       template=template)
        of, rate = data['object']['params'], float(data.get('framerate', 120.0))
        person, name = path.split(os.sep)[-2], os.path.basename(path)[:-4]
        yield Capture('%s_%s' % (person, name), person, str(data['obj_name']), np.arange(len(of['transl'])) / rate, hands,
                      _poses(Rotation.from_rotvec(of['global_orient']).inv(), of['transl']),
                      os.path.join(models or root, str(data['object']['object_mesh'])))


# Length of the last bone with the skin at its end, against the bone before, from the thumb to the little finger: means of Buryanov
# & Kotiuk 2010, Tables 1 and 2.
LAST_BONES = [0.81, 0.88, 0.81, 0.83, 1.09]


def manipnet(root, mano, models):
    """SEQUENCE/OBJECT.bvh, leftHand.bvh and rightHand.bvh, in decimetres with y up; OBJECT.obj in MODELS or below ObjectModel; 120 Hz.
    No file has the tips: they are where the last bones end on average. One person."""
    for path in _folders(root, '*/rightHand.bvh', 'the folder of the sequences'):
        folder, hands = os.path.dirname(path), {}
        if not os.path.exists(os.path.join(folder, 'leftHand.bvh')):
            continue
        for side in SIDES:
            names, places, turns, seconds = read_bvh(os.path.join(folder, side + 'Hand.bvh'))
            joints = [places[0]]
            for finger, longer in zip(('THUMB', 'INDEX', 'MIDDLE', 'RING', 'PINKY'), LAST_BONES):
                *_, base, middle, last = (i for i, name in enumerate(names) if name.startswith(finger))  # the thumb has a fourth, first
                before = turns[middle].inv().apply(places[last] - places[middle])[0]  # a straight finger goes on along it
                joints += [places[base], places[middle], places[last], places[last] + turns[last].apply(longer * before)]
            hands[side] = 0.1 * np.stack(joints, axis=1)
        for file in sorted(glob.glob(os.path.join(glob.escape(folder), '*.bvh'))):
            thing = os.path.basename(file)[:-4]
            if thing.endswith('Hand'):
                continue
            _, places, turns, seconds = read_bvh(file)
            folder_of_meshes = glob.escape(models or os.path.join(root, 'ObjectModel'))
            meshes = sorted(glob.glob(os.path.join(folder_of_meshes, '**', thing + '.obj'), recursive=True))
            count = min(len(places[0]), *map(len, hands.values()))
            yield Capture(os.path.basename(folder) + '_' + thing, 'one', thing, seconds * np.arange(count),
                          {side: joints[:count] for side, joints in hands.items()}, _poses(turns[0][:count], 0.1 * places[0][:count]),
                          meshes[0] if meshes else thing + '.obj', 0.1)


def _points_of(root, path):
    from .files import read_points
    return read_points(os.path.join(root, str(path)))


# A person's 21 joints by the names that trackers give them: MANO's and MediaPipe's, OpenXR's, Leap's in our own schema.
FINGERS = ('thumb', 'index', 'middle', 'ring', 'little')
NAMES = [['wrist', 'wrist_root']] + [
    [name.replace('F', finger) for finger in ((finger, 'pinky') if finger == 'little' else (finger,)) for name in names]
    for finger in FINGERS for names in (
        (['F_cmc', 'F_metacarpal', 'F_j1'], ['F_mcp', 'F_proximal', 'F_j2'], ['F_ip', 'F_distal', 'F_j3'], ['F_tip', 'F_j4'])
        if finger == 'thumb' else
        (['F_mcp', 'F_proximal', 'F_j1'], ['F_pip', 'F_intermediate', 'F_j2'], ['F_dip', 'F_distal', 'F_j3'], ['F_tip', 'F_j4']))]


def table(root, mano, models):
    """NAME_hands.csv (time_s, side, JOINT_x, JOINT_y, JOINT_z of any joints named as MANO, MediaPipe, OpenXR or Leap name them; a
    marker set has what it has) and NAME_object.csv (time_s, px, py, pz, qx, qy, qz, qw), NAME.obj, .ply or .glb."""
    for path in _folders(root, '*_hands.csv', table.__doc__):
        start = path[:-len('_hands.csv')]
        with open(path, newline='', encoding='utf-8') as file:
            rows = list(csv.DictReader(file))
        found = [next((name for name in names if rows and name + '_x' in rows[0]), None) for names in NAMES]
        if not any(found[4::4]):
            raise CaptureError('%s: no column of a fingertip; allowed: %s' % (path, ', '.join(name + '_x' for name in NAMES[8])))
        with open(start + '_object.csv', newline='', encoding='utf-8') as file:
            placed = np.array([[float(row[key]) for key in 'time_s px py pz qx qy qz qw'.split()] for row in csv.DictReader(file)])
        hands = {side: np.full((len(placed), 21, 3), np.nan) for side in {row['side'] for row in rows}}
        for row in rows:
            frame = int(np.argmin(np.abs(placed[:, 0] - float(row['time_s']))))
            for joint, name in enumerate(found):
                if name and row[name + '_x']:
                    hands[row['side']][frame, joint] = [float(row['%s_%s' % (name, axis)]) for axis in 'xyz']
        mesh = [start + ending for ending in ('.obj', '.ply', '.glb') if os.path.exists(start + ending)]
        name = os.path.basename(start)
        yield Capture(name, name.split('_')[0], name, placed[:, 0], hands, _poses(Rotation.from_quat(placed[:, 4:]), placed[:, 1:4]),
                      mesh[0] if mesh else start + '.obj')


LAYOUTS = {layout.__name__: layout for layout in (
    arctic, artigrasp, dexmachina, dexycb, grab, hocap, hot3d, manipnet, oakink2, table, taco)}
