#!/usr/bin/env python3
"""Says, per scene of a speed_accuracy.csv, which points of other engines are both faster and more accurate than one on
our Pareto front, and which are on the front of all engines together."""

import collections
import csv
import math
import sys

OURS = 'mr_hand_interaction'
ROUNDING = 1e-12  # smaller errors are equal

Point = collections.namedtuple('Point', 'cost error engine setting step time')  # cost: ms per simulated second


def read(path):
    scenes = collections.OrderedDict()
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            step, time = float(row['step_s']), float(row['us_per_step'])
            points = scenes.setdefault(row['scene'], [])
            if row['failed'] == '0' and time > 0:
                error = max(abs(float(row['error'])), ROUNDING)
                points.append(Point(1e-3 * time / step, error, row['engine'], row['setting'], step, time))
    return scenes


def front(points):
    """Those that no other beats in both cost and error."""
    best, result = math.inf, []
    for point in sorted(points):
        if point.error < best:
            result.append(point)
            best = point.error
    return result


def described(point):
    return '%.2g at %.3g us (%.3g ms per s): %s, %s, step %.3g ms' % (
        point.error, point.time, point.cost, point.engine, point.setting, 1e3 * point.step)


def compare(scene, points):
    # The whole frame is for information: no peer does its part.
    ours = [p for p in points if p.engine == OURS and 'whole frame' not in p.setting]
    peers = [p for p in points if p.engine != OURS]
    lines = []
    for own in front(ours):
        better = [p for p in peers if p.cost < own.cost and p.error < own.error]
        if better:
            lines += ['  ours   ' + described(own), '  beaten ' + described(min(better, key=lambda p: p.error))]
    for peer in front(peers):
        if not any(o.cost <= peer.cost and o.error <= peer.error for o in ours):
            lines.append('  front  ' + described(peer))
    print(scene + ('' if lines else ': ours alone'))
    for line in lines:
        print(line)


def main(arguments):
    if len(arguments) != 2:
        print('usage: compare_fronts.py FILE.csv', file=sys.stderr)
        return 2
    for scene, points in read(arguments[1]).items():
        compare(scene, points)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv))
