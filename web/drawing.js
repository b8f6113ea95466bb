// Draws the messages of web_door, in world: x and y horizontal, z up, metres. scripts/web/picture.py defines the numbers.

import * as THREE from './three/build/three.module.js';

const LENGTH = 1e-4, DIRECTION = 1e-3, FORCE = 1e-2; // value of one unit of an integer [m], [1], [N]
const SKIN = new THREE.Color(0.91, 0.73, 0.62), TOUCHING = new THREE.Color(0.86, 0.30, 0.08);
const STICKS = 0x009e73, SLIPS = 0xf0e442, STRUCK = 0xffffff; // colour by phase of a contact (Okabe & Ito)
const PHASES = [STRUCK, STICKS, SLIPS];
const LONGEST = 0.12, HALF = 3; // maximum length of an arrow [m], and the force with half of it [N]
const SHORTEST = 0.004, RING = 0.0105; // [m]; the ring is seen around a finger
const LETTERS = 0.009; // height [m]

function bytes(text) {
  const data = atob(text), array = new Uint8Array(data.length);
  for (let i = 0; i < data.length; ++i) array[i] = data.charCodeAt(i);
  return new Float32Array(array.buffer);
}

function place(object, x, y, z, qx, qy, qz, qw) {
  object.position.set(x, y, z);
  object.quaternion.set(qx, qy, qz, qw).normalize();
}

function length([x, y, z]) {
  return new THREE.Vector3(x, y, z).multiplyScalar(LENGTH);
}

function material([r, g, b, a], options = {}) {
  return new THREE.MeshStandardMaterial({color: new THREE.Color(r, g, b), roughness: 0.7, metalness: 0, transparent: a < 1,
    opacity: a, depthWrite: a >= 1, ...options});
}

// Text that faces the eye. It is drawn again only when it changes.
class Label extends THREE.Sprite {
  constructor(height = LETTERS) {
    const canvas = document.createElement('canvas');
    super(new THREE.SpriteMaterial({map: new THREE.CanvasTexture(canvas), depthTest: false}));
    Object.assign(this, {canvas, height, said: '', renderOrder: 1});
  }

  say(text) {
    if (text === this.said) return;
    this.said = text;
    const context = this.canvas.getContext('2d'), size = 48, lines = text.split('\n');
    context.font = `${size}px sans-serif`;
    const width = Math.max(...lines.map((line) => context.measureText(line).width)) + 16;
    this.canvas.width = THREE.Math.ceilPowerOfTwo(width); // needed for mipmaps
    this.canvas.height = THREE.Math.ceilPowerOfTwo(1.3 * size * lines.length);
    context.font = `${size}px sans-serif`;
    context.textAlign = 'center';
    context.lineJoin = 'round';
    context.lineWidth = 6;
    context.strokeStyle = '#222';
    context.fillStyle = '#f4f4f4';
    lines.forEach((line, i) => {
      context.strokeText(line, this.canvas.width / 2, size * (1 + 1.3 * i));
      context.fillText(line, this.canvas.width / 2, size * (1 + 1.3 * i));
    });
    this.material.map.dispose(); // the texture has another size
    this.material.map.needsUpdate = true;
    this.scale.set(this.height * this.canvas.width / size, this.height * this.canvas.height / size, 1);
  }
}

const ROUND = {
  1: () => new THREE.BoxBufferGeometry(1, 1, 1),
  2: () => new THREE.SphereBufferGeometry(0.5, 32, 20),
  3: () => new THREE.CylinderBufferGeometry(0.5, 0.5, 1, 40).rotateX(Math.PI / 2),
};

function triangles(shape) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(bytes(shape.points || ''), 3));
  geometry.computeVertexNormals();
  let color = shape.color;
  if (shape.colors) { // three.js has no opacity per vertex: the first vertex's counts for all
    const rgba = bytes(shape.colors), rgb = new Float32Array(rgba.length / 4 * 3);
    for (let i = 0; i < rgba.length / 4; ++i) rgb.set(rgba.subarray(4 * i, 4 * i + 3), 3 * i);
    geometry.setAttribute('color', new THREE.BufferAttribute(rgb, 3));
    color = [1, 1, 1, rgba[3]];
  }
  const options = {side: THREE.DoubleSide, vertexColors: shape.colors ? THREE.VertexColors : THREE.NoColors};
  return new THREE.Mesh(geometry, material(color, options));
}

function line(shape, Kind) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(bytes(shape.points || ''), 3));
  const [r, g, b, a] = shape.color;
  return new Kind(geometry, new THREE.LineBasicMaterial({color: new THREE.Color(r, g, b), transparent: a < 1, opacity: a}));
}

function capsule([radius, length]) {
  const steps = 16, outline = [];
  for (let i = 0; i < steps; ++i) {
    const up = Math.PI * (i / (steps - 1) - 0.5);
    outline.push(new THREE.Vector2(radius * Math.cos(up), radius * Math.sin(up) + (i < steps / 2 ? -0.5 : 0.5) * length));
  }
  return new THREE.LatheBufferGeometry(outline, 24).rotateX(Math.PI / 2);
}

// A visualization_msgs/Marker or a capsule; null for a type that is not used.
function drawn(shape) {
  let object = null;
  if (ROUND[shape.type]) {
    object = new THREE.Mesh(ROUND[shape.type](), material(shape.color));
    object.scale.set(...shape.scale);
  } else if (shape.type === 'capsule') {
    object = new THREE.Mesh(capsule(shape.scale), material(shape.color));
  } else if (shape.type === 4) {
    object = line(shape, THREE.Line);
  } else if (shape.type === 5) {
    object = line(shape, THREE.LineSegments);
  } else if (shape.type === 9) {
    object = new Label(shape.scale[2]);
    object.say(shape.text || '');
  } else if (shape.type === 11) {
    object = triangles(shape);
    object.scale.set(...shape.scale);
  }
  if (object) place(object, ...shape.pose);
  return object;
}

function clear(group) {
  for (const child of [...group.children]) {
    group.remove(child);
    child.traverse((object) => {
      if (object.geometry && !(object instanceof THREE.Sprite)) object.geometry.dispose(); // sprites share theirs
      if (object.material && object.material.map) object.material.map.dispose();
      if (object.material) object.material.dispose();
    });
  }
}

// One mesh of moving capsules and the slabs between them. Each vertex has its end of the unit capsule and its direction.
class Capsules extends THREE.Mesh {
  constructor(count, slabs) {
    const around = 16, rows = 8, corners = [], indices = [];
    for (let row = 0; row < rows; ++row) {
      const far = row >= rows / 2, up = Math.PI * ((far ? row - 1 : row) / (rows - 2) - 0.5);
      for (let i = 0; i < around; ++i) {
        const turn = 2 * Math.PI * i / around;
        corners.push([far, Math.cos(up) * Math.cos(turn), Math.cos(up) * Math.sin(turn), Math.sin(up)]);
      }
    }
    for (let k = 0; k < slabs; ++k) {
      for (const corner of [0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6]) indices.push(8 * k + corner); // four above, four below
    }
    for (let k = 0; k < count; ++k) {
      for (let row = 0; row + 1 < rows; ++row) {
        for (let i = 0; i < around; ++i) {
          const a = 8 * slabs + k * corners.length + row * around + i, b = a - i + (i + 1) % around;
          indices.push(a, b, b + around, a, b + around, a + around);
        }
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(indices);
    for (const name of ['position', 'normal', 'color'])
      geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * (8 * slabs + count * corners.length)), 3));
    super(geometry, material([1, 1, 1, 1], {vertexColors: THREE.VertexColors}));
    Object.assign(this, {corners, count, slabs, used: 0, usedSlabs: 0, frustumCulled: false});
  }

  begin() {
    this.used = this.usedSlabs = 0;
    this.geometry.attributes.position.array.fill(0, 0, 24 * this.slabs); // unused slabs have no size
  }

  // The skin above and below, from one capsule to the next.
  addSlab(a, b, color) {
    const {position, normal, color: paint} = this.geometry.attributes;
    const along = a.end.clone().sub(a.start).add(b.end).sub(b.start), out = b.start.clone().sub(a.start).add(b.end).sub(a.end);
    out.crossVectors(along, out).normalize();
    let at = 8 * this.usedSlabs++;
    for (const side of [1, -1]) {
      for (const [point, {radius}] of [[a.start, a], [a.end, a], [b.end, b], [b.start, b]]) {
        const corner = point.clone().addScaledVector(out, side * radius);
        position.setXYZ(at, corner.x, corner.y, corner.z);
        normal.setXYZ(at, side * out.x, side * out.y, side * out.z);
        paint.setXYZ(at++, color.r, color.g, color.b);
      }
    }
  }

  // color: at its end; before: at its start.
  add(start, end, radius, color, before = color) {
    if (this.used === this.count) return;
    const z = end.clone().sub(start), {position, normal, color: paint} = this.geometry.attributes;
    if (z.lengthSq() === 0) z.set(0, 0, 1);
    z.normalize();
    const x = new THREE.Vector3(1, 0, 0).cross(z);
    if (x.lengthSq() < 0.1) x.set(0, 1, 0).cross(z);
    x.normalize();
    const y = z.clone().cross(x), out = new THREE.Vector3();
    let at = 8 * this.slabs + this.used++ * this.corners.length;
    for (const [far, a, b, c] of this.corners) {
      out.set(0, 0, 0).addScaledVector(x, a).addScaledVector(y, b).addScaledVector(z, c);
      normal.setXYZ(at, out.x, out.y, out.z);
      out.multiplyScalar(radius).add(far ? end : start);
      position.setXYZ(at, out.x, out.y, out.z);
      const {r, g, b: blue} = far ? color : before;
      paint.setXYZ(at++, r, g, blue);
    }
  }

  end() {
    const ofSlabs = 12 * this.slabs;
    this.geometry.setDrawRange(0, ofSlabs + (this.geometry.index.count - ofSlabs) / this.count * this.used);
    for (const attribute of Object.values(this.geometry.attributes)) attribute.needsUpdate = true;
    this.visible = this.used > 0;
  }
}

const THUMB = 1; // its metacarpal: a Leap reports it as the proximal phalanx
const CAPSULES_OF_A_HAND = 30, SLABS_OF_A_HAND = 4, HANDS = 4, CONTACTS = 30;
const WEB = 0.6; // fraction of the index finger's metacarpal at which the thumb's skin joins it

// Phalanges as capsules, and the palm between the metacarpals of adjacent fingers, with round ends.
function addHand(capsules, [, , , , phalanges]) {
  const metacarpals = [];
  let before = SKIN; // at the end of the last phalanx
  for (const [which, ...rest] of phalanges) {
    const start = length(rest.slice(0, 3)), end = length(rest.slice(3, 6)), radius = LENGTH * rest[6];
    if (which % 4 === 0 || which === THUMB) metacarpals[Math.floor(which / 4)] = {start, end, radius};
    const color = rest[7] ? TOUCHING : SKIN;
    capsules.add(start, end, radius, color, which % 4 === 0 ? SKIN : before);
    before = color;
  }
  for (let finger = 0; finger + 1 < metacarpals.length; ++finger) {
    const a = metacarpals[finger], next = metacarpals[finger + 1];
    if (!a || !next) continue;
    const b = finger > 0 ? next : {...next, end: next.start.clone().lerp(next.end, WEB)};
    capsules.addSlab(a, b, SKIN);
    for (const end of ['start', 'end']) capsules.add(a[end], b[end], Math.min(a.radius, b.radius), SKIN);
  }
}

// A contact of a hand and an object: a ring on the surface, an arrow for the force, and its value.
class ContactMark extends THREE.Group {
  constructor() {
    super();
    this.ring = new THREE.Mesh(new THREE.RingBufferGeometry(0.8 * RING, RING, 36),
      new THREE.MeshBasicMaterial({side: THREE.DoubleSide}));
    this.shaft = new THREE.Mesh(new THREE.CylinderBufferGeometry(0.00175, 0.00175, 1, 12).rotateX(Math.PI / 2),
      material([0.97, 0.97, 0.97, 1]));
    this.head = new THREE.Mesh(new THREE.ConeBufferGeometry(0.0045, 0.014, 16).rotateX(Math.PI / 2),
      material([0.97, 0.97, 0.97, 1]));
    this.newtons = new Label();
    this.add(this.ring, this.shaft, this.head, this.newtons);
  }

  // numbered: whether the value of the force is shown.
  show([x, y, z, nx, ny, nz, fx, fy, fz, phase], numbered) {
    const point = length([x, y, z]), normal = new THREE.Vector3(nx, ny, nz).multiplyScalar(DIRECTION);
    const force = new THREE.Vector3(fx, fy, fz).multiplyScalar(FORCE), newtons = force.length();
    const ahead = new THREE.Vector3(0, 0, 1);
    this.ring.position.copy(point).addScaledVector(normal, 6e-4);
    this.ring.quaternion.setFromUnitVectors(ahead, normal.normalize());
    this.ring.material.color.setHex(PHASES[phase] === undefined ? STRUCK : PHASES[phase]);
    const arrow = LONGEST * newtons / (newtons + HALF);
    const seen = arrow >= SHORTEST;
    for (const part of [this.shaft, this.head]) part.visible = seen;
    this.newtons.visible = seen && numbered;
    if (!seen) return;
    const direction = force.divideScalar(newtons), tip = point.clone().addScaledVector(direction, -0.02);
    const head = Math.min(0.014, 0.5 * arrow);
    this.head.scale.z = head / 0.014;
    this.head.position.copy(tip).addScaledVector(direction, -0.5 * head);
    this.shaft.scale.z = arrow - head;
    this.shaft.position.copy(tip).addScaledVector(direction, -0.5 * (arrow + head));
    this.head.quaternion.setFromUnitVectors(ahead, direction);
    this.shaft.quaternion.copy(this.head.quaternion);
    this.newtons.position.copy(tip).addScaledVector(direction, -arrow - LETTERS);
    this.newtons.say(`${newtons.toFixed(1)} N`);
  }
}

// Darkens the edge of the view while it moves, which reduces motion sickness.
export class Vignette extends THREE.Mesh {
  constructor() {
    super(new THREE.SphereBufferGeometry(0.1, 32, 20), new THREE.ShaderMaterial({
      side: THREE.BackSide, transparent: true, depthTest: false, depthWrite: false, uniforms: {strength: {value: 0}},
      vertexShader: 'varying vec3 ray; void main() { ray = position;' +
        ' gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
      fragmentShader: 'uniform float strength; varying vec3 ray; void main() {' +
        ' float off = acos(clamp(-normalize(ray).z, -1.0, 1.0));' +
        ' gl_FragColor = vec4(0.0, 0.0, 0.0, strength * smoothstep(0.3, 0.75, off)); }',
    }));
    Object.assign(this, {frustumCulled: false, renderOrder: 2, matrixAutoUpdate: false, visible: false});
  }

  // At an eye; speed and spin of the view [m/s], [rad/s].
  show(on, eye, {speed, spin}) {
    const wanted = on ? Math.min(1, speed / 0.5 + spin / 0.5) : 0, {strength} = this.material.uniforms;
    strength.value += 0.05 * (wanted - strength.value); // slowly, without flicker
    this.visible = strength.value > 0.01;
    this.matrix.copy(eye.matrixWorld);
    this.matrixWorldNeedsUpdate = true;
  }
}

const AVERAGED = 250; // period over which displayed speed and spin are averaged [ms]

// The moving frame in which an operator's hands and headset are tracked.
class Carrier {
  constructor(group, origin) {
    Object.assign(this, {group, origin, past: [], motion: {speed: 0, spin: 0}});
  }

  get matrix() {
    this.group.updateMatrix();
    return this.group.matrix.clone().multiply(new THREE.Matrix4().makeTranslation(...this.origin.toArray()));
  }

  read(time) {
    const {position, quaternion} = this.group;
    this.past.push({time, position: position.clone(), quaternion: quaternion.clone()});
    while (this.past.length > 2 && time - this.past[0].time > AVERAGED) this.past.shift();
    const [first] = this.past, seconds = (time - first.time) / 1000;
    if (seconds <= 0) return;
    this.motion = {speed: position.distanceTo(first.position) / seconds, spin: quaternion.angleTo(first.quaternion) / seconds};
  }
}

const READ = ['instructions', 'timer', 'result']; // training's texts, which rviz shows in front of the camera

export class Drawing {
  constructor() {
    this.world = new THREE.Group(); // parent of everything; move it to place the scene
    this.objects = new THREE.Group();
    this.training = new THREE.Group();
    this.hands = Array.from({length: HANDS}, () => new Capsules(CAPSULES_OF_A_HAND, SLABS_OF_A_HAND));
    this.contacts = Array.from({length: CONTACTS}, () => new ContactMark());
    this.label = new Label(0.014); // for a headset, which does not show the page
    this.world.add(this.objects, this.training, ...this.hands, ...this.contacts, this.label);
    this.title = '';
    this.instructions = '';
    this.changed = false; // the view has changed
    this.bodies = new Map();
    this.carriers = []; // by operator; empty: hands are tracked in world
    this.poses = new Map(); // latest entries, also of objects without a shape yet
    this.touching = false;
    this.frames = 0;
    this.frame([[], [], []]);
  }

  scene({title, bodies}) {
    clear(this.objects);
    this.bodies.clear();
    this.carriers = [];
    this.title = title;
    this.changed = true;
    for (const body of bodies) {
      const group = new THREE.Group();
      group.name = body.name;
      for (const shape of body.shapes) {
        const object = drawn(shape);
        if (object) group.add(object);
      }
      if (body.carries) this.carriers.push(new Carrier(group, length(body.carries)));
      group.visible = !body.free; // hidden until its pose is known
      if (!body.free) place(group, ...length(body.pose.slice(0, 3)).toArray(), ...body.pose.slice(3));
      this.objects.add(group);
      this.bodies.set(body.id, group);
      if (body.free && this.poses.has(body.id)) this.move(this.poses.get(body.id));
    }
  }

  trainingMarks(shapes) {
    const before = this.training.children.length;
    clear(this.training);
    this.instructions = shapes.filter((shape) => READ.includes(shape.ns)).map((shape) => shape.text || '').join('\n');
    for (const shape of shapes.filter((other) => !READ.includes(other.ns))) {
      const object = drawn(shape);
      if (object) this.training.add(object);
    }
    if (before === 0 && this.training.children.length > 0) this.changed = true;
  }

  move(entry) {
    const [id, held, x, y, z, ...turn] = entry;
    this.poses.set(id, entry);
    const group = this.bodies.get(id);
    if (!group) return;
    place(group, ...length([x, y, z]).toArray(), ...turn);
    group.visible = true;
    group.held = held; // 1: by contact, 2: with grasp assist
  }

  frame([hands, contacts, objects]) {
    this.frames += 1;
    this.hands.forEach((capsules, i) => {
      capsules.begin();
      if (hands[i]) addHand(capsules, hands[i]);
      capsules.end();
    });
    this.touching = contacts.length > 0;
    const forces = contacts.map(([, , , , , , x, y, z]) => Math.hypot(x, y, z)), largest = Math.max(...forces);
    this.contacts.forEach((mark, i) => {
      mark.visible = i < contacts.length;
      if (mark.visible) mark.show(contacts[i], forces[i] > 0.5 * largest); // numbers of smaller forces would overlap
    });
    for (const entry of objects) this.move(entry);
    for (const carrier of this.carriers) carrier.read(performance.now());
  }

  // True if all poses are known.
  get complete() {
    return this.bodies.size > 0 && this.objects.children.every((group) => group.visible);
  }

  // A sphere around the objects and training's places, in the view's axes.
  extent() {
    this.world.updateMatrixWorld(true);
    const box = new THREE.Box3().setFromObject(this.objects), ball = new THREE.Sphere(new THREE.Vector3(0, 0.25, 0), 0);
    box.expandByObject(this.training);
    if (!box.isEmpty()) box.getBoundingSphere(ball);
    ball.radius = Math.max(0.14, ball.radius);
    return ball;
  }

  get text() {
    const held = this.objects.children.filter((group) => group.held)
      .map((group) => group.name + (group.held === 2 ? ' (with grasp assist)' : ''));
    return `${this.title}  |  holding: ${held.join(', ') || 'nothing'}`;
  }
}

export function lights() {
  const sun = new THREE.DirectionalLight(0xffffff, 0.45);
  sun.position.set(0.4, 0.8, 1);
  return [new THREE.HemisphereLight(0xffffff, 0x9c9894, 0.75), sun];
}
