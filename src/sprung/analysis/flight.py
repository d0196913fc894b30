"""The fall: a drop is a known experiment from its release on, and what happens before the last tyre is down tells too.

While a wheel is in the air its tyre does nothing, and when it lands everything moves at once: masses and tyres show there as
nowhere else. The ground, which pushes and never pulls, is then one more force, and the motion is followed step by step, which
takes a few times longer than the decays alone. So it is done where it is asked for, and where it is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.analysis.all_samples import with_all_samples
from sprung.analysis.analysis import Analysis
from sprung.analysis.clocks import use_clock_flights
from sprung.analysis.on_pads import NOT_STEPPED, has_pads
from sprung.campaign import Campaign
from sprung.estimation import FitStatistics, uncertainty_of, weigh_statements
from sprung.preprocess import DropObservation, FreeDecay, find_flights
from sprung.progress import Progress, Step
from sprung.selection import ModelSearch, final_tolerance, fit_structure, select_gravity_leakage, with_short_steps
from sprung.vehicle import (
    Motion,
    Readout,
    Vehicle,
    evaluate_quantity,
    layout_of,
    parameter_names,
    state_variables,
    wheelbase_of,
)

Real = NDArray[np.float64]

_UNDETERMINED = 0.3
"""Size of a direction that nothing determines, beside that of the scale: further samples of the same drops hardly would."""

NEEDED = 0.02
"""Relative standard uncertainty of a parameter from which the fall is needed."""

_SOUND = 10.0
"""Overdispersion from which the model errs by so much that more samples do not help."""

_NO_WORSE = 1.1
"""Noise with the fall over noise without, in any channel, above which the vehicle did something there that no model has."""

_MOST = 12
"""Iterations of the fit with the fall, at the most: others follow wheels that land as the model does not, without an end."""

_HEIGHTS = (0.02, 0.03, 0.045, 0.065, 0.09, 0.13)
"""m of blocks that nobody measured."""

_LONG_ENOUGH = 0.25
"""s after the release that tell how high the blocks were."""


def use_flight(run: Analysis, progress: Progress) -> Analysis:
    """Use the drops from their releases on, where that is asked for or needed and determines the parameters better."""
    asked = run.campaign.model.fall if run.options.fall is None else run.options.fall
    if has_pads(run):
        return run.noted("use_flight", "the fall is not used", NOT_STEPPED) if asked else run
    is_sound = run.fit.converged and not run.suspected and run.uncertainty.inflation < _SOUND
    if is_sound and not run.model.structure.is_time_stepped:
        run = use_clock_flights(run, progress)
    if asked is False or (asked is None and not (is_sound and is_needed(run.uncertainty))):
        return run
    full = with_all_samples(run, progress)
    found = find_flights(full.decays, full.prepared.observations)
    run = replace(run, fits=full.fits, preparations=full.preparations)
    if any(found):
        progress(Step("using the fall"))
        fallen = _with_fall(full, found, progress)
        if fallen is not None:
            return fallen
        run = replace(run, fits=run.fits + 1)
    remark = "the fall before the landing was tried and does not determine the parameters better"
    return replace(run, remarks=(*run.remarks, remark)).noted("use_flight", remark)


def _with_fall(run: Analysis, found: Sequence[FreeDecay | None], progress: Progress) -> Analysis | None:
    """Fit the drops from their releases on; None where the model does not describe that, or where it tells nothing more."""
    statistics, fit = run.uncertainty, run.fit
    states = _initial_states(run, found)
    decays = tuple(decay if flight is None else flight for flight, decay in zip(found, run.decays, strict=True))
    structure = replace(run.model.structure, unilateral_tyres=True)
    enough = final_tolerance(ModelSearch(structure, fit, run.decays))
    other = fit_structure(structure, decays, fit, enough, progress, states, most=_MOST)
    if not other.converged:
        return None
    search = select_gravity_leakage(ModelSearch(structure, other, decays, run.model.steps, progress))
    if not search.fit.converged or np.any(search.fit.noise > _NO_WORSE * fit.noise):
        return None
    search = with_short_steps(search)  # wheels that land are more sudden than anything after
    search = replace(search, fit=weigh_statements(search.fit))
    now = uncertainty_of(search.fit)
    estimated = np.sqrt(np.diag(statistics.covariance)) > 0
    ratios = np.sqrt(np.diag(now.covariance)[estimated] / np.diag(statistics.covariance)[estimated])
    ratio = float(np.median(ratios))
    if ratio >= 1:
        return None
    remark = f"the fall is used too, which makes uncertainties {ratio:.2f} times what they were"
    fallen = replace(run, search=search, statistics=now, fits=run.fits + 1, remarks=(*run.remarks, remark))
    return fallen.noted("use_flight", "the fall is used", f"standard uncertainties times {ratio:.2f}")


def is_needed(fit: FitStatistics) -> bool:
    """Whether the free decays leave a parameter of the paper's vehicle so uncertain that the flight phase is needed.

    Parameters
    ----------
    fit
        Of the decays.
    """
    scaling = fit.scaling
    total, gradient = evaluate_quantity("total_mass", fit.names, fit.values)
    # Falling tells nothing of the absolute scale: what is left of the uncertainties when the total mass is given.
    within = np.eye(len(fit.names)) - np.outer(scaling, gradient * fit.slopes / total)
    variances = np.maximum(np.diag(within @ fit.relative_covariance @ within.T), 0.0)  # below 0 by rounding alone
    errors = np.sqrt(variances) * np.abs(fit.slopes)
    sizes = np.array([fit.size(name) for name in fit.names])
    hopeless = np.abs(fit.undetermined - np.outer(scaling, scaling @ fit.undetermined) / (scaling @ scaling)).max(
        initial=0
    )
    layout = layout_of(fit.names)
    plain = np.isin(fit.names, [*parameter_names("shared", (), layout), *parameter_names("separate", (), layout)])
    return bool(np.any((errors > NEEDED * sizes)[plain])) and hopeless < _UNDETERMINED


def _initial_states(run: Analysis, found: Sequence[FreeDecay | None]) -> Real:
    """Return {X, Ẋ} and memories with which the fits begin: of the fitted vehicle on its blocks; shape (drop, state)."""
    campaign, optimum = run.campaign, run.fit
    states = optimum.states[:, : len(state_variables(optimum.names))].copy()
    vehicle = Vehicle.nearest(optimum.parameters, name="fitted", **run.model.structure.heights.by_key)
    readout = Readout.of(campaign.sensors, optimum.names, wheelbase_of(optimum.names, optimum.values))
    observations = {observation.recording.name: observation for observation in run.prepared.observations}
    for state, flight in zip(states, found, strict=True):
        if flight is not None:
            # Coordinates without mass, whose velocities are no part of the state, come last.
            motions, before = _falls(flight, observations[flight.file], vehicle, campaign)
            fallen = [readout.read(optimum.values, motion)[:, before:] for motion in motions]
            motion = motions[_nearest(flight, fallen)]
            state[:] = np.concatenate([motion.displacement[:, before], motion.velocity[:, before]])[: len(state)]
    return states


def _falls(
    flight: FreeDecay, observation: DropObservation, vehicle: Vehicle, campaign: Campaign
) -> tuple[list[Motion], int]:
    """Return how the vehicle falls from blocks of the stated height, or of several, and which sample is the flight's."""
    load, rate, height = campaign.load(flight.load), flight.rate, observation.drop.height
    from sprung.simulation import BlockSupport, simulate_nonlinear_drops  # noqa: PLC0415 (only the fall needs it)

    wheels = observation.wheels or campaign.layout.wheels
    blocks = [BlockSupport(load, wheels, one) for one in (_HEIGHTS if height is None else (height,))]
    first = round((flight.start - observation.recording.start) * rate)
    since = (first - observation.rest.sample) / rate
    offset = since % (1 / rate)
    before, samples = round((since - offset) * rate), int(_LONG_ENOUGH * rate)
    return simulate_nonlinear_drops(vehicle, blocks, 1 / rate, before + samples, offset), before


def _nearest(flight: FreeDecay, fallen: Sequence[Real]) -> int:
    """Return the position of the readings, each of shape (channel, time), that are nearest to those of a flight."""
    samples = min(flight.values.shape[1], fallen[0].shape[1])
    readings = (flight.values - flight.rest.level[:, None])[:, :samples]
    missed = [np.nansum((readings - one[:, :samples]) ** 2) for one in fallen]
    return int(np.argmin(missed))
