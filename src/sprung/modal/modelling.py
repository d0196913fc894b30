"""How many modes the records hold: modes are added and taken away by an information criterion, and each of them refined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.modal.decays import Decays
from sprung.modal.identified import RejectedPole
from sprung.modal.likelihood import LEAST_NOISE, Poles, Stand, scales
from sprung.modal.refinement import climb
from sprung.modal.selection import FIRST_POLES, MOST_POLES
from sprung.modal.subspace import Span
from sprung.modal.turning import alternatives
from sprung.modal.uncertainty import spreads
from sprung.vibration import UNRESOLVED_FROM

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_TRIED = 3
"""Modes that are tried at a time: those that stand out most in what is left."""

_FIRST_STEPS, _STEPS, _FAR = 12, 40, 1e-2
"""Steps of a fit that is only to be compared, where it is easy and where it is not, and what they need not gain."""

_HOPELESS = 30.0
"""Times its cost that a mode must gain, the others held, for a fit without it to be left undone."""

_COLOURED = 2.0
"""Colour of residuals from which on it is asked whether the records agree with each other at all."""

_DEARER = 1.5
"""Times its cost that a mode must gain to be added where residuals are coloured: how little they tell is not known well."""

_SEEN = 1e-9
"""Information, as a part of the largest, below which a piece of a record says nothing about a direction."""


@dataclass(frozen=True, eq=False)
class Model:
    """The likeliest poles and shapes, as many as the records hold.

    Attributes
    ----------
    stand
        The likelihood there.
    rejected
        What was tried or taken away.
    """

    stand: Stand
    rejected: tuple[RejectedPole, ...] = ()


def model_of_order(decays: Decays, span: Span, order: int) -> Model:
    """Fit as many poles as asked for, less those that the records do not hold."""
    poles = span.poles(order)
    while poles.count and len(poles.both(poles.exponent)) > order:
        poles = poles.without(poles.count - 1)
    rejected: list[RejectedPole] = []
    return Model(_pruned(climb(decays, poles), rejected), tuple(rejected))


def model_by_data(decays: Decays, span: Span, most: int = MOST_POLES) -> Model:
    """Fit as many poles as the records hold.

    Parameters
    ----------
    decays
        The records.
    span
        Of them.
    most
        Poles at the most.

    Notes
    -----
    A start is made with the directions that stand out from noise. Then modes that stand out in what is left are added as long
    as that is worth their parameters by Schwarz's criterion (Ann. Statist. 6 (1978) 461), and modes that are not worth
    theirs are taken away. Two things make a gain count for less, so that no modes are invented to explain what is not
    linear: residuals that are coloured where the motion is, and pieces of the records that contradict each other.
    """
    first = max(FIRST_POLES, 2 * decays.channels)
    order = min(max(span.standing_out, 2), first, most, span.most)
    stand = climb(decays, span.poles(order))
    rejected: list[RejectedPole] = []
    inflation = _inflation(stand)
    if inflation.max() > _COLOURED:
        # No number of modes leaves white noise, and a large one may have lost its way: all smaller ones are tried.
        starts = [span.poles(n) for n in range(2, order)]
        smaller = [climb(decays, poles, _FIRST_STEPS, _FAR) for poles in starts if poles.count]
        stand = min([*smaller, stand], key=lambda one: _criterion(one, inflation))
    stand = _turned(_grown(stand, most, rejected))
    stand = _pruned(stand, rejected)
    return Model(stand, tuple(rejected))


def colour(stand: Stand) -> Real:
    """Give by how much the residuals' spectrum exceeds its mean where the motion is; at least 1, shape (channel,)."""
    power, motion = stand.left_spectrum.power.mean(axis=0), stand.decays.spectrum.power.mean(axis=0)
    weight = motion / np.maximum(motion.sum(axis=1, keepdims=True), 1e-300)
    mean = np.maximum(power[:, 1:].mean(axis=1), stand.least_variance)
    return np.asarray(np.maximum((weight * power).sum(axis=1) / mean, 1.0))


def agreement(stand: Stand) -> float:
    """Give `disagreement`, where the residuals are coloured enough for it to matter; 1 otherwise."""
    return disagreement(stand) if colour(stand).max() > _COLOURED else 1.0


def disagreement(stand: Stand) -> float:
    """Give by how much more than by their noise the early and the late halves of all records differ in poles and shapes.

    The square of Birge's ratio (Phys. Rev. 40 (1932) 207): what each half would change about the poles and shapes, in units
    of its own uncertainty, squared and averaged; 1 or more. A motion whose frequency depends on its amplitude shows here.
    """
    decays = stand.decays
    halves = [half for record in decays.values for half in _halves(record * np.sqrt(stand.weights)[:, None], record)]
    parts = Stand.at(Decays.of(halves, decays.rate), stand.poles, stand.weights)
    free = stand.free
    pieces = [(score[free], information[np.ix_(free, free)]) for score, information in parts.by_record()]
    squares, freedom = np.sum([_square(*piece) for piece in pieces], axis=0)
    common, directions = _square(*(np.sum(part, axis=0) for part in zip(*pieces, strict=True)))
    return max(float(squares - common) / max(float(freedom - directions), 1.0), 1.0)


def _square(gradient: Complex, information: Complex) -> tuple[float, int]:
    scale = scales(np.diagonal(information).real)
    eigenvalues, vectors = np.linalg.eigh(information * scale[:, None] * scale)
    seen = eigenvalues > _SEEN * eigenvalues[-1]
    parts = vectors[:, seen].conj().T @ (scale * gradient)
    return float((np.abs(parts) ** 2 / eigenvalues[seen]).sum()), int(seen.sum())


def _halves(weighted: Real, record: Real) -> tuple[Real, Real]:
    """Cut a record where half of its energy has gone by."""
    energy = np.cumsum((weighted**2).sum(axis=0))
    middle = int(np.clip(np.searchsorted(energy, energy[-1] / 2), 2, record.shape[1] - 2))
    return record[:, :middle], record[:, middle:]


def _gain(small: Stand, large: Stand) -> tuple[float, float]:
    """Give what a larger model gains in twice the log-likelihood, and what its parameters cost."""
    count, inflation = small.decays.numbers, _inflation(large)
    gain = count * float((np.log(small.variance / large.variance) / inflation).sum())
    price = float(np.log(count * len(inflation) / inflation.mean()))
    return gain, (large.parameters - small.parameters) * price


def _criterion(stand: Stand, inflation: Real) -> float:
    count = stand.decays.numbers
    misfit = count * float((np.log(stand.variance) / inflation).sum())
    return misfit + stand.parameters * float(np.log(count * len(inflation) / inflation.mean()))


def _inflation(stand: Stand) -> Real:
    """Give by how much less each channel tells than white noise around the right model would let it; shape (channel,)."""
    return colour(stand) + agreement(stand) - 1


def _grown(stand: Stand, most: int, rejected: list[RejectedPole]) -> Stand:
    begun = stand
    while len(stand.poles.both(stand.poles.exponent)) < most:
        if not stand.left_spectrum.standing_out.any() or _is_rounding(stand.left, stand.decays):
            break
        span = Span.of(stand.left, stand.left_spectrum)
        standing = span.standing_out
        if not standing:
            break
        new = span.poles(min(standing, span.most))
        if not new.count:
            break
        more = _strongest(Stand.at(Decays.of(stand.left, stand.decays.rate), new, stand.weights))
        larger = climb(stand.decays, stand.poles.beside(more), _FIRST_STEPS, _FAR)
        gain, cost = _gain(stand, larger)
        if colour(larger).max() > _COLOURED:
            cost *= _DEARER
        if gain < cost:
            said = f"adding it gains {gain:.3g} in twice the log-likelihood, its parameters cost {cost:.3g}"
            rejected.extend(RejectedPole(complex(pole) * stand.decays.rate, said) for pole in more.exponent)
            break
        stand = larger
    return stand if stand is begun else climb(stand.decays, stand.poles)


def _turned(stand: Stand) -> Stand:
    """Try what lies beyond the points where poles meet on the real axis, until nothing there is likelier."""
    asked: set[complex] = set()
    while True:
        for poles in alternatives(stand.poles):
            known = complex(np.sum(poles.exponent))
            if known in asked:
                continue
            asked.add(known)
            other = climb(stand.decays, poles, _FIRST_STEPS, _FAR)
            if other.cost < stand.cost and _is_worth(stand, other):
                stand = climb(stand.decays, other.poles)
                break
        else:
            return stand


def _is_worth(stand: Stand, other: Stand) -> bool:
    if other.parameters == stand.parameters:
        return stand.cost - other.cost > _FAR
    gain, cost = _gain(stand, other)
    return gain > cost


def _is_rounding(left: Sequence[Real], decays: Decays) -> bool:
    energy = np.sum([np.einsum("ct,ct->c", record, record) for record in left], axis=0)
    return bool((energy <= LEAST_NOISE**2 * decays.energy.sum(axis=0)).all())


def _strongest(stand: Stand) -> Poles:
    """Keep of poles those that explain the most of the records."""
    order = np.argsort(-stand.shares.sum(axis=0))[:_TRIED]
    poles = stand.poles
    return Poles(poles.exponent[order], poles.shapes[:, order], poles.held[order])


def _pruned(stand: Stand, rejected: list[RejectedPole]) -> Stand:
    """Take away modes that are not worth their parameters, those first that the records do not determine."""
    asked: set[complex] = set()
    while stand.poles.count > 1:
        exponents = stand.poles.exponent.tolist()
        weak = [
            float(np.trace(spread.pole)) > (UNRESOLVED_FROM * abs(pole) * stand.decays.rate) ** 2
            for pole, spread in zip(exponents, spreads(stand, 1.0), strict=True)
        ]
        losses = [stand.without(i).cost for i in range(len(exponents))]
        for i in sorted(range(len(exponents)), key=lambda j: (not weak[j], losses[j])):
            if exponents[i] in asked:
                continue
            small = stand.without(i)
            gain, cost = _gain(small, stand)
            if gain > cost:
                # What the others would make up for is worth a look only where it may change the answer.
                if gain > _HOPELESS * cost and not weak[i]:
                    return stand
                small = climb(stand.decays, small.poles, (_STEPS if weak[i] else _FIRST_STEPS), _FAR)
                gain, cost = _gain(small, stand)
            if gain < cost:
                said = f"it gains {gain:.3g} in twice the log-likelihood, its parameters cost {cost:.3g}"
                rejected.append(RejectedPole(exponents[i] * stand.decays.rate, said))
                stand = climb(stand.decays, small.poles)
                break
            asked.add(exponents[i])
        else:
            return stand
    return stand
