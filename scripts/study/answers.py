"""The file of the answers."""

import csv
import io
import os

from .session_folder import RATING_COLUMNS, StudyError, read_header, read_ratings, read_trials


class Answers:
    """The answers of one participant about one condition, in the session's ratings.csv. Lines are only appended, and
    are on the disk when `add` returns."""

    def __init__(self, folder, condition=None):
        header = read_header(folder)
        self.participant, self.condition = header['participant'], condition or header['condition']
        if self.condition != header['condition']:
            self._check_condition(folder, header['condition'])
        self.path = os.path.join(folder, 'ratings.csv')
        self._read()  # refuses a file that later could not be read

    def _check_condition(self, folder, of_session):
        allowed = sorted({of_session} | {row['condition'] for row in read_trials(folder, [])})
        if self.condition not in allowed:
            raise StudyError("--condition '%s': no trial of %s has it; allowed: %s" % (self.condition, folder, ', '.join(allowed)))

    def _read(self):
        """Columns of the file, and this condition's scores by question."""
        if os.path.exists(self.path) and not os.path.isfile(self.path):
            raise StudyError('%s: is no file; allowed: a file, or none yet' % self.path)
        if not os.path.exists(self.path) or os.path.getsize(self.path) == 0:
            return list(RATING_COLUMNS), {}
        notes = []
        rows = read_ratings(self.path, notes)
        if notes:
            raise StudyError('%s; complete or delete that line first' % notes[0].replace(': left out', ''))
        with open(self.path, encoding='utf-8-sig', newline='') as file:
            columns = [cell.strip() for cell in next(csv.reader(file))]
        return columns, {row['question']: row['score'] for row in rows if row['condition'] == self.condition}

    def given(self):
        return self._read()[1]

    def missing(self, asked):
        given = self.given()
        return [question for question in asked if question not in given]

    def add(self, scores):
        """`scores`: question to whole number; all are written at once."""
        columns, _ = self._read()
        text = io.StringIO()
        writer = csv.writer(text, lineterminator='\n')
        if not os.path.exists(self.path) or os.path.getsize(self.path) == 0:
            writer.writerow(columns)
        elif not self._ends_a_line():
            text.write('\n')
        for question, value in scores.items():
            row = dict(zip(RATING_COLUMNS, (self.condition, question, value)))
            writer.writerow([row.get(column, '') for column in columns])
        with open(self.path, 'ab') as file:
            file.write(text.getvalue().encode('utf-8'))
            file.flush()
            os.fsync(file.fileno())

    def _ends_a_line(self):
        with open(self.path, 'rb') as file:
            file.seek(-1, os.SEEK_END)
            return file.read(1) in b'\r\n'
