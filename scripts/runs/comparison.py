"""When, where and by how much the objects of two runs diverge."""

import collections
import json
import os

import numpy

from study import program

from .tables import LARGEST, read_table

# The compared columns; columns that came later are not compared.
MOTION = ('time', 'name', 'px', 'py', 'pz', 'qx', 'qy', 'qz', 'qw', 'vx', 'vy', 'vz', 'wx', 'wy', 'wz')
TOLERANCE = (1e-9, 1e-9)  # m between centres of mass, rad between orientations

# Divergence of an object: its first frame [s], the position there in the first run [m], the differences there and their maxima
# afterwards [m, rad]; and the reason if it is not the pose.
Parting = collections.namedtuple('Parting', 'object time place distance angle max_distance max_angle why')
# `near_misses`: within the tolerance, though not the same to the last digit. `same_end`: the states in which the runs end,
# contacts and filters too; None where a run does not have its hash.
Comparison = collections.namedtuple('Comparison', 'tolerance objects partings near_misses same_end')


class Pair:
    """Both paths of an object, in the frames that both runs have up to the first that only one has."""

    def __init__(self, name, first, second):
        self.name, self.first, self.second = name, first, second
        count = min(len(first), len(second))
        other_time = numpy.flatnonzero(first['time'][:count].to_numpy() != second['time'][:count].to_numpy())
        self.count = count = int(other_time[0]) if len(other_time) else count
        a, b = (numpy.array(table[:count].drop(columns='cells')) for table in (first, second))
        self.place = a[:, 1:4]
        self.distance = numpy.linalg.norm(a[:, 1:4] - b[:, 1:4], axis=1)
        self.angle = _angles(a[:, 4:8], b[:, 4:8])
        self.differs = first['cells'][:count].to_numpy() != second['cells'][:count].to_numpy()

    def apart(self, tolerance):
        """Frames in which they differ; a value that is not a number differs."""
        if max(tolerance) <= 0.0:
            return self.differs
        return self.differs & ~((self.distance <= tolerance[0]) & (self.angle <= tolerance[1]))

    def parting_from(self, i):
        return Parting(self.name, self.first['time'].iloc[i], self.place[i], self.distance[i], self.angle[i],
                       numpy.fmax.reduce(self.distance[i:]), numpy.fmax.reduce(self.angle[i:]), '')

    def end(self):
        """Divergence if one run has a frame that the other lacks, else None."""
        i, ends = self.count, [self.count == len(table) for table in (self.first, self.second)]
        if all(ends):
            return None
        if any(ends):
            return alone(self.name, self.second if ends[0] else self.first, i, 'one run ends')
        earlier = self.first['time'].iloc[i] < self.second['time'].iloc[i]
        return alone(self.name, self.first if earlier else self.second, i, 'a frame of one alone')


def alone(name, table, i, why):
    row = table.iloc[i]
    return Parting(name, row['time'], numpy.array([row['px'], row['py'], row['pz']], float), 0.0, 0.0, 0.0, 0.0, why)


def _angles(a, b):
    """Between orientations [rad]."""
    real = numpy.sum(a * b, axis=1)
    vector = a[:, 3:] * b[:, :3] - b[:, 3:] * a[:, :3] - numpy.cross(a[:, :3], b[:, :3])
    return 2.0 * numpy.arctan2(numpy.linalg.norm(vector, axis=1), numpy.abs(real))


def paths_of(folder):
    """{object: its rows as numbers, and their text}."""
    table = read_table(folder, 'objects.csv', MOTION)
    texts = read_table(folder, 'objects.csv', MOTION, as_text=True)
    table['cells'] = texts['time'].str.cat([texts[column] for column in MOTION[2:]], sep=',')
    return {name: rows.drop(columns='name').reset_index(drop=True) for name, rows in table.groupby('name')}


def end_hash(folder):
    """Hash of a run's final state, if its summary.json has it."""
    try:
        return json.loads(program.read_text(os.path.join(folder, 'summary.json'), LARGEST))['state_hash']
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def compare(first, second, tolerance=TOLERANCE):
    """Compares objects.csv, and state_hash in summary.json, of two folders. Raises RunError."""
    a, b = paths_of(first), paths_of(second)
    names, partings, near_misses = sorted(set(a) | set(b)), [], []
    for name in names:
        if name not in a or name not in b:
            partings.append(alone(name, a.get(name, b.get(name)), 0, 'an object of one alone'))
            continue
        pair = Pair(name, a[name], b[name])
        apart, differs = numpy.flatnonzero(pair.apart(tolerance)), numpy.flatnonzero(pair.differs)
        parting = pair.parting_from(apart[0]) if len(apart) else pair.end()
        if parting:
            partings.append(parting)
        elif len(differs):
            near_misses.append(pair.parting_from(differs[0]))
    hashes = [end_hash(folder) for folder in (first, second)]
    return Comparison(tolerance, len(names), *(sorted(told, key=lambda parting: parting.time) for told in (partings, near_misses)),
                      hashes[0] == hashes[1] if all(hashes) else None)


def text_of(comparison):
    """A line for each object that diverges, or differs at all, one for the others, and whether the bits are equal."""
    lines = [_line(parting, 'diverges at') for parting in comparison.partings]
    lines += [_line(parting, 'stays within the tolerance, but differs from') for parting in comparison.near_misses]
    tolerance = comparison.tolerance
    within = 'equal to the last digit' if max(tolerance) <= 0.0 else 'within %s in every frame' % _apart(*tolerance)
    lines.append('%d of %d objects %s' % (comparison.objects - len(comparison.partings), comparison.objects, within))
    same = not comparison.partings and not comparison.near_misses
    end = {None: 'not known of both runs', True: 'equal bits', False: 'different bits'}[comparison.same_end]
    lines.append('objects: %s; the state at the end: %s' % ('equal bits in every frame' if same else 'different bits', end))
    return '\n'.join(lines) + '\n'


def _line(parting, what):
    line = '%s: %s %.6g s near (%.4g, %.4g, %.4g) m' % ((parting.object, what, parting.time) + tuple(parting.place))
    if parting.why:
        return '%s: %s' % (line, parting.why)
    return '%s by %s, at most by %s' % (line, _apart(parting.distance, parting.angle),
                                        _apart(parting.max_distance, parting.max_angle))


def _apart(distance, angle):
    return '%.3g m and %.3g rad' % (distance, angle)
