"""How sensors are coupled: the corners of their high-passes, taken from the records of all of them together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.bench import Bench
from sprung.faults.changes import Change, described
from sprung.faults.corners import corners
from sprung.faults.hypotheses import Hypothesis
from sprung.faults.suspicion import MATTERS
from sprung.uncertainty import round_by_uncertainty
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

_ROUNDS = 8
"""Fits in which corners settle."""

_FARTHEST = 0.5
"""Hz by which a corner changes at once."""


_SURE = 4.0
"""Standard uncertainties by which a corner has to be another one than is stated."""

_SETTLED = 1e-4
"""Hz by which corners may still change: they are none below 0."""


def coupled_otherwise(bench: Bench) -> Iterator[Hypothesis]:
    """Give the sensors that may be AC-coupled the corners with which the records are most likely, all of them at once.

    Where all sensors have the same high-pass, none of them contradicts the others: the motion of each mode is changed alike in
    all of them. What tells is how the high-pass dies away after the fall.
    """
    trial, sensors = bench.base, bench.campaign.sensors
    found = corners(trial.decays, trial.optimum, sensors)
    if found is None or len(found.channels) < 2:
        return
    which = [i for i, one in enumerate(sensors) if one.channel in found.channels]
    stated = np.array([sensors[i].high_pass or 0.0 for i in which])
    now, start = stated, None
    for _ in range(_ROUNDS):
        if found is None or found.worth < 1:
            break
        now, before = np.maximum(now + np.clip(found.step, -_FARTHEST, _FARTHEST), 0.0), now
        if np.abs(now - before).max() < _SETTLED:
            break
        trial = bench.fit(_with_corners(which, now.tolist())(bench.campaign), start)
        start = trial.optimum.parameters
        found = corners(trial.decays, trial.optimum, trial.campaign.sensors)
    if found is None:
        return
    stds = np.sqrt(np.diag(found.covariance))
    changed = np.flatnonzero(np.abs(now - stated) > np.maximum(_SURE * stds, MATTERS["corner"])).tolist()
    if len(changed) < 2:
        return
    change = _with_corners([which[k] for k in changed], now[changed].tolist())
    if len(changed) < len(which):
        trial = bench.fit(change(bench.campaign), start)
    fault = of_corners([sensors[which[k]] for k in changed], now[changed].tolist(), stds[changed].tolist())
    fault = replace(fault, what=f"{fault.what}; that was undone")
    yield Hypothesis(fault, "repaired", change, trial.tally, trial, len(changed))


def with_corner(sensor: Sensor, corner: float) -> Sensor:
    """Describe a sensor with another corner of its high-pass, Hz; without one where that is all but 0."""
    return replace(sensor, high_pass=corner if corner > MATTERS["corner"] else None)


def of_corners(sensors: Sequence[Sensor], corners: Sequence[float], stds: Sequence[float]) -> Fault:
    """Name sensors whose high-pass has another corner than is stated.

    Parameters
    ----------
    sensors
        As they are described.
    corners, stds
        Their corners and standard uncertainties of these, Hz; no uncertainties where these are not known.
    """
    if len(sensors) > 1:
        each = ", ".join(f"{one.channel} {_told(*it)}" for one, *it in zip(sensors, corners, stds, strict=True))
        what = f"their high-passes have other corners than is stated, as the records of all of them show: {each}"
        do = "Set high_pass = ..., in Hz, for each of them in the campaign file; their data sheets say it, or the logger's."
        return Fault("corner", ", ".join(one.channel for one in sensors), what, do)
    (sensor,), (corner,) = sensors, corners
    size = _told(corner, *stds)
    do = f"Set high_pass = {corner:.2g} for it in the campaign file, or what its data sheet says."
    if corner < MATTERS["corner"]:
        what, do = "it has no high-pass", "Take high_pass out of the campaign file for it."
    elif sensor.high_pass is None:
        what = f"it is AC-coupled, with a corner of {size}, of which nothing is stated"
    else:
        what = f"its high-pass has a corner of {size}, not of {sensor.high_pass:g} Hz"
    return Fault("corner", sensor.channel, f"{what}, as the other channels show", do)


def _told(corner: float, std: float = 0.0) -> str:
    value, error = round_by_uncertainty(corner, std) if std else (f"{corner:.2g}", "")
    return f"{value} ± {error} Hz" if error else f"{value} Hz"


def _with_corners(which: Sequence[int], corners: Sequence[float]) -> Change:
    """Describe some channels with other corners, Hz."""

    def change(campaign: Campaign) -> Campaign:
        for channel, corner in zip(which, corners, strict=True):
            campaign = described(channel, with_corner(campaign.sensors[channel], corner))(campaign)
        return campaign

    return change
