"""The door of browsers, on this machine's own address: what it refuses, and that hands and frames never wait in line."""
import asyncio
import itertools
import json
import math
import os
import random
import socket
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
from unittest import mock

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    import aiohttp
except ImportError:
    raise unittest.SkipTest('aiohttp is not installed (Debian: python3-aiohttp)')
from doors import LONGEST, TOKEN, RunningDoor, answer_until, hands, put_hands_in  # noqa: E402
from web import certificate, messages, picture, server  # noqa: E402

FRAME = 1.0 / 60  # [s]
TRIES = 5  # other programs may have the machine for a while


def point(x=0.0, y=0.0, z=0.0, w=1.0):
    return types.SimpleNamespace(x=x, y=y, z=z, w=w)


def pose(x=0.0):
    return types.SimpleNamespace(position=point(x), orientation=point())


def object_states(count, x):
    return types.SimpleNamespace(objects=[types.SimpleNamespace(name='body_%d' % i, held=False, assisted=False,
                                                                pose=pose(x - 0.01 * i)) for i in range(count)])


def rendered_hands(count):
    phalanges = [types.SimpleNamespace(finger=i // 4, bone=i % 4, start=point(-1.2345, 0.4321, 1.1111), radius=0.0088,
                                       end=point(-1.2345, 0.4321, 1.1111), touching=True) for i in range(20)]
    hand = types.SimpleNamespace(side=1, palm=pose(1.2345), palm_width=0.085, wrist=point(1.0), phalanges=phalanges)
    return types.SimpleNamespace(hands=count * [hand])


def wait_until(holds, what, longest=LONGEST):
    end = time.monotonic() + longest
    while not holds():
        if time.monotonic() > end:
            raise AssertionError('waited %g s for %s' % (longest, what))
        time.sleep(0.01)


def silent_viewer(door):
    """A WebSocket's socket that nobody reads, and the door's viewer for it, of whose words the system keeps few."""
    idle = socket.create_connection(('127.0.0.1', door.number))
    idle.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    idle.sendall(('GET /%s/socket HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nOrigin: %s\r\nUpgrade: websocket\r\n'
                  'Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n'
                  % (TOKEN, door.number, door.origin)).encode())
    wait_until(lambda: door.port.counts, 'the viewer')
    viewer, = door.door._viewers
    viewer.transport.get_extra_info('socket').setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    return idle, viewer


class DoorTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def run_with(self, visit, **options):
        """visit(door, session), a coroutine; the door's log stays in self.lines."""
        async def run(door):
            async with aiohttp.ClientSession() as session:
                return await asyncio.wait_for(visit(door, session), LONGEST)
        with RunningDoor(self.folder, **options) as door:
            self.lines = door.port.lines
            return asyncio.run(run(door))

    def refused(self, line):
        """In the log, in one line; it may be told a second later, with others."""
        wait_until(lambda: any(line in told for told in self.lines), "'%s' in %s" % (line, self.lines))
        self.assertTrue(all(told.isprintable() for told in self.lines))

    def test_a_wrong_token_gets_one_line_whatever_it_asks_for(self):
        async def visit(door, session):
            for path in ('', 'x', 'x/', 'x/socket', TOKEN + 'x/', TOKEN[:-1] + '/page.js', '%ff%fe/', '../' + TOKEN + '/../'):
                async with session.get('%s/%s' % (door.origin, path)) as reply:
                    self.assertEqual((reply.status, await reply.text()),
                                     (403, 'wrong access token; open the address that web_door printed\n'), path)
            self.refused('wrong access token')
            for name, status in (('', 200), ('page.js', 200), ('three/build/three.module.js', 200), ('server.py', 404),
                                 ('../package.xml', 404), ('..%2fpackage.xml', 404), ('three/../../etc/passwd', 404)):
                async with session.get(aiohttp.client.URL(door.page + name, encoded=True)) as reply:
                    self.assertEqual(reply.status, status, name)
        self.run_with(visit)

    def test_a_page_of_another_origin_is_refused(self):
        async def visit(door, session):
            for origin in ('http://evil.example', 'https' + door.origin[4:], 'null', door.origin + '.evil.example', None):
                with self.assertRaises(aiohttp.WSServerHandshakeError) as refusal:
                    await session.ws_connect(door.page + 'socket', origin=origin)
                self.assertEqual(refusal.exception.status, 403)
            self.refused("origin 'http://evil.example'; allowed: " + door.origin)
        self.run_with(visit)

    def test_ten_megabytes_are_refused_in_one_line_and_others_are_served_on(self):
        async def visit(door, session):
            async with door.connect(session) as looker:
                for send in ('send_str', 'send_bytes'):
                    async with door.connect(session) as sender:
                        large = 10 * 1024 * 1024 * 'x'
                        try:
                            await getattr(sender, send)(large if send == 'send_str' else large.encode())
                            while not sender.closed:
                                await sender.receive(timeout=LONGEST)
                        except OSError:
                            pass  # it was ended while most of it had not been sent
                await answer_until(looker, lambda kind, content: kind == 'ping')
            self.refused('exceeds limit %d' % messages.MAX_BYTES)
        self.run_with(visit)

    def test_a_thousand_connections_leave_the_viewers_that_are_there_alone(self):
        async def visit(door, session):
            async with door.connect(session) as looker:
                await answer_until(looker, lambda kind, content: kind == 'ping')
                crowd, refused = [], set()

                def note_refused():
                    for one in crowd:
                        try:
                            if one.recv(200).endswith(b'too many connections; allowed: %d\n' % server.MAX_CONNECTIONS):
                                refused.add(one)
                        except OSError:
                            pass  # nothing said yet, or ended
                    return len(refused)
                try:
                    for _ in range(1000):
                        crowd.append(socket.create_connection(('127.0.0.1', door.number), timeout=LONGEST))
                        crowd[-1].setblocking(False)
                        await asyncio.sleep(0)
                    await answer_until(looker, lambda kind, content: kind == 'ping')
                    # Those that have been silent for long make room for others meanwhile.
                    wait_until(lambda: note_refused() > 1000 - 3 * server.MAX_CONNECTIONS, 'refusals')
                finally:
                    for one in crowd:
                        one.close()
                await answer_until(looker, lambda kind, content: kind == 'ping')
            self.refused('too many connections; allowed: %d' % server.MAX_CONNECTIONS)
            self.assertLess(len(self.lines), 20, 'a line for each would be a flood')

            async def returns():
                async with session.get(door.page) as reply:
                    return reply.status == 200
            self.assertTrue(await returns(), 'there is room again')
        self.run_with(visit)

    def test_refusals_that_go_on_for_an_hour_are_all_counted_in_few_lines(self):
        now, lines, due = [0.0], [], []
        loop = types.SimpleNamespace(call_later=lambda wait, call: due.append((now[0] + wait, call)))
        with mock.patch.object(server.time, 'monotonic', lambda: now[0]), \
                mock.patch.object(server.asyncio, 'get_running_loop', lambda: loop):
            refusals = server.Refusals(lines.append)
            for k in range(36000):
                now[0] = 0.1 * k
                while due and due[0][0] <= now[0]:
                    due.pop(0)[1]()
                refusals.add('wrong access token')
            self.assertEqual(lines[0], 'refused: wrong access token')
            self.assertLess(len(lines), 80, 'one a minute, and a few at the start')
            counted = sum(int(line.split()[1]) for line in lines[1:]) + 1
            self.assertGreater(counted, 36000 - 10 * server.LONGEST_SILENCE - 1, 'none is lost but those still to be told')
            due[0][1]()
            now[0] += 61.0
            refusals.add('another')
            self.assertEqual(lines[-1], 'refused: another', 'told at once after a pause')

    def test_viewers_beyond_the_limit_are_refused(self):
        async def visit(door, session):
            async with door.connect(session), door.connect(session):
                with self.assertRaises(aiohttp.WSServerHandshakeError):
                    await door.connect(session)
            self.refused('too many viewers; allowed: 2')
        self.run_with(visit, viewers=2)

    def test_a_message_that_is_not_allowed_ends_its_sender_with_the_reason(self):
        async def visit(door, session):
            for message in ('{', '{"delete": "cube"}', '{"place": [0, 0, 0, 0, 0, 0, 0]}', '{"pong": [1, -1]}'):
                async with door.connect(session) as sender:
                    await sender.send_str(message)
                    while True:
                        reply = await sender.receive(timeout=LONGEST)
                        if reply.type == aiohttp.WSMsgType.CLOSE:
                            break
                    self.assertEqual(reply.data, 1008)
                    self.assertIn('allowed: ', reply.extra)
            self.refused('an unknown key; allowed: pong, hands, place')
        self.run_with(visit)

    def test_whatever_is_sent_the_door_serves_on(self):
        async def visit(door, session):
            chance = random.Random(1)
            texts = ['{"place": [%s]}' % ', '.join(7 * ['1e308']), '[' * 2000, '{"pong": [NaN, 1]}', '"\\ud800"', '{"hands": 1}', '']
            async with door.connect(session) as looker:
                for k in range(300):
                    async with door.connect(session) as sender:
                        for _ in range(chance.randrange(1, 5)):
                            try:
                                if chance.random() < 0.3:
                                    await sender.send_str(chance.choice(texts))
                                else:
                                    size = chance.choice([messages.HANDS.size, chance.randrange(2000)])
                                    await sender.send_bytes(bytes(chance.randrange(256) for _ in range(size)))
                            except OSError:
                                break  # refused already
                    with socket.create_connection(('127.0.0.1', door.number)) as raw:
                        raw.sendall(chance.choice([b'', b'GET / HTTP/1.1\r\n', b'GET /%s/socket HTTP/1.1\r\nUpgrade: x\r\n\r\n'
                                                   % TOKEN.encode()]) + bytes(chance.randrange(256) for _ in range(200)) +
                                    b'\r\n\r\n')
                    if k % 20 == 0:
                        await answer_until(looker, lambda kind, content: kind == 'ping')
                await answer_until(looker, lambda kind, content: kind == 'ping')
            wait_until(lambda: door.port.counts[-1] == 0, 'the end of all viewers')
            self.assertTrue(all(line.isprintable() and 'Traceback' not in line for line in self.lines), self.lines)
            self.assertFalse([line for line in self.lines if 'Unhandled' in line or 'exception' in line.lower()], self.lines)
            self.assertEqual(door.port.taken, [], 'hands of nobody')
        self.run_with(visit)

    def test_hands_keep_their_bits_and_come_within_a_frame(self):
        async def measure(door, headset, count=400):
            """The delay that 99 % of the frames keep within, and the largest error of a stamp [s]. Where more programs run than
            there are processors it is the median: what is later has waited for them."""
            del door.port.taken[:]
            sent = []
            for k in range(count):
                now = time.monotonic()
                await headset.send_bytes(hands(now, k / 8192.0))  # a float32, and so to be kept to the bit
                sent.append((1000.0 + now, k / 8192.0))
                while time.monotonic() < now + FRAME / 2:
                    try:
                        message = await headset.receive(timeout=max(1e-4, now + FRAME / 2 - time.monotonic()))
                    except asyncio.TimeoutError:
                        break
                    if 'ping' in message.data[:8]:
                        await headset.send_json({'pong': [message.json()['ping'][0], 1e3 * time.monotonic()]})
            await asyncio.sleep(0.1)
            given = iter(value for _, value in sent)
            self.assertTrue(all(any(numbers == 200 * [value] for value in given) for *_, numbers in door.port.taken), 'other bits')
            if len(door.port.taken) < 0.9 * count:
                return math.inf, math.inf  # so busy was the machine that many came together
            then = {value: time for time, value in sent}
            late = sorted(arrival - then[numbers[0]] for arrival, _, _, _, numbers in door.port.taken)
            off = max(abs(stamp - then[numbers[0]]) for _, _, stamp, _, numbers in door.port.taken)
            print('hands: median %.2f ms, p99 %.2f ms; stamps off by at most %.2f ms' %
                  (1e3 * late[len(late) // 2], 1e3 * late[int(0.99 * len(late))], 1e3 * off))
            busy = os.getloadavg()[0] > os.cpu_count()
            return late[int((0.5 if busy else 0.99) * len(late))], off

        async def visit(door, session):
            async with door.connect(session) as headset:
                await put_hands_in(headset)
                await asyncio.sleep(server.SETTLING)
                for _ in range(TRIES):
                    late, off = await measure(door, headset)
                    if late < FRAME and off < 0.005:  # half of a slow round trip
                        return
                self.fail('hands are %g s late, and stamps off by up to %g s' % (late, off))
        self.run_with(visit)

    def test_of_hands_that_came_at_once_only_the_newest_is_published(self):
        async def visit(door, session):
            async with door.connect(session) as headset:
                await put_hands_in(headset)
                await asyncio.sleep(server.SETTLING)
                start, sent = time.monotonic(), threading.Event()
                door.call(sent.wait, 60.0)  # the door is busy so long
                for k in range(20):
                    await headset.send_bytes(hands(start + 0.01 * k, k / 8192.0))
                sent.set()
                wait_until(lambda: door.port.taken, 'hands')
                await asyncio.sleep(0.2)
                self.assertLess(len(door.port.taken), 5)
                self.assertEqual(door.port.taken[-1][4][0], 19 / 8192.0)
                left_out = 20 - len(door.port.taken)
                await answer_until(headset, lambda kind, content: kind == 'ping' and content[3] == left_out)
        self.run_with(visit)

    def test_each_person_has_a_place_and_the_hands_go_when_they_leave(self):
        async def visit(door, session):
            async with door.connect(session) as first:
                await put_hands_in(first)
                async with door.connect(session) as second:
                    await put_hands_in(second)
                    async with door.connect(session) as third:
                        await third.send_json({'hands': True})
                        line = await answer_until(third, lambda kind, content: kind == 'refused')
                        self.assertEqual(line, 'hands of 2 already; allowed: 2')
                    await asyncio.sleep(server.SETTLING)
                    for one in (first, second):
                        await one.send_bytes(hands(time.monotonic()))
                    wait_until(lambda: len(door.port.taken) == 2, 'both')
                    self.assertEqual({(person, frame) for _, person, _, frame, _ in door.port.taken},
                                     {(0, 'headset_1_1'), (1, 'headset_2_1')})
                wait_until(lambda: len(door.port.taken) == 3, 'the end of the second')
                _, person, stamp, _, numbers = door.port.taken[-1]
                self.assertEqual((person, numbers), (1, []))
                self.assertGreater(stamp, door.port.taken[1][2])
        self.run_with(visit, people=2)

    def test_a_new_placing_has_a_frame_of_its_own_which_nodes_know_before_it_is_used(self):
        async def visit(door, session):
            async with door.connect(session) as headset:
                await put_hands_in(headset)
                await asyncio.sleep(server.SETTLING)
                settling, server.SETTLING = server.SETTLING, 2.0  # a busy machine has time for some frames
                self.addCleanup(setattr, server, 'SETTLING', settling)
                await headset.send_json({'place': [1, 0, 0, 0, 0, 0, 1]})
                end = time.monotonic() + LONGEST
                while not door.port.taken or door.port.taken[-1][3] != 'headset_1_2':
                    self.assertLess(time.monotonic(), end, 'the new frame')
                    await headset.send_bytes(hands(time.monotonic()))
                    await asyncio.sleep(FRAME)
                self.assertEqual([[name for name, _ in transforms] for transforms in door.port.mounted],
                                 [['headset_1_1'], ['headset_1_1', 'headset_1_2']])
                used = [frame for _, _, _, frame, _ in door.port.taken]
                self.assertEqual(used, sorted(used))
                self.assertGreater(used.count('headset_1_1'), 3, 'the hands stay while the nodes learn the new frame')
        self.run_with(visit)

    def test_frames_fit_into_five_kilobytes_and_every_body_has_its_turn(self):
        async def visit(door, session):
            door.picture.take_hands(rendered_hands(4))
            async with door.connect(session) as looker:
                seen, frames = set(), 0
                while len(seen) < 300:
                    frames += 1
                    door.picture.take_hands(rendered_hands(4))
                    door.picture.take_objects(object_states(300, 0.001 * frames))
                    door.changed()
                    content = await answer_until(looker, lambda kind, content: kind == 'frame')
                    self.assertLessEqual(len(json.dumps({'frame': content}, separators=(',', ':'))), picture.MAX_FRAME)
                    seen |= {entry[0] for entry in content[2]}
                    self.assertLess(frames, 60)
        self.run_with(visit)

    async def change(self, door, number):
        door.picture.take_objects(object_states(50, 0.001 * number))
        door.picture.take_hands(rendered_hands(4))
        door.changed()
        await asyncio.sleep(0.002)

    def test_who_does_not_read_is_left_behind_and_costs_nothing(self):
        async def visit(door, session):
            idle, viewer = silent_viewer(door)
            most = full = 0
            for number in itertools.count():
                await self.change(door, number)
                most = max(most, viewer.transport.get_write_buffer_size())
                full += most > server.UNSENT
                if full > 200:
                    break
            self.assertLess(most, 4 * server.UNSENT)
            self.assertLess(len(viewer.texts), 20)
            idle.close()
        self.run_with(visit, rate=120.0)

    def test_who_gives_no_sign_of_life_leaves_its_place(self):
        async def visit(door, session):
            idle, viewer = silent_viewer(door)
            most = 0
            for number in itertools.count():
                await self.change(door, number)
                most = max(most, viewer.transport.get_write_buffer_size())
                if viewer not in door.door._viewers:
                    break
            self.assertGreater(most, server.UNSENT, 'it had not read')
            idle.close()
        with mock.patch.object(server, 'PATIENCE', 4.0):
            self.run_with(visit, rate=120.0)

    def test_it_ends_when_it_is_told_whatever_changes_at_that_moment(self):
        async def change_and_stop(door, turns):
            door.changed()
            for _ in range(turns):
                await asyncio.sleep(0)
            await door.stop()
        for turns in range(8):
            with RunningDoor(self.folder) as door:
                stopped = asyncio.run_coroutine_threadsafe(change_and_stop(door.door, turns), door._loop)
                stopped.result(20)

    def test_https_has_a_certificate_of_its_own_that_is_made_once(self):
        import ssl
        names = ['127.0.0.1', 'lab.local']
        files = certificate.own_certificate(os.path.join(self.folder, 'ros'), names)
        self.assertEqual(os.stat(files[1]).st_mode & 0o077, 0, 'nobody else reads the key')
        with open(files[0], 'rb') as first:
            made = first.read()
        self.assertEqual(certificate.own_certificate(os.path.join(self.folder, 'ros'), names[::-1]), files)
        with open(files[0], 'rb') as again:
            self.assertEqual(again.read(), made)
        told = subprocess.run(['openssl', 'x509', '-in', files[0], '-noout', '-ext', 'subjectAltName'], check=True,
                              stdout=subprocess.PIPE, universal_newlines=True).stdout
        self.assertIn('DNS:lab.local', told)
        self.assertIn('IP Address:127.0.0.1', told)
        own = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        own.load_cert_chain(*files)
        trusting = ssl.create_default_context(cafile=files[0])

        async def visit(door, session):
            async with session.get(door.page, ssl=trusting) as reply:
                self.assertEqual(reply.status, 200)
            async with door.connect(session, ssl=trusting) as looker:
                await answer_until(looker, lambda kind, content: kind == 'ping')
        self.run_with(visit, context=own)


if __name__ == '__main__':
    unittest.main()
