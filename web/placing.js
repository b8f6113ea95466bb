// The scene's pose in a headset's space: first in front of the person, then where it is placed.

import {Matrix4, Quaternion, Vector3} from './three/build/three.module.js';
import {INDEX_TIP, THUMB_TIP} from './hands.js';

const AHEAD = 0.45, BELOW = 0.45; // of the scene's origin, relative to the eyes [m]: at the height of a table
const PINCH = 0.02, APART = 0.1; // distance between the fingertips of a pinch, and between two pinches [m]
const HOLD = 1000; // duration of a pinch with both hands that grabs the scene [ms]
const MOVED = 0.002, TURNED = 0.003; // motion of an anchor that is reported to the nodes [m], [rad]
const PERIOD = 1000; // minimum interval of such reports [ms]
export const Z_UP = new Matrix4().makeRotationX(-Math.PI / 2); // rotation of world in a space with y up

const ONE = new Vector3(1, 1, 1), UP = new Vector3(0, 1, 0);

function upright(position, towardX, towardZ) {
  return new Matrix4().compose(position, new Quaternion().setFromAxisAngle(UP, Math.atan2(towardX, towardZ)), ONE);
}

function parts(matrix) {
  const position = new Vector3(), turn = new Quaternion(), scale = new Vector3();
  matrix.decompose(position, turn, scale);
  return {position, turn};
}

function inverse(matrix) {
  return new Matrix4().getInverse(matrix);
}

export class Placing {
  // tell(numbers): the pose of the headset's space in world, x y z qx qy qz qw.
  constructor(tell) {
    this.tell = tell;
    this.scene = null; // with y up, in the headset's space
    this.told = new Matrix4();
    this.toldAt = 0;
    this.anchor = null;
    this.wanted = true; // place it in front of the person at the next frame
    this.pinchedSince = null;
    this.grip = null; // while two hands hold the scene: its pose relative to them
  }

  // Pose of world in the headset's space.
  get world() {
    return this.scene.clone().multiply(Z_UP);
  }

  inFront() {
    this.wanted = true;
  }

  // Handles a reset of the space's origin. transform: the new origin in the old space, if the browser knows it.
  reset(transform) {
    if (this.anchor) return; // the anchor defines the scene's pose
    if (!transform || !this.scene) return this.inFront();
    this.scene = inverse(new Matrix4().fromArray(transform.matrix)).multiply(this.scene);
    this.report(performance.now());
  }

  update(frame, space, viewer, hands, touching, time) {
    if (this.wanted) {
      const m = viewer.transform.matrix, eyes = new Vector3(m[12], m[13], m[14]);
      const back = new Vector3(m[8], 0, m[10]).normalize();
      const place = eyes.addScaledVector(back, -AHEAD).addScaledVector(UP, -BELOW);
      this.put(upright(place, back.x, back.z), frame, space, time);
      this.wanted = false;
    }
    this.followAnchor(frame, space, time);
    this.followPinch(frame, space, hands, touching, time);
  }

  put(scene, frame, space, time) {
    this.scene = scene;
    this.report(time);
    if (this.anchor) this.anchor.delete();
    this.anchor = null;
    if (!frame.createAnchor || !(frame.session.enabledFeatures || []).includes('anchors')) return;
    const {position, turn} = parts(scene);
    const made = frame.createAnchor(new XRRigidTransform(position, turn), space);
    made.then((anchor) => { this.anchor = anchor; }, () => {}); // without an anchor the scene is fixed in the space
  }

  followAnchor(frame, space, time) {
    const pose = this.anchor && !this.grip && frame.getPose(this.anchor.anchorSpace, space);
    if (!pose) return;
    this.scene.fromArray(pose.transform.matrix);
    const now = parts(this.scene), then = parts(this.told);
    const moved = now.position.distanceTo(then.position) > MOVED || now.turn.angleTo(then.turn) > TURNED;
    if (moved && time - this.toldAt > PERIOD) this.report(time);
  }

  // The frame between two pinching hands; null unless both pinch.
  between(hands) {
    const middles = [0, 1].map((side) => {
      const thumb = new Vector3().fromArray(hands.point(side, THUMB_TIP));
      const index = new Vector3().fromArray(hands.point(side, INDEX_TIP));
      return thumb.distanceTo(index) < PINCH ? thumb.lerp(index, 0.5) : null;
    });
    if (!middles[0] || !middles[1]) return null;
    const across = middles[1].clone().sub(middles[0]);
    if (Math.hypot(across.x, across.z) < APART) return null;
    return upright(middles[0].lerp(middles[1], 0.5), -across.z, across.x);
  }

  // Two hands that pinch in the air grab the scene, and release it when they open.
  followPinch(frame, space, hands, touching, time) {
    const held = this.between(hands);
    if (!held) {
      if (this.grip) this.put(this.scene, frame, space, time);
      this.grip = null;
      this.pinchedSince = null;
    } else if (this.grip) {
      this.scene = held.multiply(this.grip);
    } else if (touching) {
      this.pinchedSince = null;
    } else {
      if (this.pinchedSince === null) this.pinchedSince = time;
      if (time - this.pinchedSince > HOLD) this.grip = inverse(held).multiply(this.scene);
    }
  }

  report(time) {
    this.told.copy(this.scene);
    this.toldAt = time;
    const {position, turn} = parts(inverse(this.world));
    this.tell([...position.toArray(), ...turn.toArray()]);
  }
}
