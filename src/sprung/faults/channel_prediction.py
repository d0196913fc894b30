"""A channel beside its prediction from the motion of a vehicle that was fitted without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct
from scipy.optimize import minimize_scalar
from scipy.signal import correlate

from sprung.estimation import LowPass
from sprung.faults.candidate_fit import DRIFT_SPAN, CandidateFit
from sprung.preprocess import FreeDecay
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import Sensor, coordinates, sensor_rows, wheelbase_of

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_DEAD = -np.log(np.finfo(float).eps)
"""Exponent by which a motion has died away to rounding."""

_LATEST = 0.05
"""s by which a channel may be late."""

_STEPS = 4
"""Steps in which a delay settles."""

_OFFSET = 0.1
"""Offset of a sensor over gravity up to which its reading at rest still tells its gain."""

_CORNERS = np.concatenate([[0.0], np.geomspace(0.01, 5.0, 40)])
"""Corners of a high-pass that are tried, Hz."""

_LOW_PASSES = np.geomspace(5.0, 300.0, 30)
"""Corners of a low-pass that are tried, Hz."""


@dataclass(frozen=True, eq=False)
class ChannelPrediction:
    """A channel beside the motion of the vehicle, its decays end to end.

    Attributes
    ----------
    candidate
        The fit without the channel.
    channel
        Its index.
    decays
        With the channel in them.
    states
        {X, Ẋ} of the vehicle at the start of each, SI, shape (decay, state).
    drifts
        Whether the residual of the channel in a fit of all channels is slower than any vehicle.
    """

    candidate: CandidateFit
    channel: int
    decays: Sequence[FreeDecay]
    states: Real
    drifts: bool = False

    @property
    def sensor(self) -> Sensor:
        """Its sensor, as stated."""
        return self.candidate.campaign.sensors[self.channel]

    @cached_property
    def record(self) -> Real:
        """The record, less the mean of each decay, m/s², shape (sample,)."""
        return np.concatenate([_centred(decay.values[self.channel]) for decay in self.decays])

    @cached_property
    def motion(self) -> Real:
        """What the sensor reads rows of: the coordinates or their derivatives, SI, shape (coordinate, sample)."""
        return self.delayed_motion(0.0)[0]

    @cached_property
    def energy(self) -> float:
        """Sum of squares of the record, (m/s²)²."""
        return float(self.record @ self.record)

    @cached_property
    def _first(self) -> NDArray[np.int64]:
        return np.cumsum([0, *(decay.samples for decay in self.decays)])[:-1]

    @cached_property
    def _waves(self) -> list[tuple[Complex, Complex, Complex]]:
        """For each decay its poles, what the sensor reads rows of in each mode, and e^{λt}."""
        order = max(self.sensor.rows(self.candidate.fit.names, self._wheelbase))
        solved = {
            load: np.linalg.eig(self.candidate.models[load].matrices(self.candidate.fit.values).state)
            for load in {decay.load for decay in self.decays}
        }
        n = len(coordinates(self.candidate.fit.names))
        waves = []
        for decay, state in zip(self.decays, self.states, strict=True):
            poles, right = solved[decay.load]
            amplitudes = right[:n] * (poles**order * np.linalg.solve(right, state.astype(np.complex128)))
            waves.append((poles, amplitudes, np.exp(poles[:, None] * (np.arange(decay.samples) / decay.rate))))
        return waves

    @property
    def _wheelbase(self) -> float:
        return wheelbase_of(self.candidate.fit.names, self.candidate.fit.values)

    @cached_property
    def stated(self) -> Real:
        """What the channel should read as stated, m/s², shape (sample,)."""
        stated: Real = self.row(self.sensor) @ self.motion
        return stated

    @property
    def gain(self) -> float:
        """What the channel reads over what it should."""
        return float(self.record @ self.stated) / max(float(self.stated @ self.stated), np.finfo(float).tiny)

    def rest_allows(self, gain: float) -> bool:
        """Whether what it reads while the vehicle stands agrees with a gain.

        A sensor that shows gravity shows it with the same gain, and a displacement by how much the vehicle is lower in the end
        than on blocks of a stated height.
        """
        shown = self._shown_at_rest
        if not np.isfinite(shown) or (self.sensor.reads_gravity and abs(shown) < _OFFSET * abs(gain)):
            return True  # AC-coupled, zeroed at rest, or no rest
        return abs(gain - shown) < _OFFSET * max(abs(gain), 1.0)

    @cached_property
    def _shown_at_rest(self) -> float:
        """The gain that the reading at rest shows; NaN where it shows none."""
        if self.sensor.reads_gravity:
            return float(np.median([decay.rest.level[self.channel] for decay in self.decays])) / STANDARD_GRAVITY
        if self.sensor.quantity != "displacement" or self.sensor.relative_to is not None or self.sensor.on is None:
            return np.nan
        drops = {drop.recording.name: drop for drop in self.candidate.campaign.drops}
        every = self.candidate.campaign.layout.wheels
        gains = []
        for decay in self.decays:
            drop = drops.get(decay.file)  # not one that the candidate leaves out
            needed = every if self.sensor.on == "body" else (self.sensor.wheel,)
            if drop and drop.excitation == "drop" and drop.height and {*needed} <= {*drop.wheels}:
                end = decay.values[self.channel, -max(int(DRIFT_SPAN * decay.rate), 1) :].mean()
                gains.append(float(decay.rest.level[self.channel] - end) / drop.height)
        return float(np.median(gains)) if gains else np.nan

    def delayed_motion(self, delay: float) -> tuple[Real, Real]:
        """Return the motion that a channel with a delay, s, shows, and its rate; shape (coordinate, sample) each."""
        parts = []
        for poles, amplitudes, waves in self._waves:
            # What has died away by rounding within the delay shows nothing of it any more.
            lasts = -poles.real * delay < _DEAD
            turned = amplitudes * np.exp(np.where(lasts, -poles * delay, -np.inf))
            parts.append(_centred((np.concatenate([turned, turned * poles]) @ waves).real))
        motion, rates = np.split(np.hstack(parts), 2)
        return motion, rates

    def row(self, sensor: Sensor) -> Real:
        """Return the row of the coordinates that a sensor measures, shape (coordinate,)."""
        fit = self.candidate.fit
        of_sensor: Real = sensor_rows([sensor], fit.names, self._wheelbase).at(fit.values)[0]
        return of_sensor

    def residual_of(self, predicted: Real) -> Real:
        """Return the residual sum of squares of a predicted record in each decay, (m/s²)², shape (decay,)."""
        residual: Real = np.add.reduceat((self.record - predicted) ** 2, self._first)
        return residual

    @cached_property
    def least_residual(self) -> Real:
        """Residual where the channel may measure any part of the motion, and be delayed, (m/s²)², shape (decay,)."""
        both = np.concatenate(self.delayed_motion(0.0))
        return self.residual_of(np.linalg.lstsq(both.T, self.record, rcond=1e-9)[0] @ both)

    @cached_property
    def drift(self) -> tuple[Real, int]:
        """Residual beside the stated motion and a slow baseline, (m/s²)², shape (decay,), and the numbers of all baselines.

        The baseline is a sum of cosines with whole numbers of half periods in a decay, all slower than a vehicle vibrates.
        """
        left = np.split(self.record - self.stated, self._first[1:])
        numbers = [int(decay.samples / decay.rate / DRIFT_SPAN) for decay in self.decays]
        powers = [dct(record, norm="ortho") ** 2 for record in left]
        residual = [float(power[1 + number :].sum()) for power, number in zip(powers, numbers, strict=True)]
        return np.array(residual), sum(numbers)

    def delay(self, row: Real) -> float:
        """Return the delay of the channel, s, if it measures this row."""
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
            motion, faster = self.delayed_motion(late)
            slope = -(row @ faster)
            step = float((self.record - row @ motion) @ slope) / max(float(slope @ slope), np.finfo(float).tiny)
            late = float(np.clip(late + np.clip(step, -2 / rate, 2 / rate), -2 * _LATEST, 2 * _LATEST))
        return late

    def through_high_pass(self, corner: float) -> Real:
        """Return what the channel reads through a high-pass with this corner, Hz, in all.

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
        """Return the corner of the high-pass, Hz, with which the channel is most likely; 0 for none."""

        def cost(corner: float) -> float:
            return float(self.residual_of(self.through_high_pass(corner)).sum())

        best = int(np.argmin([cost(one) for one in _CORNERS.tolist()]))
        between = _CORNERS[[max(best - 1, 0), min(best + 1, len(_CORNERS) - 1)]]
        return float(minimize_scalar(cost, bounds=between.tolist(), method="bounded", options={"xatol": 1e-5}).x)

    def through_low_pass(self, low_pass: LowPass) -> Real:
        """Return what the channel reads through a low-pass, shape (sample,).

        What the low-pass remembers of the time before each decay fades with its poles, and is fitted.
        """
        row, record, fitted = self.row(self.sensor), iter(np.split(self.record, self._first[1:])), []
        own = low_pass.poles[low_pass.poles.imag >= 0]
        for decay, (poles, amplitudes, waves) in zip(self.decays, self._waves, strict=True):
            motion = _centred(((row @ amplitudes) * low_pass.response(poles) @ waves).real)
            fading = np.exp(own[:, None] * (np.arange(decay.samples) / decay.rate))
            memory = _centred(np.concatenate([fading.real, fading.imag[own.imag > 0]]))
            rest = np.linalg.lstsq(memory.T, next(record) - motion, rcond=1e-9)[0]
            fitted.append(motion + rest @ memory)
        return np.concatenate(fitted)

    def low_pass(self, order: int) -> LowPass:
        """Return the low-pass of an order with which the channel is most likely."""

        def cost(corner: float) -> float:
            return float(self.residual_of(self.through_low_pass(LowPass(corner, order))).sum())

        best = int(np.argmin([cost(one) for one in _LOW_PASSES.tolist()]))
        between = _LOW_PASSES[[max(best - 1, 0), min(best + 1, len(_LOW_PASSES) - 1)]]
        found = minimize_scalar(cost, bounds=between.tolist(), method="bounded", options={"xatol": 1e-3})
        return LowPass(float(found.x), order)


def _centred(values: Real) -> Real:
    centred: Real = values - values.mean(axis=-1, keepdims=True)
    return centred
