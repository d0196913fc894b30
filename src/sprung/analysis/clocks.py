"""The clocks of several loggers: set as far as the release and the decays tell, before the fit finds the rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.analysis.analysis import Analysis
from sprung.analysis.baseline import fit_baseline_model, structures
from sprung.analysis.synchronisation import mask_unsynchronised, synchronise_at_release, synchronise_by_decay
from sprung.campaign import Campaign, LoggerClock
from sprung.checking import ClockReport
from sprung.estimation import CONVERGED, FitResult, FitStatistics, clear_of_splines, uncertainty_of
from sprung.preprocess import FreeDecay, Prepared, exclude_drops, prepare
from sprung.progress import Progress
from sprung.selection import fit_structure
from sprung.vehicle import Vehicle, with_separate_tracks

Real = NDArray[np.float64]

_DRIFT = 3e-5
"""s: by so much a crystal that is fast or slow by some ten parts in a million drifts while a vehicle vibrates."""

_NO_WORSE = 1.1
"""Noise with the flight over noise without above which the vehicle did something there that no model has."""

_PASSES = 2
"""Fits between which the clocks are set again: vehicle and clocks determine each other."""

FLIGHTS_FITTED = "the flights that determined the clock offsets are fitted too"


def clock_reports(
    optimum: FitResult, fit: FitStatistics, decays: Sequence[FreeDecay]
) -> dict[str, tuple[ClockReport, ...]]:
    """Return the clock offsets of several loggers, by the drop's file.

    Parameters
    ----------
    optimum, fit
        The fit.
    decays
        What was fitted.
    """
    found = optimum.clock_delays(fit.covariance)
    return {decays[i].file: tuple(_reported(decays[i].clocks, *delays)) for i, delays in found.items()}


def _reported(clocks: Sequence[LoggerClock], late: Real, covariance: Real) -> Iterator[ClockReport]:
    """Refer every clock to the first one: whose sample was taken later shows less than it would."""
    variance = np.diag(covariance) + covariance[0, 0] - 2 * covariance[0]
    own = np.array([clock.offset for clock in clocks]) - late
    for clock, ahead, squared in zip(clocks, (own - own[0]).tolist(), variance.tolist(), strict=True):
        std = float(np.hypot(max(squared, 0.0) ** 0.5, _DRIFT if ahead else 0.0))
        yield ClockReport(clock.name, ahead, std)


def synchronise(run: Analysis, progress: Progress) -> Analysis:
    """Set the clocks of several loggers, by the releases and then by the decays."""
    prepared = run.prepared
    if not any(decay.clocks for decay in prepared.decays):
        return run
    campaign, (_, structure) = run.campaign, structures(run)
    # As far as the first motion that each logger shows determines it, all clocks are one: near enough for a first vehicle.
    fit = fit_baseline_model(run, structure, [replace(decay, clocks=()) for decay in prepared.decays], progress)
    for _ in range(_PASSES):
        released = _synchronised_at_release(campaign, prepared, prepared.decays, fit)
        fit = fit_baseline_model(run, structure, [mask_unsynchronised(decay) for decay in released], progress)
        timed = synchronise_by_decay(released, fit)
        known = {
            decay.file: [
                replace(clock, offset=_moment(other, fit.parameters))
                for clock, other in zip(decay.clocks, synchronised.clocks, strict=True)
            ]
            for decay, synchronised in zip(released, timed, strict=True)
        }
        recordings = [
            replace(recording, clocks=tuple(known.get(recording.name, recording.clocks)))
            for recording in campaign.recordings
        ]
        prepared = exclude_drops(campaign, prepare(campaign.with_recordings(recordings), progress), run.excluded)
    by_file = {decay.file: decay.clocks for decay in timed}
    decays = [_with_known_clocks(decay, by_file.get(decay.file, ()), fit.parameters) for decay in prepared.decays]
    prepared = prepared._replace(decays=tuple(clear_of_splines(decay) for decay in decays))
    what = f"the clocks of the loggers of {len(by_file)} drops are set by their releases and decays"
    counted = replace(run, preparation=prepared, fits=run.fits + 1 + _PASSES, preparations=run.preparations + _PASSES)
    return replace(counted, clock_fit=fit).noted("synchronise", what, "several loggers")


def use_clock_flights(run: Analysis, progress: Progress) -> Analysis:
    """Use the samples between release and landing, which determined the clocks, for the vehicle too.

    Not where the vehicle did something during the flight that the model does not have.
    """
    prepared, fit = run.prepared, run.fit
    if not any(decay.clocks for decay in prepared.decays):
        return run
    clocks = {observation.recording.name: observation.recording.clocks for observation in prepared.observations}
    flown = _synchronised_at_release(
        run.campaign, prepared, [replace(decay, clocks=clocks[decay.file]) for decay in run.decays], fit
    )
    flights = [decay.flight for decay in flown if decay.flight is not None]
    if not flights:
        return run
    decays = tuple(replace(decay, flight=other.flight) for decay, other in zip(run.decays, flown, strict=True))
    other = fit_structure(run.model.structure, decays, fit, CONVERGED, progress)
    values = with_separate_tracks(other.parameters)
    squares = sum(
        flight.chi_square_at(np.array([values.get(name, at) for name, at in zip(flight.names, flight.at, strict=True)]))
        for flight in flights
    )
    ratio = max(float(np.max(other.noise / fit.noise)), (squares / sum(flight.samples for flight in flights)) ** 0.5)
    run = replace(run, fits=run.fits + 1)
    if not other.converged or ratio >= _NO_WORSE:
        why = f"noise {ratio:.2f} times that of the decays, at most {_NO_WORSE}"
        return run.noted("use_flight", "the flights that determined the clock offsets are not fitted", why)
    search = replace(run.model, fit=other, decays=decays)
    run = replace(run, search=search, statistics=uncertainty_of(other), remarks=(*run.remarks, FLIGHTS_FITTED))
    return run.noted("use_flight", FLIGHTS_FITTED, f"noise {ratio:.2f} times that of the decays")


def _synchronised_at_release(
    campaign: Campaign, prepared: Prepared, decays: Sequence[FreeDecay], optimum: FitResult
) -> list[FreeDecay]:
    """Time the clocks of decays by their releases, for the vehicle of a fit."""
    vehicle = Vehicle.nearest(optimum.parameters, name=campaign.name, **campaign.heights.by_key)
    by_name = {seen.recording.name: (seen, replace(seen.drop, wheels=seen.wheels)) for seen in prepared.observations}
    return [
        synchronise_at_release(decay, *by_name[decay.file], vehicle, campaign.load(decay.load), campaign.sensors)
        for decay in decays
    ]


def _moment(clock: LoggerClock, parameters: Mapping[str, float]) -> float:
    """Return the reading of a logger's clock at a common instant, s."""
    return clock.offset - clock.expected_delay(parameters)


def _with_known_clocks(decay: FreeDecay, before: Sequence[LoggerClock], parameters: Mapping[str, float]) -> FreeDecay:
    """Return a decay with the clock offsets of its loggers, beyond whole samples.

    No sample was taken before the decay's clock says: what it must not hold, such as a tyre in the air, none of its channels
    does.
    """
    known = {clock.name: clock for clock in before}
    if not all(clock.name in known for clock in decay.clocks):
        return decay
    earliest = min((clock.offset - _moment(known[clock.name], parameters) for clock in decay.clocks), default=0.0)
    clocks = [
        replace(
            clock,
            delay=old.delay + clock.offset - old.offset - earliest,
            delay_std=old.delay_std,
            d_delay_d_parameter=old.d_delay_d_parameter,
        )
        for clock, old in ((clock, known[clock.name]) for clock in decay.clocks)
    ]
    return replace(decay, clocks=tuple(clocks))
