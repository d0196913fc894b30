"""Fitted records of one load, from which spectra and stabilisation diagrams are computed."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.checking import DropReport
from sprung.results import Result, Series
from sprung.vehicle import PADS, SensorPlace

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LoadDecays:
    """Free decays, or forced responses, of one load with a common rate and common channels.

    Attributes
    ----------
    load
        Its name.
    rate
        Samples per second.
    measured, fitted
        SI, shape (channel, time) each.
    places
        What each channel's sensor sits on: ``body``, ``wheel`` or ``pad``.
    units
        Of each channel's readings.
    is_driven
        Whether pads drove the vehicle all along, so that the records are no free decays.
    """

    load: str
    rate: float
    measured: tuple[Real, ...]
    fitted: tuple[Real, ...]
    places: tuple[str, ...]
    units: tuple[str, ...]
    is_driven: bool = False

    @property
    def title(self) -> str:
        """The load, and that it stood on pads where it did."""
        return f"{self.load}, on pads" if self.is_driven else self.load


def decays_by_load(result: Result) -> Iterator[LoadDecays]:
    """Yield the decays of every load of a result.

    Parameters
    ----------
    result
        With its series.

    Returns
    -------
    iterator of LoadDecays
        In the order of the result's modes, free decays before forced responses; loads without records are left out.
    """
    for load, is_driven in itertools.product(result.modes, (False, True)):
        fitted = [
            drop
            for drop in result.drops
            if (drop.load, drop.is_driven) == (load, is_driven) and drop.name in result.series
        ]
        if fitted and (records := _records(result, load, fitted)) is not None:
            yield records


def _records(result: Result, load: str, fitted: Sequence[DropReport]) -> LoadDecays | None:
    """Return the records of drops of one load; None where they have no channel in common."""
    rates = [round(rate_of(result.series[drop.name]), 6) for drop in fitted]
    rate = Counter(rates).most_common(1)[0][0]
    series = [result.series[drop.name] for drop, own_rate in zip(fitted, rates, strict=True) if own_rate == rate]
    usable = np.logical_and.reduce([~np.isnan(decay.measured).any(axis=1) for decay in series])
    if not usable.any():
        return None
    units = {channel.name: channel.unit for channel in fitted[0].channels}
    places = {channel.name: _place(channel.on) for channel in fitted[0].channels}
    names = [name for name, use in zip(series[0].channels, usable, strict=True) if use]
    return LoadDecays(
        load,
        rate,
        tuple(decay.measured[usable] for decay in series),
        tuple(decay.fitted[usable] for decay in series),
        tuple(places[name] for name in names),
        tuple(units[name] for name in names),
        fitted[0].is_driven,
    )


def _place(on: SensorPlace | None) -> str:
    return "body" if on == "body" else "pad" if on in PADS else "wheel"


def rate_of(series: Series) -> float:
    """Return the samples per second of a drop."""
    return (len(series.time) - 1) / float(series.time[-1] - series.time[0])
