"""Changes: what puts a campaign right, or takes something out of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign, Recording
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

Change = Callable[[Campaign], Campaign]
"""A campaign in, another one out."""

_How = Callable[[Real, float], None]
"""Changes samples, shape (channel, time), of which there are so many per second, where they are."""

_TAPS = 8
"""Samples to each side from which a value between two samples is read."""


def nothing(campaign: Campaign) -> Campaign:
    """Change nothing."""
    return campaign


def silenced(channel: int, only: str | None = None) -> Change:
    """Leave a channel out, of all drops or of one."""

    def how(values: Real, _: float) -> None:
        values[channel] = np.nan

    return lambda campaign: _with_samples(campaign, how, only)


def scaled(channel: int, factor: float) -> Change:
    """Multiply a channel's samples, and its full scale."""

    def how(values: Real, _: float) -> None:
        values[channel] *= factor

    def full(scale: float | None) -> float | None:
        return None if scale is None else abs(factor) * scale

    def change(campaign: Campaign) -> Campaign:
        recordings = [
            replace(one, full_scale=tuple(full(s) if i == channel else s for i, s in enumerate(one.full_scale)))
            for one in _with_samples(campaign, how).recordings
        ]
        return campaign.with_recordings(recordings)

    return change


def advanced(channel: int, seconds: float) -> Change:
    """Move a channel's samples to an earlier time, by any part of a sample (Lanczos' kernel)."""

    def how(values: Real, rate: float) -> None:
        whole = int(np.clip(np.floor(seconds * rate), -values.shape[1], values.shape[1]))
        taps = np.arange(1 - _TAPS, _TAPS + 1)
        away = taps - (seconds * rate - whole)
        kernel = np.sinc(away) * np.sinc(away / _TAPS)
        margin = _TAPS + abs(whole)
        padded = np.pad(values[channel], margin, mode="edge")
        moved = np.convolve(padded, kernel[::-1] / kernel.sum(), mode="valid")
        first = margin + whole + int(taps[0])
        values[channel] = moved[first : first + values.shape[1]]

    return lambda campaign: _with_samples(campaign, how)


def exchanged(one: int, other: int, only: str | None = None) -> Change:
    """Exchange two channels: in one drop their samples, in all what is said of them."""

    def how(values: Real, _: float) -> None:
        values[[one, other]] = values[[other, one]]

    def everywhere(campaign: Campaign) -> Campaign:
        sensors = list(campaign.sensors)
        sensors[one], sensors[other] = _like(sensors[one], sensors[other]), _like(sensors[other], sensors[one])
        return replace(campaign, sensors=tuple(sensors))

    return everywhere if only is None else lambda campaign: _with_samples(campaign, how, only)


def described(channel: int, sensor: Sensor) -> Change:
    """Describe a channel's sensor otherwise."""

    def change(campaign: Campaign) -> Campaign:
        sensors = (*campaign.sensors[:channel], sensor, *campaign.sensors[channel + 1 :])
        return replace(campaign, sensors=sensors)

    return change


def relabelled(loads: Mapping[str, str]) -> Change:
    """Say of some drops that they had another load, by the names of their recordings."""

    def change(campaign: Campaign) -> Campaign:
        drops = [replace(drop, load=loads.get(drop.recording.name, drop.load)) for drop in campaign.drops]
        return replace(campaign, drops=tuple(drops))

    return change


def load_moved(name: str, item: int, axis: int, by: float) -> Change:
    """Put an item of a load elsewhere, m."""

    def change(campaign: Campaign) -> Campaign:
        load = campaign.load(name)
        items = list(load.items)
        x, y, z = items[item].position or (0.0, 0.0, 0.0)
        items[item] = replace(items[item], position=(x + by * (axis == 0), y + by * (axis == 1), z + by * (axis == 2)))
        moved = replace(load, items=tuple(items))
        return replace(campaign, loads=tuple(moved if one.name == name else one for one in campaign.loads))

    return change


def without_drops(*files: str) -> Change:
    """Leave drops out, by the names of their recordings."""

    def change(campaign: Campaign) -> Campaign:
        return replace(campaign, drops=tuple(drop for drop in campaign.drops if drop.recording.name not in files))

    return change


def _like(sensor: Sensor, other: Sensor) -> Sensor:
    """Say of a sensor what is said of another one; channel and logger stay its own."""
    return replace(other, channel=sensor.channel, logger=sensor.logger)


def _with_samples(campaign: Campaign, how: _How, only: str | None = None) -> Campaign:
    """Change the samples of all recordings, or of one."""
    changed = [_changed(one, how) if only in (None, one.name) else one for one in campaign.recordings]
    return campaign.with_recordings(changed)


def _changed(recording: Recording, how: _How) -> Recording:
    """Change a recording's samples, and those of the loggers from which it was put together."""
    values = recording.values.copy()
    how(values, recording.rate)
    parts = []
    for part in recording.parts:
        rows = [recording.channels.index(channel) for channel in part.channels]
        whole = np.full((len(recording.channels), part.values.shape[1]), np.nan)
        whole[rows] = part.values
        how(whole, part.rate)
        parts.append(replace(part, values=whole[rows]))
    return replace(recording, values=values, parts=tuple(parts))
