"""Baseline drift that is too slow for any vehicle and too small to spoil the fit: found in the residuals, and named."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as fisher

from sprung.errors import Fault
from sprung.estimation import FitResult
from sprung.faults.residual_table import is_explained
from sprung.preprocess import FreeDecay, quantisation_variance
from sprung.units import si_symbol
from sprung.vehicle import Sensor

Real = NDArray[np.float64]

_SLOWEST = 2
"""Half periods in a record, up to which nothing but a drift is what a vehicle leaves."""

_FIRST, _LAST = 10, 30
"""Half periods in a record that noise is taken from: beyond the body's modes, below the wheels'."""

_CHANCE = 1e-6
"""How often chance alone may name a channel."""

_MORE = 4.0
"""Times what chance may make of it that it has to be: the spectrum of noise that is not white is not quite even."""


def detect_drift(decays: Sequence[FreeDecay], optimum: FitResult, sensors: Sequence[Sensor]) -> tuple[Fault, ...]:
    """Return the channels with baseline drift, from the slowest residuals of all drops together.

    Parameters
    ----------
    decays
        What was fitted.
    optimum
        Where the fit ended.
    sensors
        One for each channel; where a high-pass was undone, noise walks as well, and nothing is said.

    Returns
    -------
    tuple of Fault
        None where more is left than noise: what that is, others say.

    Notes
    -----
    The power of the slowest half periods of the residuals (by a cosine transform, in which white noise is spread evenly) over
    that of those between the body's modes and the wheels' follows Fisher's distribution in noise that has no drift.
    """
    if not is_explained(decays, optimum):
        return ()
    slow, fast = slowness(decays, optimum)
    fast = np.maximum(fast, quantisation_variance(decays))
    drops = np.sum([one.usable for one in decays], axis=0)
    most = _MORE * fisher.isf(_CHANCE, np.maximum(_SLOWEST * drops, 1), np.maximum((_LAST - _FIRST) * drops, 1))
    walks = (slow > most * fast) & [sensor.high_pass is None for sensor in sensors]
    return tuple(
        Fault(
            "drift",
            sensors[channel].channel,
            f"baseline drift of {_size(decays, slow[channel]):.2g} {si_symbol(sensors[channel].quantity)} in a recording; "
            "nothing was changed",
            "Let the sensor and the logger warm up before the test, and see that nothing strains the sensor's base.",
        )
        for channel in np.flatnonzero(walks).tolist()
    )


def slowness(decays: Sequence[FreeDecay], optimum: FitResult) -> tuple[Real, Real]:
    """Return the mean power, (m/s²)², of the residuals: slowest half periods, and faster ones; shape (channel,) each."""
    slow = fast = drops = np.zeros(len(decays[0].values))
    for record in optimum.residuals:
        power = np.nan_to_num(record @ _cosines(record.shape[1])) ** 2
        slow, fast = slow + power[:, :_SLOWEST].mean(axis=1), fast + power[:, _FIRST:].mean(axis=1)
        drops = drops + ~np.isnan(record[:, 0])
    return slow / np.maximum(drops, 1), fast / np.maximum(drops, 1)


@lru_cache(maxsize=64)
def _cosines(samples: int) -> Real:
    """Return the first cosines of the cosine transform after the constant one, orthonormal, shape (time, half periods)."""
    phase = np.pi * (np.arange(samples) + 0.5) / samples
    cosines: Real = np.sqrt(2 / samples) * np.cos(np.outer(phase, np.arange(1, _LAST + 1)))
    return cosines


def _size(decays: Sequence[FreeDecay], power: float) -> float:
    """Return the range of a straight line whose slowest half periods have this power, m/s²."""
    # Of a line's sum of squares, N walk²/12, the first half period holds 96/π⁴, the second none.
    samples = float(np.median([decay.samples for decay in decays]))
    return float(np.sqrt(_SLOWEST * power * 12 / samples * np.pi**4 / 96))
