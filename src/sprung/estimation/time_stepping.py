"""Time stepping: the likelihood of all decays of a vehicle with nonlinear forces, all drops and all derivatives in one batch.

The initial states of a linear vehicle are eliminated in closed form; here each evaluation has its own, and those of the
next one are predicted from the derivatives at this one. Memories of dry friction are part of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.low_pass import LowPass, SampledLowPass
from sprung.estimation.priors import scaling_direction
from sprung.estimation.projected_response import initial_state_prior_std
from sprung.estimation.records import channel_rate_ratios
from sprung.estimation.stepped_likelihood import TimeSteppingAt
from sprung.estimation.stepped_motion import SteppedMotion
from sprung.preprocess import FreeDecay
from sprung.vehicle import (
    NonlinearModel,
    Readout,
    Stepper,
    coordinates,
    layout_of,
    parameter_of,
)

Real = NDArray[np.float64]
Index = NDArray[np.int64]

_MEMORY_STD = 1.0
"""Prior standard uncertainty of a friction's memory when a decay begins, as a part of the friction."""

_MOST_MEMORY = 2.0
"""Memory that no friction has: it slides at one, and noise and a friction of another law add as much at the most."""


@dataclass(frozen=True, eq=False)
class TimeSteppingObjective:
    """The likelihood of decays of a vehicle with nonlinear forces.

    Attributes
    ----------
    decays
        What is fitted.
    models
        Equations of motion by load name, all over the same parameters.
    sensors
        The sensors over the fit's parameters, in the order of the decays' channels.
    states
        {X, Ẋ} of each drop at its first sample, from which an evaluation starts, and memories where they are known, from where
        the vehicle rests with its load; shape (drop, state) or (drop, state + memory).
    sensors_tilt
        Whether the sensors turn with the body, and measure the less of gravity.
    longest_step
        s: over a longer one forces do not run straight.
    low_pass
        Of the loggers, which all channels passed; None for none. Its corner may be one of the parameters: this one is where a
        fit begins, and the samples of its delay are taken from it.
    """

    decays: Sequence[FreeDecay]
    models: Mapping[str, NonlinearModel]
    sensors: Readout
    states: Real
    sensors_tilt: bool
    longest_step: float
    low_pass: LowPass | None = None

    @cached_property
    def _kinds(self) -> list[tuple[str, float]]:
        """Kinds of steps: a load and a rate."""
        return sorted({(decay.load, decay.rate) for decay in self.decays})

    @cached_property
    def kind(self) -> Index:
        """Which kind of step each drop takes, shape (drop,)."""
        return np.array([self._kinds.index((decay.load, decay.rate)) for decay in self.decays])

    @cached_property
    def models_by_kind(self) -> tuple[NonlinearModel, ...]:
        """Equations of motion of each kind of step."""
        return tuple(self.models[load] for load, _ in self._kinds)

    @cached_property
    def times(self) -> tuple[float, ...]:
        """Length of each kind of step, s."""
        return tuple(1.0 / (rate * self.every) for _, rate in self._kinds)

    @cached_property
    def every(self) -> int:
        """Steps from one sample to the next."""
        return max(int(np.ceil(1.0 / (min(decay.rate for decay in self.decays) * self.longest_step))), 1)

    @cached_property
    def samples(self) -> Index:
        """Of each drop, shape (drop,)."""
        return np.array([decay.samples for decay in self.decays])

    @cached_property
    def records(self) -> Real:
        """Centred records, m/s², zero beyond their end and in channels that are left out; shape (drop, channel, time)."""
        records = np.zeros((len(self.decays), len(self.decays[0].values), int(self.samples.max())))
        for record, decay in zip(records, self.decays, strict=True):
            centred = decay.values - decay.values.mean(axis=1, keepdims=True)
            record[:, : decay.samples] = np.where(decay.usable[:, None], centred, 0.0)
        return records

    @cached_property
    def channel_weights(self) -> Real:
        """0 for a channel that is left out, else the samples that were taken for each one; shape (drop, channel)."""
        return np.array([decay.usable * channel_rate_ratios(decay) for decay in self.decays])

    @cached_property
    def observations(self) -> Real:
        """Samples that count by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        counted: Real = self.channel_weights * self.is_sample.sum(axis=1, keepdims=True)
        return counted

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""
        squares = np.einsum("dct,dct->dc", self.records, self.records)
        energy: Real = (self.channel_weights * squares).sum(axis=0)
        return energy

    @cached_property
    def is_sample(self) -> Real:
        """1 where a drop has a sample that counts, shape (drop, time)."""
        counted = self.samples - np.array([low_pass.lag for low_pass in self.low_passes])
        is_sample: Real = (np.arange(self.records.shape[2]) < counted[:, None]).astype(float)
        return is_sample

    @cached_property
    def low_passes(self) -> tuple[SampledLowPass, ...]:
        """The low-pass at the sampling rate of each drop."""
        by_rate = {rate: SampledLowPass.of(self.low_pass, rate) for _, rate in self._kinds}
        return tuple(by_rate[decay.rate] for decay in self.decays)

    def low_passes_at(self, values: Real, part: float = 1.0) -> tuple[SampledLowPass, ...]:
        """Return the low-pass at parameter values, SI, shape (parameter,), or one with a part of its corner."""
        position = self.sensors.corner_position
        if position is None:
            return self.low_passes
        return tuple(one.with_corner(part * float(values[position])) for one in self.low_passes)

    def free_signals(self, low_passes: Sequence[SampledLowPass]) -> Real:
        """Return what each record may show whatever the motion behind a low-pass for each drop.

        Orthonormal, shape (drop, time, signal); see `SampledLowPass`.
        """
        of_drops = [
            low_pass.free_signals(decay.samples) for low_pass, decay in zip(low_passes, self.decays, strict=True)
        ]
        signals = np.zeros((len(of_drops), self.records.shape[2], max(own.shape[1] for own in of_drops)))
        for padded, own in zip(signals, of_drops, strict=True):
            padded[: own.shape[0], : own.shape[1]] = own
        return signals

    @cached_property
    def shows_scale(self) -> bool:
        """Whether any record would change if every mass and rate of the vehicle grew alike."""
        grows = np.array([parameter_of(name).scales for name in self.sensors.names[: self.sensors.shared]])
        read = self.sensors.rows.affine[:, :, 1:][:, :, grows]
        return bool(read.any()) or any(model.linear.has_scale for model in self.models_by_kind)

    def change_between(self, values: Real, others: Real) -> Real:
        """Return the change from parameter values to others that initial states follow, SI, shape (parameter,) each.

        The delay of a low-pass is reciprocal to its corner, and moves the motion in time: of the corner it is the change that
        would delay as much if the delay were linear.
        """
        change = others - values
        if (corner := self.sensors.corner_position) is not None:
            change[corner] *= values[corner] / others[corner]
        return change

    def visible_changes(self, values: Real) -> Real:
        """Return what of a change of the parameters records show, as a projection, SI, shape (parameter, parameter).

        Where nothing gives the scale, no motion changes with it. Steps, and what is assumed of the memories of friction,
        keep this symmetry only in part: they would weigh a vehicle that nobody has weighed.
        """
        everything = np.eye(len(values))
        if self.shows_scale:
            return everything
        along = scaling_direction(self.sensors.names, values, np.ones(len(values)))
        grows = along != 0
        share = np.divide(1.0, values * np.sum(grows), out=np.zeros(len(values)), where=grows)
        return everything - np.outer(along, share)

    @property
    def state_size(self) -> int:
        """How many numbers {X, Ẋ} has."""
        return self.models_by_kind[0].state_size

    @property
    def coordinates(self) -> int:
        """How many numbers X has."""
        return len(coordinates(self.models_by_kind[0].names))

    @property
    def angles(self) -> slice:
        """Positions of the angles of the body among the coordinates."""
        return slice(1, len(layout_of(self.models_by_kind[0].names).body))

    @cached_property
    def prior_std(self) -> Real:
        """Prior standard uncertainty of initial states and memories, shape (state + memory,)."""
        memories = self.models_by_kind[0].forces.memories
        return np.concatenate(
            [initial_state_prior_std(self.coordinates, self.state_size), np.full(memories, _MEMORY_STD)]
        )

    def with_decays(self, decays: Sequence[FreeDecay]) -> TimeSteppingObjective:
        """Return the objective of other decays; those of the same recordings start from the same states, others from rest."""
        known = {decay.file: state for decay, state in zip(self.decays, self.states, strict=True)}
        rest = np.zeros(self.states.shape[1])
        return replace(self, decays=decays, states=np.array([known.get(decay.file, rest) for decay in decays]))

    def with_states(self, states: Real) -> TimeSteppingObjective:
        """Return the objective with other initial states and memories to start from, shape (drop, state + memory)."""
        return replace(self, states=states)

    def at(self, values: Real, weights: Real) -> TimeSteppingAt:
        """Evaluate at parameter values, SI, shape (parameter,), with 1/σ² of each channel, s⁴/m², shape (channel,)."""
        begin = self.sag(values)
        begin[:, : self.states.shape[1]] += self.states[:, : begin.shape[1]]
        return self.at_states(values, weights, begin)

    def at_states(self, values: Real, weights: Real, begin: Real) -> TimeSteppingAt:
        """Evaluate with initial states and memories from where the empty vehicle rests, shape (drop, state + memory)."""
        states, memories = np.split(begin, [self.state_size], axis=1)
        steps = self.every * (self.records.shape[2] - 1)
        with np.errstate(over="ignore", invalid="ignore"):  # where a motion has no bounds
            stepper = Stepper.of(self.models_by_kind, self.times, self.kind, values[: self.sensors.shared])
            trajectory = stepper.integrate(states, memories, steps)
        return TimeSteppingAt(SteppedMotion(self, values, begin, stepper, trajectory), weights)

    def sag(self, values: Real) -> Real:
        """Displacement of each drop's resting point under its load; (drop, state + memory), only X is not zero."""
        sag = np.zeros((len(self.decays), len(self.prior_std)))
        by_kind = np.array([model.sag(values) for model in self.models_by_kind])[self.kind]
        sag[:, : by_kind.shape[1]] = by_kind
        return sag

    def with_possible_memories(self, states: Real) -> Real:
        """Return initial states with memories that friction can have.

        A drop in which some friction holds with much more than it can begins with all of its frictions sliding, at the most.

        Parameters
        ----------
        states
            {X, Ẋ} and memories, shape (drop, state + memory).
        """
        motion, memories = np.split(states, [self.state_size], axis=1)
        is_impossible = np.any(np.abs(memories) > _MOST_MEMORY, axis=1, keepdims=True)
        return np.hstack([motion, np.where(is_impossible, np.clip(memories, -1.0, 1.0), memories)])
