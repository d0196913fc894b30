"""Poles and shapes that make the records likeliest, by Gauss-Newton steps with Levenberg and Marquardt's damping."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.modal.decays import Decays
from sprung.modal.likelihood import ModalObjective, Poles, unit_scales

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_STEPS = 50
_SETTLED = 1e-6
"""Gain in twice the log-likelihood that a step must promise to be worth taking."""

_GROWTH = 5.0
"""Powers of e by which a motion may grow over the longest record: beyond, it is none of a free decay."""

_FIRMEST = 1e8
"""Damping of the steps at which there is nothing more to be gained."""


def climb(
    decays: Decays, poles: Poles, steps: int = _STEPS, settled: float = _SETTLED, only: int | None = None
) -> ModalObjective:
    """Climb from given poles and shapes to the nearest summit of the likelihood.

    Parameters
    ----------
    decays
        The records.
    poles
        Where to start.
    steps
        How many to take at the most.
    settled
        Gain in twice the log-likelihood below which a step is not taken any more.
    only
        The one mode whose pole is free, everything else being as given; unless given, all poles and shapes are free.

    Returns
    -------
    Stand
        At the summit, channels weighted by the noise found there.
    """
    objective = _weighted(ModalObjective.at(decays, poles, 1 / np.maximum(decays.energy.sum(axis=0), 1e-300)))
    damping = 1e-4
    for _ in range(steps):
        free = objective.free if only is None else objective.pole_of(only)
        information = objective.information[np.ix_(free, free)]
        gradient = objective.gradient.ravel()[free]
        scale = unit_scales(np.diagonal(information).real)
        scaled = information * scale[:, None] * scale
        better = None
        while better is None and damping < _FIRMEST:
            step = scale * np.linalg.solve(scaled + (damping + 1e-14) * np.eye(len(free)), scale * gradient)
            promised = float((step.conj() @ gradient).real)
            if promised < settled:
                return objective
            whole = np.zeros(objective.gradient.size, dtype=np.complex128)
            whole[free] = step
            moved = objective.moved(whole.reshape(objective.gradient.shape))
            tried = None
            if _allowed(moved, decays):
                tried = ModalObjective.at(decays, moved, objective.weights)
            if tried is not None and tried.cost < objective.cost:
                better = tried
                damping = max(damping / 10, 1e-12)
            else:
                damping *= 10
        if better is None:
            return objective
        objective = _weighted(better)
    return objective


def _weighted(objective: ModalObjective) -> ModalObjective:
    return objective.weighted(1 / objective.variance)


def _allowed(poles: Poles, decays: Decays) -> bool:
    exponent = poles.exponent
    return bool(
        np.isfinite(exponent).all()
        and (exponent.real * decays.samples.max() < _GROWTH).all()
        and (exponent.imag < np.pi).all()
        and (np.abs(exponent) < 30.0).all()
    )
