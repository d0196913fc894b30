"""Estimates beside true values: differences in percent and in standard errors, of what was estimated."""

from __future__ import annotations

from pathlib import Path

import pytest

import sprung
from layouts import check_view_is_whole, piped
from sprung.report import truth_view
from sprung.study import true_values
from sprung.vehicle import TABLE_1_CAR, Vehicle

RESULT = Path(__file__).resolve().parents[1] / "report" / "accept.json"


def test_every_estimate_stands_beside_its_true_value() -> None:
    result = sprung.load(RESULT, series=False)
    values = true_values(result, TABLE_1_CAR)
    assert list(values) == [name for name, one in result.parameters.items() if one.status == "estimated"]
    m_s = values["m_s"]
    assert m_s.estimate.value is not None
    assert m_s.estimate.std is not None
    assert m_s.percent == pytest.approx(100 * (m_s.estimate.value / 1380 - 1))
    assert m_s.standard_errors == pytest.approx((m_s.estimate.value - 1380) / m_s.estimate.std)
    view = truth_view(values)
    check_view_is_whole(view, tables=1)
    near = sum(abs(one.standard_errors) <= 2 for one in values.values())
    assert f"{near} of {len(values)} estimates are within 2 standard errors" in " ".join(piped(view).split())


def test_what_the_vehicle_has_not_is_not_compared() -> None:
    result = sprung.load(RESULT, series=False)
    others = {name: value for name, value in TABLE_1_CAR.parameters.items() if name not in ("t_f", "t_r")}
    bus = Vehicle.from_parameters(others | {"t_f1": 0.6, "t_f2": 0.7, "t_r1": 0.6, "t_r2": 0.7}, name="other")
    assert not {"t_f", "t_r"} & set(true_values(result, bus))
