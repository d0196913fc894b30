"""Maximum likelihood poles and shapes, by the method of Levenberg and Marquardt."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.modal.decays import Decays
from sprung.modal.likelihood import ModalObjective, Poles, unit_scales
from sprung.optimisation import NormalEquations, maximise

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_STEPS = 50
_TOLERANCE = 1e-6
"""Expected gain in twice the log-likelihood at which to stop."""

_GROWTH = 5.0
"""Powers of e by which a motion may grow over the longest record."""

_DAMPING = 1e-4
"""Damping of the first step, as a part of the information."""

_ROUNDING = 1e-14
"""Part of the information that is added to it: rounding must not make it indefinite."""


def maximise_likelihood(
    decays: Decays, poles: Poles, steps: int = _STEPS, tolerance: float = _TOLERANCE, only: int | None = None
) -> ModalObjective:
    """Maximise the likelihood of poles and shapes from given ones.

    Parameters
    ----------
    decays
        The records.
    poles
        Start.
    steps
        Largest number of steps.
    tolerance
        Expected gain in twice the log-likelihood at which to stop.
    only
        The one mode whose pole is free, everything else being as given; unless given, all poles and shapes are free.

    Returns
    -------
    ModalObjective
        At the maximum, channels weighted by the noise found there.
    """
    start = _weighted(ModalObjective.at(decays, poles, 1 / np.maximum(decays.energy.sum(axis=0), 1e-300)))
    problem = ModalProblem(decays, only)
    return maximise(problem, start, tolerance=tolerance, damping=_DAMPING, most_steps=steps).point


class ModalProblem(NamedTuple):
    """The likelihood of records as a function of the poles and shapes of their modes.

    Attributes
    ----------
    decays
        The records.
    only
        The one mode whose pole is free; None where everything is.
    """

    decays: Decays
    only: int | None

    def normal_equations(self, point: ModalObjective, _damping: float = 0.0) -> NormalEquations:
        """Return information and gradient in what is free, each direction scaled to an information of one."""
        free = point.free if self.only is None else point.pole_of(self.only)
        information = point.information[np.ix_(free, free)]
        scale = unit_scales(np.diagonal(information).real)
        directions = np.zeros((point.gradient.size, len(free)))
        directions[free, np.arange(len(free))] = scale
        unit = np.eye(len(free))
        scaled = information * scale[:, None] * scale + _ROUNDING * unit
        return NormalEquations(scaled, scale * point.gradient.ravel()[free], unit, directions)

    def trial(self, point: ModalObjective, step: Complex, _damping: float = 0.0) -> tuple[ModalObjective, float]:
        """Return the likelihood a step away, and what it gains."""
        moved = point.moved(step.reshape(point.gradient.shape))
        if not _allowed(moved, self.decays):
            return point, -np.inf
        tried = ModalObjective.at(self.decays, moved, point.weights)
        return _weighted(tried), point.cost - tried.cost


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
