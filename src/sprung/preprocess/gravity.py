"""Gravity at rest: what a sensor reads while nothing moves shows its sign, unit, offset and coupling."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Recording
from sprung.errors import Fault
from sprung.preprocess.high_pass import AC_LEVEL
from sprung.preprocess.release import Release
from sprung.units import STANDARD_GRAVITY, si_factor
from sprung.vehicle import Sensor

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_NEAR = 0.1
"""Part of gravity by which tilt and offset may change what a sensor reads at rest."""

_NEGLIGIBLE = 0.05
"""Part of gravity up to which an offset is not reported: a tilt of 18 degrees."""

_SEVERAL = 3
"""Sensors with the same fault from which it is reported once for all of them."""

_FARTHEST = 3.0
"""g at rest from which it is no offset any more, but numbers in an unknown unit."""

_UNITS = (
    (1.0, "", ""),
    *((si_factor(unit), f"in {unit}", unit) for unit in ("g", "mg", "mm/s^2", "cm/s^2", "ft/s^2", "in/s^2")),
    (1 / STANDARD_GRAVITY, "in m/s^2, not in g", "m/s^2"),
)
"""Factor that corrects a channel's unit, what the numbers are then, and the unit to write for the sensor."""


def check_gravity(
    recordings: Sequence[Recording], releases: Sequence[Release | None], sensors: Sequence[Sensor]
) -> tuple[list[Recording], list[Release | None], tuple[Sensor, ...]]:
    """Correct the channels whose reading at rest shows beyond doubt that their sign, unit or coupling is another one.

    Parameters
    ----------
    recordings
        As they were read.
    releases
        The release in each, with what the sensors read before it.
    sensors
        One for each channel.

    Returns
    -------
    recordings : list of Recording
        With a fault for each channel that was changed, or that reads something else than gravity.
    releases : list of Release or None
        With the baselines changed likewise.
    sensors : tuple of Sensor
        Without the high-pass of those that read gravity.

    Notes
    -----
    Only accelerometers that read gravity can be checked, and only where they agree in every drop with a rest. A unit is changed
    where gravity is about 1 in another one and the channel then moves more like its neighbours, a sign where most of the
    sensors that read gravity read it the other way. The sign of an AC-coupled sensor does not show at rest.
    """
    rests = [release.level for release in releases if release is not None]
    if not rests:
        return list(recordings), list(releases), tuple(sensors)
    levels = np.array(rests) / STANDARD_GRAVITY
    levels[:, [not sensor.reads_gravity for sensor in sensors]] = np.nan
    known: Flags = np.logical_not(np.isnan(levels).all(axis=0))
    usual = np.full(len(sensors), np.nan)
    usual[known] = [np.median(level[~np.isnan(level)]) for level in levels.T[known]]
    zero = known & _in_every_drop(np.abs(levels) < AC_LEVEL / STANDARD_GRAVITY, levels)
    units = _recognise_units(levels, known & ~zero, recordings, sensors)
    factors = np.array([_UNITS[unit][0] for unit in units])
    gravity = known & _in_every_drop(np.abs(np.abs(levels * factors) - 1) < _NEAR, levels)
    signs = np.sign(np.where(gravity, usual, 0.0))
    majority = -1.0 if signs.sum() < 0 else 1.0
    inverted = gravity & (signs * signs.sum() < 0)
    upward = usual * factors * np.where(inverted, -majority, majority)

    stated_ac = np.array([sensor.high_pass is not None for sensor in sensors])
    other = known & ~stated_ac & ~zero & ~gravity
    most_read_gravity = bool(gravity.sum() > other.sum())
    implausible = other & most_read_gravity & (np.abs(usual) > _FARTHEST)
    uncoupled = zero & ~stated_ac & most_read_gravity & bool(gravity.sum() > zero.sum())
    offset = known & ~zero & ~stated_ac & ~implausible & most_read_gravity & (np.abs(upward - 1) > _NEGLIGIBLE)
    faults: list[Fault] = []
    wrong = (np.array(units) > 0) | inverted | (stated_ac & gravity) | implausible | uncoupled | offset
    for channel in np.flatnonzero(wrong).tolist():
        sensor, reading = sensors[channel], float(usual[channel]) * STANDARD_GRAVITY
        found = {
            _unit_fault(sensor, reading, units[channel]): units[channel] > 0,
            _sign_fault(sensor, reading): inverted[channel],
            _no_high_pass_fault(sensor): stated_ac[channel] and gravity[channel],
            _unknown_unit_fault(sensor, reading): implausible[channel],
            _coupling_fault(sensor): uncoupled[channel],
            _offset_fault(sensor, float(upward[channel])): offset[channel],
        }
        faults += [fault for fault, holds in found.items() if holds]
    if not faults:
        return list(recordings), list(releases), tuple(sensors)
    factors = np.where(implausible, np.nan, factors * np.where(inverted, -1.0, 1.0))
    changed = [scale_recording(recording, factors) for recording in recordings]
    changed[0] = replace(changed[0], faults=(*changed[0].faults, *_group_faults(faults)))
    return (
        changed,
        [None if release is None else _scale_release(release, factors) for release in releases],
        tuple(
            replace(sensor, high_pass=None) if reads else sensor
            for sensor, reads in zip(sensors, gravity.tolist(), strict=True)
        ),
    )


def _in_every_drop(holds: Flags, levels: Real) -> Flags:
    return np.asarray((holds | np.isnan(levels)).all(axis=0))


def _recognise_units(
    levels: Real, reads: Flags, recordings: Sequence[Recording], sensors: Sequence[Sensor]
) -> list[int]:
    """Return for each channel the unit in which it reads gravity; the stated one where none, or no other, is beyond doubt."""
    factors = np.array([factor for factor, _, _ in _UNITS])
    best = [0] * len(sensors)
    for channel in np.flatnonzero(reads).tolist():
        own = np.abs(levels[~np.isnan(levels[:, channel]), channel])
        off = np.abs(own[:, None] * factors - 1).max(axis=0)
        if off[0] >= _NEAR > off.min():
            best[channel] = int(np.argmin(off))
    if not any(best):
        return best
    peaks = _mean_ranges(recordings)
    on_body = np.array([sensor.on == "body" for sensor in sensors])
    accelerometers = np.array([sensor.reads_gravity for sensor in sensors])
    for channel, chosen in enumerate(best):
        others = accelerometers & (on_body == on_body[channel]) & (np.array(best) != chosen) & (peaks > 0)
        if chosen and others.any():
            ratio = np.log(peaks[channel] / np.median(peaks[others]))
            if abs(ratio + np.log(_UNITS[chosen][0])) > abs(ratio):
                best[channel] = 0
    return best


def _mean_ranges(recordings: Sequence[Recording]) -> Real:
    """Return the range of each channel, m/s², in the mean over the drops; shape (channel,)."""
    ranges = np.array([np.ptp(recording.values, axis=1) for recording in recordings if recording.values.size])
    there = ~np.isnan(ranges)
    mean: Real = np.where(there, ranges, 0.0).sum(axis=0) / np.maximum(there.sum(axis=0), 1)
    return mean


def _unit_fault(sensor: Sensor, reading: float, unit: int) -> Fault:
    _, meaning, name = _UNITS[unit]
    what = f"reads {reading:.4g} at rest, which is gravity {meaning}; converted from {name}"
    return Fault("unit", sensor.channel, what, f'Set unit = "{name}" for it in the campaign file.')


def _sign_fault(sensor: Sensor, reading: float) -> Fault:
    own, others = ("downward", "upward") if reading < 0 else ("upward", "downward")
    what = f"reads gravity {own} at rest, most other sensors {others}; its sign was reversed"
    direction = "down" if sensor.direction == "up" else "up"
    return Fault("sign", sensor.channel, what, f'Set direction = "{direction}" for it in the campaign file.')


def _no_high_pass_fault(sensor: Sensor) -> Fault:
    what = (
        f"reads gravity at rest, so it is not AC-coupled; its high-pass of {sensor.high_pass or 0:g} Hz was not undone"
    )
    return Fault("coupling", sensor.channel, what, "Remove high_pass for it from the campaign file.")


def _unknown_unit_fault(sensor: Sensor, reading: float) -> Fault:
    what = f"reads {reading:.4g} at rest, which is gravity in no known unit; the channel is left out"
    return Fault("unit", sensor.channel, what, "Give the sensor its unit in the campaign file.")


def _coupling_fault(sensor: Sensor) -> Fault:
    what = "reads zero at rest, most other sensors read gravity: AC-coupled, or zeroed; nothing was changed"
    do = (
        "If it is AC-coupled, state high_pass = ... (its cut-off, Hz) in the campaign file: it distorts the body modes."
    )
    return Fault("coupling", sensor.channel, what, do)


def _offset_fault(sensor: Sensor, reading: float) -> Fault:
    what = f"reads {reading:.2f} g at rest, {reading - 1:+.2f} g off gravity; an offset does no harm"
    if 0 < reading < 1:
        tilt = np.degrees(np.arccos(reading))
        what += f", but a tilt, which would be {tilt:.0f}°, would reduce its sensitivity to {reading:.0%}"
    return Fault(
        "offset", sensor.channel, f"{what}; nothing was changed", "Mount the sensor upright, or have its zero set."
    )


def _group_faults(faults: Sequence[Fault]) -> list[Fault]:
    """Return the faults with one for several sensors that have the same: the same code, and the same remedy."""
    groups: dict[tuple[str, str], list[Fault]] = {}
    for fault in faults:
        alike = fault.code in {"unit", "sign"}
        groups.setdefault((fault.code, fault.do if alike else fault.where + fault.do), []).append(fault)
    return [fault for group in groups.values() for fault in ([_joint(group)] if len(group) >= _SEVERAL else group)]


def _joint(group: Sequence[Fault]) -> Fault:
    first = group[0]
    where = ", ".join(fault.where for fault in group)
    what = f"{len(group)} sensors, for example {first.where}: {first.what}"
    return Fault(first.code, where, what, first.do.replace(" for it ", " for them "))


def scale_recording(recording: Recording, factors: Real) -> Recording:
    """Scale the channels of a recording.

    Parameters
    ----------
    recording
        As it was read.
    factors
        Dimensionless, shape (channel,); NaN leaves a channel out.

    Returns
    -------
    Recording
    """
    scales = zip(recording.full_scale, factors.tolist(), strict=True) if recording.full_scale else ()
    return replace(
        recording,
        values=recording.values * factors[:, None],
        full_scale=tuple(None if scale is None else scale * abs(factor) for scale, factor in scales),
    )


def _scale_release(release: Release, factors: Real) -> Release:
    return release._replace(
        level=release.level * factors,
        noise=release.noise * factors[:, None],
        step=release.step * np.abs(factors),
    )
