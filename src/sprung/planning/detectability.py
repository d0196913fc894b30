"""Detectability of model terms: which size of a term the recordings of a planned test would show.

The motion with a term differs from that without. What the parameters of the planned model, the initial states and the sensors
within their uncertainties imitate of that difference says nothing; the rest, over the noise, is what twice the log-likelihood
gains by the term, without any further simulation (non-centrality parameter: Kay, Fundamentals of Statistical Signal
Processing, volume 2, 1998, section 6.5).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.planning.setup import MeasurementSetup, PlannedDrop
from sprung.simulation import simulate_nonlinear_drops
from sprung.vehicle import NEUTRAL, PARAMETERS, Motion, Readout, Vehicle, nonlinear_elements

Real = NDArray[np.float64]

_PART, _LEAST_PART, _OVER = 0.1, 1e-3, 2.0
"""Part of a usual size at which a term is simulated at first, at the least, and over what is found from the first one."""

_SMALL = 1e-3
"""Of differences beside the motion, root-mean-square, when their energies are computed."""

_SETTLED = 0.004
"""s after the last lift-off of the vehicle without a term, from which a vehicle with a part of it stands on the ground too."""


class TermCandidate(NamedTuple):
    """A term that the vehicle may have beside those of the planned model.

    Attributes
    ----------
    name
        Of the term.
    parameters
        Its parameters at a usual size, SI, by name.
    size
        That size, dimensionless, as in the selection of model terms.
    required
        Gain in twice the log-likelihood that it needs to be included.
    """

    name: str
    parameters: Mapping[str, float]
    size: float
    required: float


@shown
@dataclass(frozen=True, slots=True)
class TermDetectability:
    """What a test would show of one term.

    Attributes
    ----------
    name
        Of the term.
    size
        Usual size, dimensionless, as in the selection of model terms.
    gain
        What twice the log-likelihood would gain by the term at that size.
    smallest
        Size from which the term would be included, dimensionless; infinite where the model imitates it altogether.
    rival
        Another term that imitates most of it; empty where none imitates as much as a tenth.
    smallest_beside
        Size from which it would be told from that one, dimensionless.
    """

    name: str
    size: float
    gain: float
    smallest: float
    rival: str = ""
    smallest_beside: float = math.inf

    @property
    def is_found(self) -> bool:
        """Whether a usual size would be found."""
        return self.smallest <= self.size


def detect_terms(
    setup: MeasurementSetup, drops: Sequence[PlannedDrop], candidates: Sequence[TermCandidate]
) -> tuple[TermDetectability, ...]:
    """Return what drops would show of terms, each alone beside the planned model.

    Parameters
    ----------
    setup
        Vehicle, model and measurement.
    drops
        Each done once.
    candidates
        The terms, none of them in the vehicle.

    Returns
    -------
    tuple of TermDetectability
        In the order of the candidates.

    Raises
    ------
    InputError
        If the vehicle cannot be dropped so, or does not come to rest on its tyres in time.
    """
    setup = replace(setup, delay=setup.delay + _SETTLED)
    windows = [setup.decay_window(drop) for drop in drops]
    plain = _readings(setup, setup.vehicle, drops, windows)
    parts = [_PART] * len(candidates)
    for _ in range(2):
        vehicles = [_with(setup.vehicle, one, part) for one, part in zip(candidates, parts, strict=True)]
        differences = [
            [moved - still for moved, still in zip(_readings(setup, vehicle, drops, windows), plain, strict=True)]
            for vehicle in vehicles
        ]
        products = _unimitated(setup, drops, plain, differences) / np.outer(parts, parts)
        found = tuple(_detectability(candidates, products, i) for i in range(len(candidates)))
        parts = [min(max(_OVER * one.smallest / one.size, _LEAST_PART), 1.0) for one in found]
    return found


def _detectability(candidates: Sequence[TermCandidate], products: Real, own: int) -> TermDetectability:
    one, gain = candidates[own], float(products[own, own])
    least = one.size * math.sqrt(one.required / gain) if gain > 0 else math.inf
    gains = np.diag(products)
    shares = np.where(gains > 0, products[own] ** 2 / np.maximum(gains * products[own, own], np.finfo(float).tiny), 0.0)
    shares[own] = 0.0
    other = int(np.argmax(shares)) if shares.size else own
    share = min(float(shares[other]), 1.0) if shares.size else 0.0
    if share < 0.1:
        return TermDetectability(one.name, one.size, gain, least)
    beside = least / math.sqrt(1 - share) if share < 1 else math.inf
    return TermDetectability(one.name, one.size, gain, least, candidates[other].name, beside)


def _with(vehicle: Vehicle, candidate: TermCandidate, part: float) -> Vehicle:
    """Return the vehicle with a part of the usual size of a term: where it is small, the gain grows as its square."""
    small = {name: _part_of(name, value, part) for name, value in candidate.parameters.items()}
    return Vehicle.from_parameters({**vehicle.parameters, **small}, name=vehicle.name, **vehicle.heights.by_key)


def _part_of(name: str, usual: float, part: float) -> float:
    neutral = NEUTRAL.get(name)
    if neutral is None:  # without effect where the others are neutral: times and travels stay what they are
        return part * usual if PARAMETERS[name].scales else usual
    return usual / part if math.isinf(neutral) else neutral + part * (usual - neutral)


def _readings(
    setup: MeasurementSetup, vehicle: Vehicle, drops: Sequence[PlannedDrop], windows: Sequence[tuple[int, int]]
) -> list[Real]:
    """Return what the sensors read in a window of each drop, SI, shape (channel, time)."""
    readout = Readout.of(setup.sensors, tuple(vehicle.parameters), vehicle.wheelbase)
    values = list(vehicle.parameters.values())
    return [
        readout.read(values, Motion(*(part[:, first : first + samples] for part in motion)))
        for motion, (first, samples) in zip(_motions(setup, vehicle, drops), windows, strict=True)
    ]


def _motions(setup: MeasurementSetup, vehicle: Vehicle, drops: Sequence[PlannedDrop]) -> list[Motion]:
    """Return the motion of each drop from the release on."""
    samples = [sum(setup.decay_window(drop)) for drop in drops]
    if nonlinear_elements(vehicle.tracks, vehicle.extras):
        starts = [setup.acting.beginning(vehicle, drop.load, drop) for drop in drops]
        whole = simulate_nonlinear_drops(vehicle, starts, 1 / setup.rate, max(samples))
        return [Motion(*(part[:, :own] for part in motion)) for motion, own in zip(whole, samples, strict=True)]
    duration = setup.duration + 1 / setup.rate
    exact = (setup.acting.motion(vehicle, drop.load, drop, duration) for drop in drops)
    return [motion.motion(1 / setup.rate, own) for motion, own in zip(exact, samples, strict=True)]


def _unimitated(
    setup: MeasurementSetup, drops: Sequence[PlannedDrop], plain: Sequence[Real], differences: Sequence[Sequence[Real]]
) -> Real:
    """Return the inner products of what the model does not imitate of the differences, over the noise, shape (term, term)."""
    # Small beside the motion itself, the differences change neither initial states nor information by which they are judged.
    factors = [_SMALL * math.sqrt(_energy(plain) / max(_energy(one), np.finfo(float).tiny)) for one in differences]
    small = [[factor * one for one in difference] for factor, difference in zip(factors, differences, strict=True)]
    alone = [_sums(plain, one) for one in small]
    pairs = list(combinations(range(len(small)), 2))
    together = [_sums(alone[i], small[j]) for i, j in pairs]
    own, of_pairs = np.split(setup.unexplained(drops, [*alone, *together]), [len(small)])
    products = np.diag(own)
    for (i, j), energy in zip(pairs, of_pairs, strict=True):
        # The energy of a sum tells the inner product.
        products[i, j] = products[j, i] = (energy - own[i] - own[j]) / 2
    return np.asarray(products / np.outer(factors, factors), dtype=np.float64)


def _sums(records: Sequence[Real], others: Sequence[Real]) -> list[Real]:
    return [record + other for record, other in zip(records, others, strict=True)]


def _energy(records: Sequence[Real]) -> float:
    return float(sum(np.sum(record**2) for record in records))
