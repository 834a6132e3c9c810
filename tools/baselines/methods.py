"""The baselines: PySINDy's STLSQ and E-SINDy, SysIdentPy's FROLS, on the same regression."""

import warnings

import numpy as np
import pysindy as ps
from residuals import Problem
from sysidentpy.model_structure_selection import FROLS

# Tuned on the practice records: smallest coefficient kept, in standard deviations (the columns
# are brought to unit length first; a threshold on sizes keeps whatever the records do not show).
STLSQ_THRESHOLD = 20.0
ENSEMBLE_MODELS = 20
ENSEMBLE_PRESENCE = 0.8
# FROLS adds a term while it explains this energy (squared standard deviations) and, after the
# first, this share of what is explained already: what is left of a large effect is not an effect.
FROLS_ENERGY = 40.0
FROLS_SHARE = 0.05
MOST_TERMS = 4


def effect_of(name):
    return name.split(":")[0]


def energy_of_effects(problem, kept):
    """Loss of fit when one effect's columns are taken out of the kept ones, largest first."""
    kept = list(kept)

    def energy(columns):
        if not columns:
            return float(problem.target @ problem.target)
        matrix = problem.columns[:, columns]
        left = problem.target - matrix @ np.linalg.lstsq(matrix, problem.target, rcond=1e-10)[0]
        return float(left @ left)

    full = energy(kept)
    effects = sorted({effect_of(problem.names[k]) for k in kept})
    loss = {e: energy([k for k in kept if effect_of(problem.names[k]) != e]) - full for e in effects}
    return sorted(effects, key=lambda e: -loss[e])


def unit_columns(problem):
    return problem.columns / np.linalg.norm(problem.columns, axis=0)


def sparse_optimizer():
    return ps.STLSQ(threshold=STLSQ_THRESHOLD, alpha=0.01, max_iter=50)


def stlsq(problem: Problem):
    optimizer = sparse_optimizer()
    optimizer.fit(unit_columns(problem), problem.target[:, None])
    return energy_of_effects(problem, np.flatnonzero(optimizer.coef_[0]))


def e_sindy(problem: Problem):
    np.random.seed(0)  # EnsembleOptimizer draws its bags from the global generator
    ensemble = ps.EnsembleOptimizer(sparse_optimizer(), bagging=True, n_models=ENSEMBLE_MODELS)
    ensemble.fit(unit_columns(problem), problem.target[:, None])
    presence = np.mean([np.abs(c[0]) > 0 for c in ensemble.coef_list], axis=0)
    return energy_of_effects(problem, np.flatnonzero(presence >= ENSEMBLE_PRESENCE))


def frols(problem: Problem):
    selector = FROLS()
    selector.max_lag = 0
    terms = min(2 * MOST_TERMS, problem.columns.shape[1] - 1)
    ratios, order, _ = selector.error_reduction_ratio(problem.columns, problem.target[:, None], terms)
    total = float(problem.target @ problem.target)
    chosen, explained = [], 0.0
    for ratio, column in zip(ratios, order):
        gain = ratio * total
        effect = effect_of(problem.names[column])
        if effect not in chosen:
            if gain < max(FROLS_ENERGY, FROLS_SHARE * explained) or len(chosen) == MOST_TERMS:
                break
            chosen.append(effect)
        explained += gain
    return chosen


METHODS = {"STLSQ": stlsq, "E-SINDy": e_sindy, "FROLS": frols}


def run(name, problem):
    """Effects a method names, the one it trusts most first."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return METHODS[name](problem)
