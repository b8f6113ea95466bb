"""The linear mixed model of one measure: which effects, which components, which contrasts."""

import itertools

import numpy as np

from . import mixed_model

ORDER, PERIOD = 'order', 'period'  # columns of cells: place of the trial in its session, of the condition among all


class Model:
    """`cells`: a row for each participant, and level of the factors; `factors`: {column: levels in order}; factors
    with one level do not count. `logarithm`: of the values; effects are ratios then. The residual has a variance for each
    object, unless `scatters_alike`. Raises ValueError where nothing can be estimated."""

    def __init__(self, cells, factors, covariates=(), logarithm=False, scatters_alike=False):
        self.factors = {name: levels for name, levels in factors.items() if len(levels) > 1}
        self.logarithm = logarithm
        values = cells['value'].values.astype(float)
        columns = {name: [list(levels).index(level) for level in cells[name]]
                   for name, levels in self.factors.items()}
        self.terms = [term for size in range(len(self.factors) + 1)
                      for term in itertools.combinations(self.factors, size)]
        design = self._drop_what_cannot_be_told(columns, len(cells))
        self.covariates = []
        for name in covariates:
            wider = np.column_stack([design, _centred(cells[name])])
            if np.isfinite(wider).all() and np.linalg.matrix_rank(wider) == wider.shape[1] < len(cells) - 1:
                self.covariates.append(name)
                design = wider
        who = cells['participant'].values
        within = [name for name in self.factors if name != 'group']
        components = {'participant': np.zeros(len(cells))}
        if len(within) > 1:
            components.update({'participant x ' + name: cells[name].values for name in within})
        strata = 'residual of ' + cells['object'] if not scatters_alike and self._can_tell_scatter(cells) else None
        self.fit = mixed_model.fit(np.log(values) if logarithm else values, design, who, components, strata)

    def _can_tell_scatter(self, cells):
        """True if each object has enough values for a residual variance of its own."""
        groups = len(self.factors.get('group', ' '))
        return 'object' in self.factors and cells.groupby('object')['participant'].nunique().min() >= groups + 2

    def _drop_what_cannot_be_told(self, columns, rows):
        """Interactions of cells that nobody has, the highest first."""
        while True:
            parts = [self._part(term, columns, rows) for term in self.terms]
            design = np.column_stack(parts)
            if np.linalg.matrix_rank(design) == design.shape[1]:
                self.places = dict(zip(self.terms, np.split(np.arange(design.shape[1]),
                                                            np.cumsum([part.shape[1] for part in parts])[:-1])))
                return design
            if len(self.terms) == 1:
                raise ValueError('no values')
            self.terms.pop()

    def _part(self, term, columns, rows):
        part = np.ones((rows, 1))
        for name in term:
            coded = _sum_coded(len(self.factors[name]))[columns[name]]
            part = np.einsum('ri,rj->rij', part, coded).reshape(rows, -1)
        return part

    def effects(self):
        """(names of the factors, test) of each effect, the others at their mean: type III."""
        width = len(self.fit.beta)
        for term in self.terms[1:]:
            yield term, mixed_model.f_test(self.fit, np.eye(width)[self.places[term]])

    def difference(self, a, b):
        """Of the means at two sets of levels, such as {'group': 'beginner', 'object': 'cube'}; what is not named is
        averaged, levels counting alike. None where the model lacks the interaction."""
        names = tuple(name for name in self.factors if name in a)
        if names not in self.places:
            return None
        return mixed_model.contrast(self.fit, self._row(a) - self._row(b))

    def _row(self, levels):
        row = np.zeros(len(self.fit.beta))
        for term, places in self.places.items():
            part = np.ones(1)
            for name in term:
                count = len(self.factors[name])
                coded = (_sum_coded(count)[list(self.factors[name]).index(levels[name])] if name in levels
                         else np.zeros(count - 1))
                part = np.outer(part, coded).ravel()
            row[places] = part
        return row

    def variances(self):
        return dict(zip(self.fit.components, self.fit.theta))


def _sum_coded(count):
    return np.vstack([np.eye(count - 1), -np.ones(count - 1)])


def _centred(column):
    values = column.values.astype(float)
    return values - values.mean()
