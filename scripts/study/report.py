"""The report: one HTML file that includes the figures."""

import base64
import html

import numpy as np

from .measures import CONDITIONS, MAIN, OF, in_order, plain, shown, with_unit
from .questions import scale_of
from .study_data import SIMULATED, label_of

STYLE = '''body{font:15px/1.5 sans-serif;color:#222;max-width:62rem;margin:2rem auto;padding:0 1rem}
.findings{font-size:1.05rem}
h1{font-size:1.6rem}h2{margin-top:2.4rem;border-bottom:2px solid #ccc}h3{margin-top:1.6rem}
table{border-collapse:collapse;margin:.7rem 0;font-size:.87rem}caption{text-align:left;font-weight:bold}
th,td{padding:.2rem .7rem;border-bottom:1px solid #ddd;text-align:right}
td{white-space:nowrap}th:first-child,td:first-child{text-align:left}img{max-width:100%}
.simulated{background:#fff3cd;border:2px solid #b58900;padding:.6rem 1rem;font-weight:bold}
.wide{overflow-x:auto}summary{cursor:pointer}li{margin:.15rem 0}'''
PAGE = '''<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>{style}</style></head><body>
<h1>{title}</h1>
{body}
</body></html>
'''
NO_PERSON = 'Simulated operators: no person took part. These figures describe a program that plays a person.'
EFFECT_COLUMNS = ('Effect', 'Test', 'p', 'partial \u03b7\u00b2', 'Scale', 'n')
MOST_FINDINGS = 6  # in one part; the tables have all
ANOVA_COLUMNS = ('Effect', 'Test', 'p', 'partial \u03b7\u00b2', 'Correction')
SPHERICITY_COLUMNS = ('Measure', 'W', 'Test', 'p', 'Greenhouse-Geisser \u03b5', 'Huynh-Feldt \u03b5')
METHODS = '''<p>A participant's repetitions are averaged first. A missing trial costs no participant. Times (their logarithm)
and other amounts: linear mixed models with random participants and a residual variance for each object, by restricted
maximum likelihood, with Kenward and Roger's F and t. Counts (drops, grasps, tracking losses, trials completed): permutation
tests, in which participants change groups or a participant's values change places; ratios with the intervals of
resampled participants; exact tests of who had any (Fisher's, McNemar's). Ratings: Wilcoxon's and Mann and Whitney's tests,
exact with ties, and the rank-biserial correlation. p-values of pairs are Bonferroni-corrected within a measure and a
family of comparisons (the groups at each object; the objects; the conditions); stars follow the corrected values.</p>
<p>The paper's own analysis is beside them: a mixed analysis of variance with type III sums of squares of the
participants with a value everywhere; Mauchly's test of sphericity and, where it is violated (p &lt; 0.05, or too few
participants to tell), Greenhouse and Geisser's correction if its &epsilon; is at most 0.75, else Huynh and Feldt's;
Welch's t-test with Cohen's d between groups, the paired t-test with d<sub>z</sub> within participants. Its p-values are
not to be trusted for counts that are mostly 0.</p>
<p>Completion time and drops during manipulation (the paper's attempts) are the measures named in advance. The others are
exploratory, and nothing corrects for how many they are.</p>'''


class Report:
    def __init__(self, title):
        self.title, self.body = title, []

    def heading(self, text, level=2):
        self.body.append('<h%d>%s</h%d>' % (level, html.escape(text), level))

    def text(self, text, css=''):
        self.body.append('<p%s>%s</p>' % (' class="%s"' % css if css else '', html.escape(text)))

    def markup(self, text):
        self.body.append(text)

    def items(self, lines):
        self.body.append('<ul>%s</ul>' % ''.join('<li>%s</li>' % html.escape(line) for line in lines))

    def figure(self, path, description):
        with open(path, 'rb') as file:
            data = base64.b64encode(file.read()).decode()
        self.body.append('<img alt="%s" src="data:image/svg+xml;base64,%s">' % (html.escape(description), data))

    def table(self, caption, columns, rows):
        cells = ['<th>%s</th>' % html.escape(column) for column in columns]
        lines = ['<tr>%s</tr>' % ''.join(cells)]
        lines += ['<tr>%s</tr>' % ''.join('<td>%s</td>' % html.escape(cell) for cell in row) for row in rows]
        self.body.append('<div class="wide"><table><caption>%s</caption>%s</table></div>'
                         % (html.escape(caption), ''.join(lines)))

    def folded(self, summary):
        return _Folded(self, summary)

    def write(self, path):
        with open(path, 'w', encoding='utf-8') as file:
            file.write(PAGE.format(title=html.escape(self.title), style=STYLE, body='\n'.join(self.body)))


class _Folded:
    def __init__(self, report, summary):
        self.report, self.summary = report, summary

    def __enter__(self):
        self.report.markup('<details><summary>%s</summary>' % html.escape(self.summary))

    def __exit__(self, *_):
        self.report.markup('</details>')


def p_text(p):
    return '\u2013' if np.isnan(p) else 'p < 0.001' if p < 0.001 else 'p = %.3f' % p


def number(value, digits=3):
    return '\u2013' if value is None or np.isnan(value) else '%.*g' % (digits, value)


def write_report(path, results, sessions, figures, notes):
    """`figures`: (part, condition or None, kind) to the path of an SVG; in order."""
    report = Report('Study: %d sessions, %d participants' % (
        len(sessions), len({(s.participant, s.simulated) for s in sessions})) if sessions else 'Trajectories')
    if any(s.simulated for s in sessions):
        some = '' if all(s.simulated for s in sessions) else 'Some of the sessions, analysed apart: '
        report.text(some + NO_PERSON, 'simulated')
    found = sorted(set(map(tuple, results.comparison[['source', 'gravity_g']].values))) if results else ()
    if found:
        report.heading('Findings')
        report.items([line for part in found for line in _findings(results, part)])
    if sessions:
        report.heading('Who took part')
        _participants(report, sessions)
    for part in found:
        _part(report, part, results, figures)
    if results is not None:
        _gravities(report, results)
    for (part, name, kind), file in figures.items():
        if kind == 'trajectory':
            report.heading('Trajectories: ' + name)
            report.figure(file, 'Trajectories, raw and filtered: ' + name)
    if sessions:
        _account(report, sessions, notes)
    report.write(path)


def _findings(results, part):
    """Sentences on the measures named in advance: what differs, by how much, with its interval and corrected p."""
    pairs = _rows(results.post_hoc, part)
    pairs = pairs[pairs['measure'].isin(MAIN) & pairs['at'].isin(['conditions', 'all objects']) &
                  pairs['p_bonferroni'].notna() & pairs['effect'].notna()].sort_values('p_bonferroni', kind='stable')
    where = label_of(part)
    if pairs.empty:
        return ['%s: no two groups or conditions to compare.' % where.capitalize()]
    shown_first = pairs[pairs['stars'] != ''].head(MOST_FINDINGS)
    if shown_first.empty:
        return ['%s: of %d comparisons none is shown to differ. Nearest: %s' % (
            where.capitalize(), len(pairs), _sentence(next(pairs.itertuples())))]
    more = (pairs['stars'] != '').sum() - len(shown_first)
    return ['%s: %s' % (where.capitalize(), _sentence(row)) for row in shown_first.itertuples()] + (
        ['%s: %d further differences are in the tables.' % (where.capitalize(), more)] if more else [])


def _sentence(row):
    ratio = row.effect_name.startswith('ratio')
    size = ('is %s times that' if ratio else 'differs by %s from that') % number(row.effect)
    limits = '' if np.isnan(row.low) else '95 %% interval %s to %s, ' % (number(row.low), number(row.high))
    under = ', under ' + plain(row.condition) if row.at == 'all objects' else ''
    return '%s of %s %s of %s%s (%s%s after correction, n = %s).' % (
        OF[row.measure].label, plain(row.a), size, plain(row.b), under, limits, p_text(row.p_bonferroni),
        '%d' % row.n_a if row.at == 'conditions' else '%d and %d' % (row.n_a, row.n_b))


def _gravities(report, results):
    """Section on participants who were at several gravities."""
    effects, pairs = (table[table['gravity_g'].isna()] for table in (results.effects, results.post_hoc))
    if len(effects) or len(pairs):
        report.heading('Gravity, within participants')
        report.table('Effects', EFFECT_COLUMNS, [[plain(name) + ', ' + row[0]] + row[1:] for name, row in zip(
            effects['condition'], _effect_rows(effects))])
        _pairs(report, pairs[pairs['p'].notna()], 'Pairs',
               lambda row: '%s, %s' % (plain(row.condition), OF[row.measure].label))


def _account(report, sessions, notes):
    report.heading('What was left out, and why')
    report.items(notes or ['Nothing.'])
    report.heading('Methods')
    report.markup(METHODS)


def _rows(table, part, **equal):
    table = table[(table['source'] == part[0]) & (table['gravity_g'] == part[1])]
    for column, value in equal.items():
        table = table[table[column] == value]
    return table


def _part(report, part, results, figures):
    report.heading(label_of(part).capitalize())
    if part[0] == SIMULATED:
        report.text(NO_PERSON, 'simulated')
    _comparison(report, _rows(results.comparison, part))
    _figure_of(report, figures, part, None, 'conditions', 'Conditions side by side')
    _tests(report, results, part, 'all', 'conditions')
    for condition in in_order(_rows(results.bars, part)['condition'], CONDITIONS):
        report.heading('Groups and objects: ' + plain(condition), 3)
        _figure_of(report, figures, part, condition, 'bars', 'Drops during manipulation and completion time')
        _tests(report, results, part, condition, 'objects and groups')
        if (part, condition, 'further') in figures:
            with report.folded('Further measures'):
                _figure_of(report, figures, part, condition, 'further', 'Further measures')
    _ratings(report, results, part, figures)
    if (part, None, 'learning') in figures:
        report.heading('Learning', 3)
        _figure_of(report, figures, part, None, 'learning', 'Learning curves')


def _figure_of(report, figures, part, condition, kind, description):
    if (part, condition, kind) in figures:
        report.figure(figures[part, condition, kind], description)


def _comparison(report, rows):
    quantities = list(dict.fromkeys(rows['quantity']))
    columns = ['Condition', 'n'] + [with_unit(OF[q]) if q in OF else '%s [%s]' % (plain(q).capitalize(), scale_of(q))
                                    for q in quantities]
    table = []
    for condition in dict.fromkeys(rows['condition']):
        some = rows[rows['condition'] == condition]
        cells = {row.quantity: '%s \u00b1 %s%s' % (number(shown(row.quantity, row.mean)), number(shown(row.quantity, row.sd), 2),
                                                 '' if row.n == some['n'].max() else ' (n = %d)' % row.n)
                 for row in some.itertuples()}
        table.append([plain(condition), str(some['n'].max())] + [cells.get(q, '\u2013') for q in quantities])
    report.table('Mean \u00b1 standard deviation over participants', columns, table)


def _tests(report, results, part, condition, what):
    effects = _rows(results.effects, part, condition=condition)
    main, rest = (effects[effects['measure'].isin(MAIN) == wanted] for wanted in (True, False))
    if len(main):
        report.table('Effects', EFFECT_COLUMNS, _effect_rows(main))
    pairs = _rows(results.post_hoc, part, condition=condition)
    any_had = _rows(results.any, part, condition=condition)
    with report.folded('Pairs, and effects on further measures: ' + what):
        if len(rest):
            report.table('Effects, exploratory', EFFECT_COLUMNS, _effect_rows(rest))
        _pairs(report, pairs[pairs['p'].notna()], 'Pairs',
               lambda row: '%s, %s' % (OF[row.measure].label, plain(row.at)))
        _any(report, any_had[any_had['p'].notna()])
    with report.folded('Classical analysis of variance and t-tests, as in the paper: ' + what):
        _classical(report, results, part, condition)


def _effect_rows(effects):
    return [['%s: %s' % (OF[row.measure].label, row.effect.replace(' x ', ' \u00d7 ')),
             row.test if np.isnan(row.statistic) else
             'F(%d, %s) = %.2f' % (row.df, number(row.df_error, 4), row.statistic),
             p_text(row.p), number(row.partial_eta_squared, 2), row.scale, str(row.n)] for row in effects.itertuples()]


def _any(report, rows):
    def had(count, n, low, high):
        return '%d of %d (%.0f to %.0f %%)' % (count, n, 100 * low, 100 * high)
    if len(rows):
        report.table('Participants who had any, with exact 95 % intervals', ['Of', 'a', 'b', 'a', 'b', 'Test',
                                                                             'p, Bonferroni', ''], [
            ['%s, %s' % (OF[row.measure].label, plain(row.at)), plain(row.a), plain(row.b),
             had(row.had_a, row.n_a, row.low_a, row.high_a), had(row.had_b, row.n_b, row.low_b, row.high_b), row.test,
             p_text(row.p_bonferroni), row.stars] for row in rows.itertuples()])


def _classical(report, results, part, condition):
    anova = _rows(results.anova, part, condition=condition)
    if len(anova):
        report.table('Analysis of variance', ANOVA_COLUMNS, _anova_rows(anova))
    sphericity = _rows(results.sphericity, part, condition=condition)
    if len(sphericity):
        report.table("Sphericity (Mauchly's test)", SPHERICITY_COLUMNS, [
            [OF[row.measure].label, number(row.w), '\u03c7\u00b2(%d) = %s' % (row.df, number(row.chi_squared)),
             p_text(row.p), number(row.greenhouse_geisser), number(row.huynh_feldt)]
            for row in sphericity.itertuples()])
    pairs = _rows(results.classical_pairs, part, condition=condition)
    _pairs(report, pairs[pairs['p'].notna()], 'Pairs',
           lambda row: '%s, %s' % (OF[row.measure].label, plain(row.at)))


def _anova_rows(anova):
    return [['%s: %s' % (OF[row.measure].label, row.effect.replace(' x ', ' \u00d7 ')),
             'F(%s, %s) = %.2f' % (number(row.df * row.epsilon, 4), number(row.df_error * row.epsilon, 4), row.f),
             p_text(row.p), '%.3f' % row.partial_eta_squared,
             row.correction if row.correction == 'none' else '%s, \u03b5 = %.3f' % (row.correction, row.epsilon)]
            for row in anova.itertuples()]


def _pairs(report, pairs, caption, where):
    if len(pairs):
        report.table(caption, ['Of', 'a', 'b', 'a', 'b', 'Test', 'p, Bonferroni', '', 'Effect'], [
            [where(row), plain(row.a), plain(row.b), *[number(shown(getattr(row, 'measure', ''), centre))
                                                       for centre in (row.centre_a, row.centre_b)],
             _test_text(row), p_text(row.p_bonferroni), row.stars, _effect_text(row)]
            for row in pairs.itertuples()])


def _test_text(row):
    if np.isnan(row.statistic):
        return row.test
    df = '(%s)' % number(row.df, 4) if 'df' in row._fields and row.df == row.df else ''
    return '%s%s = %.2f' % (row.test, df, row.statistic)


def _effect_text(row):
    name = getattr(row, 'measure', '') if row.effect_name == 'difference' else ''  # other effects have no unit
    text = '%s = %s' % (row.effect_name.replace('_', ''), number(shown(name, row.effect)))
    known = 'low' in row._fields and not np.isnan(row.low)
    return text + (' (%s to %s)' % (number(shown(name, row.low)), number(shown(name, row.high))) if known else '')


def _ratings(report, results, part, figures):
    ratings = _rows(results.ratings, part)
    if ratings.empty:
        return
    report.heading('Ratings', 3)
    _figure_of(report, figures, part, None, 'ratings', 'Distributions of the ratings')
    report.table('Ratings', ['Condition', 'Question', 'n', 'Mean', 'SD', 'Median', 'Quartiles'], [
        [plain(row.condition), '%s [%s]' % (plain(row.question), scale_of(row.question)), str(row.n),
         number(row.mean), number(row.sd, 2), number(row.median),
         '%s to %s' % (number(row.quartile_1), number(row.quartile_3))] for row in ratings.itertuples()])
    pairs = _rows(results.rating_tests, part)
    _pairs(report, pairs[pairs['p'].notna()], 'Pairs: medians',
           lambda row: '%s, %s' % (row.question, plain(row.condition)))


def _participants(report, sessions):
    people = {(s.participant, s.simulated): s for s in sessions}
    rows = []
    for simulated in (False, True):
        for group in in_order({s.group for s in people.values()}, ()):
            some = [s for s in people.values() if s.simulated == simulated and s.group == group]
            if some:
                rows.append([group + (' (simulated)' if simulated else ''), str(len(some)),
                             str(sum(s.handedness == 'left' for s in some))])
    report.table('Groups', ['Group', 'Participants', 'Left-handed'], rows)
