"""Rounding by uncertainty."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sprung.uncertainty import Estimate, round_by_uncertainty, without_rounding_errors


@pytest.mark.parametrize(
    ("value", "std", "shown"),
    [
        (17007.34, 43.9, ("17007", "44")),
        (1.25049, 0.00161, ("1.2505", "0.0016")),
        (192053.0, 1234.0, ("192100", "1200")),
        (0.5, 0.0996, ("0.50", "0.10")),
        (-3.14159, 0.31, ("-3.14", "0.31")),
        (2.76, 0.0, ("2.76", "")),
        (380.0, 9.96, ("380", "10")),
    ],
)
def test_two_figures_of_the_uncertainty(value: float, std: float, shown: tuple[str, str]) -> None:
    assert round_by_uncertainty(value, std) == shown


@given(value=st.floats(-1e7, 1e7), std=st.floats(1e-6, 1e5))
def test_what_is_shown_is_near_what_is_meant(value: float, std: float) -> None:
    shown, uncertainty = (float(text) for text in round_by_uncertainty(value, std))
    assert abs(shown - value) <= 0.051 * std + 1e-9 * abs(value)
    assert abs(uncertainty / std - 1) <= 0.051


def test_what_follows_from_exact_quantities_is_known() -> None:
    """Axle masses without uncertainty: their share had one of 1.3e-11 (a rounding error), printed with twelve digits."""
    share = Estimate(0.578726968174, 1.3e-11, (0.5787269681, 0.5787269682), "1", "estimated", "curvature")
    rate = Estimate(22000.0, 130.0, (21745.0, 22255.0), "N/m", "estimated", "curvature")
    found = without_rounding_errors({"share": share}, among={"rate": rate})["share"]
    assert (found.status, found.std, found.value) == ("known", 0.0, share.value)
    noise_free = {name: replace(one, std=1e-13 * (one.std or 0)) for name, one in {"rate": rate, "other": rate}.items()}
    assert without_rounding_errors(noise_free) == noise_free
