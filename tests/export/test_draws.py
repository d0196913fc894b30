"""Draws: their moments are those of the result, and each is a vehicle."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sprung
from sprung import export
from sprung.errors import InputError
from sprung.results import Result
from sprung.uncertainty import Estimate
from sprung.vehicle import PARAMETERS

SAVED = Path(__file__).resolve().parents[1] / "report"
MANY = 40_000


@pytest.fixture(scope="module")
def result() -> Result:
    return sprung.load(SAVED / "accept.json", series=False)


@pytest.fixture(scope="module")
def many(result: Result) -> export.Draws:
    return export.draws(result, MANY, seed=3)


def test_the_correlation_is_that_of_the_result(result: Result, many: export.Draws) -> None:
    columns = [many.names.index(name) for name in result.correlation.names]
    found = np.corrcoef(many.values[:, columns].T)
    assert np.abs(found - np.array(result.correlation.matrix)).max() < 5 / MANY**0.5  # five standard errors


def test_the_standard_deviations_are_the_uncertainties(result: Result, many: export.Draws) -> None:
    for name, column in zip(many.names, many.values.T, strict=True):
        estimate = result.parameters[name]
        assert estimate.value is not None
        assert estimate.std is not None
        # Five standard errors, and the skewness of the logarithm to the second order.
        tolerance = 5 / (2 * MANY) ** 0.5 + 2 * (estimate.std / estimate.value) ** 2
        assert np.std(column) == pytest.approx(estimate.std, rel=tolerance)
        assert np.median(column) == pytest.approx(estimate.value, abs=7 * estimate.std / MANY**0.5)


def test_95_percent_are_in_the_interval(result: Result, many: export.Draws) -> None:
    for name, column in zip(many.names, many.values.T, strict=True):
        low, high = result.parameters[name].interval95 or (None, None)
        assert low is not None
        assert high is not None
        inside = np.mean((column >= low) & (column <= high))
        assert abs(inside - 0.95) < 5 * (0.95 * 0.05 / MANY) ** 0.5


def test_what_is_known_together_stays_together(result: Result, many: export.Draws) -> None:
    # The wheelbase is known exactly: a and b move against each other, to the second order of their uncertainties.
    a, b = (many.values[:, many.names.index(name)] for name in "ab")
    std = result.parameters["a"].std
    assert std is not None
    assert result.setup.known["wheelbase"].std == 0
    assert np.std(a + b) < 3 * std**2


def test_a_seed_repeats_them(result: Result) -> None:
    first, again, other = (export.draws(result, 5, seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(first.values, again.values)
    assert not np.array_equal(first.values, other.values)
    assert not np.array_equal(export.draws(result, 5).values, export.draws(result, 5).values)


def test_each_is_a_vehicle(result: Result) -> None:
    drawn = export.draws(result, 4, seed=1)
    for row, vehicle in zip(drawn.values, drawn.vehicles(), strict=True):
        assert np.array_equal(list(vehicle.parameters.values()), row)
        assert tuple(vehicle.parameters) == drawn.names
        assert vehicle.name == result.name


def test_tables_hold_all_digits(result: Result) -> None:
    pandas = pytest.importorskip("pandas")
    parquet = pytest.importorskip("pyarrow.parquet")
    drawn = export.draws(result, 7, seed=1)
    assert np.array_equal(pandas.read_csv(io.BytesIO(drawn.csv().content)).to_numpy(), drawn.values)
    table = parquet.read_table(io.BytesIO(drawn.parquet().content))
    assert np.array_equal(table.to_pandas().to_numpy(), drawn.values)
    assert table.schema.field("k_sf").metadata == {b"unit": b"N/m"}
    assert np.array_equal(drawn.to_dataframe().to_numpy(), drawn.values)
    assert drawn.units == tuple(PARAMETERS[name].unit for name in drawn.names)


def with_parameter(result: Result, name: str, estimate: Estimate) -> Result:
    """Return a result with one more estimate, correlated with nothing."""
    names = (*result.correlation.names, name)
    matrix = np.eye(len(names))
    matrix[:-1, :-1] = result.correlation.matrix
    correlation = replace(result.correlation, names=names, matrix=tuple(map(tuple, matrix.tolist())))
    return replace(result, parameters={**result.parameters, name: estimate}, correlation=correlation)


def test_what_may_be_zero_is_never_negative(result: Result) -> None:
    rubbing = with_parameter(result, "c_tf", Estimate(10.0, 10.0, (-9.6, 29.6), "N s/m", "estimated", "curvature"))
    rubbing = with_parameter(rubbing, "c_tr", Estimate(50.0, 0.0, (50.0, 50.0), "N s/m", "known"))
    rubbing = replace(rubbing, correlation=with_parameter(result, "c_tf", rubbing.parameters["c_tf"]).correlation)
    drawn = export.draws(rubbing, 1000, seed=1)
    damping = drawn.values[:, drawn.names.index("c_tf")]
    assert damping.min() == 0
    assert 120 < np.sum(damping == 0) < 200  # 16 %
    assert drawn.notes == (f"{np.sum(damping == 0)} of 1000 draws of c_tf are 0: it cannot be negative.",)
    assert np.all(drawn.values[:, drawn.names.index("c_tr")] == 50.0)
    assert len(list(drawn.vehicles())) == 1000


def test_what_is_not_determined_has_no_distribution() -> None:
    undetermined = sprung.load(SAVED / "unidentifiable.json", series=False)
    with pytest.raises(InputError) as caught:
        export.draws(undetermined, 0, seed=-1)
    assert len(caught.value.problems) == 3
    assert "m_s, I_yy" in str(caught.value)
    with pytest.raises(InputError, match="reject"):
        export.draws(sprung.load(SAVED / "reject.json", series=False))
