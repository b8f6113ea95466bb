"""A door without ROS, in a thread of its own, and viewers of it."""
import asyncio
import os
import struct
import sys
import threading
import time

import aiohttp

PACKAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir)
sys.path.insert(0, os.path.join(PACKAGE, 'scripts'))
from web import picture, server  # noqa: E402

TOKEN = 'secret'
LONGEST = 600.0  # [s], far beyond what is needed, however busy the machine is


def three_folder(folder):
    """Stands for three.js, of which these tests need nothing."""
    for name in server.THREE:
        file = os.path.join(folder, name)
        os.makedirs(os.path.dirname(file), exist_ok=True)
        with open(file, 'w', encoding='utf-8') as stream:
            stream.write('// three.js\n')
    return folder


class RecordingPort(server.Port):
    def __init__(self):
        self.taken, self.mounted, self.lines, self.counts = [], [], [], []

    def now(self):
        return 1000.0 + time.monotonic()

    def hands(self, person, stamp, frame, numbers, confidences):
        self.taken.append((self.now(), person, stamp, frame, numbers))

    def mounts(self, transforms):
        self.mounted.append(transforms)

    def viewers(self, count):
        self.counts.append(count)

    def say(self, line):
        self.lines.append(line)


class RunningDoor:
    """For the length of a block. `call` runs a function in its thread."""

    def __init__(self, folder, context=None, three=None, **options):
        """`three`: folder of three.js; none: something stands for it."""
        self.port, self.picture = RecordingPort(), picture.Picture()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._three, self._context, self._options = three or three_folder(folder), context, options

    def __enter__(self):
        self._thread.start()
        self.number = asyncio.run_coroutine_threadsafe(self._start(), self._loop).result(20)
        self.origin = 'http%s://127.0.0.1:%d' % ('s' if self._context else '', self.number)
        self.page = '%s/%s/' % (self.origin, TOKEN)
        return self

    async def _start(self):
        self.door = server.Door(self.port, self.picture, os.path.join(PACKAGE, 'web'), self._three, TOKEN,
                                **self._options)
        return await self.door.start('127.0.0.1', 0, self._context)

    def call(self, function, *arguments):
        self._loop.call_soon_threadsafe(function, *arguments)

    def changed(self):
        self._loop.call_soon_threadsafe(self.door.changed)

    def __exit__(self, *_):
        asyncio.run_coroutine_threadsafe(self.door.stop(), self._loop).result(20)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def connect(self, session, **options):
        return session.ws_connect(self.page + 'socket', origin=self.origin, max_msg_size=0, **options)


def hands(device, value=0.0625):
    """A message with both hands; device: its time [s]; value: of each number, at most the largest radius."""
    return struct.pack('<d200f50B', 1e3 * device, *(200 * [value]), *(50 * [2]))


async def answer_until(socket, done, longest=LONGEST):
    """Answers pings until done(kind, content)."""
    end = time.monotonic() + longest
    while time.monotonic() < end:
        message = await socket.receive(timeout=longest)
        if message.type != aiohttp.WSMsgType.TEXT:
            raise AssertionError('the door has ended it: %s' % (message,))
        (kind, content), = message.json().items()
        if kind == 'ping':
            await socket.send_json({'pong': [content[0], 1e3 * time.monotonic()]})
        if done(kind, content):
            return content
    raise AssertionError('nothing came within %g s' % longest)


async def put_hands_in(socket, place=(0, 0, 0, 0, 0, 0, 1)):
    """Until hands are taken: a place, a clock, and the mount known to all."""
    await socket.send_json({'hands': True})
    await answer_until(socket, lambda kind, content: kind == 'person')
    await socket.send_json({'place': list(place)})
    await answer_until(socket, lambda kind, content: kind == 'ping' and content[0] > 8)
