"""The path of a fingertip, raw against filtered, as the paper's figure 4."""

import collections
import itertools
import os

import numpy as np
import pandas

from . import program
from .session_folder import StudyError
from .style import FILTERED, INK, RAW, finish, new_figure, save

INDEX, DISTAL, TRACKED = 1, 3, 0
COLUMNS = ('time', 'hand_id', 'finger', 'bone', 'rendered', 'ex', 'ey', 'ez')
GAP = 5  # median intervals without a frame interrupt the line
CLOSE_UP = 1.0  # [s] are shown against time
LONGEST = 20.0  # [s] of a path are drawn
AXES = 'xyz'

Path = collections.namedtuple('Path', 'time position length')


def read_path(file):
    """Path of the index fingertip [m] of the hand that is seen longest, from a hands.csv of replay."""
    table = _read_numbers(file)
    wanted = (table['finger'] == INDEX) & (table['bone'] == DISTAL) & (table['rendered'] == TRACKED)
    table = table[wanted]
    if len(table) < 2:
        raise StudyError('%s: fewer than two positions of the index fingertip (finger 1, bone 3, rendered 0)' % file)
    table = table[table['hand_id'] == table['hand_id'].value_counts().sort_index().idxmax()].sort_values('time', kind='mergesort')
    return _path(table['time'].values, table[['ex', 'ey', 'ez']].values)


def _read_numbers(file):
    """The columns needed, as these files have millions of lines. A last line that a crash cut off is left out."""
    try:
        program.open_regular(file).close()
        table = pandas.read_csv(file, skipinitialspace=True, index_col=False)
        if not _ends_with_line(file):
            table = table.iloc[:-1].copy()
    except OSError as error:
        raise StudyError('%s: cannot be read: %s' % (file, error.strerror or error)) from None
    except (ValueError, UnicodeDecodeError) as error:  # pandas names the line
        raise StudyError('%s: is not a table: %s' % (file, str(error).strip())) from None
    for column in COLUMNS:
        if column not in table.columns:
            raise StudyError("%s: line 1: no column '%s'" % (file, column))
        numbers = pandas.to_numeric(table[column], errors='coerce').astype(float)
        bad = np.flatnonzero(~np.isfinite(numbers.values))
        if len(bad):
            raise StudyError("%s: line %d: %s: '%s' is not a finite number"
                             % (file, bad[0] + 2, column, table[column].iloc[bad[0]]))
        table[column] = numbers
    return table


def _ends_with_line(file):
    with open(file, 'rb') as opened:
        opened.seek(-1, os.SEEK_END)
        return opened.read(1) in b'\r\n'


def _path(time, position):
    steps = np.linalg.norm(np.diff(position, axis=0), axis=1)
    return Path(time, position, float(steps[~_gaps(time)].sum()))


def _excerpt(path, start, duration):
    """The path from `start`, or from earlier if it ends too soon."""
    start = max(min(start, path.time[-1] - duration), path.time[0])
    some = (path.time >= start) & (path.time <= start + duration)
    return _path(path.time[some], path.position[some])


def _gaps(time):
    intervals = np.diff(time)
    return intervals > GAP * np.median(intervals) if len(intervals) else np.zeros(0, bool)


def draw_trajectories(raw, filtered, title, source, folder, file_name):
    """Above: both paths in the plane of their greatest extent, at one scale. Below: the shakiest seconds."""
    start = _shakiest(raw, filtered)
    raw, filtered = (_excerpt(path, start + (CLOSE_UP - LONGEST) / 2, LONGEST) for path in (raw, filtered))
    extent = np.ptp(raw.position, axis=0)
    plane = max(itertools.combinations(range(3), 2), key=lambda axes: extent[list(axes)].sum())
    figure, panels = new_figure(4, 4.3, 3.0, gridspec_kw={'height_ratios': [3, 2]})
    paths = ((raw, RAW, '(a) raw'), (filtered, FILTERED, '(b) filtered'))
    for axes, (path, colour, label) in zip(panels[0], paths):
        axes.plot(*_with_gaps(path.time, path.position[:, plane]).T, color=colour, lw=1.0)
        axes.plot(*path.position[0, plane], 'o', color=INK, markersize=4)
        axes.annotate('start', path.position[0, plane], xytext=(5, 4), textcoords='offset points', fontsize=8)
        axes.set_title('%s: %.2f m long' % (label, path.length), loc='left')
        axes.set_xlabel('%s [m]' % AXES[plane[0]])
        axes.set_aspect('equal', adjustable='datalim')
        axes.locator_params(nbins=6)
    panels[0, 0].set_ylabel('%s [m]' % AXES[plane[1]])
    _same_limits(panels[0], raw.position[:, plane])
    _draw_close_up(panels[1], [_excerpt(path, start, CLOSE_UP) for path in (raw, filtered)], plane)
    finish(figure, title, 'Tip of the index finger in the world frame, at most %g s. Below: where the raw path is '
           'shakiest.' % LONGEST, source)
    return save(figure, folder, file_name)


def _with_gaps(time, values):
    """Rows of nan where tracking was lost, so that no line is drawn across."""
    return np.insert(values, np.flatnonzero(_gaps(time)) + 1, np.nan, axis=0)


def _same_limits(panels, positions):
    low, high = positions.min(axis=0), positions.max(axis=0)
    margin = 0.06 * max(*(high - low), 1e-3)
    for axes in panels:
        axes.set_xlim(low[0] - margin, high[0] + margin)
        axes.set_ylim(low[1] - margin, high[1] + margin)


def _draw_close_up(panels, paths, plane):
    for axes, coordinate in zip(panels, plane):
        for path, colour, width in zip(paths, (RAW, FILTERED), (0.9, 1.6)):
            table = _with_gaps(path.time, np.column_stack([path.time, 1e3 * path.position[:, coordinate]]))
            axes.plot(*table.T, color=colour, lw=width)
        axes.set_xlabel('time [s]')
        axes.set_ylabel('%s [mm]' % AXES[coordinate])
        axes.margins(x=0)
    for x, colour, label in ((0.72, RAW, 'raw'), (0.86, FILTERED, 'filtered')):
        panels[0].text(x, 1.03, label, color=colour, transform=panels[0].transAxes, fontsize=9)


def _shakiest(raw, filtered):
    """Start of the CLOSE_UP seconds with the largest second differences of raw minus filtered, which exclude the lag."""
    smooth = np.column_stack([np.interp(raw.time, filtered.time, column) for column in filtered.position.T])
    steps = np.diff(raw.position - smooth, axis=0)
    steps[_gaps(raw.time)] = 0.0
    square = np.concatenate([[0.0], np.sum(np.diff(steps, axis=0) ** 2, axis=1), [0.0]])
    ends = np.searchsorted(raw.time, raw.time + CLOSE_UP)
    total = np.concatenate([[0.0], np.cumsum(square)])
    full = raw.time + CLOSE_UP <= max(raw.time[-1], raw.time[0] + CLOSE_UP)
    means = np.where(full, (total[ends] - total[:-1]) / np.maximum(ends - np.arange(len(square)), 1), -1.0)
    return float(raw.time[int(np.argmax(means))])
