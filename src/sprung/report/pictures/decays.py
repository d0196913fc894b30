"""Free decays of one load, from which spectra and stabilisation diagrams are computed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.results import Result, Series

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LoadDecays:
    """Decays of one load with a common rate and common channels.

    Attributes
    ----------
    load
        Its name.
    rate
        Samples per second.
    measured, fitted
        SI, shape (channel, time) each.
    on_body
        Whether each channel is of a sensor on the body, shape (channel,).
    units
        Of each channel's readings.
    """

    load: str
    rate: float
    measured: tuple[Real, ...]
    fitted: tuple[Real, ...]
    on_body: NDArray[np.bool_]
    units: tuple[str, ...]


def decays_by_load(result: Result) -> Iterator[LoadDecays]:
    """Yield the decays of every load of a result.

    Parameters
    ----------
    result
        With its series.

    Returns
    -------
    iterator of LoadDecays
        In the order of the result's modes; loads without decays are left out.
    """
    for load in result.modes:
        fitted = [drop for drop in result.drops if drop.load == load and drop.name in result.series]
        if not fitted:
            continue
        rates = [round(rate_of(result.series[drop.name]), 6) for drop in fitted]
        rate = Counter(rates).most_common(1)[0][0]
        series = [result.series[drop.name] for drop, own_rate in zip(fitted, rates, strict=True) if own_rate == rate]
        usable = np.logical_and.reduce([~np.isnan(decay.measured).any(axis=1) for decay in series])
        if not usable.any():
            continue
        units = {channel.name: channel.unit for channel in fitted[0].channels}
        locations = {channel.name: channel.on for channel in fitted[0].channels}
        names = [name for name, use in zip(series[0].channels, usable, strict=True) if use]
        yield LoadDecays(
            load,
            rate,
            tuple(decay.measured[usable] for decay in series),
            tuple(decay.fitted[usable] for decay in series),
            np.array([locations.get(name) == "body" for name in names]),
            tuple(units[name] for name in names),
        )


def rate_of(series: Series) -> float:
    """Return the samples per second of a drop."""
    return (len(series.time) - 1) / float(series.time[-1] - series.time[0])
