"""Simulated operators beside people."""
import re

from .measuring import PEOPLE, Recipe, run


def people():
    """What the tests of simulated operators print of six on whom nothing was chosen."""
    return people_figures(run('test_operators', '--gtest_filter=*OperatorReaches*:*OperatorSwings*:*OperatorHolds*:*OperatorSees*')), {}


def people_figures(printed):
    def found(pattern):
        return [[float(number) for number in match.groups()] for match in re.finditer(pattern, printed)]

    def span(numbers, form):
        return form % min(numbers) + ' to ' + form % max(numbers)
    widest, grips = (sum(found(pattern), []) for pattern in (r'widest at (\d+) %', r', \w+: grip ([\d.]+) N'))
    swings = sorted(found(r'load ([\d.]+) N, r ([\d.]+), margin (\d+) %'))
    (aside,), (further,) = (found(r'a leap of 12 cm %s: noticed after ([\d.]+) s, reach longer by ([\d.]+) s' % way)
                            for way in ('aside', 'further'))
    early, late = (found(r'of size [\d.]+ after %.1f s: noticed after ([\d.]+) s, reach longer by ([\d.]+) s' % after) for after in (0.0, 0.3))
    return {
        'widest': span(widest, '%.0f') + ' %', 'grip': span(grips, '%.1f') + ' N',
        'correlation': 'r = ' + span([r for _, r, _ in swings], '%.2f'),
        'margin': '%.0f %% at %.1f N of load, %.0f %% at %.0f N' % (swings[0][2], swings[0][0], swings[-1][2], swings[-1][0]),
        'size': 'after %s s; reach at most %.2f s longer (at its start), %.2f s (0.3 s later)' % (
            span([noticed for noticed, _ in early + late], '%.2f'), *(max(longer for _, longer in each) for each in (early, late))),
        'leap': 'after %.2f s; the reach takes %.2f s longer (12 cm aside), %.2f s (further)' % (aside[0], aside[1], further[1]),
    }


RECIPES = {
    'people': Recipe('1 minute', PEOPLE + ['test/operators'], people),
}
