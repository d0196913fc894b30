"""Standard uncertainties of what follows from the parameters: against draws from their joint distribution."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sprung.estimation import FitStatistics, characteristics_of, rates_at_motion_ratios
from sprung.estimation.estimates import estimate_of
from sprung.uncertainty import KnownValue
from sprung.vehicle import CHARACTERISTICS, PARAMETERS, TABLE_1_CAR, Vehicle, evaluate_quantity, wheel_loads
from sprung.vehicle.nuisances import sensor_unknown

UNEVEN = TABLE_1_CAR.with_values(y_s=0.02, d_ksf=600.0, name="uneven")

DRAWS = 600
"""The standard deviation of so many is known to 1 / sqrt(2 DRAWS), 2.9 %."""


def fit_of(vehicle: Vehicle, relative_covariance: np.ndarray) -> FitStatistics:
    """Make a fit that found a vehicle, with a covariance of its coordinates."""
    names, values = tuple(vehicle.parameters), np.array(list(vehicle.parameters.values()))
    sizes = {"y_s": 0.1}
    slopes = np.array(
        [
            value if PARAMETERS[name].positive else sizes.get(name, 1000.0)
            for name, value in zip(names, values, strict=True)
        ]
    )
    return FitStatistics(
        names=names, values=values, slopes=slopes, relative_covariance=relative_covariance,
        covariance=relative_covariance * np.outer(slopes, slopes), undetermined=np.zeros((len(names), 0)),
        noise=np.ones(8), residual=np.ones((1, 8)), inflation=1.0, residuals=(), contradictions={},
        loglikelihood=0.0, iterations=1, converged=True, starts_agreeing=1, starts=1,
    )  # fmt: skip


def correlated(size: int, std: float) -> np.ndarray:
    """Make a covariance with standard deviations of about `std` and strong correlations."""
    random = np.random.default_rng(5)
    factor = random.normal(size=(size, size)) / np.sqrt(size)
    covariance: np.ndarray = std**2 * (factor @ factor.T + 0.1)
    return covariance


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, UNEVEN], ids=lambda one: one.name)
@pytest.mark.slow
def test_uncertainties_are_those_of_draws(vehicle: Vehicle) -> None:
    fit = fit_of(vehicle, correlated(len(vehicle.parameters), 0.003))
    found = characteristics_of(fit, {}, vehicle.linear_model())
    random = np.random.default_rng(1)
    # Coordinates are logarithms of what must be positive and multiples of the others: `moved` follows them.
    drawn = [
        fit.moved(step) for step in random.multivariate_normal(np.zeros(len(fit.names)), fit.relative_covariance, DRAWS)
    ]
    for name, estimate in found.items():
        if name in CHARACTERISTICS:
            values = np.array([evaluate_quantity(name, fit.names, one)[0] for one in drawn])
            assert estimate.std == pytest.approx(values.std(), rel=4 * 0.029), name
    loads = np.array([wheel_loads(vehicle.linear_model(), one)[0] for one in drawn])
    names = [name for name in found if name.endswith("wheel_load")]
    columns = [0, 2] if len(names) == 2 else [0, 1, 2, 3]
    stds = np.array([found[name].std for name in names], dtype=float)
    assert stds == pytest.approx(loads[:, columns].std(axis=0), rel=4 * 0.029)
    assert len(names) == (2 if vehicle is TABLE_1_CAR else 4)
    assert ("cg_left" in found) == (vehicle is UNEVEN)


def test_without_absolute_scale_what_does_not_depend_on_it_keeps_its_number() -> None:
    names = list(TABLE_1_CAR.parameters)
    tight = correlated(len(names), 0.003)
    scaling = np.array([float(PARAMETERS[name].scales) for name in names])
    known = characteristics_of(fit_of(TABLE_1_CAR, tight), {}, TABLE_1_CAR.linear_model())
    free = characteristics_of(
        fit_of(TABLE_1_CAR, tight + 100 * np.outer(scaling, scaling)), {}, TABLE_1_CAR.linear_model()
    )
    lost = {name for name, one in free.items() if one.value is None}
    assert lost == {"total_mass", "front_axle_mass", "rear_axle_mass", "front_wheel_load", "rear_wheel_load"}
    # The scale has 1e5 times the variance of the rest: 1e-11 of rounding is left of it.
    assert {name: one.std for name, one in free.items() if name not in lost} == pytest.approx(
        {name: one.std for name, one in known.items() if name not in lost}, rel=1e-6
    )


def test_what_was_known_exactly_is_known() -> None:
    names = list(TABLE_1_CAR.parameters)
    total = TABLE_1_CAR.total_mass
    found = characteristics_of(
        fit_of(TABLE_1_CAR, correlated(len(names), 0.003)),
        {"total_mass": KnownValue(total)},
        TABLE_1_CAR.linear_model(),
    )
    assert (found["total_mass"].status, found["total_mass"].value, found["total_mass"].std) == ("known", total, 0.0)


def test_a_lateral_centre_of_gravity_near_the_middle_has_a_number() -> None:
    """Zero is a value as any other: 2 ± 3 mm is not undetermined."""
    vehicle = UNEVEN.with_values(y_s=0.002)
    fit = fit_of(vehicle, np.diag(np.full(len(vehicle.parameters), 0.03**2)))
    found = characteristics_of(fit, {}, vehicle.linear_model())["cg_left"]
    share = vehicle.m_s / vehicle.total_mass
    assert found.value == pytest.approx(0.002 * share)
    assert found.std == pytest.approx(0.003 * share, rel=0.01)
    assert found.interval95 is not None
    assert found.interval95[0] is not None
    assert found.interval95[0] < 0


def test_rates_at_the_spring_and_at_the_damper_have_the_uncertainty_of_rate_and_ratio() -> None:
    fit = fit_of(TABLE_1_CAR, np.diag(np.full(len(TABLE_1_CAR.parameters), 0.02**2)))
    ratios = {"spring_front": KnownValue(0.7), "spring_rear": KnownValue(0.7, 0.014), "damper_front": KnownValue(0.5)}
    found = rates_at_motion_ratios(fit, ratios)
    assert list(found) == ["k_sf_at_spring", "k_sr_at_spring", "c_sf_at_damper"]
    front, rear, damper = found.values()
    # k / i²: 2 % of the rate alone; with twice the 2 % of the ratio, 4.47 %.
    assert (front.value, front.std) == pytest.approx((17000 / 0.49, 0.02 * 17000 / 0.49))
    assert (rear.value, rear.std) == pytest.approx((22000 / 0.49, 0.02 * 5**0.5 * 22000 / 0.49))
    assert (damper.value, damper.std) == pytest.approx((6000.0, 120.0))
    assert (front.unit, damper.unit) == ("N/m", "N s/m")


def test_the_size_of_a_difference_between_the_sides_is_the_mean_of_both() -> None:
    fit = fit_of(UNEVEN, np.eye(len(UNEVEN.parameters)))
    assert fit.size("d_ksf") == UNEVEN.k_sf
    assert fit.size("d_ktr") == UNEVEN.k_tr
    assert fit.size("y_s") == max(abs(UNEVEN.y_s), 0.1)
    assert fit.size("m_s") == UNEVEN.m_s


def test_the_interval_of_what_is_unknown_of_a_sensor_is_even_around_its_value() -> None:
    """Of a gain near zero a logarithmic interval had overflown."""
    plain = fit_of(TABLE_1_CAR, 1e-6 * np.eye(len(TABLE_1_CAR.parameters)))
    gain = sensor_unknown("gain", "body_fl")
    fit = replace(
        plain, names=(*plain.names, gain), values=np.append(plain.values, 1e-6), slopes=np.append(plain.slopes, 1.0),
        relative_covariance=1e-4 * np.eye(len(plain.names) + 1), covariance=1e-4 * np.eye(len(plain.names) + 1),
        undetermined=np.zeros((len(plain.names) + 1, 0)),
    )  # fmt: skip
    found = estimate_of(fit, {}, gain)
    assert found.interval95 == pytest.approx((1e-6 - 1.96e-2, 1e-6 + 1.96e-2), rel=1e-3)
