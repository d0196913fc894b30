"""The clocks of several loggers: set as far as the release and the decays tell, before the fit finds the rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.identification import Fit, Summit, clear_of_splines, timed_by_decay, timed_by_release, told_alone
from sprung.prepare import Decay, Prepared
from sprung.recording import Campaign, LoggerClock, Recording
from sprung.vehicle import Vehicle

Real = NDArray[np.float64]

_DRIFT = 3e-5
"""s: by so much a crystal that is fast or slow by some ten parts in a million drifts while a vehicle vibrates."""

_SET = 1e-3
"""s to which a clock is set, at the worst, before the fit finds the rest."""

_PASSES = 2
"""The better the vehicle, the better it tells the clocks, and they it."""


@dataclass(frozen=True)
class ClockReport:
    """How a logger's clock stood in a drop.

    Attributes
    ----------
    logger
        The logger's file.
    ahead, std
        What it showed when the first logger's clock showed zero, s, and the standard uncertainty of that.
    """

    logger: str
    ahead: float
    std: float


def clock_reports(summit: Summit, fit: Fit, decays: Sequence[Decay]) -> dict[str, tuple[ClockReport, ...]]:
    """Say how the clocks of several loggers stood, by the drop's file.

    Parameters
    ----------
    summit, fit
        The fit.
    decays
        What was fitted.
    """
    found = summit.point.place.delays(summit.point.weights, fit.covariance)
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
    fit: Callable[[Sequence[Decay]], Summit],
) -> tuple[Prepared, Summit | None]:
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
    summit = fit([replace(decay, clocks=()) for decay in prepared.decays])
    for _ in range(_PASSES):
        vehicle = Vehicle.nearest(summit.parameters, name=campaign.name, **campaign.heights.by_key)
        by_name = {
            seen.recording.name: (seen, drop.model_copy(update={"wheels": seen.wheels}))
            for drop, seen in zip(campaign.drops, prepared.seen, strict=True)
        }
        timed = [
            timed_by_release(decay, *by_name[decay.file], vehicle, campaign.load(decay.load), campaign.sensors)
            for decay in prepared.decays
        ]
        summit = fit([told_alone(decay) for decay in timed])
        timed = list(timed_by_decay(timed, summit))
        told = {decay.file: _moments(decay.clocks, summit.parameters) for decay in timed if decay.clocks}
        recordings = [_with_clocks(one, told.get(one.name, {})) for one in campaign.recordings]
        prepared = prepare_again(replace(campaign, recordings=tuple(recordings)))
        by_file = {decay.file: decay.clocks for decay in timed}
        decays = [_told_before(one, by_file.get(one.file, ()), told.get(one.file, {})) for one in prepared.decays]
        prepared = prepared._replace(decays=tuple(decays))
    return prepared._replace(decays=tuple(clear_of_splines(decay) for decay in prepared.decays)), summit


def _moments(clocks: Sequence[LoggerClock], parameters: Mapping[str, float]) -> dict[str, float]:
    """Give what each logger's clock showed at one moment, s, by its name."""
    return {clock.name: clock.ahead - clock.expected(parameters) for clock in clocks}


def _with_clocks(recording: Recording, moments: Mapping[str, float]) -> Recording:
    """Give a recording with clocks of which one moment is known; without any as it is."""
    told = [replace(one, ahead=moments[one.name], std=_SET) for one in recording.clocks if one.name in moments]
    return replace(recording, clocks=tuple(told) or recording.clocks)


def _told_before(decay: Decay, before: Sequence[LoggerClock], moments: Mapping[str, float]) -> Decay:
    """Give a decay with what is known of its clocks, which were set by it as far as whole samples go.

    No sample was taken before the decay's clock says: what it must not hold, such as a tyre in the air, none of its channels
    does.
    """
    known = {clock.name: clock for clock in before}
    if not all(clock.name in known for clock in decay.clocks):
        return decay
    earliest = min((clock.ahead - moments[clock.name] for clock in decay.clocks), default=0.0)
    clocks = [
        replace(clock, late=old.late + clock.ahead - old.ahead - earliest, std=old.std, follows=old.follows)
        for clock, old in ((clock, known[clock.name]) for clock in decay.clocks)
    ]
    return replace(decay, clocks=tuple(clocks))
