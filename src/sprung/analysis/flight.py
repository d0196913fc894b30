"""The fall: a drop is a known experiment from its release on, and what happens before the last tyre is down tells too.

While a wheel is in the air its tyre does nothing, and when it lands everything moves at once: masses and tyres show there as
nowhere else. The ground, which pushes and never pulls, is then one more force, and the motion is followed step by step, which
takes a few times longer than the decays alone. So it is done where it is asked for, and where it is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import Campaign
from sprung.estimation import CONVERGED, FitResult, FitStatistics, uncertainty_of
from sprung.preprocess import Flight, FreeDecay, Prepared, flights
from sprung.progress import Progress, Step, silent
from sprung.selection import ModelSearch, ModelStructure, fit_structure, select_gravity_leakage
from sprung.vehicle import WHEELS, BlockSupport, Rows, Vehicle, coordinates, evaluate_quantity, simulate_nonlinear_drops

Real = NDArray[np.float64]

_UNDETERMINED = 0.3
"""Size of a direction that nothing determines, beside that of the scale: further samples of the same drops hardly would."""

NEEDED = 0.02
"""Relative standard uncertainty of a parameter from which the fall is needed."""

_NO_WORSE = 1.1
"""Noise with the fall over noise without, in any channel, above which the vehicle did something there that no model has."""

_HEIGHTS = (0.02, 0.03, 0.045, 0.065, 0.09, 0.13)
"""m of blocks that nobody measured."""

_LONG_ENOUGH = 0.25
"""s after the release that tell how high the blocks were."""


@dataclass(frozen=True, eq=False)
class Flown:
    """A fit that uses drops from their releases on.

    Attributes
    ----------
    choice, summit, decays, fit
        As without.
    sharper
        Standard uncertainties over those without, in the middle of the parameters.
    """

    choice: ModelStructure
    optimum: FitResult
    decays: tuple[FreeDecay, ...]
    fit: FitStatistics
    sharper: float


def is_needed(fit: FitStatistics) -> bool:
    """Say whether the decays alone leave a parameter so uncertain that the fall is needed.

    Parameters
    ----------
    fit
        Of the decays.
    """
    scaling = fit.scaling
    total, gradient = evaluate_quantity("total_mass", fit.names, fit.values)
    # Falling tells nothing of the absolute scale: what is left of the uncertainties when the total mass is given.
    within = np.eye(len(fit.names)) - np.outer(scaling, gradient * fit.slopes / total)
    errors = np.sqrt(np.diag(within @ fit.relative_covariance @ within.T)) * np.abs(fit.slopes)
    sizes = np.array([fit.size(name) for name in fit.names])
    hopeless = np.abs(fit.undetermined - np.outer(scaling, scaling @ fit.undetermined) / (scaling @ scaling)).max(
        initial=0
    )
    return bool(np.any(errors > NEEDED * sizes)) and hopeless < _UNDETERMINED


def fly(
    campaign: Campaign,
    choice: ModelStructure,
    prepared: Prepared,
    optimum: FitResult,
    fit: FitStatistics,
    progress: Progress = silent,
) -> Flown | None:
    """Fit the drops from their releases on.

    Parameters
    ----------
    campaign
        Of which drops.
    choice, summit, fit
        The model, and where its fit of the decays ended.
    prepared
        The decays that were fitted, and what the recordings show.
    progress
        Called with each step that begins.

    Returns
    -------
    Flown or None
        None where no drop can be used so, or where the vehicle did something during the fall that the model does not have.
    """
    found = flights(prepared.decays, prepared.seen)
    if not any(found):
        return None
    progress(Step("using the fall"))
    begun = _begun(campaign, choice, optimum, found)
    decays = tuple(one.decay if one else decay for one, decay in zip(found, prepared.decays, strict=True))
    airborne = replace(choice, unilateral_tyres=True)
    higher = fit_structure(airborne, decays, optimum, CONVERGED, progress, begun)
    way = select_gravity_leakage(ModelSearch(airborne, higher, decays, (), progress))
    if not way.fit.converged or np.any(way.fit.noise > _NO_WORSE * optimum.noise):
        return None
    now = uncertainty_of(way.fit)
    known = np.sqrt(np.diag(fit.covariance)) > 0
    ratios = np.sqrt(np.diag(now.covariance)[known] / np.diag(fit.covariance)[known])
    sharper = float(np.median(ratios))
    return Flown(way.structure, way.fit, decays, now, sharper) if sharper < 1 else None


def _begun(campaign: Campaign, choice: ModelStructure, optimum: FitResult, found: Sequence[Flight | None]) -> Real:
    """Give {X, Ẋ} and memories with which the fits begin: of the fitted vehicle on its blocks; shape (drop, state)."""
    states = optimum.states[:, : 2 * len(coordinates(optimum.names))].copy()
    vehicle = Vehicle.nearest(optimum.parameters, name="fitted", **choice.heights.by_key)
    rows = Rows.of([sensor.row for sensor in campaign.sensors], optimum.names).at(optimum.values)
    for state, flight in zip(states, found, strict=True):
        if flight is not None:
            state[:] = _start(flight, vehicle, campaign, rows)
    return states


def _start(flight: Flight, vehicle: Vehicle, campaign: Campaign, rows: Real) -> Real:
    decay = flight.decay
    load, rate = campaign.load(decay.load), decay.rate
    heights = _HEIGHTS if flight.height is None else (flight.height,)
    blocks = [BlockSupport(load, flight.wheels or WHEELS, height) for height in heights]
    offset = flight.since % (1 / rate)
    before, samples = round((flight.since - offset) * rate), int(_LONG_ENOUGH * rate)
    motions = simulate_nonlinear_drops(vehicle, blocks, 1 / rate, before + samples, offset)
    told = (decay.values - decay.rest.level[:, None])[:, :samples]
    missed = [
        np.nansum((told - (rows @ motion.acceleration)[:, before : before + told.shape[1]]) ** 2) for motion in motions
    ]
    best = motions[int(np.argmin(missed))]
    return np.concatenate([best.displacement[:, before], best.velocity[:, before]])
