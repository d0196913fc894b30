"""A channel heard: its records beside the motion of a vehicle that was fitted without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.signal import correlate

from sprung.faults.bench import CandidateFit
from sprung.preprocess import FreeDecay
from sprung.vehicle import Rows, Sensor

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_LATEST = 0.05
"""s by which a channel may be late."""

_STEPS = 4
"""Steps in which a delay settles."""

_CORNERS = np.concatenate([[0.0], np.geomspace(0.01, 5.0, 40)])
"""Corners of a high-pass that are tried, Hz."""


@dataclass(frozen=True, eq=False)
class ChannelPrediction:
    """A channel beside the vehicle's motion, decays end to end.

    Attributes
    ----------
    trial
        The vehicle, fitted without the channel.
    channel
        Its position.
    decays
        With the channel in them.
    states
        {X, Ẋ} of the vehicle at the start of each, SI, shape (decay, state).
    """

    trial: CandidateFit
    channel: int
    decays: Sequence[FreeDecay]
    states: Real

    @property
    def sensor(self) -> Sensor:
        """What is said of the channel."""
        return self.trial.campaign.sensors[self.channel]

    @cached_property
    def record(self) -> Real:
        """What was recorded, each decay's mean taken off, shape (sample,)."""
        return np.concatenate([_centred(decay.values[self.channel]) for decay in self.decays])

    @cached_property
    def motion(self) -> Real:
        """Accelerations of the coordinates, shape (coordinate, sample)."""
        return self.moved(0.0)[0]

    @cached_property
    def energy(self) -> float:
        """Sum of squares of the record, (m/s²)²."""
        return float(self.record @ self.record)

    @cached_property
    def _first(self) -> NDArray[np.int64]:
        return np.cumsum([0, *(decay.samples for decay in self.decays)])[:-1]

    @cached_property
    def _waves(self) -> list[tuple[Complex, Complex, Complex]]:
        """For each decay its poles, the accelerations of the coordinates in each mode, and e^{λt}."""
        solved = {
            load: np.linalg.eig(self.trial.models[load].matrices(self.trial.optimum.values).state)
            for load in {decay.load for decay in self.decays}
        }
        waves = []
        for decay, state in zip(self.decays, self.states, strict=True):
            poles, right = solved[decay.load]
            amplitudes = right[len(poles) // 2 :] * (poles * np.linalg.solve(right, state.astype(np.complex128)))
            waves.append((poles, amplitudes, np.exp(poles[:, None] * (np.arange(decay.samples) / decay.rate))))
        return waves

    def moved(self, late: float) -> tuple[Real, Real]:
        """Give the accelerations as they come to a channel that is late, s, and their slopes; each (coordinate, sample)."""
        parts = []
        for poles, amplitudes, waves in self._waves:
            turned = amplitudes * np.exp(-poles * late)
            parts.append(_centred((np.concatenate([turned, turned * poles]) @ waves).real))
        felt, changed = np.split(np.hstack(parts), 2)
        return felt, changed

    def row(self, sensor: Sensor) -> Real:
        """Give the row of the motion that a sensor feels, shape (coordinate,)."""
        of_sensor: Real = Rows.of([sensor.row], self.trial.optimum.names).at(self.trial.optimum.values)[0]
        return of_sensor

    def left(self, fitted: Real) -> Real:
        """Give the sum of squares that is left in each decay, shape (decay,)."""
        left: Real = np.add.reduceat((self.record - fitted) ** 2, self._first)
        return left

    @cached_property
    def best(self) -> Real:
        """What is left where the channel may feel any part of the motion, and be late; shape (decay,)."""
        both = np.concatenate(self.moved(0.0))
        return self.left(np.linalg.lstsq(both.T, self.record, rcond=1e-9)[0] @ both)

    def delay(self, row: Real) -> float:
        """Give how late the channel is, s, if it feels this row."""
        stated, rate = row @ self.motion, self.decays[0].rate
        ends = [*self._first[1:].tolist(), self.record.size]
        most = min(int(_LATEST * rate), min(decay.samples for decay in self.decays) - 1)
        alike = np.zeros(2 * most + 1)
        for begin, end in zip(self._first.tolist(), ends, strict=True):
            product = correlate(self.record[begin:end], stated[begin:end], mode="full", method="fft")
            middle = end - begin - 1
            alike += product[middle - most : middle + most + 1]
        late = float(np.argmax(alike) - most) / rate
        for _ in range(_STEPS):
            motion, faster = self.moved(late)
            slope = -(row @ faster)
            step = float((self.record - row @ motion) @ slope) / max(float(slope @ slope), np.finfo(float).tiny)
            late = float(np.clip(late + np.clip(step, -2 / rate, 2 / rate), -2 * _LATEST, 2 * _LATEST))
        return late

    def through(self, corner: float) -> Real:
        """Give what the channel reads if it feels the row that is stated, through a high-pass with this corner, Hz, in all.

        What the high-pass remembers of the time before each decay goes as its exponential does, and is fitted.
        """
        row, record, fitted = self.row(self.sensor), iter(np.split(self.record, self._first[1:])), []
        omega = 2 * np.pi * corner
        undone = 2 * np.pi * (self.sensor.high_pass or 0.0)
        for decay, (poles, amplitudes, waves) in zip(self.decays, self._waves, strict=True):
            motion = _centred(((row @ amplitudes) * (poles + undone) / (poles + omega) @ waves).real)
            fading = _centred(np.exp(-omega * np.arange(decay.samples) / decay.rate))
            rest = float((next(record) - motion) @ fading) / max(float(fading @ fading), np.finfo(float).tiny)
            fitted.append(motion + rest * fading)
        return np.concatenate(fitted)

    def corner(self) -> float:
        """Give the corner of the high-pass, Hz, through which the channel feels the row that is stated; 0 without any."""

        def cost(corner: float) -> float:
            return float(self.left(self.through(corner)).sum())

        best = int(np.argmin([cost(one) for one in _CORNERS.tolist()]))
        between = _CORNERS[[max(best - 1, 0), min(best + 1, len(_CORNERS) - 1)]]
        return float(minimize_scalar(cost, bounds=between.tolist(), method="bounded", options={"xatol": 1e-5}).x)


def _centred(values: Real) -> Real:
    centred: Real = values - values.mean(axis=-1, keepdims=True)
    return centred
