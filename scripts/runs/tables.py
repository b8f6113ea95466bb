"""Reads the tables that replay writes into a folder. Faults end in a RunError of one line."""

import json
import os

import pandas

from study import program

LARGEST, LARGEST_TABLE = 16 * program.MEBIBYTE, 16384 * program.MEBIBYTE  # of summary.json, of a table
ALLOWED = '; allowed: a folder that replay has written'

# Columns that are read, by table; those named here are texts, all others are numbers.
COLUMNS = {
    'frames.csv': ('time', 'frame', 'stamp', 'gx', 'gy', 'gz'),
    'bodies.csv': ('name', 'mass', 'static_friction', 'dynamic_friction', 'radius', 'hx', 'hy', 'hz', 'joint', 'joint_kind',
                   'lower', 'upper'),
    'objects.csv': ('time', 'name', 'px', 'py', 'pz', 'qx', 'qy', 'qz', 'qw', 'vx', 'vy', 'vz', 'level', 'held', 'assisted',
                    'assist_fx', 'assist_fy', 'assist_fz', 'frame'),
    'joints.csv': ('time', 'name', 'position'),
    'contacts.csv': ('object', 'hand_id', 'finger', 'x', 'y', 'z', 'nx', 'ny', 'nz', 'depth', 'jx', 'jy', 'jz', 'fx', 'fy',
                     'fz', 'normal_force', 'tangential_force', 'friction_limit', 'touching', 'slipping', 'patch', 'frame', 'torque'),
    'palms.csv': ('time', 'hand_id', 'side', 'px', 'py', 'pz', 'qx', 'qy', 'qz', 'qw', 'confidence', 'lost', 'frame'),
    'hands.csv': ('hand_id', 'side', 'finger', 'bone', 'rendered', 'sx', 'sy', 'sz', 'ex', 'ey', 'ez', 'radius', 'frame'),
    'events.csv': ('time', 'kind', 'object', 'hand_id', 'frame'),
}
TEXTS = {'name', 'object', 'kind', 'joint', 'joint_kind'}
WHOLE = {'frame', 'stamp', 'hand_id', 'side', 'finger', 'bone', 'rendered', 'level', 'held', 'assisted', 'touching', 'slipping',
         'lost'}
# Keys that are read from summary.json, and from its live_run if it has one.
NUMBER = (int, float)
SUMMARY = {'input': str, 'scene': str, 'frames': int, 'simulated_seconds': NUMBER, 'gravity': list, 'contact_model': str,
           'version': str, 'rejected': dict, 'parameters': dict, 'not_known': list, 'state_hash': str}
LIVE_RUN = {'lost_by_queue': int, 'overridden': list, 'parts_at': NUMBER + (type(None),), 'same': int, 'compared': int,
            'changes': list}
KINDS = {str: 'a text', int: 'a whole number', NUMBER: 'a number', list: 'a list', dict: 'names with values'}
OPTIONAL = {'joints.csv'}  # of a scene with joints
MAY_BE_EMPTY = {'lower', 'upper'}


class RunError(Exception):
    """One line: file, line and column, what is wrong, what is allowed."""


def read_table(folder, name, columns=None, as_text=False):
    """A data frame with these columns of a table, by default those of COLUMNS. Raises RunError."""
    path, columns = os.path.join(folder, name), columns or COLUMNS[name]
    if name in OPTIONAL and not os.path.lexists(path):
        return pandas.DataFrame({column: [] for column in columns})
    if not as_text:
        try:
            return _read(path, columns, {column: _kind(column) for column in columns})
        except (ValueError, OverflowError):
            pass  # read again, to name the value that is not a number
    cells = _read(path, columns, str)
    if as_text:
        return cells
    return pandas.DataFrame({column: cells[column] if column in TEXTS else _numbers(path, cells[column]) for column in columns})


def _kind(column):
    return str if column in TEXTS else 'int64' if column in WHOLE else 'float64'


def _read(path, columns, kinds):
    """Raises ValueError for a value that is not a number, RunError for a file that is not a table."""
    try:
        with program.open_regular(path, LARGEST_TABLE) as file:
            cells = pandas.read_csv(file, dtype=kinds, keep_default_na=False, float_precision='round_trip',
                                    usecols=lambda column: column in columns)
    except pandas.errors.EmptyDataError:
        raise RunError('%s: is empty%s' % (path, ALLOWED)) from None
    except OSError as error:
        raise RunError('%s: %s%s' % (path, error.strerror, '' if 'allowed' in error.strerror else ALLOWED)) from None
    except (pandas.errors.ParserError, UnicodeDecodeError) as error:
        raise RunError('%s: is no table: %s%s' % (path, program.one_line(str(error)), ALLOWED)) from None
    missing = [column for column in columns if column not in cells]
    if missing:
        raise RunError("%s: has no column '%s', as of another version%s by this version" % (path, missing[0], ALLOWED))
    return cells[list(columns)]


def _numbers(path, cells):
    """Numbers of a column. Raises RunError that names a value that is not a number, with its line."""
    name = cells.name
    if name in MAY_BE_EMPTY:
        cells = cells.where(cells != '', 'nan')
    try:
        return cells.astype(_kind(name))
    except (ValueError, OverflowError):
        pass
    for line, cell in enumerate(cells, 2):
        try:
            (int if name in WHOLE else float)(cell)
        except ValueError:
            raise RunError("%s, line %d, %s: '%s' is no %s%s" % (path, line, name, program.one_line(cell), 'whole number'
                                                               if name in WHOLE else 'number', ALLOWED)) from None
    raise RunError('%s: %s has a number out of range%s' % (path, name, ALLOWED))


def read_summary(folder):
    """summary.json as a dictionary with all keys that are read. Raises RunError."""
    path = os.path.join(folder, 'summary.json')
    try:
        summary = json.loads(program.read_text(path, LARGEST))
        why = _fault_of(summary, SUMMARY) or _fault_of(summary.get('live_run', {}), 'live_run' in summary and LIVE_RUN or {})
        if not why:
            return summary
    except OSError as error:
        why = error.strerror
    except ValueError as error:
        why = 'is not JSON: %s' % error
    except RecursionError:
        why = 'is nested too deep'
    raise RunError('%s: %s; allowed: a recording, or a folder that replay has written' % (path, program.one_line(why)))


def _fault_of(members, kinds):
    """Text of the fault, or empty."""
    if not isinstance(members, dict):
        return 'is not names with values'
    for name, kind in kinds.items():
        if name not in members:
            return "no '%s' in it" % name
        if not isinstance(members[name], kind):
            return "'%s' is not %s" % (name, KINDS.get(kind, 'a number'))
    if len(members.get('gravity', [0, 0, 0])) != 3 or not all(isinstance(g, NUMBER) for g in members.get('gravity', [])):
        return "'gravity' is not three numbers"
    return ''


class Run:
    """Summary and tables of a folder; hands.csv is read when it is first asked for."""

    def __init__(self, folder):
        self.folder = folder
        self.summary = read_summary(folder)
        self.frames, self.bodies, self.objects, self.joints, self.contacts, self.palms, self.events = (
            read_table(folder, name + '.csv')
            for name in ('frames', 'bodies', 'objects', 'joints', 'contacts', 'palms', 'events'))
        if not len(self.frames):
            raise RunError('%s: has no frame%s' % (os.path.join(folder, 'frames.csv'), ALLOWED))
        for name in ('objects', 'contacts', 'palms', 'events'):
            self._check_frames(name + '.csv', getattr(self, name))
        self._phalanges = None

    def _check_frames(self, name, table):
        wrong = table['frame'][(table['frame'] < 0) | (table['frame'] >= len(self.frames))]
        if len(wrong):
            raise RunError('%s: has a row of frame %d; allowed: 0 to %d, those of frames.csv' % (
                os.path.join(self.folder, name), wrong.iloc[0], len(self.frames) - 1))

    def parameter(self, name, default):
        """A number of the summary's parameters, which has those that are not the default."""
        try:
            return float(self.summary['parameters'].get(name, default))
        except (TypeError, ValueError):
            raise RunError("%s: '%s' is not a number%s" % (os.path.join(self.folder, 'summary.json'), name, ALLOWED)) from None

    @property
    def phalanges(self):
        """Phalanges of the tracked hands."""
        if self._phalanges is None:
            hands = read_table(self.folder, 'hands.csv')
            self._check_frames('hands.csv', hands)
            self._phalanges = hands[hands['rendered'] == 0]
        return self._phalanges


def vectors(table, names):
    """Columns as an array with a row for each of the table's."""
    return table[list(names)].to_numpy(dtype=float)


def write_text(path, text):
    """Writes to a regular file. Raises RunError."""
    if os.path.lexists(path) and not os.path.isfile(path):
        raise RunError('cannot write %s: it is no file; allowed: a file, or a free name' % path)
    try:
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
    except OSError as error:
        raise RunError('cannot write %s: %s' % (path, error.strerror)) from None
