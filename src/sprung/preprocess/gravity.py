"""Gravity at rest: what a sensor reads while nothing moves tells its sign, its unit, its offset and how it is coupled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Recording
from sprung.errors import Fault
from sprung.preprocess.high_pass import SILENT
from sprung.preprocess.release import Release, StaticBaseline
from sprung.units import STANDARD_GRAVITY, acceleration_factor
from sprung.vehicle import Sensor

Real = NDArray[np.float64]
Flags = NDArray[np.bool_]

_NEAR = 0.1
"""Part of gravity by which tilt and offset may change what a sensor reads at rest."""

_UNTOLD = 0.05
"""Part of gravity up to which that is not worth a word: a tilt of 18 degrees."""

_SEVERAL = 3
"""Sensors from which the same mistake with all of them is told once."""

_FARTHEST = 3.0
"""g at rest from which it is no offset any more, but numbers in an unknown unit."""

_SCALES = (
    (1.0, "", ""),
    *((acceleration_factor(unit), f"in {unit}", unit) for unit in ("g", "mg", "mm/s^2", "cm/s^2", "ft/s^2", "in/s^2")),
    (1 / STANDARD_GRAVITY, "in m/s^2, not in g", "m/s^2"),
)
"""Factor that puts a channel's unit right, what the numbers are then, and the unit to give the sensor."""


class SignAndUnitCorrection(NamedTuple):
    """A campaign's recordings with what gravity tells put right.

    Attributes
    ----------
    recordings
        With a fault for each channel that was changed, or that reads something else than gravity.
    releases
        With what those channels read before it, changed likewise.
    sensors
        Without the high-pass of those that feel gravity.
    """

    recordings: list[Recording]
    releases: list[Release | None]
    sensors: tuple[Sensor, ...]


def check_gravity(
    recordings: Sequence[Recording], releases: Sequence[Release | None], sensors: Sequence[Sensor]
) -> SignAndUnitCorrection:
    """Put right the channels whose rest shows beyond doubt that their sign, unit or coupling is another one.

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
    Righted

    Notes
    -----
    Only sensors that feel gravity tell, and only what they read in every drop that has a rest. A unit is changed where
    gravity is about 1 in another one and the channel then moves more like its neighbours, a sign where most of the sensors
    that feel gravity feel it the other way. Whether an AC-coupled sensor is upside down, its rest does not say.
    """
    unchanged = SignAndUnitCorrection(list(recordings), list(releases), tuple(sensors))
    rests = [release.rest.level for release in releases if release is not None]
    if not rests:
        return unchanged
    told = _read(np.array(rests) / STANDARD_GRAVITY, _peaks(recordings), sensors)
    faults = _together([fault for reading in told for fault in _faults(reading)])
    if not faults:
        return unchanged
    factors = np.array([np.nan if r.strange else _SCALES[r.scale][0] * (-1.0 if r.turned else 1.0) for r in told])
    changed = [_times(recording, factors) for recording in recordings]
    changed[0] = replace(changed[0], faults=(*changed[0].faults, *faults))
    direct = tuple(replace(r.sensor, high_pass=None) if r.feels else r.sensor for r in told)
    return SignAndUnitCorrection(changed, [None if one is None else _changed(one, factors) for one in releases], direct)


class _Reading(NamedTuple):
    """What one sensor reads at rest, in every drop."""

    sensor: Sensor
    usual: float
    """g, as it is."""
    at_rest: float
    """g, upward, its unit and sign put right."""
    scale: int
    """Which of the scales puts its unit right."""
    feels: bool
    """Whether it reads gravity, in that scale and either way."""
    turned: bool
    """Whether it does so the other way than most."""
    silent: bool
    """Whether it reads nothing."""
    strange: bool
    """Whether it reads what can be no offset."""
    compared: bool
    """Whether most sensors that read anything read gravity."""
    outvoted: bool
    """Whether more sensors read gravity than nothing."""


def _read(levels: Real, peaks: Real, sensors: Sequence[Sensor]) -> list[_Reading]:
    """Understand levels at rest, g, shape (drop, channel), with how much the channels move, m/s², shape (channel,)."""
    known: Flags = np.logical_not(np.isnan(levels).all(axis=0))
    usual = np.array(
        [np.median(of[~np.isnan(of)]) if some else np.nan for of, some in zip(levels.T, known, strict=True)]
    )
    silent = known & _in_every_drop(np.abs(levels) < SILENT / STANDARD_GRAVITY, levels)
    scale = _scales(levels, known & ~silent, peaks, sensors)
    factors = np.array([_SCALES[i][0] for i in scale])
    feels = known & _in_every_drop(np.abs(np.abs(levels * factors) - 1) < _NEAR, levels)
    way = np.sign(np.where(feels, usual, 0.0))
    most = -1.0 if way.sum() < 0 else 1.0
    turned = feels & (way * way.sum() < 0)
    at_rest = usual * factors * np.where(turned, -most, most)
    through = np.array([sensor.high_pass is not None for sensor in sensors])
    odd = known & ~through & ~silent & ~feels
    compared = bool(feels.sum() > odd.sum())
    strange = odd & compared & (np.abs(usual) > _FARTHEST)
    outvoted = bool(feels.sum() > silent.sum())
    return [
        _Reading(
            sensor=sensor,
            usual=float(usual[i]),
            at_rest=float(at_rest[i]),
            scale=scale[i],
            feels=bool(feels[i]),
            turned=bool(turned[i]),
            silent=bool(silent[i]),
            strange=bool(strange[i]),
            compared=compared,
            outvoted=outvoted,
        )
        for i, sensor in enumerate(sensors)
    ]


def _faults(reading: _Reading) -> list[Fault]:
    sensor = reading.sensor
    faults = []
    _, seen, unit = _SCALES[reading.scale]
    number = f"{reading.usual * STANDARD_GRAVITY:.4g}"
    if unit:
        what = f"at rest it reads {number}, which is gravity {seen}; it was taken to be in {unit}"
        do = f'Set unit = "{unit}" for it in the campaign file.'
        faults.append(Fault("unit", sensor.channel, what, do))
    if reading.turned:
        way, other = ("downward", "upward") if reading.usual < 0 else ("upward", "downward")
        what = f"at rest it reads gravity {way}, where most of the others read it {other}; it was turned over"
        direction = "down" if sensor.direction == "up" else "up"
        faults.append(
            Fault("sign", sensor.channel, what, f'Set direction = "{direction}" for it in the campaign file.')
        )
    if reading.feels and sensor.high_pass is not None:
        what = (
            "at rest it reads gravity, which no AC-coupled sensor does; its high-pass of "
            f"{sensor.high_pass:g} Hz was not undone"
        )
        faults.append(Fault("coupling", sensor.channel, what, "Take high_pass out of the campaign file for it."))
    elif sensor.high_pass is not None or not reading.compared:
        return faults
    elif reading.strange:
        what = f"at rest it reads {number}, which is gravity in no unit that is known; the channel is left out"
        faults.append(Fault("unit", sensor.channel, what, "Give the sensor its unit in the campaign file."))
    elif reading.silent and reading.outvoted:
        what = (
            "at rest it reads nothing, where most others read gravity: AC-coupled, or set to zero; nothing was changed"
        )
        do = "If it is AC-coupled, say its corner in the campaign file, high_pass = ... in Hz: it distorts the body modes."
        faults.append(Fault("coupling", sensor.channel, what, do))
    elif not reading.silent and abs(reading.at_rest - 1) > _UNTOLD:
        what = f"at rest it reads {reading.at_rest:.2f} g, {reading.at_rest - 1:+.2f} g off gravity; an offset does no harm"
        if 0 < reading.at_rest < 1:
            tilt = np.degrees(np.arccos(reading.at_rest))
            what += (
                f", but were it a tilt, of {tilt:.0f}°, the sensor would show only {reading.at_rest:.0%} of what moves"
            )
        do = "Mount the sensor upright, or have its zero set."
        faults.append(Fault("offset", sensor.channel, f"{what}; nothing was changed", do))
    return faults


def _together(faults: Sequence[Fault]) -> list[Fault]:
    """Name one mistake with several sensors once: the same code, and the same thing to do about it."""
    groups: dict[tuple[str, str], list[Fault]] = {}
    for fault in faults:
        alike = fault.code in {"unit", "sign"}
        groups.setdefault((fault.code, fault.do if alike else fault.where + fault.do), []).append(fault)
    return [
        _one(group) if len(group) >= _SEVERAL else fault
        for group in groups.values()
        for fault in group[: _shown(group)]
    ]


def _shown(group: Sequence[Fault]) -> int:
    return 1 if len(group) >= _SEVERAL else len(group)


def _one(group: Sequence[Fault]) -> Fault:
    first = group[0]
    where = ", ".join(fault.where for fault in group)
    what = f"{len(group)} sensors alike, such as {first.where}: {first.what}"
    return Fault(first.code, where, what, first.do.replace(" for it ", " for them "))


def _in_every_drop(holds: Flags, levels: Real) -> Flags:
    return np.asarray((holds | np.isnan(levels)).all(axis=0))


def _peaks(recordings: Sequence[Recording]) -> Real:
    """Give by how much each channel moves, m/s², in the mean over the drops; shape (channel,)."""
    ranges = np.array([np.ptp(recording.values, axis=1) for recording in recordings if recording.values.size])
    there = ~np.isnan(ranges)
    mean: Real = np.where(there, ranges, 0.0).sum(axis=0) / np.maximum(there.sum(axis=0), 1)
    return mean


def _scales(levels: Real, loud: Flags, peaks: Real, sensors: Sequence[Sensor]) -> list[int]:
    """Find for each channel the scale in which it reads gravity; that of m/s² where none, or no other, is beyond doubt."""
    usual = np.array([np.abs(level[~np.isnan(level)]) for level in levels.T], dtype=object)
    on_body = np.array([sensor.on == "body" for sensor in sensors])
    best = []
    for channel, readings in enumerate(usual):
        fits = {
            i: float(np.abs(readings * factor - 1).max())
            for i, (factor, _, _) in enumerate(_SCALES)
            if loud[channel] and np.all(np.abs(readings * factor - 1) < _NEAR)
        }
        best.append(0 if not fits or 0 in fits else min(fits, key=fits.__getitem__))
    for channel, chosen in enumerate(best):
        others = (on_body == on_body[channel]) & (np.array(best) != chosen) & (peaks > 0)
        if chosen and others.any():
            ratio = np.log(peaks[channel] / np.median(peaks[others]))
            if abs(ratio + np.log(_SCALES[chosen][0])) > abs(ratio):
                best[channel] = 0
    return best


def _times(recording: Recording, factors: Real) -> Recording:
    scales = zip(recording.full_scale, factors.tolist(), strict=True) if recording.full_scale else ()
    return replace(
        recording,
        values=recording.values * factors[:, None],
        full_scale=tuple(None if scale is None else scale * abs(factor) for scale, factor in scales),
    )


def _changed(release: Release, factors: Real) -> Release:
    rest = release.rest
    return Release(
        release.sample, StaticBaseline(rest.level * factors, rest.noise * factors[:, None], rest.step * np.abs(factors))
    )
