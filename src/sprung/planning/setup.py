"""Planned drops and the Fisher information in them.

The information in a drop is that of its decay without noise, at the true parameters, weighted with the noise that the
sensors will have: the same exact derivatives that the fit uses, so that the bound is the one the fit will meet. Drops are
independent, so their informations add; repeating a drop multiplies its own, and half the noise makes four times as much.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import DEFAULT_HEIGHT, Drop, Excitation
from sprung.display import shown
from sprung.errors import InputError, Problem
from sprung.estimation import ClosedFormObjective, Coordinates, PriorsAndConstraints, eliminate, statements_of
from sprung.preprocess import FreeDecay, unknown_release
from sprung.simulation import Acting, DropMotion
from sprung.uncertainty import KnownValue
from sprung.vehicle import (
    LinearModel,
    Load,
    Readout,
    Sensor,
    Tracks,
    Vehicle,
    Wheel,
    is_nuisance,
    linear_elements,
    parameter_names,
    parameter_of,
    stiffened_air_springs,
)

Real = NDArray[np.float64]

_SHORTEST = 0.5
"""s of free vibration that a recording must hold to be of any use."""


class PlannedDrop(NamedTuple):
    """One planned release off the blocks, push or pass over a bump.

    Attributes
    ----------
    load
        Load on the vehicle.
    wheels
        With blocks under them; of a push those between which the body is pushed, of a pass those that run over the bump.
    height
        Of the blocks, m.
    excitation
        What excites the vehicle.
    speed
        Of a pass, m/s; None for a usual one.
    """

    load: Load
    wheels: tuple[Wheel, ...]
    height: float = DEFAULT_HEIGHT
    excitation: Excitation = "drop"
    speed: float | None = None

    @classmethod
    def of(cls, drop: Drop, load: Load, wheels: tuple[Wheel, ...] | None = None) -> PlannedDrop:
        """Return a drop of a campaign with its load, and its wheels where others fell than it states."""
        return cls(load, wheels or drop.wheels, drop.height or DEFAULT_HEIGHT, drop.excitation, drop.speed)


@shown
@dataclass(frozen=True, eq=False)
class MeasurementSetup:
    """A vehicle to be tested, what is known of it beforehand, and how it is measured.

    Attributes
    ----------
    vehicle
        With the best available values of its parameters.
    tracks, extras
        The model to be fitted.
    known
        Quantities known beforehand, with the wheelbase.
    sensors
        The sensors.
    noise
        Of each sample, m/s² root-mean-square, shape (channel,).
    rate
        Samples per second.
    duration
        Of the recording after the release, or after nothing drives the vehicle any more, s.
    inflation
        Factor by which coloured residuals increase the variance of the estimates.
    delay
        Of the first sample that is used, after the last lift-off, s.
    acting
        How the body is pushed, and what is driven over.
    """

    vehicle: Vehicle
    tracks: Tracks
    extras: tuple[str, ...]
    known: Mapping[str, KnownValue]
    sensors: tuple[Sensor, ...]
    noise: Real
    rate: float
    duration: float = 3.2
    inflation: float = 1.0
    delay: float = 0.0
    acting: Acting = field(default_factory=Acting)

    def __post_init__(self) -> None:
        invalid = [
            Problem(f"vehicle {self.vehicle.name}: {name}", "0", "a positive number", "Give it a small value instead.")
            for name, value in zip(self.names, self.values, strict=True)
            if parameter_of(name).positive and not value > 0
        ]
        if invalid:
            raise InputError(invalid)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Parameters of the model, masses of loads that are known with an uncertainty, and what is uncertain of the sensors."""
        return (*self._own_names, *filter(is_nuisance, self.statements))

    @property
    def _own_names(self) -> tuple[str, ...]:
        return parameter_names(self.tracks, self.extras, self.vehicle.layout)

    @cached_property
    def statements(self) -> Mapping[str, KnownValue]:
        """Everything that is known beforehand, of the vehicle, of loads and of sensors."""
        return statements_of(self.known, self.sensors, self._own_names)

    @cached_property
    def values(self) -> Real:
        """Their values, SI, shape (parameter,)."""
        stated = {name: one.value for name, one in self.statements.items() if is_nuisance(name)}
        return np.array(
            [stated[name] if name in stated else getattr(self.vehicle, name) for name in self.names], dtype=float
        )

    @cached_property
    def priors(self) -> PriorsAndConstraints:
        """What is known beforehand, in the coordinates of the fit: a model term is relative to a spring or damper rate."""
        return PriorsAndConstraints(Coordinates.scaled_by(self.names, self.vehicle.parameters), self.statements)

    @cached_property
    def u(self) -> Real:
        """Coordinates of the fit, shape (parameter,)."""
        return self.priors.coordinates.from_values(self.values)

    @cached_property
    def slopes(self) -> Real:
        """Derivative of each value by its coordinate, shape (parameter,)."""
        return self.priors.coordinates.derivatives(self.u)

    @cached_property
    def free(self) -> Real:
        """Directions of the coordinates that exact constraints leave free, shape (parameter, direction)."""
        return self.priors.null_space(self.u)

    def prior_information(self, known: Mapping[str, KnownValue]) -> Real:
        """Return the information in quantities known with an uncertainty; shape (direction, direction)."""
        _, by_coordinate = PriorsAndConstraints(self.priors.coordinates, known).residuals(self.u)
        slopes = by_coordinate @ self.free
        return slopes.T @ slopes

    def with_sensors(self, sensors: Sequence[Sensor], noise: Sequence[float]) -> MeasurementSetup:
        """Return the same measurement with further sensors.

        Parameters
        ----------
        sensors
            The sensors.
        noise
            Of each, SI root-mean-square.
        """
        return replace(self, sensors=(*self.sensors, *sensors), noise=np.append(self.noise, noise))

    def drop_information(self, drops: Sequence[PlannedDrop], rate: float | None = None) -> Real:
        """Return the Fisher information in drops, each done once.

        Parameters
        ----------
        drops
            The drops.
        rate
            Samples per second, if other than planned; the noise density of a sensor is the same, so that of a sample changes.

        Returns
        -------
        ndarray
            Shape (direction, direction).

        Raises
        ------
        InputError
            If the vehicle cannot be dropped so, or does not come to rest on its tyres in time.
        """
        return self.free.T @ self._coordinate_information(drops, rate or self.rate) @ self.free

    def information_with(self, sensors: Sequence[Sensor], noise: Sequence[float], drops: Sequence[PlannedDrop]) -> Real:
        """Return the Fisher information in drops that further sensors record too; what is uncertain of these is eliminated.

        Parameters
        ----------
        sensors, noise
            As for `with_sensors`.
        drops
            The drops.

        Returns
        -------
        ndarray
            Shape (direction, direction).

        Raises
        ------
        InputError
            As for `drop_information`.
        """
        larger = self.with_sensors(sensors, noise)
        information = larger._coordinate_information(drops, self.rate)
        known = {name: one for name, one in larger.statements.items() if name not in self.statements}
        _, by_coordinate = PriorsAndConstraints(larger.priors.coordinates, known).residuals(larger.u)
        information = information + by_coordinate.T @ by_coordinate
        order = [larger.names.index(name) for name in (*self.names, *known)]
        kept = len(self.names)
        information, _, _ = eliminate(information[np.ix_(order, order)], np.zeros(len(order)), kept)
        return self.free.T @ information @ self.free

    def _coordinate_information(self, drops: Sequence[PlannedDrop], sampling: float) -> Real:
        """Return the Fisher information in drops, shape (coordinate, coordinate)."""
        if not drops:
            return np.zeros((len(self.u),) * 2)
        names = _load_names(drops)
        decays = [self._decay(drop, names[drop.load], sampling) for drop in drops]
        weights = self.rate / sampling / self.noise**2
        of_parameters = self._objective(decays, names).at(self.values, weights).information
        information: Real = self.slopes[:, None] * of_parameters * self.slopes / self.inflation
        return information

    def unexplained(self, drops: Sequence[PlannedDrop], alternatives: Sequence[Sequence[Real]]) -> Real:
        """Return what the model does not explain of records near those of the vehicle, after one Newton step from it.

        Parameters
        ----------
        drops
            The drops.
        alternatives
            Each a record of every drop, of the samples that `decay_window` states, m/s², shape (channel, time).

        Returns
        -------
        ndarray
            Sum of squares over the noise of each alternative, shape (alternative,).
        """
        names = _load_names(drops)
        decays = [self._decay(drop, names[drop.load], self.rate) for drop in drops]
        objective, weights = self._objective(decays, names), 1 / self.noise**2
        directions = self.slopes[:, None] * self.free
        stated = self.prior_information(self.statements)
        left = []
        for records in alternatives:
            recorded = [replace(decay, values=record) for decay, record in zip(decays, records, strict=True)]
            found = objective.with_decays(recorded).at(self.values, weights)
            information = directions.T @ found.information @ directions + stated
            score = directions.T @ found.gradient
            explained = float(score @ np.linalg.lstsq(information, score, rcond=1e-12)[0])
            energy = float((found.residual_sums @ weights).sum() + found.penalty)
            left.append(max(energy - explained, 0.0) / self.inflation)
        return np.array(left)

    def _objective(self, decays: Sequence[FreeDecay], names: Mapping[Load, str]) -> ClosedFormObjective:
        heights, wheelbase = self.vehicle.heights, self.vehicle.wheelbase
        layout = self.vehicle.layout
        elements = linear_elements(self.tracks, self.extras, heights, wheelbase, layout)
        models = {
            name: LinearModel.of(
                elements
                + stiffened_air_springs(
                    load.mass_at_wheels(wheelbase, layout), self.tracks, self.extras, wheelbase, layout
                )
                + load.elements(heights, self.names, wheelbase),
                self.names,
            )
            for load, name in names.items()
        }
        return ClosedFormObjective(decays, models, Readout.of(self.sensors, self.names, wheelbase))

    def decay_window(self, drop: PlannedDrop) -> tuple[int, int]:
        """Return the first sample of a drop's decay, counted from the release, and the number of samples."""
        return self._window(self._motion(drop), self.rate)

    def _motion(self, drop: PlannedDrop) -> DropMotion:
        return self.acting.motion(self.vehicle, drop.load, drop, self.duration)

    def _window(self, motion: DropMotion, rate: float) -> tuple[int, int]:
        first = math.ceil((motion.decay_start + self.delay) * rate)
        return first, int((motion.driven_until + self.duration) * rate) - first

    def _decay(self, drop: PlannedDrop, load: str, rate: float) -> FreeDecay:
        motion = self._motion(drop)
        first, samples = self._window(motion, rate)
        if samples < _SHORTEST * rate:
            found = f"{max(samples / rate, 0.0):.2f} s of free vibration within {self.duration:.1f} s of the release"
            where = f"drop of {self.vehicle.name}, load '{drop.load.name}'"
            raise InputError([Problem(where, found, f"{_SHORTEST} s", "Lower the blocks, or record for longer.")])
        parameters, channels = self.vehicle.parameters, len(self.sensors)
        readout = Readout.of(self.sensors, tuple(parameters), self.vehicle.wheelbase)
        return FreeDecay(
            name=load,
            file=load,
            load=load,
            values=readout.read(list(parameters.values()), motion.motion(1 / rate, samples, first / rate)),
            earlier=np.zeros((channels, 0)),
            rate=rate,
            start=first / rate,
            rest=unknown_release(channels),
        )


def _load_names(drops: Sequence[PlannedDrop]) -> dict[Load, str]:
    return {load: f"{i}" for i, load in enumerate(dict.fromkeys(drop.load for drop in drops))}


@shown
@dataclass(frozen=True, eq=False)
class PlannedTest:
    """A test: drops of one vehicle, planned or completed.

    Attributes
    ----------
    setup
        Vehicle, model and measurement.
    drops
        The drops, each done once.
    recorded_information
        Information in their recordings if the test is completed, dimensionless, shape (direction, direction); else None.
    """

    setup: MeasurementSetup
    drops: tuple[PlannedDrop, ...]
    recorded_information: Real | None = field(default=None, repr=False)

    @cached_property
    def information(self) -> Real:
        """Information in the drops, shape (direction, direction)."""
        return (
            self.setup.drop_information(self.drops) if self.recorded_information is None else self.recorded_information
        )

    @cached_property
    def known_information(self) -> Real:
        """Information in what is known beforehand, shape (direction, direction)."""
        return self.setup.prior_information(self.setup.statements)
