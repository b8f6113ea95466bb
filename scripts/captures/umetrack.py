"""Joints of the hand of UmeTrack (Han et al. 2022) from its angles, by the profile of a person that HOT3D gives with each sequence."""
import json

import numpy as np
from scipy.spatial.transform import Rotation

# Of the profile's landmarks (five tips, wrist, two of the thumb, three of each finger, palm), in the order from palm to tip. The
# thumb's base, its first joint, is none of them.
LANDMARKS = [5, None, 6, 7, 0, 8, 9, 10, 1, 11, 12, 13, 2, 14, 15, 16, 3, 17, 18, 19, 4]


class UmeTrack:
    def __init__(self, path):
        with open(path, encoding='utf-8') as file:
            model = json.load(file)['hand_model']
        self.axes, self.rest = np.array(model['joint_rotation_axes'])[:20], np.array(model['joint_rest_positions'])[:20] / 1000.0
        self.points = np.array(model['landmark_rest_positions']) / 1000.0
        self.bones, self.weights = np.array(model['landmark_rest_bone_indices'], int), np.array(model['landmark_rest_bone_weights'])

    def joints(self, side, turn, angles, places):
        """(T, 21, 3): `turn`, a Rotation for each frame; `angles` (T, 20 or more), four of each finger; `places` of the wrist."""
        frames, angles = len(places), np.asarray(angles, float)
        turns, shifts = [np.tile(np.eye(3), (frames, 1, 1))] * 2, [np.zeros((frames, 3))] * 2  # of the bones: root, wrist, three a finger
        for finger in range(5):
            turned, shifted = turns[0], shifts[0]
            for joint in range(4 * finger, 4 * finger + 4):
                local = Rotation.from_rotvec(np.outer(angles[:, joint], self.axes[joint])).as_matrix()
                shifted = shifted + np.einsum('fij,fj->fi', turned, self.rest[joint] - local @ self.rest[joint])
                turned = turned @ local
                if joint % 4:
                    turns.append(turned)
                    shifts.append(shifted)
        found = np.empty((frames, 21, 3))
        for place, landmark in enumerate(LANDMARKS):
            found[:, place] = self.rest[0] if landmark is None else sum(
                weight * (turns[bone] @ self.points[landmark] + shifts[bone])
                for bone, weight in zip(self.bones[landmark], self.weights[landmark]))
        if side == 'right':  # the profile is of a left hand
            found[:, :, 0] *= -1
        return np.einsum('fij,fkj->fki', turn.as_matrix(), found) + np.asarray(places, float)[:, None]
