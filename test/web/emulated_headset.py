"""Chromium with Meta's emulated headset, IWER, in the page."""
import json
import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, os.pardir, 'study'))
import web_browser  # noqa: E402

VERSION = '2.5.0'
FOLDER = os.path.join(HERE, os.pardir, os.pardir, 'build', 'npm')
FILE = os.path.join(FOLDER, 'node_modules', 'iwer', 'build', 'iwer.min.js')
WITHOUT_GPU = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader']

DEVICE = '''
window.device = new IWER.XRDevice(IWER.metaQuest3);
device.installRuntime({forceInstall: true});
device.primaryInputMode = 'hand';
device.stereoEnabled = false;
window.errors = [];
addEventListener('error', (event) => errors.push(event.message + ' ' + event.filename + ':' + event.lineno));
addEventListener('unhandledrejection', (event) => errors.push(String(event.reason)));
'''
# One row of a recording for each frame of the session: x, y, z of 25 joints in the session's space; null: no hand.
PLAY = '''
const names = %s, rows = %s, radius = 0.0078125;
const hand = device.hands.right, next = hand.onFrameStart.bind(hand);
const settings = hand[Object.getOwnPropertySymbols(hand).find((symbol) => String(symbol).includes('hand-input'))];
hand.position.set(0, 0, 0);
hand.quaternion.set(0, 0, 0, 1);
device.hands.left.connected = false;
window.played = 0;
settings.poses.played = {jointTransforms: Object.fromEntries(names.map((name) => [name, {radius}]))};
settings.poses.pinch = settings.poses.played;
hand.poseId = 'played';
const show = (row) => names.forEach((name, i) => {
  const [x, y, z] = row.slice(3 * i, 3 * i + 3);  // IWER mirrors poses, which are a left hand's
  settings.poses.played.jointTransforms[name].offsetMatrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, -x, y, z, 1];
});
show(rows[0]);
hand.onFrameStart = (frame) => {
  if (played < rows.length) show(rows[played]);
  played += 1;
  if (played > rows.length) hand.connected = false;
  next(frame);
};
'''


def missing():
    """What is not installed, or nothing. Gets IWER by npm, once."""
    lacks = web_browser.missing()
    if lacks or os.path.exists(FILE):
        return lacks
    if not shutil.which('npm'):
        return 'npm is not installed, which gets iwer %s' % VERSION
    os.makedirs(FOLDER, exist_ok=True)
    done = subprocess.run(['npm', 'install', '--prefix', FOLDER, '--ignore-scripts', '--no-audit', '--no-fund', '--no-save',
                           'iwer@' + VERSION], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=300, check=False)
    return '' if done.returncode == 0 and os.path.exists(FILE) else 'npm cannot get iwer %s' % VERSION


class Headset(web_browser.Browser):
    def __init__(self, size='480,360'):
        super().__init__(*WITHOUT_GPU, '--window-size=' + size)
        with open(FILE, encoding='utf-8') as file:
            self.run_first(file.read() + DEVICE)

    def enter(self, mode):
        self.run('document.getElementById("%s").click()' % mode)

    def play(self, names, rows):
        self.run(PLAY % (json.dumps(names), json.dumps(rows)))

    def errors(self):
        return self.run('return errors')
