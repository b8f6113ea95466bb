// The page: a view with orbit and touch controls for viewers, and WebXR sessions for headsets and phones.

import * as THREE from './three/build/three.module.js';
import {OrbitControls} from './three/examples/jsm/controls/OrbitControls.js';
import {Drawing, Vignette, lights} from './drawing.js';
import {Hands} from './hands.js';
import {Link} from './link.js';
import {Placing, Z_UP} from './placing.js';

const BACKGROUND = 0x303236;
const FEATURES = ['local-floor', 'hand-tracking', 'anchors', 'dom-overlay'];
const element = (id) => document.getElementById(id);

const renderer = new THREE.WebGLRenderer({canvas: element('view'), antialias: true, alpha: true});
const stage = new THREE.Scene(), drawing = new Drawing();
const vignette = new Vignette();
const grid = new THREE.GridHelper(1, 20, 0x777777, 0x555555);
const camera = new THREE.PerspectiveCamera(45, 1, 0.01, 20), eye = new THREE.PerspectiveCamera();
const orbit = new OrbitControls(camera, renderer.domElement);
stage.add(...lights(), drawing.world, grid, vignette);
orbit.addEventListener('start', () => { turned = true; });
drawing.world.matrixAutoUpdate = false;
grid.position.y = 0.1; // as in rviz
eye.matrixAutoUpdate = false;
let hold = '', people = 1, session = null, space = null, claimed = false, turned = false;
let ridden = 0, rides = false, darkens = false; // the operator with whom the view moves, if it does

function say(text) {
  element('message').textContent = text;
}

const link = new Link({
  welcome: (content) => { people = content.people; },
  connected: () => { claimed = false; drawing.poses.clear(); },
  scene: (content) => drawing.scene(content),
  training: (content) => drawing.trainingMarks(content),
  frame: (content) => {
    drawing.frame(content);
    if (!drawing.changed || !drawing.complete) return;
    drawing.changed = false;
    if (!turned) home();
  },
  ping: ([, trip, offset, overtaken]) => {
    if (trip === null) return;
    const ahead = offset - performance.timeOrigin / 1000; // offset of this device's clock; a page's time starts with the page
    const clock = offset === null ? '' : `, ROS's clock ${ahead < 0 ? '' : '+'}${ahead.toFixed(3)} s`;
    const late = link.unsent + overtaken, left = late ? `, left out to stay in time: ${late} of the hands' frames` : '';
    element('link').textContent = `round trip ${trip.toFixed(1)} ms${clock}${left}`;
  },
  person: (number) => { ridden = number - 1; say(people > 1 ? `your hands are person ${number}'s` : ''); if (placing.scene) placing.report(performance.now()); },
  refused: (line) => say(line),
}, say);
const hands = new Hands();
const placing = new Placing((pose) => link.tell({place: pose}));

// Shows all objects, from the person's side and slightly from above.
function home() {
  const {center, radius} = drawing.extent();
  orbit.target.copy(center);
  camera.position.set(0.25, 0.4, 0.88).multiplyScalar(1.2 * radius / Math.sin(camera.fov * Math.PI / 360)).add(center);
  orbit.update();
}

function resize() {
  if (session) return;
  renderer.setPixelRatio(window.devicePixelRatio);
  renderer.setSize(window.innerWidth, window.innerHeight, false);
  camera.aspect = window.innerWidth / window.innerHeight;
  camera.updateProjectionMatrix();
}

function label(text, instructions) {
  if (hold === text + instructions) return;
  hold = text + instructions;
  element('title').textContent = text;
  element('instructions').textContent = instructions;
}

function carrier() {
  return drawing.carriers[ridden % drawing.carriers.length];
}

// The world in the operator's frame.
function carried(world) {
  const by = carrier();
  return by ? world.multiply(new THREE.Matrix4().getInverse(by.matrix)) : world;
}

function readOut() {
  const by = carrier();
  for (const id of ['ride', 'vignette']) element(id).hidden = !by || (id === 'ride' && session !== null);
  element('motion').textContent = by ?
    `${by.motion.speed.toFixed(3)} m/s, ${(by.motion.spin * 180 / Math.PI).toFixed(1)} °/s` : '';
}

function drawPage() {
  requestAnimationFrame(drawPage);
  label(drawing.text, drawing.instructions);
  readOut();
  if (session) return;
  orbit.update();
  drawing.world.matrix.copy(rides ? carried(Z_UP.clone()) : Z_UP);
  camera.updateMatrixWorld();
  vignette.show(darkens && rides && carrier(), camera, carrier() ? carrier().motion : {speed: 0, spin: 0});
  renderer.render(stage, camera);
}

function beOnPage() {
  renderer.setFramebuffer(null);
  renderer.setRenderTarget(null);
  renderer.autoClear = true;
  renderer.setClearColor(BACKGROUND, 1);
  drawing.world.matrix.copy(Z_UP);
  drawing.label.visible = false;
  grid.visible = true;
  resize();
}

async function enter(mode) {
  const wanted = {optionalFeatures: FEATURES, domOverlay: {root: element('overlay')}};
  try {
    session = await navigator.xr.requestSession(mode, wanted);
    await renderer.getContext().makeXRCompatible();
    session.updateRenderState({baseLayer: new XRWebGLLayer(session, renderer.getContext()), depthNear: 0.02});
    space = await session.requestReferenceSpace('local-floor').catch(() => session.requestReferenceSpace('local'));
  } catch (error) {
    say(`the browser does not start ${mode}: ${error.message}`);
    if (session) session.end();
    session = null;
    return;
  }
  session.addEventListener('end', leave);
  // A tap on a phone or a controller's trigger. A pinch is a select event too, but is for objects.
  session.addEventListener('select', (event) => {
    if (!hands.there && event.inputSource.targetRayMode !== 'transient-pointer') placing.inFront();
  });
  space.addEventListener('reset', (event) => placing.reset(event.transform));
  placing.inFront();
  renderer.autoClear = false;
  renderer.setClearColor(BACKGROUND, mode === 'immersive-ar' ? 0 : 1);
  renderer.setPixelRatio(1);
  grid.visible = mode !== 'immersive-ar';
  drawing.label.visible = true;
  showButtons();
  session.requestAnimationFrame(drawXr);
}

function leave() {
  session = null;
  if (claimed) link.tell({hands: false});
  claimed = false;
  placing.anchor = null;
  beOnPage();
  showButtons();
}

function drawXr(time, frame) {
  frame.session.requestAnimationFrame(drawXr);
  const viewer = frame.getViewerPose(space);
  if (!viewer) return;
  hands.read(frame, space, frame.predictedDisplayTime || time);
  placing.update(frame, space, viewer, hands, drawing.touching, time);
  sendHands();
  drawing.world.matrix.copy(carried(placing.world));
  const by = carrier();
  drawing.label.position.set(0, 0, 0.05);
  drawing.label.say([drawing.instructions, drawing.text].filter((text) => text).join('\n'));
  const layer = frame.session.renderState.baseLayer;
  renderer.setFramebuffer(layer.framebuffer);
  renderer.setRenderTarget(null);
  renderer.clear();
  for (const view of viewer.views) drawView(view, layer.getViewport(view), by);
}

// Viewers without hands do not count as people.
function sendHands() {
  if (!hands.there) return;
  if (!claimed) link.tell({hands: true});
  claimed = true;
  if (placing.grip) hands.forget(); // they move the scene, and hold no object
  link.sendHands(hands.data);
}

function drawView(view, port, by) {
  if (!port) return;
  renderer.setViewport(port.x, port.y, port.width, port.height);
  eye.projectionMatrix.fromArray(view.projectionMatrix);
  eye.projectionMatrixInverse.getInverse(eye.projectionMatrix);
  eye.matrix.fromArray(view.transform.matrix);
  eye.updateMatrixWorld(true);
  vignette.show(darkens && by, eye, by ? by.motion : {speed: 0, spin: 0});
  renderer.render(stage, eye);
}

function showButtons() {
  const xr = navigator.xr;
  for (const mode of ['immersive-ar', 'immersive-vr']) {
    element(mode).hidden = true;
    if (xr && !session) xr.isSessionSupported(mode).then((yes) => { element(mode).hidden = !yes || session !== null; });
  }
  element('place').hidden = element('leave').hidden = session === null;
  element('home').hidden = session !== null;
}

for (const mode of ['immersive-ar', 'immersive-vr']) element(mode).onclick = () => enter(mode);
element('place').onclick = () => placing.inFront();
element('leave').onclick = () => session.end();
element('home').onclick = home;
element('ride').onclick = () => { rides = !rides; element('ride').classList.toggle('on', rides); };
element('vignette').onclick = () => { darkens = !darkens; element('vignette').classList.toggle('on', darkens); };
element('buttons').addEventListener('beforexrselect', (event) => event.preventDefault()); // a tap on a button is not a select event
window.addEventListener('resize', resize);
if (navigator.xr) navigator.xr.addEventListener('devicechange', showButtons);
home();
beOnPage();
showButtons();
drawPage();
window.page = {drawing, hands, link, placing}; // for tests and the browser's console
