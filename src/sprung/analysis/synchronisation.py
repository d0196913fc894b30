"""Timing: how the clocks of several loggers stand, from what a rough vehicle makes of the release and of the decay.

The release is one moment for all loggers. Just after it, before any wheel lands, the motion follows from the vehicle alone,
so that each logger that shows it tells when the release was on its own clock, to a small part of a millisecond. A
logger whose sensors hardly moved then is held against what the others say of the decay.

Given the vehicle, a flight tells the clocks; whatever the clocks, it tells of the vehicle. Both follow from the same samples,
and the likelihood of these is the product of the two: the first is always used, the second only where a flight is explained.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from sprung.campaign import CLOCK_STD, Drop
from sprung.errors import SprungError
from sprung.estimation import FitResult
from sprung.preprocess import DropObservation, FlightLikelihood, FreeDecay
from sprung.vehicle import Heights, Load, Readout, Sensor, Vehicle, wheelbase_of, with_separate_tracks

Real = NDArray[np.float64]

_FLIGHT = 0.04
"""s after the release that are enough."""

_IN_THE_AIR, _LOW = 0.85, 0.02
"""Part of the time to the landing that is certainly flight, and height of blocks where nobody says it, m."""

_AWAY = 2 * CLOCK_STD
"""s within which the release is looked for on both sides of where the first motion that a logger shows would have it."""

_BEFORE = 0.008
"""s before the release that are looked at with it."""

_FINE = 1e-4
"""s: step at which the flight is computed, and to which the release is looked for at first."""

_CLEAR = 20.0
"""Peak of the flight over a channel's noise from which its logger tells the release."""

_NEIGHBOURS, _LOST = 20, 1e-9
"""Samples on each side of which a spline makes a new one, and part of the largest singular value that is rounding."""

_LIKE_IT = 0.2
"""Part of the flight that may be left unexplained: beyond it the release was not at one moment, and tells nothing."""

_FLOOR = 5e-6
"""s: by so much crystals that are fast or slow by some ten parts in a million drift from the release to the liveliest part
of a decay."""

_COMPUTED = 1e-3
"""m/s² to which a flight is computed, read between its steps."""

_NEAR = 2.5 * _FINE
"""s from the release within which a sample may be from before or after it."""

_NUDGE = 1e-4
"""Part of a parameter by which it is moved to see what that does to the flight."""

_VAGUE = 2e-4
"""s of uncertainty from which so faint a beginning of a motion tells its moment less well than its slope says."""

_UNTOLD = 0.01
"""s of uncertainty from which a clock is not told."""

_FARTHEST, _COARSE = 0.1, 0.001
"""s by which the first motion of a sensor that hardly moves may come after the release, and step of looking for it."""


_Moment = tuple[float, float, Real, Real, Real]
"""When a logger saw the release and the standard uncertainty of that, s; how it would move with each parameter of the vehicle
that the flight was computed with, s per SI unit, shape (parameter,); what the flight leaves of the logger's samples, over their
noise, shape (sample,); and by how much more it would read with each parameter, less what another moment takes up, shape
(parameter, sample)."""


def synchronise_at_release(
    decay: FreeDecay, seen: DropObservation, drop: Drop, vehicle: Vehicle, load: Load, sensors: Sequence[Sensor]
) -> FreeDecay:
    """Return a decay with the clock offsets from the release and the information of its flight phase; other clocks are kept.

    Parameters
    ----------
    decay
        Of several loggers.
    seen
        The recording it is from.
    drop
        How it was dropped.
    vehicle, load
        A vehicle, however rough, and its load.
    sensors
        One for each channel.

    Returns
    -------
    Decay
    """
    from sprung.simulation import drop_from_blocks  # noqa: PLC0415 (only several loggers need it)

    if seen.release is None or drop.is_driven:
        return decay
    parameters, height = with_separate_tracks(vehicle.parameters), drop.height or _LOW
    try:
        fall = drop_from_blocks(vehicle, load, drop.wheels, height, duration=_FLIGHT)
        flight, slopes = _flights(parameters, drop, height, load, sensors, vehicle.heights)
    except SprungError:  # so rough a vehicle that it does not even stand
        return decay
    air = next((event.time for event in fall.events if event.kind == "landing"), _FLIGHT) * _IN_THE_AIR
    recording = seen.recording
    times = (np.arange(recording.values.shape[1]) - seen.release) / recording.rate
    # In units of each channel's noise.
    noise = np.hypot(np.maximum(seen.rest.noise.std(axis=1), decay.resolution / 12**0.5), _COMPUTED)[:, None]
    values, flight, slopes = (recording.values - seen.rest.level[:, None]) / noise, flight / noise, slopes / noise
    moments: dict[int, _Moment] = {}
    parts = {part.name: part for part in recording.parts}
    for number, clock in enumerate(decay.clocks):
        own = [channel for channel in clock.channels if decay.usable[channel]]
        if not own or np.abs(flight[own, : int(air / _FINE)]).max() < _CLEAR:
            continue
        begin = _begins(values[own], times, flight[own], air)
        if begin is None:
            continue
        window = (times > begin - _BEFORE) & (times < begin + air)
        taken = parts[clock.name].time - clock.offset - recording.start - seen.release / recording.rate
        read, when = values[own][:, window], times[window]
        if clock.rate_ratio < 1:
            read, when = _as_taken(read, when, taken, 1 / parts[clock.name].rate)
        found = _moment_of(read, when, flight[own], slopes[:, own], begin)
        if found is not None:
            moments[number] = found
    if not moments:
        return decay
    released, stds, slopes_of, left, unseen = zip(*moments.values(), strict=True)
    common, here = float(np.median(released)), np.array(list(parameters.values()))
    clocks = list(decay.clocks)
    for number, time, std, own_slopes in zip(moments, released, stds, slopes_of, strict=True):
        clocks[number] = replace(
            clocks[number],
            # Expected at parameters of zero, so that the slopes alone lead to what is expected elsewhere.
            delay=common - time + float(own_slopes @ here),
            delay_std=std,
            d_delay_d_parameter=dict(zip(parameters, (-own_slopes).tolist(), strict=True)),
        )
    residual, more = np.concatenate(left), np.concatenate(unseen, axis=-1)
    from_flight = FlightLikelihood(
        tuple(parameters),
        here,
        more @ residual,
        more @ more.T,
        float(residual @ residual),
        residual.size - len(moments),
    )
    return replace(decay, clocks=tuple(clocks), flight=from_flight)


def _flights(
    parameters: Mapping[str, float],
    drop: Drop,
    height: float,
    load: Load,
    sensors: Sequence[Sensor],
    heights: Heights,
) -> tuple[Real, Real]:
    """Return the readings after the release, and their derivatives by each parameter.

    Shapes (channel, time) and (parameter, channel, time), m/s² and that per SI unit, in steps of `_FINE`.
    """
    names, samples = tuple(parameters), int(_FLIGHT / _FINE)
    readout = Readout.of(sensors, names, wheelbase_of(names, parameters.values()))

    from sprung.simulation import drop_from_blocks  # noqa: PLC0415 (only several loggers need it)

    def flight(values: Mapping[str, float]) -> Real:
        vehicle = Vehicle.nearest(values, name="falling", **heights.by_key)
        fall = drop_from_blocks(vehicle, load, drop.wheels, height, duration=_FLIGHT)
        return readout.read(list(values.values()), fall.motion(_FINE, samples))

    steps = {name: _NUDGE * (abs(value) or 1.0) for name, value in parameters.items()}
    here = flight(parameters)
    moved = [(flight({**parameters, name: parameters[name] + step}) - here) / step for name, step in steps.items()]
    return here, np.array(moved)


def _read(flight: Real, times: Real) -> Real:
    """Return the readings at times after the release, s, 0 before it; shape (channel, time)."""
    grid = _FINE * np.arange(flight.shape[1])
    return np.array([np.interp(times, grid, one, left=0.0) for one in flight])


def _begins(values: Real, times: Real, flight: Real, air: float) -> float | None:
    """Find to a sample when a logger saw the release; None where it did not."""
    rate = 1 / (times[1] - times[0])
    before, after = int(_BEFORE * rate), int(air * rate)
    expected = _read(flight, np.arange(-before, after + 1) / rate)
    near = np.flatnonzero(np.abs(times) < _AWAY)
    first, last = max(near[0] - before, 0), near[-1] + after
    windows = np.lib.stride_tricks.sliding_window_view(values[:, first : last + 1], before + after + 1, axis=1)
    missed = np.sum((windows - expected[:, None]) ** 2, axis=(0, 2))
    best = int(np.argmin(missed))
    # At either end of what was looked at, it is not known to be where it is least.
    return float(times[first + before + best]) if 0 < best < len(missed) - 1 else None


def _as_taken(values: Real, times: Real, taken: Real, step: float) -> tuple[Real, Real]:
    """Return the samples of a logger and their times, from those that a spline through them gives."""
    near = taken[(taken > times[0] - _NEIGHBOURS * step) & (taken < times[-1] + _NEIGHBOURS * step)]
    made = CubicSpline(near, np.eye(len(near)))(times)
    within = (near >= times[0]) & (near <= times[-1])
    return (values @ np.linalg.pinv(made, rcond=_LOST).T)[:, within], near[within]


def _moment_of(values: Real, times: Real, flight: Real, slopes: Real, begin: float) -> _Moment | None:
    """Find when a logger saw the release, of which the sample is known; None where it is not certain."""

    def model(moment: float, waves: Real = flight) -> Real:
        return _read(waves, times - moment)

    def cost(moment: float) -> float:
        return float(np.sum((values - model(moment)) ** 2))

    step = float(np.median(np.diff(times)))
    tried = np.arange(begin - 2 * step, begin + 2 * step, _FINE)
    moment = float(tried[np.argmin([cost(one) for one in tried])])
    # The reading jumps at the release: a sample so near to it may be from before or after.
    clear = np.abs(times - moment) > _NEAR
    values, times = values[:, clear], times[clear]
    jerk = np.gradient(flight, _FINE, axis=1)
    for _ in range(5):
        slope = -model(moment, jerk)
        steepness = max(float(np.sum(slope**2)), np.finfo(float).tiny)
        further = float(np.sum(slope * (values - model(moment)))) / steepness
        moment = float(np.clip(moment + further, tried[0], tried[-1]))
    left = values - model(moment)
    squared = float(np.sum(left**2))
    if squared > _LIKE_IT**2 * np.sum(model(moment) ** 2):
        return None
    more = np.array([model(moment, one).ravel() for one in slopes])
    along = more @ slope.ravel() / steepness
    # A slow logger takes so few samples in flight that what they leave may be much less than their noise by chance.
    spread = (max(squared / max(values.size - 1, 1), 1.0) / steepness) ** 0.5
    if spread > _VAGUE:
        return None
    std = float(np.hypot(spread, _FLOOR))
    return moment, std, -along, left.ravel(), more - along[:, None] * slope.ravel()


def synchronise_by_decay(decays: Sequence[FreeDecay], optimum: FitResult) -> tuple[FreeDecay, ...]:
    """Set the clocks that the release did not tell by what makes the decay most likely.

    Parameters
    ----------
    decays
        Of several loggers; the clocks that are told have a small uncertainty.
    optimum
        A fit of these decays without the other loggers' channels.

    Returns
    -------
    tuple of Decay
    """
    untold = {(i, clock.name) for i, decay in enumerate(decays) for clock in decay.clocks if clock.delay_std > _UNTOLD}
    timed = list(decays)
    shifts = np.arange(-_FARTHEST, _FARTHEST + _COARSE, _COARSE)
    for i, found in optimum.most_likely_delays(decays, shifts).items():
        clocks = zip(timed[i].clocks, found.tolist(), strict=True)
        timed[i] = replace(
            timed[i],
            clocks=tuple(
                replace(clock, delay=late, delay_std=4 * _COARSE) if (i, clock.name) in untold else clock
                for clock, late in clocks
            ),
        )
    return tuple(timed)


def mask_unsynchronised(decay: FreeDecay) -> FreeDecay:
    """Leave out the channels of loggers that the release did not tell.

    Parameters
    ----------
    decay
        Of several loggers.

    Returns
    -------
    Decay
        With those channels NaN.
    """
    untold = [channel for clock in decay.clocks if clock.delay_std > _UNTOLD for channel in clock.channels]
    values = decay.values.copy()
    values[untold] = np.nan
    return replace(decay, values=values)
