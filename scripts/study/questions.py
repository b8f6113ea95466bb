"""The questions to participants and their scales: the paper's two questions, NASA-TLX and SUS."""

import collections

Question = collections.namedtuple('Question', 'text low high lowest highest')

PAPER = collections.OrderedDict((
    ('naturalness', Question('How natural did the sensation of the average task completion experience feel?',
                             'Extremely unnatural', 'Extremely natural', 0, 10)),
    ('efficiency', Question('How would you rate the efficiency of the average task completion experience?',
                            'Extremely inefficient', 'Extremely efficient', 0, 10)),
))

# Hart and Staveland 1988 (NASA): 21 steps; the raw mean of the six is reported from 0 to 100 (Hart 2006).
TLX_STEPS = 20
NASA_TLX = collections.OrderedDict(
    ('tlx_' + name, Question(text, low, high, 0, TLX_STEPS)) for name, text, low, high in (
        ('mental', 'How mentally demanding was the task?', 'Very low', 'Very high'),
        ('physical', 'How physically demanding was the task?', 'Very low', 'Very high'),
        ('temporal', 'How hurried or rushed was the pace of the task?', 'Very low', 'Very high'),
        ('performance', 'How successful were you in accomplishing what you were asked to do?', 'Perfect', 'Failure'),
        ('effort', 'How hard did you have to work to accomplish your level of performance?', 'Very low', 'Very high'),
        ('frustration', 'How insecure, discouraged, irritated, stressed, and annoyed were you?', 'Very low', 'Very high')))

# The System Usability Scale, Brooke 1996 (in Usability Evaluation in Industry); odd ones are good, even ones bad.
SUS = collections.OrderedDict(
    ('sus_%d' % i, Question(text, 'Strongly disagree', 'Strongly agree', 1, 5)) for i, text in enumerate((
        'I think that I would like to use this system frequently.',
        'I found the system unnecessarily complex.',
        'I thought the system was easy to use.',
        'I think that I would need the support of a technical person to be able to use this system.',
        'I found the various functions in this system were well integrated.',
        'I thought there was too much inconsistency in this system.',
        'I would imagine that most people would learn to use this system very quickly.',
        'I found the system very cumbersome to use.',
        'I felt very confident using the system.',
        'I needed to learn a lot of things before I could get going with this system.'), 1))

SETS = collections.OrderedDict((('paper', PAPER), ('nasa_tlx', NASA_TLX), ('sus', SUS)))
ALL = collections.OrderedDict(item for questions in SETS.values() for item in questions.items())
HIGHEST_OF_OTHERS = 100  # highest score of any other question
SCALES = collections.OrderedDict((('nasa_tlx', '0 to 100, less is better'), ('sus', '0 to 100, more is better')))


def score_of(question, text):
    """The score in a text. Other questions have scores from 0 to 100. Raises ValueError that says what is allowed."""
    asked = ALL.get(question, Question('', '', '', 0, HIGHEST_OF_OTHERS))
    try:
        value = int(text)
    except ValueError:
        value = None
    if value is None or not asked.lowest <= value <= asked.highest:
        raise ValueError("'%s' is not a whole number from %d to %d" % (text, asked.lowest, asked.highest))
    return value


def scale_of(question):
    if question in SCALES:
        return SCALES[question]
    return '%d to %d' % ((ALL[question].lowest, ALL[question].highest) if question in ALL else (0, HIGHEST_OF_OTHERS))


def derived(scores):
    """The scales whose questions are all answered: {'nasa_tlx': 45.0, 'sus': 72.5}."""
    found = collections.OrderedDict()
    if all(name in scores for name in NASA_TLX):
        found['nasa_tlx'] = 100.0 * sum(scores[name] for name in NASA_TLX) / (TLX_STEPS * len(NASA_TLX))
    if all(name in scores for name in SUS):
        found['sus'] = 2.5 * sum(scores[name] - 1 if i % 2 == 0 else 5 - scores[name] for i, name in enumerate(SUS))
    return found
