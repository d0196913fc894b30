"""Kinks of force laws within a time step, and the ground, whose damper acts only while a tyre touches it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sprung.vehicle.compiled_slopes import differentiate_excess
from sprung.vehicle.force_laws import GROUND, ElementInput
from sprung.vehicle.kinks import KinkForces, differentiate_fields
from sprung.vehicle.law_table import FieldSlopes, LawTable, TableSlopes

K, C = 2e5, 80.0
"""Of a tyre, N/m and N s/m."""

ENDS = st.tuples(*(st.floats(-1.0, 1.0, width=16) for _ in range(4)))


def ground(stiffness: float = K, damping: float = C) -> KinkForces:
    """Return the ground under one tyre, whose two parameters are the two dependences."""
    assert GROUND.kinks is not None
    return KinkForces.of([(GROUND.kinks, np.array([0]), np.array([[stiffness], [damping]]))], 1)


def forces_of_ground(inputs: np.ndarray) -> np.ndarray:
    """Return what the ground cancels at heights and rates, N, shape (time,)."""
    height, rate = inputs.T[:, :, None]
    given = ElementInput(height, rate, 0 * height, 0 * height)
    return GROUND.evaluate(np.array([[K], [C]]), given).force[:, 0]


def force_of_tyre(height: float, rate: float) -> float:
    """Return the whole force of a tyre at a height of the wheel above first touch, m, and its rate, m/s."""
    cancelled = forces_of_ground(np.array([[height, rate]]))[0]
    return float(-K * height - C * rate - cancelled)


@given(st.floats(-1e-3, 1e-3), st.floats(-2.0, 2.0))
def test_a_tyre_pushes_only_while_it_touches_the_ground_and_never_pulls(height: float, rate: float) -> None:
    """A spring and a damper side by side, whose tread is relaxed at once in the air."""
    pushes = max(-K * height - C * rate, 0.0) if height <= 0 else 0.0
    assert force_of_tyre(height, rate) == pytest.approx(pushes, abs=1e-9)


def test_a_wheel_that_lands_meets_the_damper_at_once() -> None:
    assert force_of_tyre(1e-9, -1.0) == 0.0
    assert force_of_tyre(-1e-9, -1.0) == pytest.approx(C, rel=1e-4)


@given(ENDS)
def test_the_mean_of_the_ground_over_a_step_is_that_of_many_short_ones(ends: tuple[float, ...]) -> None:
    """Height and rate run straight; a thousandth of the largest force is what the sum of 20000 pieces errs by."""
    (x, y), (v, w) = 1e-3 * np.array(ends[:2]), 2.0 * np.array(ends[2:])
    at, part = ground(), (np.arange(20000) + 0.5) / 20000
    way = np.stack([x + (y - x) * part, v + (w - v) * part], axis=1)
    found = at.surplus(np.array([[x, v]]), np.array([[y, w]]))[0, 0]
    mean, first, last = (forces_of_ground(inputs) for inputs in (way, np.array([[x, v]]), np.array([[y, w]])))
    assert found == pytest.approx(2 * mean.mean() - first[0] - last[0], abs=0.5)


@given(ENDS)
def test_the_mean_of_the_ground_tells_its_own_derivatives(ends: tuple[float, ...]) -> None:
    at, step = ground(), 1e-7
    start, end = np.array([1e-3 * ends[0], 2.0 * ends[2]]), np.array([1e-3 * ends[1], 2.0 * ends[3]])
    arguments = np.abs([K * start[0] + C * start[1], K * end[0] + C * end[1]])
    if arguments.min() < 1e-2 or np.abs([*start, *end]).min() < 1e-5:
        return  # at a kink there is no slope

    def surplus(start: np.ndarray, end: np.ndarray, at: KinkForces = at) -> float:
        return float(at.surplus(start[None], end[None])[0, 0])

    by_start, by_end, by_parameter = (np.zeros((1, 2), dtype=np.float32) for _ in range(3))
    laws = LawTable(np.stack([at.row_of, *at.kinks]), np.zeros((5, 0)), np.zeros((3, 0)))
    none = [FieldSlopes.none(fields) for fields in (3, 1, 1)]
    assert GROUND.kinks is not None
    slopes = differentiate_fields(GROUND.kinks, np.array([[K], [C]]))[:5]
    table = TableSlopes(FieldSlopes.of_law(slopes, 0, np.arange(2)[:, None, None]), *none)
    differentiate_excess(laws, table, start, end, by_start[0], by_end[0], by_parameter[0])
    for which, scale in enumerate((1e-3, 1.0)):
        change = step * scale * np.eye(2)[which]
        width = 2 * step * scale
        size = K if which == 0 else C
        expected = (surplus(start + change, end) - surplus(start - change, end)) / width
        assert by_start[0, which] == pytest.approx(expected, rel=1e-4, abs=1e-4 * size)
        expected = (surplus(start, end + change) - surplus(start, end - change)) / width
        assert by_end[0, which] == pytest.approx(expected, rel=1e-4, abs=1e-4 * size)
    stiffer, softer = ground(K + 1.0), ground(K - 1.0)
    expected = (surplus(start, end, stiffer) - surplus(start, end, softer)) / 2
    assert by_parameter[0, 0] == pytest.approx(expected, rel=1e-3, abs=1e-8)
    more, less = ground(damping=C + 1e-3), ground(damping=C - 1e-3)
    expected = (surplus(start, end, more) - surplus(start, end, less)) / 2e-3
    assert by_parameter[0, 1] == pytest.approx(expected, rel=1e-3, abs=1e-5)
