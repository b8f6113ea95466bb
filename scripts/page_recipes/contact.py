"""Refinements of contact: benefit, cost, and tiers of geometry; speed of a body that a hand hits."""
import collections
import re

from .measuring import CORE, Recipe, draw_printed, run


def contact():
    benefits, costs = run('ablation').split('\n\nA step of scene (a): ')
    instructions, costs = costs.split(' instructions', 1)
    costs = re.findall(r'^\| (`\w+`) \| .*\(([-+][\d.]+) %\) \|', costs, re.MULTILINE)
    draw_printed('speed_against_mass', 'plot_speed_against_mass.py', run('speed_against_mass'))
    tiers = collections.OrderedDict()
    for line in run('geometry_tiers').split('\n'):
        found = re.match(r'(.{18}) +([-\d.]+) +([-\d.]+) +([-\d.]+) +([-\d.]+)$', line)
        if found:
            tiers.setdefault(found.group(1).strip(), []).append([float(x) for x in found.groups()[1:]])
    return {
        'refinements': benefits.strip(), 'printed': run('ablation', '--printed').strip(),
        'instructions': _range_of(costs, instructions),
        'tiers': ', '.join('%s %.2f mm (%.1f)' % (name, sides[0][0], sides[0][3] / next(
            some for n, some in tiers.items() if n.startswith('capsule'))[0][3]) for name, sides in tiers.items()),
    }, {}


def _range_of(costs, instructions):
    least, most = sorted(costs, key=lambda cost: float(cost[1]))[::len(costs) - 1]
    return '%s %% (%s) to %s %% (%s) of %s instructions' % (least[1], least[0], most[1], most[0], instructions)


RECIPES = {
    'contact': Recipe('5 minutes', CORE + ['benchmark/ablation', 'benchmark/geometry_tiers.cpp', 'benchmark/speed_against_mass.cpp',
                                    'benchmark/plot_speed_against_mass.py', 'modelling'], contact, ['speed_against_mass']),
}
