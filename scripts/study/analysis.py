"""The tables of a study, one row each: descriptions, analyses of variance, sphericity, comparisons."""

import collections
import itertools

import numpy as np
import pandas
from scipy import stats

from . import exact, pairwise, permutation
from .anova import mixed_anova
from .linear import ORDER, PERIOD, Model
from .measures import COMPARED, CONDITIONS, GROUPS, OBJECTS, OF, QUESTIONS, in_order, is_tested, plain
from .questions import scale_of
from .study_data import SIMULATED, measures_in, of_part, parts

Results = collections.namedtuple('Results', 'bars comparison effects post_hoc any anova sphericity classical_pairs ratings '
                                            'rating_tests notes')
PAIRS = ('source gravity_g condition measure at a b test n_a n_b centre_a centre_b difference statistic df p '
         'comparisons p_bonferroni stars effect_name effect low high')
COLUMNS = {
    'bars': 'source gravity_g condition group object measure unit n mean sd ci95',
    'comparison': 'source gravity_g condition quantity unit n mean sd ci95',
    'anova': 'source gravity_g condition within measure effect n df df_error f epsilon correction p p_uncorrected '
             'p_greenhouse_geisser p_huynh_feldt partial_eta_squared',
    'sphericity': 'source gravity_g condition within measure n w chi_squared df p greenhouse_geisser huynh_feldt',
    'effects': 'source gravity_g condition within measure effect test scale n values statistic df df_error p '
               'partial_eta_squared terms variances',
    'any': 'source gravity_g condition measure at a b test had_a n_a low_a high_a had_b n_b low_b high_b p comparisons '
           'p_bonferroni stars',
    'post_hoc': PAIRS,
    'classical_pairs': PAIRS,
    'ratings': 'source gravity_g condition question n mean sd median quartile_1 quartile_3',
    'rating_tests': 'source gravity_g condition question a b test n_a n_b centre_a centre_b difference statistic p '
                    'comparisons p_bonferroni stars effect_name effect',
}
EVERY, OVERALL = 'all', 'all objects'


def analyse(data):
    tables, notes = {name: [] for name in COLUMNS}, _Notes()
    for part in parts(data):
        head = dict(zip(('source', 'gravity_g'), part))
        cells, ratings = of_part(data.cells, part), of_part(data.ratings, part)
        for condition in in_order(cells['condition'], CONDITIONS):
            _analyse_objects(tables, notes, dict(head, condition=condition),
                             cells[cells['condition'] == condition])
        _analyse_conditions(tables, notes, dict(head, condition=EVERY), cells)
        _compare(tables['comparison'], head, of_part(data.trials, part), cells, ratings)
        _analyse_ratings(tables, head, ratings)
    for source in sorted(set(data.cells['source'])):
        _analyse_gravities(tables, notes, data.cells[data.cells['source'] == source], source)
    frames = {name: pandas.DataFrame(rows, columns=COLUMNS[name].split()) for name, rows in tables.items()}
    return Results(notes=notes.lines(), **frames)


class _Notes:
    """Notes; one line if the same item is left out for several measures."""

    def __init__(self):
        self.measures = collections.OrderedDict()

    def add(self, head, measure, what):
        where = '%s%g g, %s conditions' if head['condition'] == EVERY else '%s%g g, %s'
        if np.isnan(head['gravity_g']):
            where = '%sgravities, %.0s%s'
        simulated = 'simulated, ' if head['source'] == SIMULATED else ''
        key = where % (simulated, head['gravity_g'], head['condition']), what
        self.measures.setdefault(key, []).append(plain(measure))

    def lines(self):
        return ['%s: %s: %s' % (where, ', '.join(measures), what)
                for (where, what), measures in self.measures.items()]


def summary(values):
    """n, mean, standard deviation and half the width of the mean's 95 % confidence interval; nan without enough data."""
    values = np.asarray(values, float)
    sd = values.std(ddof=1) if len(values) > 1 else np.nan
    ci95 = stats.t.ppf(0.975, len(values) - 1) * sd / np.sqrt(len(values)) if len(values) > 1 else np.nan
    return {'n': len(values), 'mean': values.mean() if len(values) else np.nan, 'sd': sd, 'ci95': ci95}


def _analyse_objects(tables, notes, head, cells):
    """Analyses group and object under one condition."""
    for measure in measures_in(cells):
        of_measure = cells[cells['measure'] == measure]
        head_of = dict(head, measure=measure)
        wide = of_measure.pivot_table(index=['group', 'participant'], columns='object', values='value')
        wide = wide[in_order(wide.columns, OBJECTS)]
        for group, name in itertools.product(in_order(of_measure['group'], GROUPS), wide.columns):
            values = wide.loc[group][name].dropna()
            tables['bars'].append(dict(head_of, group=group, object=name, unit=OF[measure].unit, **summary(values)))
        _test(tables, notes, head_of, 'object', wide)
        model = _test_effects(tables, notes, head_of, 'object', wide, of_measure)
        between = [('at ' + name, a, b, wide.loc[a][name].dropna(), wide.loc[b][name].dropna())
                   for name in wide.columns for a, b in _pairs(wide)]
        overall = [(OVERALL, a, b, *[wide.loc[g].mean(axis=1).dropna() for g in (a, b)]) for a, b in _pairs(wide)]
        within = [('objects', a, b, *_both(wide, a, b)) for a, b in itertools.combinations(wide.columns, 2)]
        _add_pairs(tables, head_of, model, between, 'group')
        _add_pairs(tables, head_of, model, overall, 'group')
        _add_pairs(tables, head_of, model, within, 'object')


def _both(wide, a, b):
    both = wide[[a, b]].dropna()
    return both[a], both[b]


def _add_pairs(tables, head, model, family, factor):
    """`family`: (at, a, b, values of a, values of b). Counts by permutation, the rest by contrasts of the model; and the
    classical tests."""
    between = factor == 'group'
    classical = pairwise.independent if between else pairwise.paired
    _add_comparisons(tables['classical_pairs'], head, [
        (at, a, b, classical(of_a, of_b)) for at, a, b, of_a, of_b in family])
    if OF[head['measure']].kind == 'count':
        test = pairwise.counts_of_groups if between else pairwise.counts_of_pairs
        rows = [(at, a, b, test(of_a, of_b)) for at, a, b, of_a, of_b in family]
        _add_any(tables['any'], head, family, between)
    else:
        rows = [(at, a, b, pairwise.modelled(of_a, of_b, _contrast(model, factor, at, a, b),
                                             model is not None and model.logarithm))
                for at, a, b, of_a, of_b in family]
    _add_comparisons(tables['post_hoc'], head, rows)


def _contrast(model, factor, at, a, b):
    if model is None or not {a, b} <= set(model.factors.get(factor, ())):
        return None
    of = {'object': at[len('at '):]} if at.startswith('at ') and 'object' in model.factors else {}
    return model.difference(dict(of, **{factor: a}), dict(of, **{factor: b}))


def _add_any(table, head, family, between):
    """Tests who had any at all; exact, also if all of one group had and none of the other."""
    rows = []
    for at, a, b, of_a, of_b in family:
        had_a, had_b = np.asarray(of_a) > 0, np.asarray(of_b) > 0
        of_a, of_b = exact.share(had_a), exact.share(had_b)
        p = exact.fisher(had_a, had_b) if between else exact.mcnemar(had_a, had_b)
        rows.append(dict(head, at=at, a=a, b=b, test='Fisher, exact' if between else 'McNemar, exact',
                         had_a=of_a.had, n_a=of_a.n, low_a=of_a.low, high_a=of_a.high, had_b=of_b.had, n_b=of_b.n,
                         low_b=of_b.low, high_b=of_b.high, p=p))
    corrected = pairwise.bonferroni([row['p'] for row in rows])
    for row, p in zip(rows, corrected):
        table.append(dict(row, comparisons=int(np.isfinite(corrected).sum()), p_bonferroni=p, stars=pairwise.stars(p)))


def _test_effects(tables, notes, head, factor, wide, cells):
    """Tests group, factor and interaction without leaving out incomplete participants. Returns the mixed model, if any."""
    head = dict(head, within=factor)
    values = wide.values[~np.isnan(wide.values)]
    if len(values) < 2 or np.ptp(values) == 0:
        return None
    if OF[head['measure']].kind == 'count':
        _add_permutations(tables['effects'], head, factor, wide)
        return None
    alone = [group for group, some in cells.groupby('group') if some['participant'].nunique() < 2]
    some = cells[~cells['group'].isin(alone)]
    factors = collections.OrderedDict([('group', in_order(some['group'], GROUPS)),
                                       ('object', in_order(some['object'], OBJECTS))])
    if factor == 'condition':
        factors['condition'] = in_order(some['condition'], CONDITIONS)
    logarithm = OF[head['measure']].kind == 'time' and bool((some['value'] > 0).all())
    covariates = [ORDER] + [PERIOD] * (factor == 'condition')
    try:
        model = Model(some, factors, covariates, logarithm)
        for names, test in model.effects():
            tables['effects'].append(dict(
                head, effect=' x '.join(names), test='mixed model F', scale='logarithm' if logarithm else 'as it is',
                n=some['participant'].nunique(), values=len(some), statistic=test.f, df=test.df,
                df_error=test.df_error, p=test.p,
                partial_eta_squared=test.f * test.df / (test.f * test.df + test.df_error), terms=' + '.join([' x '.join(t) for t in model.terms[1:]] +
                                                                   model.covariates),
                variances='; '.join('%s %.6g' % item for item in model.variances().items())))
        return model
    except (ValueError, np.linalg.LinAlgError) as error:
        notes.add(head, head['measure'], 'no mixed model: %s' % error)
        return None


def _add_permutations(table, head, factor, wide):
    """Adds permutation tests. Columns of `wide` are the factor's levels."""
    wide = wide.dropna(axis=1, how='all')
    labels = wide.index.get_level_values('group')
    of_groups = [(effect, permutation.several_groups, permutation.explained_by_groups, (labels, profile))
                 for effect, profile in (('group', False), ('group x ' + factor, True))]
    of_levels = (factor, permutation.levels, permutation.explained_by_levels, ())
    for effect, test, explained, options in (of_groups[0], of_levels, of_groups[1]):
        p = test(wide.values, *options)
        if np.isfinite(p):
            table.append(dict(head, effect=effect, test='permutation', scale='as it is', n=len(wide),
                              values=int(wide.notna().values.sum()), statistic=np.nan, df=np.nan, df_error=np.nan, p=p,
                              partial_eta_squared=explained(wide.values, *options), terms='', variances=''))


def _analyse_conditions(tables, notes, head, cells):
    """Analyses group and condition by each participant's mean over the objects, for participants with all values; and pairs
    of conditions by the mean over the objects with a value under both."""
    tested = cells['condition'].map(is_tested).astype(bool)
    for condition in in_order(cells[~tested]['condition'], CONDITIONS):
        notes.add(head, 'all measures', '%s was training: not compared with the other conditions' % condition)
    cells = cells[tested]
    if cells['condition'].nunique() < 2:
        return
    for measure in measures_in(cells):
        of_measure = cells[cells['measure'] == measure]
        head_of = dict(head, measure=measure)
        objects = [set(some['object']) for _, some in of_measure.groupby('condition')]
        common = in_order(set.intersection(*objects), OBJECTS)
        if len(common) < len(set.union(*objects)):
            notes.add(head, measure, 'analysis of variance over the objects that all conditions had: %s'
                      % (', '.join(common) or 'none'))
        wide = of_measure.pivot_table(index=['group', 'participant'], columns=['condition', 'object'], values='value')
        conditions = in_order(of_measure['condition'], CONDITIONS)
        model = None
        if common:
            means = pandas.DataFrame({condition: wide[condition][common].dropna().mean(axis=1)
                                      for condition in conditions}, index=wide.index)
            _test(tables, notes, head_of, 'condition', means)
            shown = pandas.DataFrame({condition: wide[condition].reindex(columns=common).mean(axis=1)
                                      for condition in conditions}, index=wide.index)
            model = _test_effects(tables, notes, head_of, 'condition', shown,
                                  of_measure[of_measure['object'].isin(common)])
        family = [('conditions', a, b, *_means_over_shared(wide[a], wide[b]))
                  for a, b in itertools.combinations(conditions, 2)]
        _add_pairs(tables, head_of, model, family, 'condition')


def _analyse_gravities(tables, notes, cells, source):
    """Analyses gravity within participants under each condition, if the same people were at several. gravity_g is then empty
    in `effects` and the tables of pairs."""
    for condition in in_order(cells['condition'], CONDITIONS):
        some = cells[cells['condition'] == condition]
        strengths = some.groupby('participant')['gravity_g'].nunique()
        some = some[some['participant'].isin(strengths[strengths > 1].index)]
        if some.empty:
            continue
        some = some.assign(condition=['%g g' % gravity for gravity in some['gravity_g']])
        made = {name: [] for name in COLUMNS}
        _analyse_conditions(made, notes, {'source': source, 'gravity_g': np.nan, 'condition': condition}, some)
        for name, rows in made.items():
            for row in rows:
                for key in ('within', 'effect', 'at', 'terms'):
                    if key in row and isinstance(row[key], str):
                        row[key] = row[key].replace('conditions', 'gravities').replace('condition', 'gravity')
                tables[name].append(row)


def _means_over_shared(a, b):
    """Each participant's means over the objects with a value in both tables."""
    shared = a.notna() & b.reindex(columns=a.columns).notna()
    return [table.reindex(columns=a.columns).where(shared).mean(axis=1).dropna() for table in (a, b)]


def _pairs(wide):
    return itertools.combinations(in_order(wide.index.get_level_values('group'), GROUPS), 2)


def _paired_columns(wide, at, test):
    rows = []
    for a, b in itertools.combinations(wide.columns, 2):
        both = wide[[a, b]].dropna()
        rows.append((at, a, b, test(both[a], both[b])))
    return rows


def _add_comparisons(table, head, family):
    corrected = pairwise.bonferroni([result.p for _, _, _, result in family])
    tested = int(np.isfinite(corrected).sum())
    for (at, a, b, result), p in zip(family, corrected):
        table.append(dict(head, at=at, a=a, b=b, comparisons=tested, p_bonferroni=p, stars=pairwise.stars(p),
                          **result._asdict()))


def _test(tables, notes, head, factor, wide):
    """Analysis of variance of the participants with a value at every level, in groups of two or more."""
    values = wide.values[~np.isnan(wide.values)]
    if len(values) > 1 and np.ptp(values) == 0:
        notes.add(head, head['measure'], 'every value is %g: nothing to test' % values[0])
        return
    full = wide.dropna()
    if len(full) < len(wide):
        who = [participant for _, participant in wide.index.difference(full.index)]
        notes.add(head, head['measure'], 'no value for every %s from %s: left out of the analysis of variance'
                  % (factor, ', '.join(sorted(who))))
    groups = full.index.get_level_values('group')
    sizes = groups.value_counts().sort_index()  # equal ones come in an order that changes from run to run with pandas 1.1
    for group, size in sizes.items():
        if size < 2:
            notes.add(head, head['measure'], 'one participant in group %s: left out of the analysis of variance'
                      % group)
    full = full[groups.map(sizes) > 1]
    groups = full.index.get_level_values('group')
    if len(full) == 0 or (groups.nunique() < 2 and full.shape[1] < 2):
        notes.add(head, head['measure'], 'no analysis of variance: it needs two participants in a group, and two '
                                         'groups or two %ss' % factor)
        return
    if groups.nunique() < 2:
        notes.add(head, head['measure'], 'one group, %s: its effect cannot be tested' % groups[0])
    if full.shape[1] < 2:
        notes.add(head, head['measure'], 'one %s, %s: its effect cannot be tested' % (factor, full.columns[0]))
    _add_anova(tables, notes, dict(head, within=factor), mixed_anova(full.values, list(groups)))


def _add_anova(tables, notes, head, result):
    names = {'group': 'group', 'within': head['within'], 'interaction': 'group x ' + head['within']}
    for effect in result.effects:
        if np.isnan(effect.f):
            notes.add(head, head['measure'], 'participants do not differ: the effect of %s cannot be tested'
                      % names[effect.name])
            continue
        row = dict(head, n=result.n, **effect._asdict())
        row['effect'] = names[effect.name]
        tables['anova'].append(row)
    if result.sphericity is not None and result.sphericity.df > 0:
        tables['sphericity'].append(dict(head, n=result.n, **result.sphericity._asdict()))


def _compare(table, head, trials, cells, ratings):
    """The paper's table 1: each condition's mean and standard deviation over participants, whatever their group."""
    for condition in in_order(set(trials['condition']) | set(ratings['condition']), CONDITIONS):
        head_of = dict(head, condition=condition)
        for measure in [m for m in COMPARED if m in set(cells['measure'])]:
            some = cells[(cells['condition'] == condition) & (cells['measure'] == measure)]
            row = summary(some.groupby('participant')['value'].mean())
            table.append(dict(head_of, quantity=measure, unit=OF[measure].unit, **row))
        for question in in_order(ratings['question'], QUESTIONS):
            some = ratings[(ratings['condition'] == condition) & (ratings['question'] == question)]
            if len(some):
                row = summary(some['score'].astype(float))
                table.append(dict(head_of, quantity=question, unit=scale_of(question), **row))


def _analyse_ratings(tables, head, ratings):
    for question in in_order(ratings['question'], QUESTIONS):
        some = ratings[ratings['question'] == question]
        if some.empty:
            continue
        scores = some.assign(score=some['score'].astype(float)).pivot_table(
            index=['group', 'participant'], columns='condition', values='score')
        scores = scores[in_order(scores.columns, CONDITIONS)]
        between = []
        for condition in scores.columns:
            values = scores[condition].dropna()
            row = summary(values)
            row.pop('ci95')
            quartiles = dict(zip(('quartile_1', 'median', 'quartile_3'), np.percentile(values, [25, 50, 75])))
            tables['ratings'].append(dict(head, condition=condition, question=question, **row, **quartiles))
            between += [(condition, a, b, pairwise.rank_sum(values.loc[a], values.loc[b])) for a, b in _pairs(scores)
                        if a in values.index.get_level_values(0) and b in values.index.get_level_values(0)]
        for family in (between, _paired_columns(scores, EVERY, pairwise.signed_rank)):
            rows = []
            _add_comparisons(rows, dict(head, question=question), family)
            tables['rating_tests'] += [dict(row, condition=row['at']) for row in rows]
