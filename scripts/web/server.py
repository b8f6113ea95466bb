"""Serves the page and communicates with its viewers. Independent of ROS: passes their messages to a Port."""

import asyncio
import collections
import hmac
import json
import logging
import math
import os
import time

from aiohttp import WSMsgType, web

from . import messages
from .device_clock import DeviceClock

PAGE = ('index.html', 'page.css', 'page.js', 'link.js', 'hands.js', 'drawing.js', 'placing.js')
THREE = ('build/three.module.js', 'examples/jsm/controls/OrbitControls.js')  # of three.js, below three/
MAX_CONNECTIONS = 128  # of all viewers; a browser opens up to six for itself
PATIENCE = 10.0  # [s]: for a handshake, for a request on a new connection, and for a sign of life
FIRST_PINGS, FIRST_PERIOD, PERIOD = 8, 0.05, 0.5  # how often a viewer is asked for its time [s]
UNSENT = 8192  # bytes: a viewer with more of them is slow, and waits for its next frame
SETTLING = 0.2  # [s]: until all nodes know a new mount; the previous one holds until then
LONGEST_SILENCE = 60.0  # [s] between two lines about refusals
MAX_REASONS = 50  # counted separately between two lines
STARVED = 1.0  # [s] after which a viewer gets a frame even if nothing moved
HEADERS = {'Cache-Control': 'no-store', 'Referrer-Policy': 'no-referrer', 'X-Content-Type-Options': 'nosniff',
           'Content-Security-Policy': "default-src 'self'; connect-src 'self' ws: wss:; img-src 'self' data:"}


class Port:
    """Interface of the server to ROS."""

    def now(self):
        """[s]"""
        raise NotImplementedError

    def hands(self, person, stamp, frame, numbers, confidences):
        """Publishes joints as from messages.read_hands(); none: no hands."""
        raise NotImplementedError

    def mounts(self, transforms):
        """Publishes all current mounts: name of the frame, and its pose in world."""
        raise NotImplementedError

    def viewers(self, count):
        """Reports the number of viewers."""
        raise NotImplementedError

    def say(self, line):
        """Writes to the log."""
        raise NotImplementedError


class Refusals:
    """Logs why requests were refused: the first at once, then only counts. The log stays small however long refusals continue:
    the time between two lines doubles up to LONGEST_SILENCE, and is 1 s again after as long without a refusal."""

    def __init__(self, say):
        self._say, self._told, self._silence, self._untold = say, -math.inf, 1.0, collections.Counter()

    def add(self, line):
        wait = self._told + self._silence - time.monotonic()
        if wait <= 0.0 and not self._untold:
            self._told, self._silence = time.monotonic(), 1.0
            self._say('refused: ' + line)
            return
        if not self._untold:
            asyncio.get_running_loop().call_later(wait, self._tell)
        self._untold[line if line in self._untold or len(self._untold) < MAX_REASONS else 'other reasons'] += 1

    def _tell(self):
        self._told, self._silence = time.monotonic(), min(2.0 * self._silence, LONGEST_SILENCE)
        untold, self._untold = self._untold, collections.Counter()
        for line, count in untold.most_common(3):
            self._say('refused%s: %s' % (' %d times' % count if count > 1 else '', line))
        rest = sum(untold.values()) - sum(count for _, count in untold.most_common(3))
        if rest > 0:
            self._say('refused: %d more, for other reasons' % rest)


class OneLine(logging.Handler):
    """Logs requests that aiohttp cannot read, without tracebacks."""

    def __init__(self, refusals):
        super().__init__(logging.WARNING)
        self._refusals = refusals

    def emit(self, record):
        error = record.exc_info[1] if record.exc_info else None
        self._refusals.add(_one_line('%s: %s' % (record.getMessage(), error if error else '')))


class TooMany(asyncio.Protocol):
    """Refuses a connection above the limit."""

    def connection_made(self, transport):
        line = 'too many connections; allowed: %d\n' % MAX_CONNECTIONS
        transport.write(('HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nConnection: close\r\n'
                         'Content-Length: %d\r\n\r\n%s' % (len(line), line)).encode())
        transport.close()


class Mount:
    """Pose of a person's space in world. Each placing has its own frame, so that hands are never combined with an earlier or
    later place, live or in a replay."""

    def __init__(self, person):
        self._person, self._count = person, 0
        self.transforms = []  # the current one, and the previous one while it is needed
        self._settled = 0.0

    def clear(self):
        self.transforms = []

    def set(self, pose):
        self._count += 1
        self.transforms = self.transforms[-1:] + [('headset_%d_%d' % (self._person + 1, self._count), pose)]
        self._settled = time.monotonic() + SETTLING

    def frame(self):
        """None: not placed, or not known to all nodes yet."""
        if time.monotonic() >= self._settled:
            self.transforms = self.transforms[-1:]
            return self.transforms[0][0] if self.transforms else None
        return self.transforms[0][0] if len(self.transforms) > 1 else None


class Viewer:
    def __init__(self, socket, transport):
        self.socket, self.transport = socket, transport
        self.clock, self.pings = DeviceClock(), {}
        self.person, self.hands = None, None  # index among those with hands; the newest hands, not published yet
        self.last_stamp, self.left_out = 0.0, 0  # frames of hands that newer ones replaced
        self.texts, self.sent = collections.deque(), {}
        self.news = asyncio.Event()

    def tell(self, **content):
        self.texts.append(json.dumps(content, separators=(',', ':')))
        self.news.set()


class Door:
    def __init__(self, port, picture, folder, three, token, people=1, viewers=16, rate=60.0):
        self._port, self._picture, self._token = port, picture, token
        self._people = [None] * people
        self._mounts = [Mount(person) for person in range(people)]
        self._max_viewers, self._period = viewers, 1.0 / rate
        self._viewers = set()
        self._refusals = Refusals(port.say)
        self._files = {name: os.path.join(folder, name) for name in PAGE}
        self._files.update(('three/' + name, os.path.join(three, name)) for name in THREE)
        self._asked = set()  # protocols that have made a request
        self._shown = {}  # persistent parts: the text that viewers have
        self._changed = asyncio.Event()

    async def start(self, address, port, context=None):
        """Returns the port. OSError: it cannot be had."""
        logger = logging.getLogger('aiohttp.server')
        logger.handlers, logger.propagate = [OneLine(self._refusals)], False
        application = web.Application(client_max_size=messages.MAX_BYTES)
        application.router.add_get('/{path:.*}', self._get)
        self._runner = web.AppRunner(application, access_log=None, keepalive_timeout=PATIENCE, handle_signals=False)
        await self._runner.setup()
        self._server = await asyncio.get_running_loop().create_server(
            self._protocol, address, port, ssl=context, backlog=MAX_CONNECTIONS,
            **({'ssl_handshake_timeout': PATIENCE} if context else {}))
        self._showing = asyncio.ensure_future(self._show())
        return self._server.sockets[0].getsockname()[1]

    async def stop(self):
        self._showing.cancel()
        await asyncio.wait([self._showing])
        for viewer in list(self._viewers):
            await viewer.socket.close(code=1001, message=b'web_door ends')
        self._server.close()
        await self._runner.cleanup()

    def changed(self):
        """The picture has changed. Call in the server's thread."""
        self._changed.set()

    def _protocol(self):
        if len(self._runner.server.connections) >= MAX_CONNECTIONS:
            self._refusals.add('too many connections; allowed: %d' % MAX_CONNECTIONS)
            return TooMany()
        protocol = self._runner.server()
        asyncio.get_running_loop().call_later(PATIENCE, self._end_silent, protocol)
        return protocol

    def _end_silent(self, protocol):
        if protocol not in self._asked:
            protocol.force_close()
        self._asked.intersection_update(self._runner.server.connections)

    def _refuse(self, status, line):
        self._refusals.add(line)
        return web.Response(status=status, text=line + '\n', headers=HEADERS)

    async def _get(self, request):
        self._asked.add(request.protocol)
        token, slash, name = request.match_info['path'].partition('/')
        if not hmac.compare_digest(token.encode(errors='replace'), self._token.encode()):
            return self._refuse(403, 'wrong access token; open the address that web_door printed')
        if not slash:
            raise web.HTTPFound('/%s/' % token)
        name = name or 'index.html'
        if name == 'socket':
            return await self._meet(request)
        if name not in self._files:
            return web.Response(status=404, text='there is no such page\n', headers=HEADERS)
        return web.FileResponse(self._files[name], headers=HEADERS)

    async def _meet(self, request):
        own = '%s://%s' % (request.scheme, request.host)
        origin = request.headers.get('Origin', '')
        if origin != own:
            return self._refuse(403, "origin '%s'; allowed: %s" % (_one_line(origin), _one_line(own)))
        if len(self._viewers) >= self._max_viewers:
            return self._refuse(503, 'too many viewers; allowed: %d' % self._max_viewers)
        socket = web.WebSocketResponse(max_msg_size=messages.MAX_BYTES, compress=False, heartbeat=PATIENCE)
        if not socket.can_prepare(request).ok:
            return self._refuse(400, 'not a WebSocket; allowed: WebSocket')
        await socket.prepare(request)
        viewer = Viewer(socket, request.transport)
        self._viewers.add(viewer)
        self._port.viewers(len(self._viewers))
        tasks = [asyncio.ensure_future(task(viewer)) for task in (self._send, self._ping)]
        try:
            viewer.tell(welcome={'people': len(self._people)})
            for text in self._shown.values():
                viewer.texts.append(text)
            await self._listen(viewer)
        finally:
            for task in tasks:
                task.cancel()
            self._viewers.discard(viewer)
            self._release(viewer)
            self._port.viewers(len(self._viewers))
        return socket

    async def _listen(self, viewer):
        async for message in viewer.socket:
            try:
                if message.type == WSMsgType.BINARY:
                    self._take_hands(viewer, message.data)
                elif message.type == WSMsgType.TEXT:
                    self._take_text(viewer, message.data)
                else:
                    self._refusals.add(_one_line(str(viewer.socket.exception())))
                    return
            except messages.Refusal as refusal:
                line = _one_line(str(refusal))
                self._refusals.add(line)
                await viewer.socket.close(code=1008, message=line[:120].encode())
                return

    def _take_hands(self, viewer, data):
        """Publishes only the newest of several messages that arrived together, so none waits behind another."""
        hands = messages.read_hands(data)
        if viewer.hands is None:
            asyncio.get_running_loop().call_soon(self._publish_hands, viewer)
        else:
            viewer.left_out += 1
        viewer.hands = hands

    def _publish_hands(self, viewer):
        (device, numbers, confidences), viewer.hands = viewer.hands, None
        stamp = viewer.clock.to_ros(1e-3 * device)
        frame = None if viewer.person is None else self._mounts[viewer.person].frame()
        if stamp is None or frame is None or stamp <= viewer.last_stamp:
            return
        viewer.last_stamp = stamp
        self._port.hands(viewer.person, stamp, frame, numbers, confidences)

    def _take_text(self, viewer, text):
        key, value = messages.read_text(text)
        if key == 'pong':
            number, device = value
            asked = viewer.pings.pop(number, None)
            if asked is not None:
                viewer.clock.note(asked, self._port.now(), 1e-3 * device)
        elif key == 'hands':
            self._claim(viewer) if value else self._release(viewer)
        elif viewer.person is not None:
            mount = self._mounts[viewer.person]
            mount.set((value[:3], value[3:]))
            self._port.mounts([transform for other in self._mounts for transform in other.transforms])

    def _claim(self, viewer):
        if viewer.person is None and None not in self._people:
            line = 'hands of %d already; allowed: %d' % (len(self._people), len(self._people))
            self._refusals.add(line)
            viewer.tell(refused=line)
            return
        if viewer.person is None:
            viewer.person = self._people.index(None)
            self._people[viewer.person] = viewer
            self._mounts[viewer.person].clear()
        viewer.tell(person=viewer.person + 1)

    def _release(self, viewer):
        """Reports to the nodes at once that the hands are gone."""
        if viewer.person is None:
            return
        person, viewer.person = viewer.person, None
        self._people[person] = None
        frame = self._mounts[person].frame()
        if frame is not None and viewer.last_stamp > 0.0:
            self._port.hands(person, max(self._port.now(), viewer.last_stamp + 1e-3), frame, [], [])

    async def _ping(self, viewer):
        number = 0
        while True:
            await asyncio.sleep(FIRST_PERIOD if number < FIRST_PINGS else PERIOD)
            if viewer.transport.is_closing():
                viewer.transport.abort()  # it gave no sign of life, and will not read what was left to send
            if len(viewer.pings) > FIRST_PINGS:
                viewer.pings.clear()
            number += 1
            trip, offset = viewer.clock.round_trip, viewer.clock.offset
            viewer.pings[number] = self._port.now()
            viewer.tell(ping=[number, None if trip is None else round(1e3 * trip, 2),
                              None if offset is None else round(offset, 4), viewer.left_out])

    async def _send(self, viewer):
        """Texts all and in order; of frames always the newest, for who is ready for it."""
        try:
            while True:
                await viewer.news.wait()
                viewer.news.clear()
                while viewer.texts:
                    await viewer.socket.send_str(viewer.texts.popleft())
                while viewer.transport.get_write_buffer_size() > UNSENT:
                    await asyncio.sleep(self._period)
                await viewer.socket.send_str(self._picture.frame(viewer.sent))
        except (ConnectionError, RuntimeError):
            pass  # it is gone: _listen() ends by itself

    async def _show(self):
        """Wakes viewers when there is something new, no more often than they are to be shown it."""
        while True:
            # wait_for() can lose a cancellation that comes with what it waits for, before Python 3.12.
            starved = asyncio.get_running_loop().call_later(STARVED, self._changed.set)
            await self._changed.wait()
            starved.cancel()
            self._changed.clear()
            self._picture.expire()
            for kind in ('scene', 'training'):
                text = getattr(self._picture, kind)
                if self._shown.get(kind) != text:
                    self._shown[kind] = text
                    for viewer in self._viewers:
                        viewer.texts.append(text)
            for viewer in self._viewers:
                viewer.news.set()
            await asyncio.sleep(self._period)


def _one_line(text):
    return ''.join(letter if letter.isprintable() else '?' for letter in text)[:200]
