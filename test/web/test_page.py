"""The page in Chromium with an emulated headset: sessions of both kinds, what is drawn, and where the scene is placed."""
import math
import os
import subprocess
import sys
import tempfile
import time
import types
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import emulated_headset  # noqa: E402

MISSING = emulated_headset.missing()
THREE = '/usr/share/javascript/three'
if not os.path.exists(THREE):
    MISSING = MISSING or 'three.js is not installed (Debian: libjs-three)'
try:
    from doors import LONGEST, RunningDoor
except ImportError:
    MISSING = MISSING or 'aiohttp is not installed (Debian: python3-aiohttp)'
if MISSING:
    raise unittest.SkipTest(MISSING)

HOLD = 1.5  # [s] for which two hands pinch: they take the scene after 1 s
CUBE = (0.902, 0.624, 0.0)
# How far a headset's view of the scene has moved from where the scene was placed [m].
APART = ('const a = page.placing.world, b = page.drawing.world.matrix;'
         'return Math.hypot(a.elements[12] - b.elements[12], a.elements[14] - b.elements[14])')


def point(x=0.0, y=0.0, z=0.0, w=1.0):
    return types.SimpleNamespace(x=x, y=y, z=z, w=w)


def marker(kind, name='cube', free=False, size=0.1, color=CUBE, points=(), colors=(), text='', at=(0.0, 0.0, 0.2)):
    rgba = [types.SimpleNamespace(r=c[0], g=c[1], b=c[2], a=0.5) for c in colors]
    return types.SimpleNamespace(
        type=kind, ns=name, action=0, header=types.SimpleNamespace(frame_id=name if free else 'world'), text=text,
        pose=types.SimpleNamespace(position=point(*at), orientation=point()), scale=point(size, size, size),
        color=types.SimpleNamespace(r=color[0], g=color[1], b=color[2], a=1.0), points=[point(*p) for p in points], colors=rgba)


TRIANGLE = ((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0))
SHAPES = [marker(1), marker(2), marker(3), marker(4, points=TRIANGLE), marker(5, points=TRIANGLE[:2]),
          marker(11, size=1.0, points=TRIANGLE), marker(11, size=1.0, points=TRIANGLE, colors=3 * [CUBE]),
          marker(9, text='two\nlines')]


# Of SceneDescription: sphere, box, cylinder, capsule, mesh
SIZES = (0.05,), (0.1, 0.1, 0.1), (0.05, 0.1), (0.03, 0.1), ()


def scene(*types_):
    shapes = [types.SimpleNamespace(type=type_, size=SIZES[type_], pose=types.SimpleNamespace(position=point(), orientation=point()),
                                    color=types.SimpleNamespace(r=CUBE[0], g=CUBE[1], b=CUBE[2], a=1.0),
                                    vertices=[point(*p) for p in TRIANGLE], triangles=[0, 1, 2]) for type_ in types_]
    pose = types.SimpleNamespace(position=point(0.0, 0.0, 0.2), orientation=point())
    body = types.SimpleNamespace(name='cube', fixed=True, pose=pose, visuals=[], shapes=shapes, is_operator=False)
    return types.SimpleNamespace(name='page', model='implicit', gravity=point(0.0, 0.0, -9.81), bodies=[body] if shapes else [])


class PageTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.open_door()
        self.headset = self.open_page()

    def open_door(self, **options):
        self.door = RunningDoor(self.folder, three=THREE, **options)
        self.door.__enter__()
        self.addCleanup(self.door.__exit__)
        self.show(scene(1))

    def open_page(self):
        headset = emulated_headset.Headset()
        self.addCleanup(headset.close)
        headset.open(self.door.page)
        self.headset = headset
        self.wait(lambda: headset.run('return page.drawing.bodies.size'), 'the scene')
        return headset

    def show(self, shown, training=()):
        self.door.picture.take_scene(shown)
        self.door.picture.take_training(types.SimpleNamespace(markers=list(training)))
        self.door.changed()

    def show_objects(self, *states):
        self.door.picture.take_objects(types.SimpleNamespace(objects=[types.SimpleNamespace(**state) for state in states]))
        self.door.changed()

    def wait(self, holds, what):
        end = time.monotonic() + LONGEST
        while not holds():
            self.assertLess(time.monotonic(), end, 'waited in vain for ' + what)
            time.sleep(0.02)
        self.assertEqual(self.headset.errors(), [])

    def enter(self, mode):
        taken = len(self.door.port.taken)
        self.headset.enter(mode)
        self.wait(lambda: len(self.door.port.taken) > taken + 5, 'hands in ' + mode)

    def press(self, button):
        """In a session, where the emulated headset's picture is in the way of WebDriver's clicks."""
        self.headset.run('document.getElementById("%s").click()' % button)

    def share(self, is_of_colour):
        """Of the pixels seen."""
        file = os.path.join(self.folder, 'seen.png')
        with open(file, 'wb') as stream:
            stream.write(self.headset.picture())
        rgb = subprocess.run(['convert', file, '-resize', '200x150!', '-depth', '8', 'rgb:-'], check=True,
                             stdout=subprocess.PIPE).stdout
        return sum(is_of_colour(*rgb[3 * i:3 * i + 3]) for i in range(200 * 150)) / (200 * 150)

    def test_a_session_of_either_kind_has_both_hands_and_ends_on_the_page(self):
        for mode in ('immersive-ar', 'immersive-vr'):
            self.enter(mode)
            _, person, _, _, numbers = self.door.port.taken[-1]
            self.assertEqual((person, len(numbers)), (0, 200))
            self.assertTrue(all(map(math.isfinite, numbers)))
            self.assertTrue(all(0.003 < radius < 0.03 for radius in numbers[3::4]))
            self.press('leave')
            self.wait(lambda: self.door.port.taken[-1][4] == [], 'the end of the hands')
            self.wait(lambda: self.headset.run('return !document.getElementById("%s").hidden' % mode), 'the page')

    def test_all_kinds_of_marks_are_drawn_and_the_text_says_what_is_held(self):
        def is_cube(r, g, b):
            return r > 90 and 0.5 * r < g < 0.85 * r and b < 0.2 * r
        self.wait(lambda: self.share(is_cube) > 0.02, 'a box seen on the page')
        pose = types.SimpleNamespace(position=point(z=0.2), orientation=point())
        for assisted, held in ((False, 'holding: cube'), (True, 'holding: cube (with grasp assist)')):
            self.show_objects(dict(name='cube', held=True, assisted=assisted, pose=pose))
            self.wait(lambda held=held: self.headset.run('return page.drawing.text').endswith(held), held)
        self.show(scene(*range(len(SIZES))), training=SHAPES)
        self.wait(lambda: self.headset.run('return page.drawing.objects.children[0].children.length') == len(SIZES), 'shapes')
        self.wait(lambda: self.headset.run('return page.drawing.training.children.length') in (0, len(SHAPES)), 'training')
        self.enter('immersive-vr')
        self.show(scene())
        self.wait(lambda: self.headset.run('return page.drawing.objects.children.length') == 0, 'an empty scene')
        self.wait(lambda: self.headset.run('return page.drawing.training.children.length') == 0, 'the end of a training')
        self.assertEqual(self.share(is_cube), 0.0)

    def show_with_operators(self, *names):
        shown = scene(1)
        shown.bodies.extend(types.SimpleNamespace(
            name=name, fixed=False, pose=types.SimpleNamespace(position=point(), orientation=point()), visuals=[], shapes=[],
            is_operator=True, link=point(0.0, 0.4, 0.0)) for name in names)
        self.show(shown)

    def move_operators(self, **places):
        """Each with the frame of its hands at x, 0.4 m before its centre of mass, turned by a right angle about z."""
        half = math.sqrt(0.5)
        self.show_objects(*(dict(name=name, held=False, assisted=False, pose=types.SimpleNamespace(
            position=point(x + 0.4), orientation=point(z=half, w=half))) for name, x in places.items()))

    def test_the_view_goes_with_the_operator_and_shows_its_speed(self):
        self.show_with_operators('operator')
        self.move_operators(operator=0.3)
        self.wait(lambda: self.headset.run('return !document.getElementById("ride").hidden'), 'the button')
        self.assertAlmostEqual(self.headset.run('return page.drawing.world.matrix.elements[12]'), 0.0)
        self.press('ride')
        # World's origin is 0.3 m behind the frame's, whose x is world's y: 0.3 m along y, which the page has upright as -z.
        self.wait(lambda: abs(self.headset.run('return page.drawing.world.matrix.elements[14]') + 0.3) < 1e-3, 'the ride')
        self.move_operators(operator=0.4)
        self.wait(lambda: self.headset.run('return document.getElementById("motion").textContent').endswith('/s'), 'the read-out')
        self.enter('immersive-vr')
        self.press('vignette')
        self.wait(lambda: abs(self.headset.run(APART) - 0.4) < 1e-3, 'the headset to go along')

    def test_two_headsets_go_with_an_operator_each(self):
        self.open_door(people=2)
        self.show_with_operators('ann', 'ben')
        self.move_operators(ann=0.3, ben=0.5)
        pages = []
        for person in (0, 1):
            pages.append(self.open_page())
            pages[-1].enter('immersive-vr')
            self.wait(lambda p=person: any(taken[1] == p for taken in self.door.port.taken), 'hands of person %d' % (person + 1))
        for page, x in zip(pages, (0.3, 0.5)):
            self.wait(lambda p=page, at=x: abs(p.run(APART) - at) < 1e-3, 'the headset to go along')
        self.assertEqual(pages[0].errors(), [])

    def mounts(self):
        return [pose for transforms in self.door.port.mounted for _, pose in transforms[-1:]]

    def test_the_scene_is_in_front_at_first_and_where_a_button_puts_it_then(self):
        self.enter('immersive-ar')
        (x, y, z), _ = self.mounts()[-1]
        # Of the headset's floor in world: the eyes are at 1.6 m, the scene 0.45 m below them and 0.45 m ahead.
        self.assertTrue(all(abs(a - b) < 1e-6 for a, b in zip((x, y, z), (0.0, -0.45, -1.15))), (x, y, z))
        self.headset.run('device.position.set(1, 1.6, 0); device.quaternion.set(0, Math.SQRT1_2, 0, Math.SQRT1_2)')
        before = len(self.mounts())
        self.wait(lambda: self.headset.run('return page.hands.there'), 'a frame')
        self.press('place')
        self.wait(lambda: len(self.mounts()) > before, 'the new place')
        scene = self.headset.run('return page.placing.scene.elements')
        self.assertTrue(all(abs(a - b) < 1e-4 for a, b in zip(scene[12:15], (0.55, 1.15, 0.0))), scene)
        self.assertTrue(all(abs(a - b) < 1e-4 for a, b in zip(scene[8:11], (1.0, 0.0, 0.0))), 'its back is to the person')

    def test_two_pinching_hands_take_the_scene_and_leave_it_where_they_open(self):
        self.enter('immersive-ar')
        before, placed = len(self.mounts()), self.headset.run('return page.placing.scene.elements')
        self.headset.run('for (const hand of Object.values(device.hands)) hand.updatePinchValue(1)')
        self.wait(lambda: self.headset.run('return page.placing.grip !== null'), 'the grip')
        self.wait(lambda: math.isnan(self.door.port.taken[-1][4][0]), 'hands that hold nothing in the scene')
        self.headset.run('device.hands.left.position.set(-0.15, 1.4, -0.6); device.hands.right.position.set(0.35, 1.4, -0.6)')
        self.wait(lambda: abs(self.headset.run('return page.placing.scene.elements')[12] - placed[12] - 0.1) < 1e-3, 'the move')
        self.headset.run('for (const hand of Object.values(device.hands)) hand.updatePinchValue(0)')
        self.wait(lambda: len(self.mounts()) > before, 'the new place')
        moved = self.headset.run('return page.placing.scene.elements')
        self.assertTrue(all(abs(a - b - d) < 2e-3 for a, b, d in zip(moved[12:15], placed[12:15], (0.1, -0.1, -0.2))), moved)
        self.wait(lambda: math.isfinite(self.door.port.taken[-1][4][0]), 'hands again')

    def test_an_anchor_keeps_the_scene_and_a_reset_without_one_does_too(self):
        self.enter('immersive-ar')
        self.wait(lambda: self.headset.run('return page.placing.anchor !== null'), 'an anchor')
        before = len(self.mounts())
        moved = self.headset.run('''
            const space = page.placing.anchor.anchorSpace;
            const hidden = space[Object.getOwnPropertySymbols(space).find((symbol) => String(symbol).includes('xr-space'))];
            hidden.offsetMatrix[12] += 0.05;
            return hidden.offsetMatrix[12];''')
        self.wait(lambda: len(self.mounts()) > before, 'the place that the anchor gives')
        self.assertAlmostEqual(self.headset.run('return page.placing.scene.elements')[12], moved, delta=1e-6)
        scene = self.headset.run('''
            page.placing.anchor = null;
            const old = page.placing.scene.clone();
            page.placing.reset(new XRRigidTransform({x: 1, y: 0, z: 2}));
            return [Array.from(old.elements), Array.from(page.placing.scene.elements)];''')
        for axis, by in ((12, -1.0), (13, 0.0), (14, -2.0)):
            self.assertAlmostEqual(scene[1][axis] - scene[0][axis], by, delta=1e-6)


if __name__ == '__main__':
    unittest.main()
