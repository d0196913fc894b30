"""Corrections: what puts a campaign right, or takes something out of it.

A correction can be applied to a campaign, which is then preprocessed again, or to decays that are prepared already, which
is all that comparing hypotheses needs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign, Recording
from sprung.preprocess import FreeDecay, differentiate_by_cutoff
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

Description = Callable[[Campaign], Campaign]
"""Changes what a campaign states; its samples stay."""

Samples = Callable[[Real, float], Real]
"""From samples, shape (channel, time), and their rate in Hz to other samples."""

_TAPS = 8
"""Samples to each side from which a value between two samples is interpolated."""


def _unchanged(campaign: Campaign) -> Campaign:
    return campaign


@dataclass(frozen=True, eq=False)
class Correction:
    """A correction of a campaign.

    Attributes
    ----------
    description
        What it changes of the statements.
    samples
        What it changes of the samples; None for nothing.
    recording
        The one recording whose samples it changes; None for all.
    gains
        By channel the factor on its samples, which is also one on its full scale.
    corners
        By channel the corner of its high-pass instead of the stated one, Hz.
    exchanged
        The two channels whose samples it exchanges; empty for none.
    """

    description: Description = _unchanged
    samples: Samples | None = None
    recording: str | None = None
    gains: Mapping[int, float] = field(default_factory=dict)
    corners: Mapping[int, float] = field(default_factory=dict)
    exchanged: tuple[int, ...] = ()

    def of_campaign(self, campaign: Campaign) -> Campaign:
        """Return the corrected campaign."""
        if self.samples is not None:
            drops = (replace(drop, recording=self._of_recording(drop.recording)) for drop in campaign.drops)
            campaign = replace(campaign, drops=tuple(drops))
        return self.description(campaign)

    def of_decays(self, campaign: Campaign, decays: Sequence[FreeDecay]) -> tuple[FreeDecay, ...]:
        """Return the decays that the corrected campaign would have, with the same limits.

        Parameters
        ----------
        campaign
            The corrected campaign.
        decays
            Before the correction.
        """
        loads = {drop.recording.name: drop.load for drop in campaign.drops}
        kept = (replace(decay, load=loads[decay.file]) for decay in decays if decay.file in loads)
        corrected = tuple(self._of_decay(decay) for decay in kept)
        return tuple(decay for decay in corrected if decay.usable.any())

    def _concerns(self, name: str) -> bool:
        return self.samples is not None and self.recording in (None, name)

    def _of_recording(self, recording: Recording) -> Recording:
        """Correct a recording, and those of the loggers from which it was put together."""
        if self.samples is None or not self._concerns(recording.name):
            return recording
        parts = []
        for part in recording.parts:
            rows = [recording.channels.index(channel) for channel in part.channels]
            whole = np.full((len(recording.channels), part.values.shape[1]), np.nan)
            whole[rows] = part.values
            parts.append(replace(part, values=self.samples(whole, part.rate)[rows]))
        full_scale = tuple(
            None if scale is None else abs(self.gains.get(channel, 1.0)) * scale
            for channel, scale in enumerate(recording.full_scale)
        )
        values = self.samples(recording.values, recording.rate)
        return replace(recording, values=values, parts=tuple(parts), full_scale=full_scale)

    def _of_decay(self, decay: FreeDecay) -> FreeDecay:
        if self.corners and self.recording in (None, decay.file):
            decay = with_corners(decay, self.corners)
        if self.samples is None or not self._concerns(decay.file):
            return decay
        if self.exchanged:
            return with_exchanged(decay, *self.exchanged)
        whole = self.samples(np.concatenate([decay.earlier, decay.values], axis=1), decay.rate)
        earlier, values = np.split(whole, [decay.earlier.shape[1]], axis=1)
        level, noise = decay.rest.level[:, None], decay.rest.noise
        # A gain applies to the reading at rest too; a shift in time changes neither level nor noise.
        rest = decay.rest._replace(
            level=self.samples(level, decay.rate)[:, 0], noise=self.samples(noise, decay.rate) if noise.size else noise
        )
        return replace(decay, values=values, earlier=earlier, rest=rest)


def with_corners(decay: FreeDecay, corners: Mapping[int, float]) -> FreeDecay:
    """Return a decay whose channels had high-passes with other corners.

    The samples without the high-pass are linear in its corner frequency, so this is exact.

    Parameters
    ----------
    decay
        With the high-passes undone that are stated.
    corners
        By channel, Hz.
    """
    integral = differentiate_by_cutoff(decay, list(corners))
    stated = np.array(decay.high_pass or np.zeros(len(decay.values)))
    wanted = stated.copy()
    wanted[list(corners)] = list(corners.values())
    values = decay.values + 2 * np.pi * (wanted - stated)[:, None] * integral
    return replace(
        decay,
        values=values,
        earlier=decay.earlier[:, :0],
        high_pass=tuple(wanted.tolist()),
        initial_velocity=integral[:, 0],
    )


def with_exchanged(decay: FreeDecay, first: int, second: int) -> FreeDecay:
    """Return a decay with the samples of two channels exchanged, in which each has its own high-pass undone.

    Parameters
    ----------
    decay
        With the high-passes undone that are stated of the channels.
    first, second
        Indices of the channels.
    """
    stated, order = decay.high_pass, np.arange(len(decay.values))
    order[[first, second]] = second, first
    if stated and stated[first] != stated[second]:
        decay = with_corners(decay, {first: stated[second], second: stated[first]})
    return replace(
        decay,
        values=decay.values[order],
        earlier=decay.earlier[order],
        high_pass=stated,
        initial_velocity=decay.initial_velocity[order] if decay.initial_velocity.size else decay.initial_velocity,
        rest=decay.rest._replace(
            level=decay.rest.level[order], noise=decay.rest.noise[order] if decay.rest.noise.size else decay.rest.noise
        ),
    )


def mask_channel(channel: int, recording: str | None = None) -> Correction:
    """Leave a channel out, of all drops or of one."""

    def masked(values: Real, _: float) -> Real:
        return np.where(np.arange(len(values))[:, None] == channel, np.nan, values)

    return Correction(samples=masked, recording=recording)


def scale_channel(channel: int, factor: float) -> Correction:
    """Multiply a channel's samples, and its full scale."""

    def scaled(values: Real, _: float) -> Real:
        return np.where(np.arange(len(values))[:, None] == channel, factor * values, values)

    return Correction(samples=scaled, gains={channel: factor})


def advance_channel(channel: int, delay: float) -> Correction:
    """Undo a delay of a channel, s, by any part of a sample (interpolation with Lanczos' kernel)."""

    def advanced(values: Real, rate: float) -> Real:
        if values.shape[1] <= 2 * _TAPS:  # a level at rest is the same at every time
            return values
        whole = int(np.clip(np.floor(delay * rate), -values.shape[1], values.shape[1]))
        taps = np.arange(1 - _TAPS, _TAPS + 1)
        distance = taps - (delay * rate - whole)
        kernel = np.sinc(distance) * np.sinc(distance / _TAPS)
        margin = _TAPS + abs(whole)
        padded = np.pad(values[channel], margin, mode="edge")
        moved = np.convolve(padded, kernel[::-1] / kernel.sum(), mode="valid")
        first = margin + whole + int(taps[0])
        samples = values.copy()
        samples[channel] = moved[first : first + values.shape[1]]
        return samples

    return Correction(samples=advanced)


def exchange_channels(first: int, second: int, sensors: Sequence[Sensor]) -> Correction:
    """Exchange what is stated of two channels, also of their high-passes; channel names and loggers stay.

    Parameters
    ----------
    first, second
        Indices of the channels.
    sensors
        As they are stated.
    """
    placed = list(sensors)
    placed[first], placed[second] = (
        _placed_like(sensors[first], sensors[second]),
        _placed_like(sensors[second], sensors[first]),
    )
    corners = {channel: placed[channel].high_pass or 0.0 for channel in (first, second)}
    is_alike = sensors[first].high_pass == sensors[second].high_pass

    def exchanged(campaign: Campaign) -> Campaign:
        return replace(campaign, sensors=tuple(placed))

    return Correction(description=exchanged, corners={} if is_alike else corners)


def exchange_columns(first: int, second: int, recording: str) -> Correction:
    """Exchange the samples of two channels in one recording."""

    def exchanged(values: Real, _: float) -> Real:
        order = np.arange(len(values))
        order[[first, second]] = second, first
        return np.asarray(values[order])

    return Correction(samples=exchanged, recording=recording, exchanged=(first, second))


def describe_sensor(channel: int, sensor: Sensor) -> Correction:
    """State another sensor for a channel."""

    def described(campaign: Campaign) -> Campaign:
        sensors = (*campaign.sensors[:channel], sensor, *campaign.sensors[channel + 1 :])
        return replace(campaign, sensors=sensors)

    return Correction(description=described)


def state_corners(corners: Mapping[int, float | None]) -> Correction:
    """State other corners of some channels' high-passes, Hz, or None for no high-pass."""

    def described(campaign: Campaign) -> Campaign:
        sensors = (
            replace(sensor, high_pass=corners[channel]) if channel in corners else sensor
            for channel, sensor in enumerate(campaign.sensors)
        )
        return replace(campaign, sensors=tuple(sensors))

    return Correction(description=described, corners={channel: corner or 0.0 for channel, corner in corners.items()})


def relabel_loads(loads: Mapping[str, str]) -> Correction:
    """State other loads for some drops, by the names of their recordings."""

    def relabelled(campaign: Campaign) -> Campaign:
        drops = (replace(drop, load=loads.get(drop.recording.name, drop.load)) for drop in campaign.drops)
        return replace(campaign, drops=tuple(drops))

    return Correction(description=relabelled)


def move_load_item(name: str, item: int, axis: int, distance: float) -> Correction:
    """Move an item of a load along an axis (0 forward, 1 left), m."""

    def moved(campaign: Campaign) -> Campaign:
        load = campaign.load(name)
        items = list(load.items)
        x, y, z = items[item].position or (0.0, 0.0, 0.0)
        place = (x + distance * (axis == 0), y + distance * (axis == 1), z)
        items[item] = replace(items[item], position=place)
        other = replace(load, items=tuple(items))
        return replace(campaign, loads=tuple(other if one.name == name else one for one in campaign.loads))

    return Correction(description=moved)


def exclude_drops(*recordings: str) -> Correction:
    """Leave drops out, by the names of their recordings."""

    def excluded(campaign: Campaign) -> Campaign:
        return replace(campaign, drops=tuple(drop for drop in campaign.drops if drop.recording.name not in recordings))

    return Correction(description=excluded)


def _placed_like(sensor: Sensor, other: Sensor) -> Sensor:
    """Return a sensor with the statements of another one; channel and logger stay its own."""
    return replace(other, channel=sensor.channel, logger=sensor.logger)
