"""Inverses of many small matrices against those of NumPy."""

import numpy as np
import pytest

from sprung.vehicle.many_inverses import invert_many


@pytest.mark.parametrize(("shape", "size"), [((3, 400), 12), ((7,), 1), ((1, 2, 3), 5), ((0,), 4)])
def test_inverses_are_those_of_numpy(shape: tuple[int, ...], size: int) -> None:
    near = np.eye(size) + 0.1 * np.random.default_rng(1).standard_normal((*shape, size, size))
    given = near.copy()
    np.testing.assert_allclose(invert_many(near), np.linalg.inv(given), rtol=1e-10, atol=1e-12)
    np.testing.assert_array_equal(near, given)


def test_rows_are_exchanged_where_a_pivot_is_small() -> None:
    turned = np.tile(np.eye(3)[[1, 2, 0]], (600, 1, 1)).astype(np.float32)
    found = invert_many(turned)
    assert found.dtype == np.float32
    np.testing.assert_array_equal(found, np.swapaxes(turned, 1, 2))
