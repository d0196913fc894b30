"""A completed campaign as a test that further steps may extend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sprung.estimation import FitStatistics
from sprung.planning.setup import MeasurementSetup, PlannedDrop, PlannedTest
from sprung.uncertainty import KnownValue
from sprung.vehicle import LEVEL, Heights, Sensor, Tracks, Vehicle


def setup_from_fit(
    fit: FitStatistics,
    tracks: Tracks,
    extras: tuple[str, ...],
    known: Mapping[str, KnownValue],
    sensors: Sequence[Sensor],
    *,
    rate: float,
    duration: float,
    heights: Heights = LEVEL,
    name: str = "vehicle",
) -> MeasurementSetup:
    """Return the setup of further tests: the fitted vehicle, with the noise of the fit.

    Parameters
    ----------
    fit
        The fit.
    tracks, extras, known, sensors
        Of the campaign that was fitted.
    rate, duration
        Samples per second, and seconds after the release, of further recordings.
    heights
        Heights of centre of gravity and wheels, as far as they are known.
    name
        Of the vehicle.

    Returns
    -------
    Subject
    """
    parameters = dict(zip(fit.names, fit.values.tolist(), strict=True))
    vehicle = Vehicle.nearest(parameters, name=name, **heights.by_key)
    return MeasurementSetup(vehicle, tracks, extras, known, tuple(sensors), fit.noise, rate, duration, fit.inflation)


def completed_test(setup: MeasurementSetup, fit: FitStatistics, drops: Sequence[PlannedDrop]) -> PlannedTest:
    """Return the drops of a fit as a completed test, with the information in their recordings.

    Parameters
    ----------
    setup
        From `setup_from_fit`.
    fit
        The fit.
    drops
        The drops.

    Returns
    -------
    PlannedTest
    """
    # The fit's covariance includes what was known beforehand, which is subtracted: no repeat improves that.
    covariance = setup.free.T @ fit.relative_covariance @ setup.free
    variances, vectors = np.linalg.eigh(covariance)
    least = np.finfo(float).eps * variances.max(initial=0.0)
    total = (vectors / np.maximum(variances, least)) @ vectors.T
    return PlannedTest(setup, tuple(drops), total - setup.prior_information(setup.statements))
