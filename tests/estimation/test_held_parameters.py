"""Parameters that are held in a fit though they are uncertain: what they may be widens the errors of all others."""

from __future__ import annotations

import numpy as np
import pytest

import sprung
from selection.test_refined_terms import BALLAST
from sprung.estimation import FitStatistics, consider_held, fit_linear, uncertainty_of
from sprung.preprocess import prepare
from sprung.selection.structure import choose_structure
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle

HELD, WEIGHED = ("c_tf", "c_tr"), {"total_mass": KnownValue(TABLE_1_CAR.total_mass, 3.0)}


@pytest.fixture(scope="module")
def both() -> tuple[FitStatistics, FitStatistics]:
    """Statistics of a car without tyre damping, and of one with it where that fit has ended."""
    campaign = sprung.simulate(TABLE_1_CAR, loads=[BALLAST], rate=200, noise=0.02, seed=3, known=WEIGHED)
    decays, plain = prepare(campaign).decays, choose_structure(campaign, "shared", ())
    fit = fit_linear(decays, plain.linear_models, plain.sensors, plain.known)
    larger = plain.with_terms(("tyre-damping",))
    start = fit.parameters | dict.fromkeys(HELD, 0.0)
    there = fit_linear(decays, larger.linear_models, larger.sensors, larger.known, start=start, most=0)
    return uncertainty_of(fit), uncertainty_of(there)


def test_what_is_known_exactly_widens_nothing(both: tuple[FitStatistics, FitStatistics]) -> None:
    own, larger = both
    found = consider_held(own, larger, dict.fromkeys(HELD, 1e-9))
    scale = np.sqrt(np.diag(own.covariance))
    # The information was computed at two noise levels, which differ by what the held parameters would gain.
    np.testing.assert_allclose(
        found.covariance / np.outer(scale, scale), own.covariance / np.outer(scale, scale), atol=2e-3
    )


def test_what_is_not_known_at_all_leaves_what_the_records_tell(both: tuple[FitStatistics, FitStatistics]) -> None:
    own, larger = both
    found = consider_held(own, larger, dict.fromkeys(HELD, 1e9))
    scale = np.sqrt(np.diag(found.covariance))
    np.testing.assert_allclose(
        found.covariance / np.outer(scale, scale), larger.only(own.names).covariance / np.outer(scale, scale), atol=1e-6
    )


def test_between_both_a_prior_adds_its_information(both: tuple[FitStatistics, FitStatistics]) -> None:
    """The inverse of the information of records and prior together: another way to the same covariance."""
    own, larger = both
    held = [larger.names.index(name) for name in HELD]
    spreads = np.sqrt(np.diag(larger.covariance))[held]
    found = consider_held(own, larger, dict(zip(HELD, spreads.tolist(), strict=True)))
    slopes = larger.slopes
    # What is known exactly, the wheelbase, is no direction of the fit.
    variances, directions = np.linalg.eigh(larger.relative_covariance)
    variances, directions = variances[1:], directions[:, 1:]
    prior = directions[held].T * (slopes[held] / spreads) ** 2 @ directions[held]
    posterior = directions @ np.linalg.inv(np.diag(1 / variances) + prior) @ directions.T
    expected = (posterior * np.outer(slopes, slopes))[: len(own.names), : len(own.names)]
    assert larger.names[: len(own.names)] == own.names
    scale = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(found.covariance / np.outer(scale, scale), expected / np.outer(scale, scale), atol=1e-6)


@pytest.mark.slow
def test_a_mount_whose_damping_does_not_show_is_known_less_well() -> None:
    """No mount is without damping: 1.3 times the error of the rate, by the information on both, where none is stated."""
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"k_df": 4e5, "k_dr": 4e5})
    campaign = sprung.simulate(
        car, loads=[BALLAST], rate=500.0, noise=0.02, seed=2, known={"total_mass": car.total_mass}
    )
    found, stated = sprung.identify(campaign), sprung.identify(campaign, extras=["damper-mount"])
    assert found.fit.model == stated.fit.model == ("damper-mount",)
    for name in ("k_df", "k_dr"):
        own, exact = found.parameters[name], stated.parameters[name]
        assert own.std is not None
        assert exact.std is not None
        assert own.value == pytest.approx(exact.value, abs=0.1 * exact.std)
        assert own.std > 1.15 * exact.std
