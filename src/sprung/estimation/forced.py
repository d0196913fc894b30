"""The likelihood of records of a linear vehicle on pads that move, in the frequency domain, with noise on its inputs too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.eliminated_inputs import EliminatedEnds, EliminatedInputs
from sprung.estimation.forced_response import ForcedResponse
from sprung.estimation.objective import NoiseCoupling
from sprung.estimation.spectral_lines import SpectralLines, lines_of
from sprung.estimation.starts import VehicleSize
from sprung.preprocess import FreeDecay
from sprung.vehicle import LinearModel, PadInputs, Readout, Sensor, Wheel

Real = NDArray[np.float64]

_ENOUGH, _MOST = 150, 4
"""Lines of each record, and records, that are enough to rank vehicles."""

_FEW, _FAR_FEWER = 256, 3
"""Lines of each record that lead a fit near its end, and how many times as many there are where a detour by them pays."""

_ROUNDING = 1e-12
"""Part of the mean square of a channel below which its noise is taken for rounding."""

_LEAST_NOISE = 0.25
"""Part of the noise above all lines that a channel has at least among them. Without a bound, a channel without noise that
explains the motion of a pad alone, while the others err, would be a solution far from all vehicles."""


@dataclass(frozen=True, eq=False)
class ForcedObjective:
    """The likelihood of records of a linear vehicle on pads that move.

    Attributes
    ----------
    decays
        What is fitted.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors over the fit's parameters, in the order of the records' channels.
    channels
        The same as they are stated.
    transformed
        The lines of the records; empty where these are still to be transformed.
    """

    decays: Sequence[FreeDecay]
    models: Mapping[str, LinearModel]
    sensors: Readout
    channels: Sequence[Sensor]
    transformed: tuple[SpectralLines, ...] = ()

    @cached_property
    def lines(self) -> tuple[SpectralLines, ...]:
        """The lines that are fitted, one record after the other."""
        return self.transformed or lines_of(self.decays)

    @cached_property
    def pads(self) -> Mapping[tuple[Wheel, ...], PadInputs]:
        """What pads add to the equations, by the wheels over those that move."""
        driven = {one.wheels for one in self.lines}
        return {wheels: PadInputs.of(wheels, self.channels, self.sensors.names) for wheels in driven}

    @cached_property
    def observations(self) -> Real:
        """Numbers in the lines by record and channel, shape (drop, channel)."""
        return np.array([one.counts for one in self.lines])

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of the lines of each channel, SI, shape (channel,)."""
        return np.asarray(np.sum([one.energy for one in self.lines], axis=0))

    @cached_property
    def noise(self) -> Real:
        """Noise variance of each channel above all lines, SI, shape (channel,): a first guess that no model is needed for."""
        used = np.array([one.usable for one in self.lines])
        mean = np.sum([one.noise for one in self.lines], axis=0) / np.maximum(used.sum(axis=0), 1)
        least = _ROUNDING * self.energy / np.maximum(self.observations.sum(axis=0), 1.0)
        return np.asarray(np.where(used.any(axis=0), np.maximum(mean, np.maximum(least, np.finfo(float).tiny)), 1.0))

    def at(self, values: Real, weights: Real) -> ForcedAt:
        """Evaluate at parameter values, SI, shape (parameter,), with weights 1/σ² of the channels, shape (channel,)."""
        return ForcedAt(self, values, weights, self.responses(values))

    def responses(self, values: Real) -> tuple[tuple[ForcedResponse, ...], ...]:
        """Return the response of the vehicle at the lines of each record, block by block, at parameter values, SI."""
        return tuple(
            tuple(
                ForcedResponse(one, self.models[one.load], self.sensors, self.pads[one.wheels], values, part)
                for part in one.blocks
            )
            for one in self.lines
        )

    def unexplained(self, vehicles: Real, weights: Real) -> Real:
        """Return what vehicles leave of some of the lines, to rank them as starts.

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
        few = tuple(one.decimated(_ENOUGH) for one in self.lines[:_MOST])
        small = replace(self, decays=self.decays[: len(few)], transformed=few)
        energy = np.sum([one.energy for one in few], axis=0)
        sums = np.array([small.at(vehicle, weights).residual_sums.sum(axis=0) for vehicle in vehicles])
        return np.asarray(sums / np.where(energy > 0, energy, 1.0))

    def of_fewer_lines(self) -> ForcedObjective | None:
        """Return the objective of so many lines of each record that fits from usual vehicles end near those of all lines."""
        few = tuple(one.decimated(_FEW) for one in self.lines)
        whole, left = (sum(len(one.values) for one in lines) for lines in (self.lines, few))
        return replace(self, transformed=few) if whole >= _FAR_FEWER * left else None

    def estimate_start(self, sensors: Sequence[Sensor], size: VehicleSize, given: Mapping[str, float]) -> None:
        """Return None: starts of driven vehicles are ranked."""

    def with_decays(self, decays: Sequence[FreeDecay]) -> ForcedObjective:
        """Return the objective of other records with the same models and sensors."""
        return ForcedObjective(decays, self.models, self.sensors, self.channels)

    def with_models(self, models: Mapping[str, LinearModel], sensors: Readout) -> ForcedObjective:
        """Return the objective of other models of the same records, which are transformed once."""
        return ForcedObjective(self.decays, models, sensors, self.channels, self.lines)


@dataclass(frozen=True, eq=False)
class ForcedAt:
    """The likelihood of driven records at parameter values and noise levels.

    Attributes
    ----------
    objective
        The likelihood.
    values
        Parameters, SI, shape (parameter,).
    weights
        1/σ² of each channel, shape (channel,).
    responses
        Of the vehicle at the lines of each record, block by block.
    """

    objective: ForcedObjective
    values: Real
    weights: Real
    responses: tuple[tuple[ForcedResponse, ...], ...]

    is_reversible = True
    by_window = None
    modal = None

    def reweighted(self, weights: Real) -> ForcedAt:
        """Return the likelihood with other weights, the response being the same."""
        return replace(self, weights=weights)

    def damped(self, _damping: float, /) -> tuple[Real, Real, float]:
        """Return information and gradient, whatever `_damping`: what is eliminated is at its maximum."""
        return self.information, self.gradient, 0.0

    def moved(self, values: Real, _damping: float = 0.0, /) -> ForcedAt:
        """Return the likelihood at other parameter values, SI, shape (parameter,)."""
        return self.objective.at(values, self.weights)

    def with_optimal_states(self) -> ForcedAt:
        """Return the likelihood itself: the ends are eliminated."""
        return self

    def of_drop(self, drop: int) -> ForcedAt:
        """Return the likelihood of one record alone, by its position."""
        return self.objective.with_decays([self.objective.decays[drop]]).at(self.values, self.weights)

    @cached_property
    def _left(self) -> tuple[EliminatedEnds, ...]:
        scale = np.sqrt(self.weights)
        return tuple(
            EliminatedEnds([EliminatedInputs(block, scale * block.lines.usable) for block in blocks])
            for blocks in self.responses
        )

    @cached_property
    def residual_sums(self) -> Real:
        """Residual sums of squares, SI, shape (drop, channel)."""
        return np.array([left.residual_sums for left in self._left])

    @cached_property
    def penalty(self) -> float:
        """Twice the negative log-likelihood of the ends of all records."""
        return sum(left.penalty for left in self._left)

    @cached_property
    def leverage(self) -> Real:
        """Number of eliminated unknowns that each channel determines, shape (channel,)."""
        return np.asarray(np.sum([left.leverage for left in self._left], axis=0))

    @cached_property
    def coupling(self) -> NoiseCoupling:
        """How the noise of channels mixes in their residuals."""
        noise = self.objective.noise
        expected = np.asarray(np.sum([left.coupling for left in self._left], axis=0))
        restriction = sum(left.restriction(1 / noise) for left in self._left)
        return NoiseCoupling(expected, _LEAST_NOISE * noise, noise, restriction)

    @cached_property
    def gradient(self) -> Real:
        """Of the log-likelihood by the parameters, per SI unit, shape (parameter,)."""
        return np.asarray(self.by_drop[0].sum(axis=0))

    @cached_property
    def information(self) -> Real:
        """Fisher information of the parameters, shape (parameter, parameter)."""
        return np.asarray(self.by_drop[1].sum(axis=0))

    @cached_property
    def by_drop(self) -> tuple[Real, Real]:
        """Gradient and information of each record; shapes (drop, parameter) and (drop, parameter, parameter)."""
        gradients, informations = zip(*(left.score for left in self._left), strict=True)
        return np.array(gradients), np.array(informations)

    def with_larger_model(
        self, models: Mapping[str, LinearModel], sensors: Readout, ways: Sequence[tuple[Real, Real]]
    ) -> tuple[Real, Real]:
        """Return gradient and information of the parameters and of changes of a larger model, as `ObjectiveAt` has it."""
        larger = self.objective.with_models(models, sensors)
        responses = [larger.responses(values) for values, _ in ways]
        found = [
            left.with_changes([(blocks[record], changes) for blocks, (_, changes) in zip(responses, ways, strict=True)])
            for record, left in enumerate(self._left)
        ]
        gradients, informations = zip(*found, strict=True)
        return np.sum(gradients, axis=0), np.sum(informations, axis=0)

    @cached_property
    def fitted(self) -> tuple[Real, ...]:
        """Modelled records, their means subtracted, SI; one array of shape (channel, time) per record.

        What is slower than the lines that are fitted is as it was measured.
        """
        scale = np.where(self.weights > 0, self.weights, 1.0) ** -0.5
        found = []
        for decay, lines, left in zip(self.objective.decays, self.objective.lines, self._left, strict=True):
            remains = lines.to_time(np.where(lines.usable, left.residual * scale, 0.0))
            found.append(lines.up_to_highest(decay) - remains)
        return tuple(found)

    @cached_property
    def states(self) -> Real:
        """{X, Ẋ} of each record at its first sample, as far as the lines tell, SI, shape (drop, state)."""
        return np.array([left.states(1)[:, 0] for left in self._left])

    def motion(self, drop: int, before: int, after: int) -> Real:
        """Return {X, Ẋ} of a record, from its first sample on; NaN before, where nothing is known of the pads.

        Parameters
        ----------
        drop
            Its position.
        before, after
            How many samples before the first one, and how many from it on.
        """
        known = self._left[drop].states(after)
        whole = np.full((len(known), before + after), np.nan)
        whole[:, before : before + known.shape[1]] = known
        return whole
