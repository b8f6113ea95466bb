"""From session folders to tables, figures and the report."""

import collections
import os

import pandas

from . import bars, demographics, dictionary, distributions, learning, progress, trajectories, with_r
from .analysis import analyse
from .measures import COMPARED, CONDITIONS, MAIN, OF, QUESTIONS, in_order, plain
from .report import write_report
from .session_folder import StudyError, begins_a_formula, find_sessions, read_session
from .study_data import HEAD, PEOPLE, SIMULATED, file_label, gather, label_of, measures_in, of_part, parts


def run(folders, output, pairs, ask_r=False, objects=()):
    """Writes everything; returns notes on omissions. `pairs`: (raw, filtered) hands.csv to draw. `ask_r`: also fits models
    in R. `objects`: only trials with these."""
    if os.path.lexists(output) and not os.path.isdir(output):
        raise StudyError('%s: is not a folder; allowed: a folder, or a free name' % output)
    sessions = [read_session(folder) for folder in find_sessions(folders)]
    sessions, notes_on_objects = _of_objects(sessions, objects)
    people, of_people, refused = demographics.table(sessions)
    sessions = [session for session in sessions if session.participant not in refused or session.simulated]
    paths, notes = _read_paths(sessions, pairs)
    notes = notes_on_objects + of_people + notes
    data = gather(sessions) if sessions else None
    results = analyse(data) if data else None
    of_r = _models_of_r(data, notes) if data and ask_r else None
    os.makedirs(output, exist_ok=True)
    figures, pictures = collections.OrderedDict(), os.path.join(output, 'figures')
    if data:
        notes = data.notes + results.notes + notes
        blocks = learning.blocks(data.trials)
        _write_tables(output, data, results, notes, blocks, people, of_r)
        progress.write_pages(blocks, output)
        for part in parts(data):
            _draw_part(figures, pictures, part, data, results)
            some = of_part(blocks, part)
            if some['block'].nunique() > 1 and set(some['measure']) & set(learning.CURVES):
                figures[part, None, 'learning'] = learning.draw(
                    learning.curves(some), 'Learning: ' + label_of(part), part[0], pictures, 'learning_' + file_label(part))
    for label, source, raw, filtered in paths:
        file = 'trajectory_' + label.replace(os.sep, '_').replace(' ', '_')
        figures[None, label, 'trajectory'] = trajectories.draw_trajectories(
            raw, filtered, 'Trajectories: ' + label, source, pictures, file)
    write_report(os.path.join(output, 'report.html'), results, sessions, figures, notes)
    return notes


def _of_objects(sessions, objects):
    if not objects:
        return sessions, []
    known = {row['object'] for session in sessions for row in session.trials}
    unknown = sorted(set(objects) - known)
    if unknown:
        raise StudyError("--object '%s': no trial has it; allowed: %s" % (unknown[0], ', '.join(sorted(known))))
    kept = [s._replace(trials=[row for row in s.trials if row['object'] in objects]) for s in sessions]
    return kept, ['trials of %s left out, as asked' % ', '.join(sorted(known - set(objects)))]


def _models_of_r(data, notes):
    lacking = with_r.missing()
    if lacking:
        notes.append('R: %s not installed: %s' % (lacking, with_r.WITHOUT))
        return None
    return with_r.models(data.cells)


def _read_paths(sessions, pairs):
    """(label, source, raw, filtered) of the given pairs, and of the first session of each group, condition and gravity
    that has both files; and notes."""
    found, notes, drawn, passed_over = [], [], set(), 0
    for i, (raw, filtered) in enumerate(pairs):
        found.append(('given' if len(pairs) == 1 else 'given %d' % (i + 1), PEOPLE, raw, filtered))
    for session in sessions:
        raw, filtered = (os.path.join(session.folder, name) for name in ('hands_raw.csv', 'hands.csv'))
        kind = (session.simulated, session.gravity, session.condition, session.group)
        if os.path.exists(raw) and os.path.exists(filtered):
            if kind in drawn:
                passed_over += 1
                continue
            drawn.add(kind)
            found.append(('%s %s %g g' % (session.participant, session.condition, session.gravity),
                          SIMULATED if session.simulated else PEOPLE, raw, filtered))
        elif os.path.exists(raw) or os.path.exists(filtered):
            notes.append('%s: no trajectory drawn: it needs both hands_raw.csv and hands.csv' % session.folder)
    if passed_over:
        notes.append('%d sessions: no trajectory drawn: one of each group, condition and gravity is' % passed_over)
    read = trajectories.read_path
    return [(label, source, read(raw), read(filtered)) for label, source, raw, filtered in found], notes


def _write_tables(output, data, results, notes, blocks, people, of_r):
    tables = dict(results._asdict(), trials=data.trials)
    tables.pop('notes')
    keys = HEAD + ['object']
    wide = data.cells.pivot_table(index=keys, columns='measure', values='value')
    tables['participants'] = wide[measures_in(data.cells)].reset_index()
    tables['tidy'] = _tidy(data)
    tables['learning'], tables['learning_tests'] = learning.curves(blocks), learning.slopes(blocks)
    tables['demographics'] = pandas.DataFrame(people, columns=('participant', 'group') + demographics.FIELDS)
    if of_r is not None:
        tables['r_models'] = of_r
    tables['data_dictionary'] = dictionary.table(tables)
    for name, table in tables.items():
        _without_formulas(table).to_csv(os.path.join(output, name + '.csv'), index=False, float_format='%.10g')
    with open(os.path.join(output, 'left_out.txt'), 'w', encoding='utf-8') as file:
        file.writelines(note + '\n' for note in notes)


def _without_formulas(table):
    """Puts an apostrophe before texts that a spreadsheet would read as formulas: they may come from files of others."""
    def shown(value):
        return "'" + value if isinstance(value, str) and begins_a_formula(value) else value
    texts = [column for column in table.columns if table[column].dtype == object]
    safe = table.copy()
    for column in texts:
        safe[column] = table[column].map(shown)
    return safe


def _tidy(data):
    """All values and answers, one per row."""
    keys = [c for c in HEAD if c != 'handedness'] + ['session_number', 'period', 'trial', 'order', 'object', 'repetition',
                                                     'result']
    trials = data.trials.assign(completed=(data.trials['result'] == 'completed').astype(int))
    values = trials.melt(keys, [m for m in OF if m in trials.columns], 'measure').dropna(subset=['value'])
    answers = data.ratings.rename(columns={'question': 'measure', 'score': 'value'})
    answers = answers.reindex(columns=[c for c in keys if c in answers.columns and c != 'order'] + ['measure', 'value'])
    # Not by pandas.concat, which from 2.1 on warns of a table without rows, or with columns that are empty.
    return pandas.DataFrame(values.to_dict('records') + answers.to_dict('records'), columns=keys + ['measure', 'value'])


def _draw_part(figures, folder, part, data, results):
    label, file = label_of(part), file_label(part)
    cells, ratings = of_part(data.cells, part), of_part(data.ratings, part)
    compared = [name for name in COMPARED if name in set(cells['measure'])]
    if cells['condition'].nunique() > 1:
        figures[part, None, 'conditions'] = distributions.draw_conditions(
            cells, compared, 'Conditions: ' + label, folder, 'conditions_' + file)
    for condition in in_order(cells['condition'], CONDITIONS):
        some = cells[cells['condition'] == condition]
        of_condition = results._replace(**{name: _of(getattr(results, name), part, condition)
                                           for name in ('bars', 'post_hoc')})
        further = [name for name in measures_in(some) if name not in MAIN]
        main = [name for name in MAIN if name in set(some['measure'])]
        named = ' and '.join(OF[name].label for name in main).capitalize()
        for kind, measures, title in (('bars', main, named), ('further', further, 'Further measures')):
            if measures:
                figures[part, condition, kind] = bars.draw_bars(
                    of_condition, some, measures, '%s: %s, %s' % (title, plain(condition), label), folder,
                    '_'.join((kind, condition, file)))
    if ratings['question'].isin(QUESTIONS).any():
        figures[part, None, 'ratings'] = distributions.draw_ratings(ratings, 'Ratings: ' + label, folder,
                                                                    'ratings_' + file)


def _of(table, part, condition):
    table = of_part(table, part)
    return table[table['condition'] == condition]
