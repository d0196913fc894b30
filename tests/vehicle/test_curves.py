"""Force curves are the sums of what acts on one row, whatever it is; their gradients are those of the sums."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.vehicle import (
    EXTRAS,
    FORCE_CURVES,
    CurveElements,
    Tracks,
    linear_elements,
    nonlinear_elements,
    parameter_names,
)

VALUES = (
    {"c_sf": 1500.0, "c_sr": 1300.0, "k_sf": 17000.0, "k_sr": 22000.0, "k_tf": 192000.0, "k_tr": 190000.0}
    | {"r_f": 2.4, "r_r": 1.8, "F_f": 41.0, "F_r": 38.0, "s_f": 3e5, "s_r": 4e5, "p_f": 3.0, "p_r": 2.0}
    | {"k_bf": 5e4, "k_br": 6e4, "x_bf": 0.02, "x_br": 0.025, "d_ksf": 800.0, "d_csf": 90.0, "d_ktr": 5000.0}
)
"""SI; all others are one, which changes no curve."""

X = np.array([-0.04, -0.01, 0.0, 0.01, 0.03])
"""m/s or m."""


def elements(name: str, *extras: str, tracks: Tracks = "shared") -> tuple[CurveElements, tuple[str, ...], np.ndarray]:
    names = parameter_names(tracks, extras)
    found = CurveElements.of(name, linear_elements(tracks, extras), nonlinear_elements(tracks, extras))
    return found, names, np.array([VALUES.get(one, 1.0) for one in names])


def written_out(name: str) -> np.ndarray:
    """The laws of `docs/theory.md`, N."""
    axle = "f" if name.endswith("front") else "r"
    if name.startswith("damper"):
        return VALUES[f"c_s{axle}"] * X * np.where(X > 0, VALUES[f"r_{axle}"], 1.0)
    if name.startswith("tyre"):
        return VALUES[f"k_t{axle}"] * X
    spring = VALUES[f"k_s{axle}"] * (X - 0.5 * VALUES[f"p_{axle}"] * X**2)
    return spring - VALUES[f"k_b{axle}"] * np.maximum(-X - VALUES[f"x_b{axle}"], 0.0)


@pytest.mark.parametrize("tracks", ["shared", "separate"])
@pytest.mark.parametrize("name", [name for name in FORCE_CURVES if "_" in name])
def test_a_curve_is_the_sum_of_its_laws_and_the_mean_of_both_sides(name: str, tracks: Tracks) -> None:
    extras = ("rebound", "progressive", "bump-stop", "friction", "asymmetry", "anti-roll", "tyre-damping")
    found, names, values = elements(name, *extras, tracks=tracks)
    np.testing.assert_allclose(found.force(names, values, X)[0], written_out(name), rtol=1e-14)
    assert found.is_nonlinear(names, values, X) is not name.startswith("tyre")


@pytest.mark.parametrize("name", [name for name in FORCE_CURVES if "_" in name])
@pytest.mark.slow
def test_gradients_are_those_of_differences(name: str) -> None:
    found, names, values = elements(name, *(extra for extra in EXTRAS if extra != "engine"))
    steps = 1e-6 * values
    differences = [
        (found.force(names, values + step, X)[0] - found.force(names, values - step, X)[0]) / (2 * step.max())
        for step in np.diag(steps)
    ]
    # Central differences of forces of 1000 N over a step of 1e-6 of each value, a law of at most second order.
    np.testing.assert_allclose(
        found.force(names, values, X)[1], np.transpose(differences), atol=1e-12 * 1000 / steps.min(), rtol=1e-8
    )


def test_friction_is_no_part_of_a_curve_but_stated_with_the_damper() -> None:
    for tracks in ("shared", "separate"):
        damper, names, values = elements("damper_front", "friction", tracks=tracks)
        assert not damper.nonlinear
        force, gradient = damper.hysteresis(names, values)
        assert force == pytest.approx(VALUES["F_f"])
        assert dict(zip(names, gradient, strict=True))["F_f"] == pytest.approx(1.0)
        assert np.count_nonzero(gradient) == 1
        assert not elements("spring_front", "friction", tracks=tracks)[0].hysteretic


def test_a_law_of_the_travel_makes_no_curve_of_the_damper_on_the_same_row() -> None:
    damper, names, values = elements("damper_front", "progressive")
    assert not damper.is_nonlinear(names, values, X)
    spring, names, values = elements("spring_front", "rebound")
    assert not spring.is_nonlinear(names, values, X)


def test_behind_a_mount_the_curve_is_that_of_the_damper_alone() -> None:
    found, names, values = elements("damper_front", "rebound", "damper-mount", "zener")
    np.testing.assert_allclose(found.force(names, values, X)[0], written_out("damper_front"), rtol=1e-14)
    assert found.is_nonlinear(names, values, X)
    # The Zener branch relaxes: the spring's curve is that of slow motion.
    spring, names, values = elements("spring_front", "progressive", "zener")
    force = VALUES["k_sf"] * (X - 0.5 * VALUES["p_f"] * X**2)
    np.testing.assert_allclose(spring.force(names, values, X)[0], force, rtol=1e-14)
