"""Suspects: what in the campaign file or the instruments, if it were otherwise, would explain the records better.

A gain, a delay, a place: each is one more unknown of the same likelihood, and its score at the optimum tells what it would
gain and which value it would take (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50), without any further fit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import ClosedFormAt, FitResult, lift_priors, score_added
from sprung.selection import required_gain
from sprung.vehicle import (
    Heights,
    LinearModel,
    Load,
    Sensor,
    SensorQuantity,
    is_of_sensor,
    sensor_unknown,
    wheelbase_of,
)

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

Kind = Literal["gain", "late", "position", "load-position", "corner"]

HYPOTHESES = 1500
"""How many are tried on a usual campaign: some fifteen of each of eight channels, and in each of a dozen drops those of every
channel and an exchange of every two."""

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
    uncertainties: int = 0
    """Where a standard uncertainty of it is stated, which `std` contains, the number of all that are stated; else 0."""

    @property
    def is_beyond_prior(self) -> bool:
        """Whether it is what lies beyond a stated uncertainty."""
        return self.uncertainties > 0

    @property
    def required(self) -> float:
        """Gain that it needs by the error budget.

        Of what is stated with an uncertainty only so much is tried as is stated, whatever is tried besides.
        """
        return required_gain(1, self.uncertainties or HYPOTHESES, 1.0)

    @property
    def gain(self) -> float:
        """What twice the log-likelihood would gain."""
        return (self.value / self.std) ** 2 if self.std > 0 else 0.0


def score_faults(
    fit: FitResult, sensors: Sequence[Sensor], loads: Mapping[str, Load], heights: Heights
) -> tuple[FaultScore, ...]:
    """Return everything that may be otherwise, what would gain most first.

    Parameters
    ----------
    fit
        Where the fit ended.
    sensors
        The sensors.
    loads
        The loads by name.
    heights
        Heights, as far as they are known.

    Returns
    -------
    tuple of FaultScore
        Those that the records determine; none where modal coordinates do not exist, as with nonlinear forces.
    """
    at = fit.iterate.at.modal
    if at is None:
        return ()
    lifted = {score[:4]: score for score in _lifted_scores(fit, sensors)}
    changes = [one for one in _changes(fit, at, sensors, loads, heights) if one[0] not in lifted]
    test = score_added(fit, *at.with_changes(np.concatenate([readings for _, readings in changes], axis=2)))
    numbers = zip(test.values.tolist(), test.stds.tolist(), test.max_shifts.tolist(), strict=True)
    scores = [
        FaultScore(*labels, *estimate)
        for (labels, _), estimate, determined in zip(changes, numbers, test.determined, strict=True)
        if determined
    ]
    return tuple(sorted((*lifted.values(), *scores), key=lambda score: score.gain, reverse=True))


_KINDS: Mapping[SensorQuantity, tuple[Kind, int]] = {
    "gain": ("gain", 0),
    "x": ("position", 0),
    "y": ("position", 1),
    "delay": ("late", 0),
}
"""Faults that lie beyond what is stated of the unknowns of a sensor."""


def _lifted_scores(fit: FitResult, sensors: Sequence[Sensor]) -> Iterator[FaultScore]:
    """Yield what would be gained if nothing were known beforehand of one unknown of a sensor.

    The covariance of the fit contains what is known: without it the variance v of an unknown that is stated with the standard
    uncertainty s is v s² / (s² - v), and twice the log-likelihood gains the square of its distance from what is stated over the
    variance of that distance.
    """
    uncertain = [name for name in fit.names if is_of_sensor(name)]
    lifts = lift_priors(fit, uncertain) if uncertain else {}
    for sensor in sensors if lifts else ():
        for quantity, (kind, axis) in _KINDS.items():
            if (lifted := lifts.get(sensor_unknown(quantity, sensor.channel))) is not None:
                yield FaultScore(kind, sensor.channel, axis, 0, *lifted, uncertainties=len(lifts))


_Labels = tuple[Kind, str, int, int]


def _changes(
    fit: FitResult, at: ClosedFormAt, sensors: Sequence[Sensor], loads: Mapping[str, Load], heights: Heights
) -> Iterator[tuple[_Labels, Complex]]:
    """Yield what each change is, and its derivatives of the readings, (load, channel, 1, 2 mode)."""
    modes, m = at.modes, at.modes.poles.shape[-1]
    observed = modes.observed(at.objective.sensors)
    for channel, sensor in enumerate(sensors):

        def of_channel(shapes: Complex, channel: int = channel) -> Complex:
            readings = np.zeros((*modes.shapes.shape[:2], 1, 2 * m), dtype=np.complex128)
            readings[:, channel, 0, :m] = shapes
            return readings

        yield ("gain", sensor.channel, 0, 0), of_channel(modes.shapes[:, channel])
        yield ("late", sensor.channel, 0, 0), of_channel(-modes.poles * modes.shapes[:, channel])
        if sensor.position is not None:
            for axis, row in enumerate(at.objective.sensors.place_slopes[:, channel]):
                yield ("position", sensor.channel, axis, 0), of_channel(row @ observed)
    places: list[_Labels] = [
        ("load-position", name, axis, item)
        for name in at.loads
        for item, piece in enumerate(loads[name].items)
        for axis in ((0, 1) if piece.position is not None else ())
    ]
    if places:
        load, coordinate, mode = modes.accelerations.shape
        forces = np.zeros((load, coordinate, len(places), mode), dtype=np.complex128)
        for change, (_, name, axis, item) in enumerate(places):
            number = at.loads.index(name)
            forces[number, :, change] = _moved(loads[name], item, axis, heights, fit) @ modes.accelerations[number]
        readings = at.differentiate_response(forces)
        yield from ((labels, readings[:, :, [change]]) for change, labels in enumerate(places))


def _moved(load: Load, item: int, axis: int, heights: Heights, fit: FitResult) -> Real:
    """Return the change of M per metre that an item is moved; shape (coordinate, coordinate)."""
    elements, wheelbase = [], wheelbase_of(fit.names, fit.values)
    for side in (-1, 1):
        step = side * _NUDGE
        x, y, z = load.items[item].position or (0.0, 0.0, 0.0)
        place = (x + step * (axis == 0), y + step * (axis == 1), z + step * (axis == 2))
        there = replace(load.items[item], position=place)
        moved = there.elements(heights, names=fit.names, wheelbase=wheelbase)
        elements += [replace(element, factor=side * element.factor) for element in moved]
    return LinearModel.of(elements, fit.names).matrices(fit.values).M / (2 * _NUDGE)
