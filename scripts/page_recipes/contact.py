"""Refinements of contact: benefit, cost, and tiers of geometry; speed of a body that a hand hits."""
import collections
import csv
import io
import math
import re

from .measuring import CORE, Recipe, draw_printed, run


def contact():
    benefits, costs = run('ablation').split('\n\nA step of scene (a): ')
    instructions, costs = costs.split(' instructions', 1)
    costs = re.findall(r'^\| (`\w+`) \| .*\(([-+][\d.]+) %\) \|', costs, re.MULTILINE)
    speeds = run('speed_against_mass')
    draw_printed('speed_against_mass', 'plot_speed_against_mass.py', speeds)
    tiers = collections.OrderedDict()
    for line in run('geometry_tiers').split('\n'):
        found = re.match(r'(.{18}) +([-\d.]+) +([-\d.]+) +([-\d.]+) +([-\d.]+)$', line)
        if found:
            tiers.setdefault(found.group(1).strip(), []).append([float(x) for x in found.groups()[1:]])
    return {
        'refinements': benefits.strip(), 'printed': run('ablation', '--printed').strip(),
        'instructions': _range_of(costs, instructions), 'speeds': _table_of(speeds),
        'tiers': ', '.join('%s %.2f mm (%.1f)' % (name, sides[0][0], sides[0][3] / next(
            some for n, some in tiers.items() if n.startswith('capsule'))[0][3]) for name, sides in tiers.items()),
    }, {}


def _table_of(speeds):
    """Rows of the impact's speed, and of that after a further 0.4 s."""
    found = {}
    for row in csv.DictReader(io.StringIO(speeds)):
        found.setdefault(round(math.log10(float(row['mass_kg'])), 3), []).append('%.2g, %.2g' % (
            float(row['impact_m_s']), float(row['pushed_m_s'])))
    rows = ['| %g kg | %s |' % (10 ** power, ' | '.join(cells)) for power, cells in found.items() if power == int(power)]
    return '\n'.join(['| cube | fingertip | palm | the paper\'s hand |', '|---|---|---|---|'] + rows)


def _range_of(costs, instructions):
    least, most = sorted(costs, key=lambda cost: float(cost[1]))[::len(costs) - 1]
    return '%s %% (%s) to %s %% (%s) of %s instructions' % (least[1], least[0], most[1], most[0], instructions)


RECIPES = {
    'contact': Recipe('5 minutes', CORE + ['benchmark/ablation', 'benchmark/geometry_tiers.cpp', 'benchmark/speed_against_mass.cpp',
                                    'benchmark/plot_speed_against_mass.py', 'modelling'], contact, ['speed_against_mass']),
}
