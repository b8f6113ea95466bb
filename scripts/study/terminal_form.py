"""The questions asked in the terminal."""

from .questions import ALL, score_of


def ask(answers, questions, read=input, write=print):
    """Asks the questions; saves each answer before the next question. EOFError or KeyboardInterrupt ends it."""
    for question in questions:
        asked = ALL[question]
        write('\n%s\n(%d: %s, %d: %s)' % (asked.text, asked.lowest, asked.low, asked.highest, asked.high))
        answers.add({question: _read_score(question, read, write)})


def _read_score(question, read, write):
    asked = ALL[question]
    while True:
        try:
            return score_of(question, read('%d to %d: ' % (asked.lowest, asked.highest)).strip())
        except ValueError as error:
            write('%s; please answer again.' % error)
