"""Suspects: what in the campaign file or the instruments, if it were otherwise, would explain the records better.

A gain, a delay, a place: each is one more unknown of the same likelihood, and its score at the summit tells what it would
gain and which value it would take (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50), without any further fit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import FitResult, LikelihoodAt, ModalSlopes, identifiable_subspace, respond
from sprung.vehicle import Heights, LinearModel, Load, Rows, Sensor

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

Kind = Literal["gain", "late", "position", "load-position", "corner"]

_NUDGE = 0.01
"""m by which an item is moved to see what that does; its mass is quadratic in its place, so that any step is exact."""


class FaultScore(NamedTuple):
    """One thing that may be otherwise.

    Attributes
    ----------
    kind
        ``gain``: a channel reads too much, as a part; ``late``: a channel is late, s; ``position``: a sensor, and
        ``load-position``: an item of a load sits further forward or left than stated, m; ``corner``: of a channel's
        high-pass, which is higher, Hz.
    where
        The channel, or the load's name.
    axis
        0 forward, 1 left; for positions.
    item
        Which item of the load, from 0.
    value
        By how much, in that unit.
    std
        Standard uncertainty of that in white noise.
    max_parameter_shift
        By how many of its own standard uncertainties a parameter moves with one of this, the most of all parameters: how
        much less is known of the vehicle where this is not known.
    """

    kind: Kind
    where: str
    axis: int
    item: int
    value: float
    std: float
    max_parameter_shift: float

    @property
    def gain(self) -> float:
        """What twice the log-likelihood would gain."""
        return (self.value / self.std) ** 2 if self.std > 0 else 0.0


def score_faults(
    optimum: FitResult, sensors: Sequence[Sensor], loads: Mapping[str, Load], heights: Heights
) -> tuple[FaultScore, ...]:
    """List everything that may be otherwise, what would gain most first.

    Parameters
    ----------
    summit
        Where the fit ended.
    sensors
        The sensors.
    loads
        The loads by name.
    heights
        How high things are, as far as it is known.

    Returns
    -------
    tuple of Suspect
        Those of which the records say anything; none where modal coordinates do not exist, as with nonlinear forces.
    """
    place, problem = optimum.point.place, optimum.problem
    if not isinstance(place, LikelihoodAt):
        return ()
    changes = list(_changes(optimum, place, sensors, loads, heights))
    accused, slopes = [who for who, _ in changes], [slope for _, slope in changes]
    more = ModalSlopes(
        np.stack([one.poles[:, 0] for one in slopes], axis=1),
        np.stack([one.shapes[:, :, 0] for one in slopes], axis=2),
        np.stack([one.secular[:, :, 0] for one in slopes], axis=2),
    )
    found = place.beside(optimum.point.weights, more)
    if found is None:
        return ()
    gradient, information = found
    parameters = len(optimum.names)
    system, own, free = problem.system(optimum.point)
    told = identifiable_subspace(system)
    seen = (problem.priors.coordinates.slopes(optimum.point.u)[:, None] * free) @ told
    inverse = np.linalg.inv(told.T @ system @ told)
    across = seen.T @ information[:parameters, parameters:]
    left = np.diag(information)[parameters:] - np.einsum("pe,pq,qe->e", across, inverse, across)
    score = gradient[parameters:] - across.T @ inverse @ (told.T @ own)
    directions = told @ inverse
    spreads = np.sqrt(np.maximum(np.einsum("ij,ij->i", directions, told), np.finfo(float).tiny))
    shifts = np.abs(directions @ across / spreads[:, None]).max(axis=0, initial=0.0)
    alone = np.diag(information)[parameters:]
    known = left > 1e-9 * np.maximum(alone, np.finfo(float).tiny)
    named = [
        FaultScore(kind, where, axis, item, *_estimate(float(score[i]), float(left[i]), float(shifts[i])))
        for i, (kind, where, axis, item) in enumerate(accused)
        if known[i]
    ]
    return tuple(sorted(named, key=lambda one: one.gain, reverse=True))


def _estimate(score: float, left: float, max_parameter_shift: float) -> tuple[float, float, float]:
    """Return value, standard uncertainty and shift, from the score and its information beside the parameters."""
    return score / left, left**-0.5, max_parameter_shift * left**-0.5


_Who = tuple[Kind, str, int, int]


def _changes(
    optimum: FitResult, place: LikelihoodAt, sensors: Sequence[Sensor], loads: Mapping[str, Load], heights: Heights
) -> Iterator[tuple[_Who, ModalSlopes]]:
    """Give what each change does to the response of every load."""
    modes, likelihood = place.modes, place.likelihood
    nothing, no_poles = np.zeros_like(modes.shapes[:, :, None]), np.zeros_like(modes.poles[:, None])
    for channel, sensor in enumerate(sensors):
        more: tuple[tuple[Kind, Complex], ...] = (("gain", np.ones_like(modes.poles)), ("late", -modes.poles))
        for kind, factor in more:
            shapes = nothing.copy()
            shapes[:, channel, 0] = modes.shapes[:, channel] * factor
            yield (kind, sensor.channel, 0, 0), ModalSlopes(no_poles, shapes, nothing)
        if sensor.position is not None:
            for axis, row in enumerate(_along(sensor, optimum.names)):
                shapes = nothing.copy()
                shapes[:, channel, 0] = row @ modes.accelerations
                yield ("position", sensor.channel, axis, 0), ModalSlopes(no_poles, shapes, nothing)
    for number, name in enumerate(likelihood.records.loads):
        for item, piece in enumerate(loads[name].items):
            for axis in (0, 1) if piece.position is not None else ():
                forces = np.zeros_like(modes.accelerations[:, :, None])
                forces[number, :, 0] = _moved(loads[name], item, axis, heights, optimum) @ modes.accelerations[number]
                changed = respond(likelihood.loads, likelihood.sensors, place.values, modes, forces, likelihood.span)
                yield ("load-position", name, axis, item), changed


def _along(sensor: Sensor, names: Sequence[str]) -> tuple[Real, Real]:
    """Give what a body sensor's row changes by, per metre forward and left; each of shape (coordinate,)."""
    assert sensor.position is not None  # noqa: S101 (asked by the caller; for the type checker)
    x, y, z = sensor.position
    places = [(x, y, z), (x + 1, y, z), (x, y + 1, z)]
    rows = Rows.of([replace(sensor, position=one).row for one in places], names).affine[:, :, 0]
    return rows[1] - rows[0], rows[2] - rows[0]


def _moved(load: Load, item: int, axis: int, heights: Heights, optimum: FitResult) -> Real:
    """Give what M changes by, per metre that an item is moved; shape (coordinate, coordinate)."""
    sides = []
    for step in (-_NUDGE, _NUDGE):
        x, y, z = load.items[item].position or (0.0, 0.0, 0.0)
        place = (x + step * (axis == 0), y + step * (axis == 1), z + step * (axis == 2))
        there = replace(load.items[item], position=place)
        model = LinearModel.of(list(there.elements(heights)), optimum.names)
        sides.append(model.matrices(optimum.values).M)
    return (sides[1] - sides[0]) / (2 * _NUDGE)
