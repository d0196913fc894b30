"""The clocks of several loggers: set as far as the release and the decays tell, before the fit finds the rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.identification import Fit, Summit, timed_by_decay, timed_by_release, told_alone
from sprung.prepare import Decay, Prepared
from sprung.recording import Campaign, LoggerClock, Recording
from sprung.vehicle import Vehicle

Real = NDArray[np.float64]

_DRIFT = 3e-5
"""s: by so much a crystal that is fast or slow by some ten parts in a million drifts while a vehicle vibrates."""

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
    campaign: Campaign, prepared: Prepared, fit: Callable[[Sequence[Decay]], Summit]
) -> tuple[Prepared, Summit | None]:
    """Set the clocks of all loggers.

    Parameters
    ----------
    campaign
        The campaign.
    prepared
        Its decays.
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
    by_name = {
        seen.recording.name: (drop.model_copy(update={"wheels": seen.wheels}), seen)
        for drop, seen in zip(campaign.drops, prepared.seen, strict=True)
    }
    decays = prepared.decays
    for _ in range(_PASSES):
        vehicle = Vehicle.nearest(summit.parameters, name=campaign.name, **campaign.heights.by_key)
        timed = []
        for decay in prepared.decays:
            drop, seen = by_name[decay.file]
            told = timed_by_release(decay, seen, drop, vehicle, campaign.load(drop.load), campaign.sensors)
            timed.append(_put_together(told, seen.recording, summit.parameters))
        summit = fit([told_alone(decay) for decay in timed])
        decays = tuple(
            _put_together(decay, by_name[decay.file][1].recording, summit.parameters)
            for decay in timed_by_decay(timed, summit)
        )
    return prepared._replace(decays=decays), summit


def _put_together(decay: Decay, recording: Recording, parameters: Mapping[str, float]) -> Decay:
    """Shift every logger's samples to the nearest ones of the decay's clock, so that no clock is off by more than half a step.

    What the decay must not hold, such as a tyre in the air, is then held by none of its channels.
    """
    begin = round((decay.start - recording.start) * decay.rate) - decay.earlier.shape[1]
    length = decay.earlier.shape[1] + decay.samples
    most = recording.values.shape[1]
    begins = [
        min(max(begin - round((before.ahead - now.ahead + now.expected(parameters)) * decay.rate), 0), most)
        for before, now in zip(recording.clocks, decay.clocks, strict=True)
    ]
    length = min([length, *(most - first for first in begins)])
    whole = np.concatenate([decay.earlier, decay.values], axis=1)[:, :length]
    for clock, first in zip(decay.clocks, begins, strict=True):
        own = [channel for channel in clock.channels if decay.usable[channel]]
        whole[own] = recording.values[own, first : first + length]
    ahead = [
        before.ahead - (begin - first) / decay.rate for before, first in zip(recording.clocks, begins, strict=True)
    ]
    clocks = tuple(
        replace(clock, ahead=there, late=clock.late + there - clock.ahead)
        for clock, there in zip(decay.clocks, ahead, strict=True)
    )
    earlier = decay.earlier.shape[1]
    return replace(decay, earlier=whole[:, :earlier], values=whole[:, earlier:], clocks=clocks)
