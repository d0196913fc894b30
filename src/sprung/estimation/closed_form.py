"""The closed form: the likelihood of all decays of a linear vehicle, its initial states and offsets eliminated.

Every sum over samples is a sum of exponentials, so an evaluation meets the records in one matrix product and everything else is
small. Where modal coordinates do not exist, at critical damping, `MatrixExponentialAt` takes over.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form_likelihood import ClosedFormAt
from sprung.estimation.modal_solution import solve_modes
from sprung.estimation.modulating_functions import modulating_function_estimate
from sprung.estimation.objective import LinearObjective, ObjectiveAt
from sprung.estimation.projected_response import ExponentialSums
from sprung.estimation.records import RecordBatch, batch_records, in_order
from sprung.estimation.start_ranking import rank_starts
from sprung.estimation.starts import VehicleSize
from sprung.preprocess import FreeDecay
from sprung.vehicle import LinearModel, Readout, Sensor

Real = NDArray[np.float64]

_UNBOUNDED = 100.0
"""Powers of e by which no motion grows within a record."""

_MEETING = 0.05
"""Separation below which two modes have all but met in one shape."""


def linear_objective(
    decays: Sequence[FreeDecay], models: Mapping[str, LinearModel], sensors: Readout, channels: Sequence[Sensor]
) -> LinearObjective:
    """Return the likelihood of records of a linear vehicle, free or driven or both.

    Parameters
    ----------
    decays
        The records.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors over the fit's parameters.
    channels
        The same as they are stated.

    Returns
    -------
    LinearObjective
    """
    if not any(decay.pads for decay in decays):
        return ClosedFormObjective(tuple(decays), models, sensors)
    from sprung.estimation.joint_objective import driven_objective  # noqa: PLC0415 (only records on pads need it)

    return driven_objective(decays, models, sensors, channels)


@dataclass(frozen=True, eq=False)
class ClosedFormObjective:
    """The likelihood of decays of a linear vehicle.

    Attributes
    ----------
    decays
        What is fitted.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors over the fit's parameters, in the order of the decays' channels.
    cut
        The decays, centred and cut into blocks already; empty where that is still to be done.
    """

    decays: Sequence[FreeDecay]
    models: Mapping[str, LinearModel]
    sensors: Readout
    cut: tuple[RecordBatch, ...] = ()

    @cached_property
    def loads(self) -> tuple[str, ...]:
        """Names of the loads, sorted."""
        return tuple(sorted({decay.load for decay in self.decays}))

    @cached_property
    def batches(self) -> tuple[RecordBatch, ...]:
        """The decays, centred and cut into blocks."""
        return self.cut or batch_records(self.decays, self.sensors.names)

    @cached_property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        return in_order(self.batches, [batch.channel_weights * batch.samples[:, None] for batch in self.batches])

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""
        energy: Real = np.sum([batch.channel_weights * batch.energy.sum(axis=0) for batch in self.batches], axis=0)
        return energy

    @cached_property
    def side_by_side(self) -> LinearModel:
        """The models of all loads side by side."""
        return LinearModel.stack([self.models[load] for load in self.loads])

    @cached_property
    def span(self) -> float:
        """Length of the longest record, s."""
        return max(batch.duration for batch in self.batches)

    @cached_property
    def _has_clocks(self) -> bool:
        return any(batch.clock_design.shape[1] for batch in self.batches)

    def unexplained(self, vehicles: Real, weights: Real) -> Real:
        """Return what vehicles leave of some of the records, to rank them as starts.

        Parameters
        ----------
        vehicles
            Parameters, SI, shape (vehicle, parameter).
        weights
            1/σ² of each channel, SI, shape (channel,).

        Returns
        -------
        ndarray
            Residual sums of squares over their energy, dimensionless, shape (vehicle, channel).
        """
        return rank_starts(self, vehicles, weights)

    def of_fewer_lines(self) -> None:
        """Return None: the sums of the records are what a fit goes through, however many samples they have."""

    def estimate_start(
        self, sensors: Sequence[Sensor], size: VehicleSize, given: Mapping[str, float]
    ) -> dict[str, float] | None:
        """Return the parameters of a vehicle near the one that is sought, SI by name, without any guess.

        Parameters
        ----------
        sensors
            As stated.
        size
            Size of the vehicle.
        given
            Parameters that are held at a value, SI, by name.

        Returns
        -------
        dict or None
            None where the records do not show it; see `modulating_function_estimate`.
        """
        models = [self.models[load].with_known(given) if given else self.models[load] for load in self.loads]
        return modulating_function_estimate(self.batches, models, sensors, size)

    def with_decays(self, decays: Sequence[FreeDecay]) -> ClosedFormObjective:
        """Return the objective of other decays with the same models and sensors."""
        return ClosedFormObjective(decays, self.models, self.sensors)

    def with_models(self, models: Mapping[str, LinearModel], sensors: Readout) -> ClosedFormObjective:
        """Return the objective of other models of the same decays, which are cut into blocks once."""
        # What several loggers' clocks tell of the parameters belongs to the parameters of one model.
        return ClosedFormObjective(self.decays, models, sensors, () if self._has_clocks else self.batches)

    def at(self, values: Real, weights: Real) -> ObjectiveAt:
        """Evaluate at parameter values, SI, shape (parameter,), with weights 1/σ² of the channels, s⁴/m², shape (channel,)."""
        modes = solve_modes(self.side_by_side, self.sensors, values)
        # Rates that may be negative can make a motion that grows beyond all bounds.
        if float(modes.poles.real.max()) * self.span > _UNBOUNDED:
            return ClosedFormAt(self, values, weights, modes, ())
        # Delays turn shapes: they need modal coordinates, and bear with what rounding leaves near a critical damping.
        if not (self._has_clocks or self.sensors.has_delays) and modes.separation < _MEETING:
            from sprung.estimation.matrix_exponential import MatrixExponentialAt  # noqa: PLC0415 (hardly ever needed)

            return MatrixExponentialAt(self, self.models, self.sensors, values, weights)
        sums = tuple(ExponentialSums.of(batch, values, modes) for batch in self.batches)
        return ClosedFormAt(self, values, weights, modes, sums)
