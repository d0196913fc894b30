"""The decays of one load, as a result holds them: what spectra and stabilisation diagrams are made of."""

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
    """Decays of one load that go together: of one rate, with the channels that all of them have.

    Attributes
    ----------
    load
        Its name.
    rate
        Samples per second.
    measured, fitted
        m/s², shape (channel, time) each.
    on_body
        Which channels are of sensors on the body, shape (channel,).
    """

    load: str
    rate: float
    measured: tuple[Real, ...]
    fitted: tuple[Real, ...]
    on_body: NDArray[np.bool_]


def decays_by_load(result: Result) -> Iterator[LoadDecays]:
    """Give the decays of every load of a result.

    Parameters
    ----------
    result
        With its series.

    Returns
    -------
    iterator of LoadDecays
        In the order of the result's modes; not for a load of which no decay is held.
    """
    for load in result.modes:
        drops = [drop for drop in result.drops if drop.load == load and _name(drop.name, drop.file) in result.series]
        found = [(drop, result.series[_name(drop.name, drop.file)]) for drop in drops]
        if not found:
            continue
        rates = [round(rate_of(series), 6) for _, series in found]
        rate = Counter(rates).most_common(1)[0][0]
        same = [pair for pair, own in zip(found, rates, strict=True) if own == rate]
        usable = np.logical_and.reduce([~np.isnan(series.measured).any(axis=1) for _, series in same])
        if not usable.any():
            continue
        places = {channel.name: channel.on for channel in same[0][0].channels}
        names = [name for name, use in zip(same[0][1].channels, usable, strict=True) if use]
        yield LoadDecays(
            load,
            rate,
            tuple(series.measured[usable] for _, series in same),
            tuple(series.fitted[usable] for _, series in same),
            np.array([places.get(name) == "body" for name in names]),
        )


def rate_of(series: Series) -> float:
    """Give the samples per second of a drop."""
    return (len(series.time) - 1) / float(series.time[-1] - series.time[0])


def _name(name: str, file: str) -> str:
    return name or file.rpartition(".")[0]
