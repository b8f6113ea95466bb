"""Filters: jitter, lag, lag of a hand that sets off, and grasps held."""
import collections
import re
import tempfile

from .measuring import CORE, Recipe, draw, rows_of, rows_of_file, run, table

FILTERS = collections.OrderedDict([
    ('none', 'none'), ('window=3', '`window`, F = 3'), ('one_euro', '`one_euro`, beta 100, min_cutoff 2'),
    ('default', '`constant_velocity`, default'), ('agility', 'the same, agility 12')])


def _filter_name(row):
    if row['default'] == '1':
        return 'default'
    if row['series'] == 'none' or row['setting'] == 'window=3':
        return row['series'] if row['series'] == 'none' else 'window=3'
    if row['series'] == 'one_euro beta=100' and re.search(r'min_cutoff=2(\D|$)', row['setting']):
        return 'one_euro'
    same = re.search(r'acceleration=0\.1(\D|$)', row['setting'])
    return 'agility' if row['series'] == 'constant_velocity agility=12' and same else None


def filters():
    with tempfile.TemporaryDirectory() as folder:
        run('filters', '--output', folder)
        draw('filters', 'plot_filters.py', folder)
        recorded, held = rows_of_file(folder, 'filters.csv'), rows_of_file(folder, 'filters_held.csv')
        started = rows_of_file(folder, 'filters_start.csv')
    lines = []
    for panel in dict.fromkeys((row['input'], row['frames_per_s']) for row in recorded):
        of_panel = {_filter_name(row): row for row in recorded if (row['input'], row['frames_per_s']) == panel}
        lines.append(['**%s, %s frames/s**' % panel] + [''] * 4)
        for name, label in FILTERS.items():
            row = of_panel[name]
            lines.append([label, '%.3f' % float(row['jitter_mm']),
                          '%.1f (%.1f)' % (abs(round(float(row['lag_ms']), 1)), float(row['lag_p90_ms'])),
                          *['%.2f' % float(row[key]) for key in ('moving_error_mm', 'still_error_mm')]])
    of_held = {_filter_name(row): row for row in held}
    grasps = rows_of(run('noisy_grasps', 'grasp_cube'))
    return {
        'recorded': table(['', 'jitter [mm]', 'lag [ms]', 'error moving [mm]', 'error still [mm]'], lines),
        'held': table(['', 'true slip [mm]', 'displacement [mm]', "cube's jitter [mm]", 'gain of a shake'], [
            [label] + ['%.3f' % float(of_held[name][key]) for key in ('true_slip_mm', 'displacement_mm', 'jitter_mm')]
            + ['%.2f' % float(of_held[name]['gain'])] for name, label in FILTERS.items()]),
        'start': _start(started),
        'grasps': _grasps(grasps),
    }, {}


def _start(rows):
    cells = {(row['filter'], row['noise_mm'], row['frames_per_s']): row for row in rows}
    rates = list(dict.fromkeys(row['frames_per_s'] for row in rows))
    return table(['noise'] + ['%s, %s Hz' % (what, rate) for what in ('lag', 'rest') for rate in rates], [
        ['%s mm' % noise] + ['%s (%s)' % tuple(form % float(cells[name, noise, rate][key]) for name in ('constant_velocity', 'one_euro'))
                             for key, form in (('lag_mm', '%.1f'), ('rest_mm', '%.2f')) for rate in rates]
        for noise in dict.fromkeys(row['noise_mm'] for row in rows)])


def _grasps(rows):
    rows = [row for row in rows if float(row['dropped']) == 0]
    columns = list(dict.fromkeys((row['where'], row['frames_per_s']) for row in rows))
    cells = {(row['correlation'], row['noise_mm'], row['where'], row['frames_per_s']): row for row in rows}
    lines = [['%g mm%s' % (float(noise), ', correlation %g' % float(correlation) if float(correlation) else '')] + [
        '%(held_estimated)s (%(held_fixed)s)' % cells[(correlation, noise, *column)] for column in columns]
             for correlation in dict.fromkeys(row['correlation'] for row in rows)
             for noise in dict.fromkeys(row['noise_mm'] for row in rows)]
    return table(['noise'] + ['%s, %.0f Hz' % (where, float(rate)) for where, rate in columns],
                 [line for line in lines if set(line[1:]) != {'100 (100)'}])


RECIPES = {
    'filters': Recipe('15 minutes', CORE + ['benchmark/filters', 'benchmark/noisy_grasps.cpp', 'benchmark/plot_filters.py'], filters,
                      ['filters']),
}
