#!/usr/bin/python3
"""Keeps web.launch busy for hours: one browser sends a scripted hand at 60 Hz, one watches, one comes and goes. Prints memory,
open files and log of the nodes, and exits with 1 if any of them grows after the first tenth of the time."""
import asyncio
import csv
import json
import math
import os
import socket
import struct
import subprocess
import sys
import threading
import time

import aiohttp
import rospy
from mr_hand_interaction.msg import InteractionEvent

from soak_live import is_flat, looks, soak

RATE = 60
VISIT = 10.0  # [s] that the third browser stays
NODES = ('/web_door', '/interaction_node')
FINGERS = ('thumb', 'index', 'middle', 'ring', 'pinky')
RADIUS = 0.008  # [m]
ABSENT = 25 * [math.nan, math.nan, math.nan, math.nan]


def joints(row):
    """x, y, z and radius of the 25 joints of WebXR in world, of a row in the Leap's axes; none: no hand."""
    names = ['wrist'] + ['%s_j%d' % (finger, j) for finger in FINGERS for j in range(finger == 'thumb', 5)]
    if not row['palm_x']:
        return ABSENT
    points = [[float(row['%s_%s' % (name, axis)]) for axis in 'xyz'] for name in names]
    return [number for x, y, z in points for number in (x, -z, y, RADIUS)]


def scripted_hand(folder):
    file = os.path.join(folder, 'hand.csv')
    subprocess.run(['rosrun', 'mr_hand_interaction', 'synthetic_hand_node', '--csv', file, '--motion', 'grasp_cube', '--rate',
                    str(RATE)], check=True)
    with open(file, encoding='utf-8') as rows:
        return [joints(row) for row in csv.DictReader(rows)]


class Browsers:
    def __init__(self, port, rows):
        self.address, self.rows = 'http://127.0.0.1:%d' % port, rows
        self.sent, self.frames, self.visits, self.over = 0, 0, 0, False
        self.thread = threading.Thread(target=lambda: asyncio.run(self._browse()), daemon=True)
        self.thread.start()

    async def _browse(self):
        async with aiohttp.ClientSession() as session:
            await asyncio.gather(self._give_hands(session), self._look_on(session), self._visit(session))

    def _connect(self, session):
        return session.ws_connect(self.address + '/soak/socket', origin=self.address, max_msg_size=0)

    async def _answer(self, door):
        async for message in door:
            (kind, content), = json.loads(message.data).items()
            self.frames += kind == 'frame'
            if kind == 'ping':
                await door.send_json({'pong': [content[0], 1e3 * time.monotonic()]})
            if self.over:
                return

    async def _give_hands(self, session):
        async with self._connect(session) as door:
            answering = asyncio.ensure_future(self._answer(door))
            await door.send_json({'hands': True})
            await door.send_json({'place': [0, 0, 0, 0, 0, 0, 1]})
            due = time.monotonic()
            while not self.over:
                numbers = self.rows[self.sent % len(self.rows)]
                flags = 25 * [0 if numbers is ABSENT else 2]
                await door.send_bytes(struct.pack('<d200f50B', 1e3 * time.monotonic(), *ABSENT, *numbers, *(25 * [0]), *flags))
                self.sent += 1
                due = max(due + 1.0 / RATE, time.monotonic() - 1.0)
                await asyncio.sleep(max(0.0, due - time.monotonic()))
            await answering

    async def _look_on(self, session):
        async with self._connect(session) as door:
            await self._answer(door)

    async def _visit(self, session):
        """Loads the page, looks on, goes."""
        while not self.over:
            for path in ('/soak/', '/soak/page.js'):
                async with session.get(self.address + path) as reply:
                    await reply.read()
            async with self._connect(session) as door:
                end = time.monotonic() + VISIT
                while time.monotonic() < end and not self.over:
                    await door.receive(timeout=10)
            self.visits += 1


def watch(hours, browsers, grasps):
    seen = []
    print('%6s %9s %6s %9s %6s %9s %8s %8s %7s %7s' % ('min', 'door/MiB', 'files', 'node/MiB', 'files', 'log/bytes', 'hands',
                                                       'frames', 'visits', 'grasps'))
    for look in looks(hours, *NODES):
        seen.append(look)
        door, node = zip(look.memory, look.files)
        print('%6.1f %9.2f %6d %9.2f %6d %9d %8d %8d %7d %7d' % (look.minutes, *door, *node, look.log, browsers.sent,
                                                                 browsers.frames, browsers.visits, len(grasps)), flush=True)
        if not browsers.thread.is_alive():
            print('a browser was refused')
            return False
    return is_flat(seen, hours) and bool(grasps)


def wait_for(holds, what):
    end = time.monotonic() + 120.0
    while not holds():
        if time.monotonic() > end:
            sys.exit('soak_web: waited 120 s for ' + what)
        time.sleep(0.1)


def listens(port):
    with socket.socket() as one:
        return one.connect_ex(('127.0.0.1', port)) == 0


def browse(hours, folder, start):
    grasps = []
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        port = free.getsockname()[1]
    start('roslaunch', 'mr_hand_interaction', 'web.launch', 'scene:=cube', 'token:=soak', 'port:=%d' % port)
    rospy.init_node('soak', disable_signals=True)
    rospy.Subscriber('interaction_events', InteractionEvent,
                     lambda event: event.kind == InteractionEvent.GRASP_BEGIN and grasps.append(event.header.stamp))
    wait_for(lambda: listens(port), 'the door')
    browsers = Browsers(port, scripted_hand(folder))
    flat = watch(hours, browsers, grasps)
    browsers.over = True
    browsers.thread.join(30)
    return flat


if __name__ == '__main__':
    sys.exit(soak(browse))
