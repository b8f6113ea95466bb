"""Reads session folders; docs/study.md has their format. Errors are one line with file and line number."""

import collections
import csv
import io
import itertools
import math
import os

import yaml

from . import program
from .questions import score_of

GRAVITY = 9.80665  # m/s^2
LARGEST_YAML, LARGEST_TABLE = program.MEBIBYTE // 4, 256 * program.MEBIBYTE
MOST = 10 ** 9  # largest count
VERSION = 1
RESULTS = ('completed', 'skipped', 'timed_out', 'aborted')
RATING_COLUMNS = ('condition', 'question', 'score')

# `gravity` is its strength in g. `trials` and `ratings` are lists of dicts; `notes` names what was ignored.
Session = collections.namedtuple('Session', 'folder participant group handedness condition gravity simulated '
                                            'session seed task started trials ratings notes')


class StudyError(Exception):
    """One line that names the file, the line in it, and what is allowed."""

    def __init__(self, text):
        super().__init__(program.one_line(text))


class _Loader(yaml.SafeLoader):
    """Refuses aliases: a few of them can expand to a text of any length."""

    def compose_node(self, parent, index):
        if self.check_event(yaml.AliasEvent):
            raise yaml.composer.ComposerError(None, None, 'has an alias; allowed: the thing itself',
                                              self.peek_event().start_mark)
        return super().compose_node(parent, index)


def name(text):
    text = text.strip()
    if not text:
        raise ValueError('is empty')
    if begins_a_formula(text):
        raise ValueError("'%s' begins as a spreadsheet's formula does; allowed: names that begin with a letter, a digit or '_'"
                         % text)
    return text


def begins_a_formula(text):
    """True if a spreadsheet would compute the text instead of showing it. A number is not a formula."""
    try:
        float(text)
        return False
    except ValueError:
        return text[:1] in ('=', '+', '-', '@', '\t', '\r')


def one_of(*allowed):
    def parse(text):
        if text not in allowed:
            raise ValueError("'%s' is not %s" % (text, ' or '.join(allowed)))
        return text
    return parse


def amount(text):
    """A number, or None if nothing was measured."""
    if not text.strip():
        return None
    value = _number(float, text, 'a number')
    if not math.isfinite(value) or value < 0:
        raise ValueError("'%s' is not a finite number of at least 0" % text)
    return value


def count(text):
    if not text.strip():
        return None
    value = _number(int, text, 'a whole number')
    if not 0 <= value <= MOST:
        raise ValueError("'%s' is not from 0 to %d" % (text, MOST))
    return value


def number(text):
    value = count(text)
    if value is None:
        raise ValueError('is empty')
    return value


def _number(kind, text, what):
    try:
        return kind(text)
    except ValueError:
        raise ValueError("'%s' is not %s" % (text, what)) from None


TRIALS = collections.OrderedDict(
    [('trial', number), ('object', name), ('condition', name), ('repetition', number), ('result', one_of(*RESULTS)),
     ('start', amount)] +
    [(column, amount) for column in ('completion_time', 'manipulation_time', 'maintenance_time', 'release_time')] +
    [('attempts', count), ('drops', count)] +
    [(column, amount) for column in ('path_length', 'grip_force_mean', 'grip_force_max', 'release_drift',
                                     'release_speed')] +
    [('tracking_losses', count)])
# Columns of newer sessions. In older ones grasps are the attempts, and these drops are counted in events.csv.
ADDED = collections.OrderedDict(
    [('grasps', count), ('manipulation_drops', count), ('touches', count)] +
    [(column, amount) for column in ('arrival_speed', 'misplacement', 'misalignment', 'operator_speed', 'operator_spin')])
EVENTS = collections.OrderedDict([('trial', count), ('stage', str), ('event', str)])
CHANGES = collections.OrderedDict([('time', amount), ('event', str), ('detail', str)])
RATINGS = collections.OrderedDict(zip(RATING_COLUMNS, (name, name, str)))


def read_table(path, columns, notes, added=()):
    """Rows as dicts of parsed values; unknown columns, and a last line that a crash cut off, are ignored.
    `added`: columns that may be missing."""
    text = _text_of(path, LARGEST_TABLE, 'utf-8-sig')
    reader = csv.reader(io.StringIO(text, newline=''))
    header = _header(reader, path)
    missing = [column for column in columns if column not in header]
    if missing:
        raise StudyError("%s: line 1: no column '%s'" % (path, missing[0]))
    columns = collections.OrderedDict(list(columns.items()) + [item for item in dict(added).items() if item[0] in header])
    places, rows = [(column, header.index(column), parse) for column, parse in columns.items()], []
    whole = text.endswith(('\n', '\r'))
    lines = list(_lines(reader, path))
    for i, (line, cells) in enumerate(lines):
        if len(cells) < len(header) and not whole and i == len(lines) - 1:
            notes.append('%s: line %d was cut off while it was written: left out' % (path, line))
        elif cells:
            rows.append(_parse_row(path, line, cells, header, places))
    return rows


def _header(reader, path):
    """Names of the columns. Raises StudyError for a separator other than a comma."""
    header = [cell.strip() for _, cells in itertools.islice(_lines(reader, path), 1) for cell in cells]
    for separator, shown in ((';', "';'"), ('\t', 'tabs')):
        if len(header) == 1 and separator in header[0]:
            raise StudyError("%s: line 1: columns are separated by %s; allowed: ','" % (path, shown))
    return header


def _text_of(path, most, encoding='utf-8'):
    try:
        return program.read_text(path, most, encoding)
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError('%s: cannot be read: %s' % (path, getattr(error, 'strerror', None) or error)) from None


def read_yaml(path):
    """Keys with values."""
    text = _text_of(path, LARGEST_YAML)
    try:
        said = yaml.load(text, _Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, 'problem_mark', None)
        raise StudyError('%s: line %d: is not YAML: %s' % (path, mark.line + 1 if mark else 1,
                                                            getattr(error, 'problem', None))) from None
    except RecursionError:
        raise StudyError('%s: is nested too deep' % path) from None
    except Exception as error:  # for invalid values, such as a date in month 13
        raise StudyError('%s: is not YAML: %s' % (path, error)) from None
    if not isinstance(said, dict):
        raise StudyError('%s: is not a list of keys with values' % path)
    return said


def _lines(reader, path):
    try:
        for cells in reader:
            yield reader.line_num, cells
    except csv.Error as error:
        raise StudyError('%s: line %d: %s' % (path, reader.line_num, error)) from None


def _parse_row(path, line, cells, header, places):
    if len(cells) != len(header):
        raise StudyError('%s: line %d: %d fields where the header has %d' % (path, line, len(cells), len(header)))
    row = {}
    for column, place, parse in places:
        try:
            row[column] = parse(cells[place])
        except ValueError as error:
            raise StudyError('%s: line %d: %s: %s' % (path, line, column, error)) from None
    return row


def read_ratings(path, notes):
    """Rows, whose scores are in the range of their question."""
    rows = read_table(path, RATINGS, notes)
    for line, row in enumerate(rows, 2):
        try:
            row['score'] = score_of(row['question'], row['score'])
        except ValueError as error:
            raise StudyError('%s: line %d: score: %s' % (path, line, error)) from None
    return rows


def read_header(folder):
    """Content of session.yaml, validated, as a dict."""
    path = os.path.join(folder, 'session.yaml')
    said = read_yaml(path)
    return {key: _checked(path, said, key, default, parse) for key, default, parse in HEADER}


def _checked(path, said, key, default, parse):
    if said.get(key) is None:
        if default is None:
            raise StudyError("%s: no '%s'" % (path, key))
        return default
    try:
        return parse(said[key])
    except ValueError as error:
        raise StudyError('%s: %s: %s' % (path, key, error)) from None


def _version(value):
    if value != VERSION:
        raise ValueError("'%s' is not %d, the version that this program knows" % (value, VERSION))
    return value


def _strength(vector):
    if not isinstance(vector, list) or len(vector) != 3 or not all(type(x) in (int, float) for x in vector):
        raise ValueError("'%s' is not three numbers [m/s^2]" % (vector,))
    return round(math.sqrt(sum(x * x for x in vector)) / GRAVITY, 3)


def _flag(value):
    if not isinstance(value, bool):
        raise ValueError("'%s' is not true or false" % (value,))
    return value


def _session(value):
    if type(value) is not int or value < 1:
        raise ValueError("'%s' is not a whole number of at least 1" % (value,))
    return value


def _seed(value):
    if type(value) is not int or value < 0:
        raise ValueError("'%s' is not a whole number of at least 0" % (value,))
    return value


def _text(parse):
    def checked(value):
        if isinstance(value, (list, dict)):
            raise ValueError('is a list; allowed: a text')
        return parse(str(value))
    return checked


HEADER = (('version', None, _version), ('participant', None, _text(name)), ('group', None, _text(name)),
          ('handedness', 'unknown', _text(one_of('left', 'right'))), ('condition', None, _text(name)),
          ('gravity', None, _strength), ('simulated', False, _flag),
          ('session', 1, _session), ('seed', 1, _seed), ('task', '', _text(str)), ('started', '', str))


def read_trials(folder, notes):
    """Rows of trials.csv. If there are none, a note says so."""
    path = os.path.join(folder, 'trials.csv')
    there = os.path.lexists(path)
    rows = read_table(path, TRIALS, notes, ADDED) if there else []
    if not rows:
        notes.append('%s: %s: only ratings of this session count' % (path, 'has no trials' if there else 'no such file'))
    return rows


def read_session(folder):
    header, notes = read_header(folder), []
    trials, ratings_file = read_trials(folder, notes), os.path.join(folder, 'ratings.csv')
    ratings = read_ratings(ratings_file, notes) if os.path.exists(ratings_file) else []
    _add_counts(folder, trials, notes)
    _check_trial_numbers(os.path.join(folder, 'trials.csv'), trials)
    trials = _as_begun(folder, trials, notes)
    header.pop('version')
    return Session(folder=folder, trials=trials, ratings=_last_answers(ratings, folder, notes), notes=notes, **header)


def _add_counts(folder, trials, notes):
    """Adds the columns of trials.csv that older sessions lack."""
    if trials and 'manipulation_drops' in trials[0]:
        return
    path, dropped = os.path.join(folder, 'events.csv'), None
    if os.path.exists(path):
        dropped = collections.Counter(row['trial'] for row in read_table(path, EVENTS, notes)
                                      if row['stage'] == 'manipulation' and row['event'] in ('dropped', 'missed'))
    for row in trials:
        row['grasps'] = row['attempts']
        row['manipulation_drops'] = None if dropped is None else dropped[row['trial']]


def _as_begun(folder, trials, notes):
    """The trials without those in which a parameter differed from the start of the session."""
    path = os.path.join(folder, 'events.csv')
    spans = _changed_spans(read_table(path, CHANGES, [])) if trials and _has_columns(path, CHANGES) else []
    kept = []
    for row in trials:
        begin = row['start'] or 0.0
        end = begin + (row['completion_time'] or 0.0)
        said = [what for since, until, what in spans if since <= end and until >= begin]
        if said:
            notes.append('%s: trial %d: %s, which the session was not begun with: left out' % (folder, row['trial'], said[0]))
        else:
            kept.append(row)
    return kept


def _has_columns(path, columns):
    if not os.path.exists(path):
        return False
    text = io.StringIO(_text_of(path, LARGEST_TABLE, 'utf-8-sig'), newline='')
    return set(columns) <= set(_header(csv.reader(text), path))


def _changed_spans(events):
    """(since, until, parameter) of each change of a parameter until its restoration."""
    spans, now = [], {}

    def close(key, until):
        if key in now:
            spans.append(now.pop(key) + (until,))
    for row in events:
        key = row['detail'].split(':')[0]
        if row['event'] == 'session_resumed':
            for each in list(now):
                close(each, row['time'])
        if row['event'] in ('parameter_changed', 'parameter_restored'):
            close(key, row['time'])
        if row['event'] == 'parameter_changed':
            now[key] = (row['time'], row['detail'])
    for key in list(now):
        close(key, float('inf'))
    return [(since, until, what) for since, what, until in spans]


def _check_trial_numbers(path, trials):
    seen = set()
    for row in trials:
        if row['trial'] in seen:
            raise StudyError('%s: trial %d is there twice' % (path, row['trial']))
        seen.add(row['trial'])


def _last_answers(ratings, folder, notes):
    """Keeps the last answer to each question."""
    last = collections.OrderedDict(((row['condition'], row['question']), row) for row in ratings)
    if len(last) < len(ratings):
        notes.append('%s: %d answers replaced by later ones: left out'
                     % (os.path.join(folder, 'ratings.csv'), len(ratings) - len(last)))
    return list(last.values())


def find_sessions(paths):
    """Folders with a session.yaml, at or below the paths, each once, sorted."""
    found = {}
    for path in paths:
        below = [where for where, _, files in os.walk(path) if 'session.yaml' in files]
        if not below:
            raise StudyError('%s: no session.yaml in it or below' % path if os.path.isdir(path) else
                             '%s: no such folder' % path)
        found.update((os.path.realpath(folder), folder) for folder in below)
    return [folder for _, folder in sorted(found.items())]
