"""The measures of a trial: how they are shown, and from which trials they are taken."""

import collections

COMPLETED = ('completed',)
ENDED = ('completed', 'timed_out')  # for counts; times are taken from completed trials only

# `kind` chooses the tests: `time` by a mixed model of its logarithm, `amount` by one of itself, `count` by permutation.
Measure = collections.namedtuple('Measure', 'name label unit trials kind')

MEASURES = (
    Measure('manipulation_drops', "Drops during manipulation (the paper's attempts)", '', ENDED, 'count'),
    Measure('completion_time', 'Completion time', 's', COMPLETED, 'time'),
    Measure('grasps', 'Grasps', '', ENDED, 'count'),
    Measure('completed', 'Trials completed', 'share', ENDED, 'count'),
    Measure('drops', 'Drops', '', ENDED, 'count'),
    Measure('manipulation_time', 'Manipulation time', 's', COMPLETED, 'time'),
    Measure('maintenance_time', 'Maintenance time', 's', COMPLETED, 'time'),
    Measure('release_time', 'Release time', 's', COMPLETED, 'time'),
    Measure('path_length', 'Path length', 'm', COMPLETED, 'amount'),
    Measure('grip_force_mean', 'Mean grip force', 'N', COMPLETED, 'amount'),
    Measure('grip_force_max', 'Greatest grip force', 'N', COMPLETED, 'amount'),
    Measure('release_drift', 'Release drift', 'm', COMPLETED, 'amount'),
    Measure('release_speed', 'Release speed', 'm/s', COMPLETED, 'amount'),
    Measure('tracking_losses', 'Tracking losses', '', ENDED, 'count'),
)
OF = {measure.name: measure for measure in MEASURES}
MAIN = ('manipulation_drops', 'completion_time')  # named in advance, as in the paper; the others are exploratory
COMPARED = ('completion_time', 'manipulation_drops', 'grasps', 'drops', 'completed', 'release_drift')

QUESTIONS = ('naturalness', 'efficiency')  # the paper's; others follow
GROUPS = ('beginner', 'veteran')
OBJECTS = ('cube', 'flat_cuboid', 'long_cuboid')
CONDITIONS = ('implicit', 'seed', 'penetration', 'impulse', 'virtual_spring', 'soft_pad')


TRAINING = '_training'  # suffix of the condition of a training phase, which is not compared with the tested ones


def is_tested(condition):
    return not condition.endswith(TRAINING)


def in_order(names, known):
    """Known names first, in their order, then the others alphabetically."""
    return sorted(set(names), key=lambda name: (known.index(name) if name in known else len(known), name))


IN_MILLIMETRES = ('release_drift', 'release_speed')  # in reports and figures; files are in SI units


def shown(name, value):
    return 1000 * value if name in IN_MILLIMETRES else value


def with_unit(measure):
    unit = 'm' * (measure.name in IN_MILLIMETRES) + measure.unit
    return '%s [%s]' % (measure.label, unit) if unit else measure.label


def plain(name):
    return name.replace('_', ' ')
