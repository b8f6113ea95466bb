"""Joints of MANO's hand model from its parameters (Romero, Tzionas & Black 2017). The model's files are its authors': they are
given as a folder with MANO_RIGHT.pkl and MANO_LEFT.pkl, and nothing of them is shipped."""
import os

import numpy as np
from scipy.spatial.transform import Rotation

from .files import CaptureError, read_pickle

PARENTS = [-1, 0, 1, 2, 0, 4, 5, 0, 7, 8, 0, 10, 11, 0, 13, 14]  # wrist; index, middle, little, ring, thumb
TIPS = {3: 317, 6: 444, 9: 673, 12: 556, 15: 745}  # last joint of a finger: the vertex of its tip
# In the order wrist, thumb, index, middle, ring, little, from palm to tip; 16 on: the tips in the order of TIPS.
ORDER = [0, 13, 14, 15, 20, 1, 2, 3, 16, 4, 5, 6, 17, 10, 11, 12, 19, 7, 8, 9, 18]


class Mano:
    def __init__(self, folder, side):
        if folder is None:
            raise CaptureError('this layout holds parameters of MANO: give its models with --mano FOLDER (mano.is.tue.mpg.de)')
        path = os.path.join(folder, 'MANO_%s.pkl' % side.upper())
        if not os.path.exists(path):
            raise CaptureError('--mano: no %s; allowed: the folder of MANO_RIGHT.pkl and MANO_LEFT.pkl' % path)
        model = {key: getattr(value, 'values', value) for key, value in read_pickle(path).items()}
        self.template, self.shapes, self.regressor, self.components, self.mean = (np.asarray(model[key], float) for key in (
            'v_template', 'shapedirs', 'J_regressor', 'hands_components', 'hands_mean'))
        if side == 'left' and os.path.exists(path.replace('LEFT', 'RIGHT')):
            right = read_pickle(path.replace('LEFT', 'RIGHT'))['shapedirs']
            if np.abs(self.shapes[:, 0] - np.asarray(getattr(right, 'values', right))[:, 0]).sum() < 1:
                self.shapes = self.shapes * np.array([-1, 1, 1])[None, :, None]  # a fault of the released left model

    def pose(self, coefficients, mean):
        """Axis-angles of the 15 joints (T, 45) from principal components; `mean`: the coefficients are from the mean pose."""
        return np.asarray(coefficients, float) @ self.components[:np.shape(coefficients)[1]] + (self.mean if mean else 0.0)

    def joints(self, turn, pose, translation, betas=None, template=None, wrist_at_translation=False):
        """(T, 21, 3): `turn`, a Rotation for each frame; `pose`, axis-angles (T, 45) or a Rotation of T * 15."""
        vertices = self.template if template is None else template
        if betas is not None:
            vertices = vertices + self.shapes[:, :, :len(betas)] @ np.asarray(betas, float)
        rest = self.regressor @ vertices
        turns = pose if isinstance(pose, Rotation) else Rotation.from_rotvec(np.asarray(pose, float).reshape(-1, 3))
        frames = len(translation)
        local = turns.as_matrix().reshape(frames, 15, 3, 3)
        rotations, places = [turn.as_matrix()], [np.tile(rest[0], (frames, 1))]
        for joint in range(1, 16):
            parent = PARENTS[joint]
            rotations.append(rotations[parent] @ local[:, joint - 1])
            places.append(places[parent] + rotations[parent] @ (rest[joint] - rest[parent]))
        for joint, vertex in TIPS.items():  # a tip's skin goes with the last bone alone
            places.append(places[joint] + rotations[joint] @ (vertices[vertex] - rest[joint]))
        found = np.stack(places, axis=1)[:, ORDER]
        return found + (np.asarray(translation, float) - (rest[0] if wrist_at_translation else 0.0))[:, None, :]
