"""Participants, as in the paper: age, sex, handedness, experience with mixed reality; and their consent."""

import collections
import datetime
import os

import yaml

from .session_folder import StudyError, read_header, read_yaml

FILE = 'participant.yaml'
YES, NO = 'yes', 'no'
YOUNGEST, OLDEST = 18, 100
CHOICES = collections.OrderedDict((
    ('sex', ('female', 'male', 'other', 'not_said')),
    ('handedness', ('right', 'left', 'both')),
    ('mr_experience', ('none', 'some', 'regular')),
))
FIELDS = ('consent', 'consent_form', 'consent_time', 'age') + tuple(CHOICES)


def ask(folder, form, again, read=input):
    """Asks the questions; returns the closing text."""
    who = read_header(folder)['participant']
    path = os.path.join(folder, FILE)
    if os.path.exists(path) and not again:
        return '%s has been asked; --again asks anew' % who
    print('Participant %s' % who)
    if _choice(read, 'Has the participant been informed, and given consent in writing', (YES, NO)) == NO:
        return 'No consent: nothing is asked or written. Do not go on with the session.'
    said = collections.OrderedDict((
        ('consent', True), ('consent_form', form),
        ('consent_time', datetime.datetime.now(datetime.timezone.utc).strftime('%Y-%m-%dT%H:%M:%SZ')), ('age', _age(read))))
    said.update((name, _choice(read, name.replace('_', ' ').replace('mr', 'MR').capitalize(), allowed))
                for name, allowed in CHOICES.items())
    part = path + '.part'
    with open(part, 'w', encoding='utf-8') as file:
        yaml.safe_dump(dict(said), file, sort_keys=False)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, path)
    return 'Saved in ' + path


def _choice(read, text, allowed):
    while True:
        answer = read('%s (%s): ' % (text, ', '.join(allowed))).strip().lower()
        if answer in allowed:
            return answer
        print("'%s' is not %s" % (answer, ' or '.join(allowed)))


def _age(read):
    while True:
        answer = read('Age in years: ').strip()
        if answer.isdigit() and YOUNGEST <= int(answer) <= OLDEST:
            return int(answer)
        print("'%s' is not a whole number from %d to %d" % (answer, YOUNGEST, OLDEST))


def of_folder(folder):
    """Content of participant.yaml, or None. Raises StudyError that names a fault in it."""
    path = os.path.join(folder, FILE)
    if not os.path.exists(path):
        return None
    said = read_yaml(path)
    if not isinstance(said.get('consent'), bool):
        raise StudyError("%s: no 'consent'; allowed: true or false" % path)
    age = said.get('age')
    if age is not None and (type(age) is not int or not 0 < age <= OLDEST):
        raise StudyError("%s: age: '%s' is not a whole number of at most %d" % (path, age, OLDEST))
    for name, allowed in CHOICES.items():
        if said.get(name) is not None and said[name] not in allowed:
            raise StudyError("%s: %s: '%s' is not %s" % (path, name, said[name], ' or '.join(allowed)))
    return {name: said.get(name) for name in FIELDS}


def table(sessions):
    """(rows of demographics.csv: one for each person; notes; folders of those who did not consent)."""
    rows, notes, without, refused = collections.OrderedDict(), [], [], []
    for session in sessions:
        said = None if session.simulated else of_folder(session.folder)
        if said is not None and not said['consent']:
            refused.append(session)
        elif said is not None:
            rows[session.participant] = dict(said, participant=session.participant, group=session.group)
    for session in sessions:
        if not session.simulated and session.participant not in rows and session not in refused:
            without.append(session.participant)
    if refused:
        notes.append('no consent from %s: all of theirs left out' % ', '.join(sorted({s.participant for s in refused})))
    if without:
        notes.append('no participant.yaml of %s: consent and demographics not known'
                     % ', '.join(sorted(set(without))))
    return list(rows.values()), notes, {session.participant for session in refused}
