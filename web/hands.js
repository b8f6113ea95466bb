// Reads the hands of a WebXR frame.

const FINGERS = ['index-finger', 'middle-finger', 'ring-finger', 'pinky-finger'];
const BONES = ['metacarpal', 'phalanx-proximal', 'phalanx-intermediate', 'phalanx-distal', 'tip'];
const THUMB = BONES.filter((bone) => bone !== 'phalanx-intermediate').map((bone) => `thumb-${bone}`);
export const JOINTS = ['wrist', ...THUMB, ...FINGERS.flatMap((finger) => BONES.map((bone) => `${finger}-${bone}`))];
export const THUMB_TIP = JOINTS.indexOf('thumb-tip'), INDEX_TIP = JOINTS.indexOf('index-finger-tip');

const SIDES = ['left', 'right'];
const TIME_BYTES = 8, COUNT = JOINTS.length * SIDES.length, NUMBERS_BYTES = 16 * COUNT;
const NOT_TRACKED = 0, INFERRED = 1, TRACKED = 2;

export class Hands {
  constructor() {
    // As scripts/web/messages.py reads it: time [ms], x y z radius of each joint [m], tracking state of each.
    this.data = new ArrayBuffer(TIME_BYTES + NUMBERS_BYTES + COUNT);
    this.view = new DataView(this.data);
    this.numbers = new Float32Array(this.data, TIME_BYTES, 4 * COUNT); // browsers' machines are little-endian
    this.flags = new Uint8Array(this.data, TIME_BYTES + NUMBERS_BYTES, COUNT);
    this.there = false; // a device with hands, tracked or not
  }

  read(frame, space, time) {
    this.view.setFloat64(0, time, true);
    this.numbers.fill(NaN);
    this.flags.fill(NOT_TRACKED);
    this.there = false;
    for (const source of frame.session.inputSources) {
      const side = SIDES.indexOf(source.handedness);
      if (!source.hand || side < 0) continue;
      this.there = true;
      JOINTS.forEach((name, i) => this.readJoint(frame.getJointPose(source.hand.get(name), space), JOINTS.length * side + i));
    }
  }

  readJoint(pose, at) {
    if (!pose) return;
    const {x, y, z} = pose.transform.position;
    this.numbers.set([x, y, z, pose.radius], 4 * at);
    this.flags[at] = pose.emulatedPosition ? INFERRED : TRACKED;
  }

  forget() {
    this.numbers.fill(NaN);
    this.flags.fill(NOT_TRACKED);
  }

  // Of a side, 0 left or 1 right; NaN where it is not tracked.
  point(side, joint) {
    return this.numbers.subarray(4 * (JOINTS.length * side + joint), 4 * (JOINTS.length * side + joint) + 3);
  }
}
