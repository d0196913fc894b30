"""Modes of each load from its decays, without a vehicle model."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Problems
from sprung.identification import ModeEstimate
from sprung.modal import Mode, identify_modes, name_by_sensors
from sprung.prepare import Decay, prepare
from sprung.recording import Campaign


def modes(campaign: Campaign, method: str = "era", order: int | None = None) -> dict[str, tuple[ModeEstimate, ...]]:
    """Find the modes of every load; no vehicle model is needed.

    Parameters
    ----------
    campaign
        From `sprung.read` or `sprung.simulate`.
    method
        ``era``: eigensystem realisation over all drops of a load; ``svm``: the paper's State Variable Method.
    order
        Number of poles to look for; the method chooses unless it is given.

    Returns
    -------
    dict
        By load, lowest frequency first. Names are the paper's seven, by the shapes at the sensors.

    Raises
    ------
    InputError
        If there is no such method or no drop can be used.
    """
    decays = prepare(campaign).decays
    if not decays:
        problems = Problems()
        problems.add(campaign.name, "no drop that can be used", "at least one", "Run `sprung check` on the campaign.")
        problems.raise_if_any()
    found = {}
    for load in campaign.loads:
        of_load = [decay for decay in decays if decay.load == load.name]
        if of_load:
            found[load.name] = _modes_of(of_load, campaign, method, order)
    return found


def _modes_of(decays: list[Decay], campaign: Campaign, method: str, order: int | None) -> tuple[ModeEstimate, ...]:
    # Records of another rate, or channels that one drop lacks, cannot stand in the same matrix.
    rate = Counter(decay.rate for decay in decays).most_common(1)[0][0]
    same = [decay for decay in decays if decay.rate == rate]
    channels = np.logical_and.reduce([decay.usable for decay in same])
    records = [decay.values[channels] - _level(decay)[channels, None] for decay in same]
    sensors = [sensor for sensor, used in zip(campaign.sensors, channels, strict=True) if used]
    a = campaign.known.get("a")
    named = name_by_sensors(identify_modes(records, rate, method, order), sensors, a.value if a is not None else None)
    return tuple(_estimate(mode) for mode in named)


def _level(decay: Decay) -> NDArray[np.float64]:
    """Give the offset of each channel: its reading at rest, or where there was none its mean; shape (channel,)."""
    return np.where(np.isnan(decay.rest.level), decay.values.mean(axis=1), decay.rest.level)


def _estimate(mode: Mode) -> ModeEstimate:
    return ModeEstimate(
        name=mode.name or "unnamed",
        pole=(mode.pole.real, mode.pole.imag),
        frequency=mode.frequency,
        frequency_std=None,
        damped_frequency=mode.damped_frequency,
        damping_ratio=mode.damping_ratio,
        damping_ratio_std=None,
    )
