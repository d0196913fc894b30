"""The likelihood of free decays and of driven records of one vehicle together: the sum of both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import ClosedFormObjective
from sprung.estimation.forced import ForcedObjective
from sprung.estimation.objective import LinearObjective, NoiseCoupling, ObjectiveAt
from sprung.estimation.starts import VehicleSize
from sprung.preprocess import FreeDecay
from sprung.vehicle import LinearModel, Readout, Sensor

Real = NDArray[np.float64]


def driven_objective(
    decays: Sequence[FreeDecay], models: Mapping[str, LinearModel], sensors: Readout, channels: Sequence[Sensor]
) -> LinearObjective:
    """Return the likelihood of records of which at least some are driven, as `linear_objective` does of any.

    Parameters
    ----------
    decays, models, sensors, channels
        As for `linear_objective`.

    Returns
    -------
    LinearObjective
    """
    free = tuple(decay for decay in decays if not decay.pads)
    driven = tuple(decay for decay in decays if decay.pads)
    forced = ForcedObjective(driven, models, sensors, tuple(channels))
    return JointObjective(tuple(decays), (ClosedFormObjective(free, models, sensors), forced)) if free else forced


@dataclass(frozen=True, eq=False)
class JointObjective:
    """The likelihood of several kinds of records.

    Attributes
    ----------
    decays
        What is fitted, in order.
    parts
        The objectives of free decays and of driven records; each has its own records in their order.
    """

    decays: Sequence[FreeDecay]
    parts: tuple[LinearObjective, LinearObjective]

    @cached_property
    def positions(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Positions of the records of each part."""
        free = tuple(i for i, decay in enumerate(self.decays) if not decay.pads)
        return free, tuple(i for i, decay in enumerate(self.decays) if decay.pads)

    def in_order(self, by_part: Sequence[Real]) -> Real:
        """Return what belongs to each record in the order of all records."""
        found = np.empty((len(self.decays), *by_part[0].shape[1:]))
        for positions, own in zip(self.positions, by_part, strict=True):
            found[list(positions)] = own
        return found

    def place(self, drop: int) -> tuple[int, int]:
        """Return the part that a record belongs to, and its position there."""
        part = int(bool(self.decays[drop].pads))
        return part, self.positions[part].index(drop)

    @property
    def sensors(self) -> Readout:
        """The sensors over the fit's parameters."""
        return self.parts[0].sensors

    @cached_property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        return self.in_order([part.observations for part in self.parts])

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, SI, shape (channel,)."""
        return np.asarray(np.sum([part.energy for part in self.parts], axis=0))

    def at(self, values: Real, weights: Real) -> JointAt:
        """Evaluate at parameter values, SI, shape (parameter,), with weights 1/σ² of the channels, shape (channel,)."""
        free, driven = (part.at(values, weights) for part in self.parts)
        return JointAt(self, (free, driven))

    def with_decays(self, decays: Sequence[FreeDecay]) -> LinearObjective:
        """Return the objective of other decays with the same models and sensors."""
        free = [decay for decay in decays if not decay.pads]
        driven = [decay for decay in decays if decay.pads]
        if not free or not driven:
            return self.parts[int(not free)].with_decays(decays)
        return JointObjective(tuple(decays), (self.parts[0].with_decays(free), self.parts[1].with_decays(driven)))

    def with_models(self, models: Mapping[str, LinearModel], sensors: Readout) -> JointObjective:
        """Return the objective of other models of the same records."""
        free, driven = (part.with_models(models, sensors) for part in self.parts)
        return replace(self, parts=(free, driven))

    def unexplained(self, vehicles: Real, weights: Real) -> Real:
        """Return what vehicles leave of some of the records, to rank them as starts; (vehicle, channel)."""
        return np.asarray(np.sum([part.unexplained(vehicles, weights) for part in self.parts], axis=0))

    def of_fewer_lines(self) -> None:
        """Return None: the free decays lead near the end by themselves."""

    def estimate_start(
        self, sensors: Sequence[Sensor], size: VehicleSize, given: Mapping[str, float]
    ) -> dict[str, float] | None:
        """Return the parameters of a vehicle near the one that is sought, by the first part that shows it."""
        found = (part.estimate_start(sensors, size, given) for part in self.parts)
        return next((one for one in found if one is not None), None)


@dataclass(frozen=True, eq=False)
class JointAt:
    """The likelihood of several kinds of records at parameter values and noise levels.

    Attributes
    ----------
    objective
        The likelihood.
    parts
        Those of free decays and of driven records.
    """

    objective: JointObjective
    parts: tuple[ObjectiveAt, ObjectiveAt]

    is_reversible = True
    by_window = None
    modal = None

    @property
    def values(self) -> Real:
        """Parameters, SI, shape (parameter,)."""
        return self.parts[0].values

    @property
    def weights(self) -> Real:
        """1/σ² of each channel, shape (channel,)."""
        return self.parts[0].weights

    def reweighted(self, weights: Real) -> JointAt:
        """Return the likelihood with other weights."""
        free, driven = (part.reweighted(weights) for part in self.parts)
        return replace(self, parts=(free, driven))

    def damped(self, _damping: float, /) -> tuple[Real, Real, float]:
        """Return information and gradient, whatever `_damping`: what is eliminated is at its maximum."""
        return self.information, self.gradient, 0.0

    def moved(self, values: Real, _damping: float = 0.0, /) -> JointAt:
        """Return the likelihood at other parameter values, SI, shape (parameter,)."""
        free, driven = (part.moved(values) for part in self.parts)
        return replace(self, parts=(free, driven))

    def with_optimal_states(self) -> JointAt:
        """Return the likelihood itself: initial states are eliminated."""
        return self

    def of_drop(self, drop: int) -> ObjectiveAt:
        """Return the likelihood of one record alone, by its position."""
        part, position = self.objective.place(drop)
        return self.parts[part].of_drop(position)

    @cached_property
    def residual_sums(self) -> Real:
        """Residual sums of squares, SI, shape (drop, channel)."""
        return self.objective.in_order([part.residual_sums for part in self.parts])

    @property
    def penalty(self) -> float:
        """Twice the negative log-likelihood of eliminated unknowns that have a prior."""
        return sum(part.penalty for part in self.parts)

    @cached_property
    def leverage(self) -> Real:
        """Number of eliminated unknowns that each channel determines, shape (channel,)."""
        return np.asarray(np.sum([part.leverage for part in self.parts], axis=0))

    @cached_property
    def coupling(self) -> NoiseCoupling:
        """How the noise of channels mixes in their residuals."""
        free, driven = self.parts
        found = driven.coupling
        if found is None:
            raise RuntimeError("unknown motions of pads couple the noise of channels")
        observations = self.objective.parts[0].observations
        spent = np.sum(observations > 0, axis=0) + free.leverage
        return found._replace(
            expected=found.expected + np.diag(observations.sum(axis=0) - spent),
            restriction=found.restriction + float(spent @ np.log(self.weights * found.reference)),
        )

    @cached_property
    def gradient(self) -> Real:
        """Of the log-likelihood by the parameters, per SI unit, shape (parameter,)."""
        return np.asarray(np.sum([part.gradient for part in self.parts], axis=0))

    @cached_property
    def information(self) -> Real:
        """Fisher information of the parameters, shape (parameter, parameter)."""
        return np.asarray(np.sum([part.information for part in self.parts], axis=0))

    @cached_property
    def by_drop(self) -> tuple[Real, Real]:
        """Gradient and information of each drop; shapes (drop, parameter) and (drop, parameter, parameter)."""
        gradients, informations = zip(*(part.by_drop for part in self.parts), strict=True)
        return self.objective.in_order(gradients), self.objective.in_order(informations)

    def with_larger_model(
        self, models: Mapping[str, LinearModel], sensors: Readout, ways: Sequence[tuple[Real, Real]]
    ) -> tuple[Real, Real] | None:
        """Return gradient and information of the parameters and of changes of a larger model, as `ObjectiveAt` has it."""
        free, driven = (part.with_larger_model(models, sensors, ways) for part in self.parts)
        if free is None or driven is None:
            return None
        return free[0] + driven[0], free[1] + driven[1]

    @cached_property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, SI; one array of shape (channel, time) per record."""
        by_part = [part.fitted for part in self.parts]
        return tuple(self._of(drop, by_part) for drop in range(len(self.objective.decays)))

    def _of(self, drop: int, by_part: Sequence[Sequence[Real]]) -> Real:
        part, position = self.objective.place(drop)
        return by_part[part][position]

    @cached_property
    def states(self) -> Real:
        """{X, Ẋ} of each record at its first sample, SI, shape (drop, state)."""
        return self.objective.in_order([part.states for part in self.parts])

    def motion(self, drop: int, before: int, after: int) -> Real:
        """Return {X, Ẋ} of a record around its first sample, SI, shape (state, before + after)."""
        part, position = self.objective.place(drop)
        return self.parts[part].motion(position, before, after)
