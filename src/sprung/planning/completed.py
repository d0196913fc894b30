"""A campaign that is done, as a test to which others may be added."""

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
    """Take the vehicle that a fit has found, and its noise, for further tests.

    Parameters
    ----------
    fit
        The fit.
    tracks, extras, known, sensors
        Of the campaign that was fitted.
    rate, duration
        Samples per second, and seconds after the release, of further recordings.
    heights
        How high things are, as far as it is known.
    name
        The vehicle's.

    Returns
    -------
    Subject
    """
    found = dict(zip(fit.names, fit.values.tolist(), strict=True))
    vehicle = Vehicle.nearest(found, name=name, **heights.by_key)
    return MeasurementSetup(vehicle, tracks, extras, known, tuple(sensors), fit.noise, rate, duration, fit.inflation)


def completed_test(subject: MeasurementSetup, fit: FitStatistics, drops: Sequence[PlannedDrop]) -> PlannedTest:
    """Take the drops that a fit has used, with what they have told.

    Parameters
    ----------
    subject
        From `setup_from_fit`.
    fit
        The fit.
    drops
        What was dropped.

    Returns
    -------
    PlannedTest
    """
    # The fit's covariance holds what was known beforehand, which is taken out again: no repeat makes that any better.
    covariance = subject.free.T @ fit.relative_covariance @ subject.free
    variances, vectors = np.linalg.eigh(covariance)
    least = np.finfo(float).eps * variances.max(initial=0.0)
    total = (vectors / np.maximum(variances, least)) @ vectors.T
    return PlannedTest(subject, tuple(drops), total - subject.of_statements(subject.known))
