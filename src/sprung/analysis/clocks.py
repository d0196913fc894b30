"""The clocks of several loggers: set as far as the release and the decays tell, before the fit finds the rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign, LoggerClock
from sprung.checking import ClockReport
from sprung.estimation import (
    FitResult,
    FitStatistics,
    clear_of_splines,
    mask_unsynchronised,
    synchronise_at_release,
    synchronise_by_decay,
)
from sprung.preprocess import FreeDecay, Prepared
from sprung.vehicle import Vehicle, with_separate_tracks

Real = NDArray[np.float64]

_DRIFT = 3e-5
"""s: by so much a crystal that is fast or slow by some ten parts in a million drifts while a vehicle vibrates."""

_NO_WORSE = 1.1
"""Noise with the flight over noise without above which the vehicle did something there that no model has."""

_PASSES = 2
"""The better the vehicle, the better it tells the clocks, and they it."""


def clock_reports(
    optimum: FitResult, fit: FitStatistics, decays: Sequence[FreeDecay]
) -> dict[str, tuple[ClockReport, ...]]:
    """Say how the clocks of several loggers stood, by the drop's file.

    Parameters
    ----------
    summit, fit
        The fit.
    decays
        What was fitted.
    """
    found = optimum.clock_delays(fit.covariance)
    return {decays[i].file: tuple(_reported(decays[i].clocks, *delays)) for i, delays in found.items()}


def _reported(clocks: Sequence[LoggerClock], late: Real, covariance: Real) -> Iterator[ClockReport]:
    """Refer every clock to the first one: whose sample was taken later shows less than it would."""
    variance = np.diag(covariance) + covariance[0, 0] - 2 * covariance[0]
    own = np.array([clock.ahead for clock in clocks]) - late
    for clock, ahead, squared in zip(clocks, (own - own[0]).tolist(), variance.tolist(), strict=True):
        std = float(np.hypot(max(squared, 0.0) ** 0.5, _DRIFT if ahead else 0.0))
        yield ClockReport(clock.name, ahead, std)


def set_clocks(
    campaign: Campaign,
    prepared: Prepared,
    prepare_again: Callable[[Campaign], Prepared],
    fit: Callable[[Sequence[FreeDecay]], FitResult],
) -> tuple[Prepared, FitResult | None]:
    """Set the clocks of all loggers.

    Parameters
    ----------
    campaign
        The campaign.
    prepared
        Its decays.
    prepare_again
        Finds the decays of the same campaign whose clocks are known.
    fit
        Fits decays from scratch.

    Returns
    -------
    prepared
        With what is known of each logger's clock.
    summit
        A first fit; None where every drop has one logger, and nothing is to be set.
    """
    if not any(decay.clocks for decay in prepared.decays):
        return prepared, None
    # As far as the first motion that each logger shows has told, all clocks are one: near enough for a first vehicle.
    optimum = fit([replace(decay, clocks=()) for decay in prepared.decays])
    for _ in range(_PASSES):
        released = _released(campaign, prepared, prepared.decays, optimum)
        optimum = fit([mask_unsynchronised(decay) for decay in released])
        timed = synchronise_by_decay(released, optimum)
        known = {
            decay.file: [
                replace(clock, ahead=_moment(late, optimum.parameters))
                for clock, late in zip(decay.clocks, other.clocks, strict=True)
            ]
            for decay, other in zip(released, timed, strict=True)
        }
        recordings = [replace(one, clocks=tuple(known.get(one.name, one.clocks))) for one in campaign.recordings]
        prepared = prepare_again(campaign.with_recordings(recordings))
    by_file = {decay.file: decay.clocks for decay in timed}
    decays = [_told_before(one, by_file.get(one.file, ()), optimum.parameters) for one in prepared.decays]
    return prepared._replace(decays=tuple(clear_of_splines(decay) for decay in decays)), optimum


def told_by_flights(
    campaign: Campaign, prepared: Prepared, optimum: FitResult, fit: Callable[[Sequence[FreeDecay]], FitResult]
) -> tuple[tuple[FreeDecay, ...], FitResult] | None:
    """Use what the samples between release and landing, which have told the clocks, tell of the vehicle too.

    Parameters
    ----------
    campaign
        The campaign.
    prepared
        The decays that were fitted, their clocks set.
    summit
        Where that ended.
    fit
        Fits decays from there.

    Returns
    -------
    decays, summit
        With what their flights tell; None where there are no several loggers, or where during the flight the vehicle did
        something that the model does not have.
    """
    if not any(decay.clocks for decay in prepared.decays):
        return None
    clocks = {seen.recording.name: seen.recording.clocks for seen in prepared.seen}
    flown = _released(
        campaign, prepared, [replace(decay, clocks=clocks[decay.file]) for decay in prepared.decays], optimum
    )
    told = [one.flight for one in flown if one.flight is not None]
    if not told:
        return None
    decays = tuple(replace(decay, flight=one.flight) for decay, one in zip(prepared.decays, flown, strict=True))
    found = fit(decays)
    values = with_separate_tracks(found.parameters)
    missed = sum(
        one.missed(np.array([values.get(name, at) for name, at in zip(one.names, one.at, strict=True)])) for one in told
    )
    worse = max(float(np.max(found.noise / optimum.noise)), (missed / sum(one.samples for one in told)) ** 0.5)
    return (decays, found) if found.converged and worse < _NO_WORSE else None


def _released(
    campaign: Campaign, prepared: Prepared, decays: Sequence[FreeDecay], optimum: FitResult
) -> list[FreeDecay]:
    """Time the clocks of decays by their releases, for the vehicle of a fit."""
    vehicle = Vehicle.nearest(optimum.parameters, name=campaign.name, **campaign.heights.by_key)
    by_name = {seen.recording.name: (seen, replace(seen.drop, wheels=seen.wheels)) for seen in prepared.seen}
    return [
        synchronise_at_release(decay, *by_name[decay.file], vehicle, campaign.load(decay.load), campaign.sensors)
        for decay in decays
    ]


def _moment(clock: LoggerClock, parameters: Mapping[str, float]) -> float:
    """Give what a logger's clock showed at a moment that is the same for all, s."""
    return clock.ahead - clock.expected(parameters)


def _told_before(decay: FreeDecay, before: Sequence[LoggerClock], parameters: Mapping[str, float]) -> FreeDecay:
    """Give a decay with what is known of its clocks, which were set by it as far as whole samples go.

    No sample was taken before the decay's clock says: what it must not hold, such as a tyre in the air, none of its channels
    does.
    """
    known = {clock.name: clock for clock in before}
    if not all(clock.name in known for clock in decay.clocks):
        return decay
    earliest = min((clock.ahead - _moment(known[clock.name], parameters) for clock in decay.clocks), default=0.0)
    clocks = [
        replace(clock, late=old.late + clock.ahead - old.ahead - earliest, std=old.std, follows=old.follows)
        for clock, old in ((clock, known[clock.name]) for clock in decay.clocks)
    ]
    return replace(decay, clocks=tuple(clocks))
