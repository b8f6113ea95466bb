"""The questions asked in the terminal."""

from .answers import TEXTS
from .session_folder import HIGHEST_SCORE, score


def ask(answers, questions, read=input, write=print):
    """Each answer is saved before the next question is asked. EOFError or KeyboardInterrupt ends it."""
    for question in questions:
        text, low, high = TEXTS[question]
        write('\n%s\n(0: %s, %d: %s)' % (text, low, HIGHEST_SCORE, high))
        answers.add({question: _read_score(read, write)})


def _read_score(read, write):
    while True:
        try:
            return score(read('0 to %d: ' % HIGHEST_SCORE).strip())
        except ValueError as error:
            write('%s; please answer again.' % error)
