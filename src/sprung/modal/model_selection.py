"""Number of modes in the records: modes are added and removed by an information criterion, and fitted again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.modal.decays import Decays
from sprung.modal.identification_task import FIRST_POLES, MOST_POLES
from sprung.modal.likelihood import LEAST_NOISE, ModalObjective, Poles, unit_scales
from sprung.modal.mode_set import RejectedPole
from sprung.modal.real_axis import real_axis_alternatives
from sprung.modal.refinement import maximise_likelihood
from sprung.modal.subspace import SignalSubspace
from sprung.modal.uncertainty import mode_uncertainties
from sprung.vibration import UNRESOLVED_FROM

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_TRIED = 3
"""Modes that are added at a time: the strongest in the residuals."""

_FIRST_STEPS, _STEPS, _FAR = 12, 40, 1e-2
"""Steps of a fit for comparison, of an easy and of a difficult one, and its tolerance in twice the log-likelihood."""

_CLEAR_LOSS = 30.0
"""Multiple of the penalty beyond which a mode is kept without a fit that leaves it out."""

_COLOURED = 2.0
"""Residual colour above which the consistency of the records is tested."""

_COST_FACTOR = 1.5
"""Multiple of the penalty that a mode must gain to be added where residuals are coloured."""

_LEAST_INFORMATION = 1e-9
"""Information, as a part of the largest, below which a part of a record does not determine a direction."""


@dataclass(frozen=True, eq=False)
class ModalFit:
    """Maximum likelihood poles and shapes.

    Attributes
    ----------
    objective
        The likelihood there.
    rejected
        Poles that were tried and not accepted, or removed.
    """

    objective: ModalObjective
    rejected: tuple[RejectedPole, ...] = ()


def fit_order(decays: Decays, subspace: SignalSubspace, order: int) -> ModalFit:
    """Fit a given number of poles, less those that the records do not support."""
    poles = subspace.poles(order)
    while poles.count and len(poles.both(poles.exponent)) > order:
        poles = poles.without(poles.count - 1)
    rejected: list[RejectedPole] = []
    return ModalFit(_remove_modes(maximise_likelihood(decays, poles), rejected), tuple(rejected))


def fit_by_criterion(decays: Decays, subspace: SignalSubspace, most: int = MOST_POLES) -> ModalFit:
    """Fit as many poles as the records support.

    Parameters
    ----------
    decays
        The records.
    subspace
        Of them.
    most
        Poles at the most.

    Notes
    -----
    The first model has as many poles as directions exceed the noise. Then modes that exceed the noise in the residuals are
    added as long as Schwarz's criterion decreases (Ann. Statist. 6 (1978) 461), and modes without support by it are removed.
    A gain counts for less where residuals are coloured at the motion's frequencies or parts of the records are inconsistent,
    so that no modes are added to describe a nonlinearity.
    """
    first = max(FIRST_POLES, 2 * decays.channels)
    order = min(max(subspace.significant, 2), first, most, subspace.most)
    objective = maximise_likelihood(decays, subspace.poles(order))
    rejected: list[RejectedPole] = []
    inflation = _inflation(objective)
    if inflation.max() > _COLOURED:
        # No number of modes leaves white residuals, and the fit of a large one may be at a local maximum: all smaller
        # numbers are tried.
        starts = [subspace.poles(n) for n in range(2, order)]
        smaller = [maximise_likelihood(decays, poles, _FIRST_STEPS, _FAR) for poles in starts if poles.count]
        objective = min([*smaller, objective], key=lambda candidate: _criterion(candidate, inflation))
    objective = _try_real_axis(_add_modes(objective, most, rejected))
    objective = _remove_modes(objective, rejected)
    return ModalFit(objective, tuple(rejected))


def residual_colour(objective: ModalObjective) -> Real:
    """Return the ratio of the residuals' spectrum at the motion's frequencies to its mean; at least 1, shape (channel,)."""
    power, motion = objective.residual_spectrum.power.mean(axis=0), objective.decays.spectrum.power.mean(axis=0)
    weight = motion / np.maximum(motion.sum(axis=1, keepdims=True), 1e-300)
    mean = np.maximum(power[:, 1:].mean(axis=1), objective.least_variance)
    return np.asarray(np.maximum((weight * power).sum(axis=1) / mean, 1.0))


def inconsistency_factor(objective: ModalObjective) -> float:
    """Return `squared_birge_ratio` where the residuals are coloured enough for it to matter; 1 otherwise."""
    return squared_birge_ratio(objective) if residual_colour(objective).max() > _COLOURED else 1.0


def squared_birge_ratio(objective: ModalObjective) -> float:
    """Return the square of the :term:`Birge ratio` of poles and shapes in the early and late halves of all records.

    R. T. Birge, Phys. Rev. 40 (1932) 207: the changes that each half would make to poles and shapes, in units of their
    uncertainty, squared and averaged; 1 or more. It is large where frequency depends on amplitude.
    """
    decays = objective.decays
    halves = [
        half for record in decays.values for half in _halves(record * np.sqrt(objective.weights)[:, None], record)
    ]
    parts = ModalObjective.at(Decays.of(halves, decays.rate), objective.poles, objective.weights)
    free = objective.free
    parts_of_records = [(score[free], information[np.ix_(free, free)]) for score, information in parts.by_record()]
    squares, freedom = np.sum([_square(*piece) for piece in parts_of_records], axis=0)
    common, directions = _square(*(np.sum(part, axis=0) for part in zip(*parts_of_records, strict=True)))
    return max(float(squares - common) / max(float(freedom - directions), 1.0), 1.0)


def _square(gradient: Complex, information: Complex) -> tuple[float, int]:
    scale = unit_scales(np.diagonal(information).real)
    eigenvalues, vectors = np.linalg.eigh(information * scale[:, None] * scale)
    seen = eigenvalues > _LEAST_INFORMATION * eigenvalues[-1]
    parts = vectors[:, seen].conj().T @ (scale * gradient)
    return float((np.abs(parts) ** 2 / eigenvalues[seen]).sum()), int(seen.sum())


def _halves(weighted: Real, record: Real) -> tuple[Real, Real]:
    """Split a record at half of its energy."""
    energy = np.cumsum((weighted**2).sum(axis=0))
    middle = int(np.clip(np.searchsorted(energy, energy[-1] / 2), 2, record.shape[1] - 2))
    return record[:, :middle], record[:, middle:]


def _gain(small: ModalObjective, large: ModalObjective) -> tuple[float, float]:
    """Return the gain of a larger model in twice the log-likelihood, and the penalty of its parameters."""
    count, inflation = small.decays.sample_count, _inflation(large)
    gain = count * float((np.log(small.variance / large.variance) / inflation).sum())
    penalty = float(np.log(count * len(inflation) / inflation.mean()))
    return gain, (large.parameters - small.parameters) * penalty


def _criterion(objective: ModalObjective, inflation: Real) -> float:
    count = objective.decays.sample_count
    misfit = count * float((np.log(objective.variance) / inflation).sum())
    return misfit + objective.parameters * float(np.log(count * len(inflation) / inflation.mean()))


def _inflation(objective: ModalObjective) -> Real:
    """Return the overdispersion of each channel: residual colour and inconsistency; shape (channel,)."""
    return residual_colour(objective) + inconsistency_factor(objective) - 1


def _add_modes(objective: ModalObjective, most: int, rejected: list[RejectedPole]) -> ModalObjective:
    first = objective
    while len(objective.poles.both(objective.poles.exponent)) < most:
        if not objective.residual_spectrum.significant.any() or _is_rounding(objective.residuals, objective.decays):
            break
        subspace = SignalSubspace.of(objective.residuals, objective.residual_spectrum)
        standing = subspace.significant
        if not standing:
            break
        new = subspace.poles(min(standing, subspace.most))
        if not new.count:
            break
        added = _strongest(
            ModalObjective.at(Decays.of(objective.residuals, objective.decays.rate), new, objective.weights)
        )
        larger = maximise_likelihood(objective.decays, objective.poles.joined_with(added), _FIRST_STEPS, _FAR)
        gain, cost = _gain(objective, larger)
        if residual_colour(larger).max() > _COLOURED:
            cost *= _COST_FACTOR
        if gain < cost:
            reason = f"adding it gains {gain:.3g} in twice the log-likelihood, its parameters cost {cost:.3g}"
            rejected.extend(RejectedPole(complex(pole) * objective.decays.rate, reason) for pole in added.exponent)
            break
        objective = larger
    return objective if objective is first else maximise_likelihood(objective.decays, objective.poles)


def _try_real_axis(objective: ModalObjective) -> ModalObjective:
    """Try pairs for real poles and real poles for pairs, until none is likelier."""
    tried: set[complex] = set()
    while True:
        for poles in real_axis_alternatives(objective.poles):
            known = complex(np.sum(poles.exponent))
            if known in tried:
                continue
            tried.add(known)
            other = maximise_likelihood(objective.decays, poles, _FIRST_STEPS, _FAR)
            if other.cost < objective.cost and _is_worth(objective, other):
                objective = maximise_likelihood(objective.decays, other.poles)
                break
        else:
            return objective


def _is_worth(objective: ModalObjective, other: ModalObjective) -> bool:
    if other.parameters == objective.parameters:
        return objective.cost - other.cost > _FAR
    gain, cost = _gain(objective, other)
    return gain > cost


def _is_rounding(left: Sequence[Real], decays: Decays) -> bool:
    energy = np.sum([np.einsum("ct,ct->c", record, record) for record in left], axis=0)
    return bool((energy <= LEAST_NOISE**2 * decays.energy.sum(axis=0)).all())


def _strongest(objective: ModalObjective) -> Poles:
    """Return the poles that explain most of the records."""
    order = np.argsort(-objective.shares.sum(axis=0))[:_TRIED]
    poles = objective.poles
    return Poles(poles.exponent[order], poles.shapes[:, order], poles.held[order])


def _remove_modes(objective: ModalObjective, rejected: list[RejectedPole]) -> ModalObjective:
    """Remove modes that the information criterion does not support, unresolved ones first."""
    tried: set[complex] = set()
    while objective.poles.count > 1:
        exponents = objective.poles.exponent.tolist()
        weak = [
            float(np.trace(uncertainty.pole)) > (UNRESOLVED_FROM * abs(pole) * objective.decays.rate) ** 2
            for pole, uncertainty in zip(exponents, mode_uncertainties(objective, 1.0), strict=True)
        ]
        losses = [objective.without(i).cost for i in range(len(exponents))]
        for i in sorted(range(len(exponents)), key=lambda j: (not weak[j], losses[j])):
            if exponents[i] in tried:
                continue
            small = objective.without(i)
            gain, cost = _gain(small, objective)
            if gain > cost:
                # The other modes are refitted only where that may change the decision.
                if gain > _CLEAR_LOSS * cost and not weak[i]:
                    return objective
                small = maximise_likelihood(objective.decays, small.poles, (_STEPS if weak[i] else _FIRST_STEPS), _FAR)
                gain, cost = _gain(small, objective)
            if gain < cost:
                reason = f"it gains {gain:.3g} in twice the log-likelihood, its parameters cost {cost:.3g}"
                rejected.append(RejectedPole(exponents[i] * objective.decays.rate, reason))
                objective = maximise_likelihood(objective.decays, small.poles)
                break
            tried.add(exponents[i])
        else:
            return objective
    return objective
