"""What a trial measures, what is shown of it, and from which trials it is taken."""

import collections

COMPLETED = ('completed',)
ENDED = ('completed', 'timed_out')  # a time says little of a trial that ran out of time; a count still does

Measure = collections.namedtuple('Measure', 'name label unit trials')

MEASURES = (
    Measure('attempts', 'Attempts', '', ENDED),
    Measure('completion_time', 'Completion time', 's', COMPLETED),
    Measure('completed', 'Trials completed', 'share', ENDED),
    Measure('drops', 'Drops', '', ENDED),
    Measure('manipulation_time', 'Manipulation time', 's', COMPLETED),
    Measure('maintenance_time', 'Maintenance time', 's', COMPLETED),
    Measure('release_time', 'Release time', 's', COMPLETED),
    Measure('path_length', 'Path length', 'm', COMPLETED),
    Measure('grip_force_mean', 'Mean grip force', 'N', COMPLETED),
    Measure('grip_force_max', 'Greatest grip force', 'N', COMPLETED),
    Measure('release_drift', 'Release drift', 'm', COMPLETED),
    Measure('release_speed', 'Release speed', 'm/s', COMPLETED),
    Measure('tracking_losses', 'Tracking losses', '', ENDED),
)
OF = {measure.name: measure for measure in MEASURES}
MAIN = ('attempts', 'completion_time')  # named in advance, as in the paper; the others are exploratory
COMPARED = ('completion_time', 'attempts', 'drops', 'completed', 'release_drift')  # between conditions

QUESTIONS = ('naturalness', 'efficiency')
GROUPS = ('beginner', 'veteran')
OBJECTS = ('cube', 'flat_cuboid', 'long_cuboid')
CONDITIONS = ('implicit', 'seed', 'penetration', 'impulse', 'virtual_spring', 'soft_pad')


def in_order(names, known):
    """The known names first, in their order, then the others by the alphabet."""
    return sorted(set(names), key=lambda name: (known.index(name) if name in known else len(known), name))


def with_unit(measure):
    return '%s [%s]' % (measure.label, measure.unit) if measure.unit else measure.label


def plain(name):
    return name.replace('_', ' ')
