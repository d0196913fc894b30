"""The likelihood of all decays under a vehicle with nonlinear forces: stepped, all drops and all derivatives in one batch.

Where the linear vehicle's initial states are eliminated in closed form, here they are followed: each place has its own, and
those of the next place are predicted from what is known at this one. Memories of dry friction are part of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.closed_form import Evaluation
from sprung.estimation.expm_likelihood import reach
from sprung.estimation.records import channel_rate_ratios
from sprung.preprocess import FreeDecay
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import ElementInput, NonlinearModel, Rows, Stepper, Trajectory

Real = NDArray[np.float64]
Index = NDArray[np.int64]

_MEMORY = 1.0
"""How far a friction may be from none when a decay begins, in parts of itself."""

_MOST = 1.15
"""Memory that no friction has: it slides at one, and noise adds little."""


@dataclass(frozen=True, eq=False)
class SteppedLikelihood:
    """All decays of a campaign, ready to be stepped.

    Attributes
    ----------
    decays
        What is fitted.
    by_load
        Equations of motion by load name.
    longest
        s of a step at most.
    models
        Equations of motion of each kind of step: a load and a rate.
    times
        Length of each of these steps, s.
    sensors
        The sensors' rows over the fit's parameters.
    kind
        Which kind of step each drop takes, shape (drop,).
    every
        Steps from one sample to the next.
    samples
        Of each drop, shape (drop,).
    values
        Centred records, m/s², zero beyond their end and in channels that are left out; shape (drop, channel, time).
    present
        What each channel counts for: 0 where it is left out, shape (drop, channel).
    tilting
        Part of gravity's change that the sensors feel when the body turns: 1 where they turn with it, else 0.
    begin
        {X, Ẋ} and memories with which every drop starts, as far as is known at first; from where the vehicle rests with its
        load, as everywhere in the fit; shape (drop, state + memory).
    """

    decays: Sequence[FreeDecay]
    by_load: Mapping[str, NonlinearModel]
    longest: float
    models: tuple[NonlinearModel, ...]
    times: tuple[float, ...]
    sensors: Rows
    kind: Index
    every: int
    samples: Index
    values: Real
    present: Real
    tilting: float
    begin: Real

    @classmethod
    def of(
        cls,
        decays: Sequence[FreeDecay],
        models: Mapping[str, NonlinearModel],
        sensors: Rows,
        states: Real,
        tilting: bool,
        longest: float,
    ) -> SteppedLikelihood:
        """Take up the records, once.

        Parameters
        ----------
        decays
            What to fit.
        models
            Equations of motion by load name.
        sensors
            The sensors' rows, in the order of the decays' channels.
        states
            {X, Ẋ} of each drop at its first sample, from which the first climb starts, and memories where they are known;
            shape (drop, state) or (drop, state + memory).
        tilting
            Whether the sensors turn with the body, and feel the less of gravity.
        longest
            s of a step at most: over a longer one forces do not run straight.
        """
        every = max(int(np.ceil(1.0 / (min(decay.rate for decay in decays) * longest))), 1)
        kinds = sorted({(decay.load, decay.rate) for decay in decays})
        values = np.zeros((len(decays), len(decays[0].values), max(decay.samples for decay in decays)))
        for record, decay in zip(values, decays, strict=True):
            centred = decay.values - decay.values.mean(axis=1, keepdims=True)
            record[:, : decay.samples] = np.where(decay.usable[:, None], centred, 0.0)
        one = next(iter(models.values()))
        begin = np.zeros((len(decays), one.state_size + len(one.forces.with_memory)))
        given = min(begin.shape[1], states.shape[1])
        begin[:, :given] = states[:, :given]
        return cls(
            decays=decays,
            by_load=models,
            longest=longest,
            models=tuple(models[load] for load, _ in kinds),
            times=tuple(1.0 / (rate * every) for _, rate in kinds),
            sensors=sensors,
            kind=np.array([kinds.index((decay.load, decay.rate)) for decay in decays]),
            every=every,
            samples=np.array([decay.samples for decay in decays]),
            values=values,
            present=np.array([decay.usable * channel_rate_ratios(decay) for decay in decays]),
            tilting=float(tilting),
            begin=begin,
        )

    @cached_property
    def observations(self) -> Real:
        """Samples by drop and channel, 0 where a channel is left out; shape (drop, channel)."""
        return self.present * self.samples[:, None]

    @cached_property
    def energy(self) -> Real:
        """Sum of squares of all centred records of each channel, (m/s²)², shape (channel,)."""
        energy: Real = (self.present * np.einsum("dct,dct->dc", self.values, self.values)).sum(axis=0)
        return energy

    @cached_property
    def there(self) -> Real:
        """1 where a drop has a sample, shape (drop, time)."""
        there: Real = (np.arange(self.values.shape[2]) < self.samples[:, None]).astype(float)
        return there

    @cached_property
    def reach(self) -> Real:
        """How far from rest a decay may begin, in standard deviations; shape (state + memory,)."""
        state = self.models[0].state_size
        return np.concatenate([reach(state), np.full(self.begin.shape[1] - state, _MEMORY)])

    def with_decays(self, decays: Sequence[FreeDecay]) -> SteppedLikelihood:
        """Return the likelihood of other decays, their initial states being those of the vehicle without nonlinear forces."""
        one = next(iter(self.by_load.values()))
        begin = np.zeros((len(decays), one.state_size + len(one.forces.with_memory)))
        return SteppedLikelihood.of(decays, self.by_load, self.sensors, begin, bool(self.tilting), self.longest)

    def beginning(self, states: Real) -> SteppedLikelihood:
        """Give the same with other initial states and memories to start from, shape (drop, state + memory)."""
        return replace(self, begin=states)

    def at(self, values: Real) -> SteppedLikelihoodAt:
        """Go to parameter values, SI, shape (parameter,)."""
        return SteppedLikelihoodAt(self, values, self.begin + self.sag(values))

    def sag(self, values: Real) -> Real:
        """Give by how much the load of each drop lets it down where it rests; (drop, state + memory), X alone not zero."""
        sag = np.zeros_like(self.begin)
        of_each = np.array([model.sag(values) for model in self.models])[self.kind]
        sag[:, : of_each.shape[1]] = of_each
        return sag


@dataclass(frozen=True, eq=False)
class SteppedLikelihoodAt:
    """A likelihood at some parameter values. Weights are 1/σ² of each channel, shape (channel,).

    Attributes
    ----------
    likelihood
        Of which decays.
    values
        Parameters, SI, shape (parameter,).
    begin
        {X, Ẋ} and memories of each drop at its first sample, from where the empty vehicle rests, shape (drop, state + memory).
    """

    likelihood: SteppedLikelihood
    values: Real
    begin: Real

    @cached_property
    def _stepper(self) -> Stepper:
        likelihood = self.likelihood
        return Stepper.of(likelihood.models, likelihood.times, likelihood.kind, self.values)

    @cached_property
    def _path(self) -> Trajectory:
        steps = self.likelihood.every * (self.likelihood.values.shape[2] - 1)
        states, memories = np.split(self.begin, [self.likelihood.models[0].state_size], axis=1)
        return self._stepper.integrate(states, memories, steps)

    @cached_property
    def _accelerations(self) -> tuple[Real, Real]:
        """Accelerations from {X, Ẋ, u, 1} of every drop, (drop, coordinate, input), and by parameter, next to it."""
        made = [model.accelerations(self.values) for model in self.likelihood.models]
        rows, slopes = (np.stack(each)[self.likelihood.kind] for each in zip(*made, strict=True))
        return rows, slopes

    @cached_property
    def _inputs(self) -> Real:
        """{X, Ẋ, u, 1} at every sample, shape (time, drop, input)."""
        path, every = self._path, self.likelihood.every
        states, forces = path.states[::every], path.forces[::every]
        return np.concatenate([states, forces, np.ones((*states.shape[:-1], 1))], axis=-1)

    @cached_property
    def _motion(self) -> Real:
        """Accelerations of the coordinates at every sample, shape (time, drop, coordinate)."""
        motion: Real = np.einsum("dij,kdj->kdi", self._accelerations[0], self._inputs, optimize=True)
        return motion

    @cached_property
    def _left(self) -> Real:
        """Measured minus modelled, centred, shape (drop, channel, time); zero where there is no sample."""
        likelihood = self.likelihood
        with np.errstate(over="ignore", invalid="ignore"):
            left = likelihood.values - likelihood.sensors.at(self.values) @ self._motion.transpose(1, 2, 0)
            angles = self._inputs[:, :, 1:3]
            left += 0.5 * likelihood.tilting * STANDARD_GRAVITY * np.einsum("kdi,kdi->dk", angles, angles)[:, None, :]
            left -= (left @ likelihood.there[:, :, None]) / likelihood.samples[:, None, None]
            left *= likelihood.there[:, None, :]
        counted: Real = left * (likelihood.present > 0)[:, :, None]
        return counted

    @cached_property
    def _residual(self) -> Real:
        residual: Real = self.likelihood.present * np.einsum("dct,dct->dc", self._left, self._left)
        return residual

    @property
    def _pull(self) -> float:
        """What it costs that decays begin away from rest, in twice the log-likelihood."""
        return float(np.sum((self.begin / self.likelihood.reach) ** 2))

    @cached_property
    def _products(self) -> Real:
        """Inner products of derivatives, and of the residual as the last, with each other, by drop and channel.

        Shape (drop, channel, unknown + 1, unknown + 1); what offsets take up is taken off.
        """
        likelihood, every = self.likelihood, self.likelihood.every
        rows, slopes = self._accelerations
        S, by_S = likelihood.sensors.at(self.values), np.swapaxes(likelihood.sensors.slopes, 1, 2)
        drops, channels, _ = likelihood.values.shape
        parameters, unknown = len(self.values), len(self.values) + self.begin.shape[1]
        total, squares = np.zeros((drops, channels, unknown + 1)), np.zeros((drops, channels, unknown + 1, unknown + 1))
        for step, states, forces in self._stepper.sensitivities(self._path):
            chosen = slice(-step % every, None, every)
            first = (step + (-step % every)) // every
            driven = np.concatenate([states[chosen], forces[chosen]], axis=2)
            if not len(driven):
                continue
            last = first + len(driven)
            inputs = self._inputs[first:last]
            moved = rows[:, :, :-1] @ driven
            moved[..., :parameters] += np.einsum("dpij,kdj->kdip", slopes, inputs, optimize=True)
            all_of = np.empty((drops, channels, last - first, unknown + 1))
            readings = S @ moved
            readings[..., :parameters] += np.einsum("kdi,cip->kdcp", self._motion[first:last], by_S, optimize=True)
            turned = inputs[:, :, None, 1:3] @ states[chosen][:, :, 1:3]
            readings -= likelihood.tilting * STANDARD_GRAVITY * turned
            all_of[..., :unknown] = readings.transpose(1, 2, 0, 3)
            all_of[..., :unknown] *= likelihood.there[:, None, first:last, None]
            all_of[..., unknown] = self._left[:, :, first:last]
            total += all_of.sum(axis=2)
            squares += np.swapaxes(all_of, 2, 3) @ all_of
        squares -= total[..., :, None] * total[..., None, :] / likelihood.samples[:, None, None, None]
        return squares * likelihood.present[:, :, None, None]

    def _system(self, weights: Real) -> _System:
        parameters = len(self.values)
        whole = np.einsum("c,dcij->dij", weights, self._products, optimize=True)
        reach = self.likelihood.reach
        within = whole[:, parameters:-1, parameters:-1] + np.diag(reach**-2)
        own = whole[:, parameters:-1, -1] - self.begin / reach**2
        across = whole[:, :parameters, parameters:-1]
        return _System(whole[:, :parameters, :parameters], across, within, whole[:, :parameters, -1], own)

    def misfit(self, weights: Real) -> tuple[Real, float]:
        """Give the residual sums of squares alone, (m/s²)², shape (drop, channel), and what is to be added for the starts."""
        residual = self._residual
        return np.where(np.isfinite(residual), residual, np.inf), self._pull

    def evaluate(self, weights: Real) -> Evaluation:
        """Evaluate fit and derivatives."""
        gradients, informations = self.by_drop(weights)
        system, parameters = self._system(weights), len(self.values)
        seen = self._products[:, :, parameters:-1, parameters:-1]
        leverage = weights * np.einsum("dij,dcji->c", np.linalg.inv(system.within), seen, optimize=True)
        return Evaluation(self._residual, leverage, gradients.sum(axis=0), informations.sum(axis=0), self._pull)

    def by_drop(self, weights: Real) -> tuple[Real, Real]:
        """Give each drop's own gradient and information; shapes (drop, parameter), (drop, parameter, parameter)."""
        system = self._system(weights)
        carried = system.across @ np.linalg.inv(system.within)
        gradients = system.gradient - (carried @ system.own[:, :, None])[:, :, 0]
        return gradients, system.information - carried @ np.swapaxes(system.across, 1, 2)

    def moved(self, values: Real, weights: Real) -> SteppedLikelihoodAt:
        """Go to other parameter values, with the initial states that should explain the records there."""
        system = self._system(weights)
        pull = system.own - np.einsum("dpz,p->dz", system.across, values - self.values)
        step = np.linalg.solve(system.within, pull[:, :, None])[:, :, 0]
        return SteppedLikelihoodAt(self.likelihood, values, self.begin + step)

    def believable(self) -> Real | None:
        """Give beginnings without memories that no friction can have, or None where there are none such.

        Accelerations do not tell a friction's force from a spring's while neither changes: a drop may be explained for a
        while by a friction that holds against where the vehicle stands. It then begins anew from none, and stands where
        all forces are what they were.
        """
        forces, likelihood = self._stepper.forces, self.likelihood
        state = likelihood.models[0].state_size
        X, V, remembered = np.split(self.begin, [state // 2, state], axis=1)
        gone = np.abs(remembered) > _MOST
        if not gone.any():
            return None
        rows = forces.rows.at(self.values)
        memory = np.zeros((len(remembered), forces.number))
        memory[:, forces.with_memory] = remembered
        travel = X @ rows.T
        answer = forces.evaluate(self.values, ElementInput(travel, V @ rows.T, np.zeros_like(travel), memory))
        lost = np.where(gone, remembered, 0.0) * answer.by_memory[:, forces.with_memory] @ rows[forces.with_memory]
        stiffness = np.array([model.linear.matrices(self.values).K for model in likelihood.models])[likelihood.kind]
        X = X + np.linalg.solve(stiffness, lost[:, :, None])[:, :, 0]
        return np.hstack([X, V, np.where(gone, 0.0, remembered)]) - likelihood.sag(self.values)

    def noise_bias_of_information(self, weights: Real) -> Real:
        """Give the information that noise alone feigns: none is known of, shape (parameter, parameter)."""
        return np.zeros((len(self.values), len(self.values)))

    def left(self, position: int) -> Real:
        """Give what the model leaves of one drop's centred record, shape (channel, time)."""
        return self._left[position, :, : self.likelihood.samples[position]]

    def fitted(self, weights: Real) -> list[Real]:
        """Give what the model makes of every record, its mean taken off; each of shape (channel, time)."""
        whole = self.likelihood.values - self._left
        return [record[:, :samples] for record, samples in zip(whole, self.likelihood.samples, strict=True)]

    def motion(self, weights: Real, position: int, before: int, after: int) -> Real:
        """Follow one drop from its first sample on: {X, Ẋ} and memories, SI, shape (state + memory, time).

        What was before nobody knows: friction cannot be followed backward in time.
        """
        path, chosen = self._path, slice(None, self.likelihood.every * after, self.likelihood.every)
        memories = path.memories[chosen, position][:, self._stepper.forces.with_memory]
        whole = np.hstack([path.states[chosen, position], memories])
        motion: Real = (whole - self.likelihood.sag(self.values)[position]).T
        return motion

    def delays(self, weights: Real, covariance: Real) -> dict[int, tuple[Real, Real]]:
        """Give the delays of the drops with several loggers: none are stepped."""
        return {}

    def states(self, weights: Real) -> Real:
        """Give {X, Ẋ} and memories of each drop at its first sample, SI, shape (drop, state + memory)."""
        states: Real = self.begin - self.likelihood.sag(self.values)
        return states


@dataclass(frozen=True, eq=False)
class _System:
    """Normal equations of each drop: of the parameters, across, of its start, and the gradients of both."""

    information: Real
    across: Real
    within: Real
    gradient: Real
    own: Real
