"""The equations of motion against eq. (2) of the paper, written out here with its misprints corrected."""

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from sprung.vehicle import (
    LINEAR_EXTRAS,
    PARAMETERS,
    LinearModel,
    coordinates,
    linear_elements,
    parameter_names,
)

Array = NDArray[np.float64]

TYPICAL = {
    "kg": (20.0, 5000.0),
    "kg m^2": (300.0, 10_000.0),
    "N/m": (1e4, 2e6),
    "N s/m": (500.0, 6000.0),
    "m": (0.3, 2.5),
    "N m": (10.0, 1000.0),
    "N m s": (10.0, 1000.0),
    "1": (-0.5, 0.5),
    "1/m": (-0.2, 0.2),
}

UNEVEN = {
    name: 0.5 * TYPICAL[PARAMETERS[name].unit][0]
    for name in PARAMETERS
    if name[:2] == "d_" and PARAMETERS[name].unit in TYPICAL
}
NARROW = {name: (-most, most) for name, most in UNEVEN.items()}
NARROW |= {"y_s": (-0.2, 0.2), "m_xf": (-10.0, 40.0), "m_xr": (-10.0, 40.0)}
NARROW |= {"m_e": (0.5, 5.0), "x_e": (-2.5, 0.5)}  # no more than the lightest of these bodies is left with
NARROW |= {"m_o": (0.5, 5.0), "x_o": (-2.5, 0.5), "y_o": (-0.5, 0.5), "a_w": (-0.5, 0.5)}  # likewise
NARROW |= {"t_o": (0.2, 0.6), "d_mo": (-0.2, 0.2)}
NARROW |= {name: (0.4, 1.1) for name in PARAMETERS if name[:2] == "n_"}


def values_of(names: tuple[str, ...]) -> st.SearchStrategy[dict[str, float]]:
    return st.fixed_dictionaries(
        {name: st.floats(*(NARROW.get(name) or TYPICAL[PARAMETERS[name].unit])) for name in names}
    )


NAMES = parameter_names("separate")
# Loads bring the elements of seats with them.
OWN_EXTRAS = tuple(extra for extra in LINEAR_EXTRAS if extra != "seat-load")
ALL_NAMES = parameter_names("separate", OWN_EXTRAS)


def equation_2(p: Mapping[str, float], f: float, r: float, t_f: float, t_r: float) -> Array:
    """K of eq. (2) without tyres, f and r the front and rear rates; C is the same with damper rates.

    Corrected: row 4 ends in a third zero, and row 5, printed with -k_sr and -b k_sr, is a front wheel's.
    """
    a, b = p["a"], p["b"]
    return np.array(
        [
            [2 * (f + r), 2 * (b * r - a * f), 0, -f, -f, -r, -r],
            [2 * (b * r - a * f), 2 * (a**2 * f + b**2 * r), 0, a * f, a * f, -b * r, -b * r],
            [0, 0, 2 * (t_f**2 * f + t_r**2 * r), -t_f * f, t_f * f, -t_r * r, t_r * r],
            [-f, a * f, -t_f * f, f, 0, 0, 0],
            [-f, a * f, t_f * f, 0, f, 0, 0],
            [-r, -b * r, -t_r * r, 0, 0, r, 0],
            [-r, -b * r, t_r * r, 0, 0, 0, r],
        ]
    )


def model_of(names: tuple[str, ...], extras: tuple[str, ...] = ()) -> LinearModel:
    return LinearModel.of(linear_elements("separate", extras, wheelbase=2.7), names)


@given(values_of(NAMES))
@settings(max_examples=25, deadline=None)
def test_matrices_are_equation_2(p: dict[str, float]) -> None:
    M, C, K = model_of(NAMES).matrices([p[name] for name in NAMES])
    tyres = np.diag([0.0, 0.0, 0.0, p["k_tf"], p["k_tf"], p["k_tr"], p["k_tr"]])
    assert_allclose(M, np.diag([p[n] for n in ("m_s", "I_yy", "I_xx", "m_uf", "m_uf", "m_ur", "m_ur")]), rtol=1e-14)
    assert_allclose(C, equation_2(p, p["c_sf"], p["c_sr"], p["t_f1"], p["t_r1"]), rtol=1e-12, atol=1e-10)
    assert_allclose(K, equation_2(p, p["k_sf"], p["k_sr"], p["t_f2"], p["t_r2"]) + tyres, rtol=1e-12, atol=1e-8)


@given(values_of(ALL_NAMES))
@settings(max_examples=25, deadline=None)
def test_matrices_are_symmetric_and_store_or_dissipate_energy(p: dict[str, float]) -> None:
    for matrix in model_of(ALL_NAMES, OWN_EXTRAS).matrices([p[name] for name in ALL_NAMES]):
        assert_allclose(matrix, matrix.T, atol=1e-14 * np.abs(matrix).max())
        eigenvalues = np.linalg.eigvalsh(matrix)
        assert eigenvalues.min() >= -1e-12 * eigenvalues.max()


@given(values_of(ALL_NAMES))
@settings(max_examples=10, deadline=None)
def test_derivatives_by_every_parameter(p: dict[str, float]) -> None:
    # Every entry is quadratic at most in any one parameter, so central differences are exact for any step.
    values = np.array([p[name] for name in ALL_NAMES])
    model = model_of(ALL_NAMES, OWN_EXTRAS)
    slopes = model.slopes(values)
    sizes = np.maximum(np.abs(values), 0.1)
    for i, step in enumerate(np.diag(0.25 * sizes)):
        above, below = model.matrices(values + step), model.matrices(values - step)
        for slope, high, low in zip(slopes, above, below, strict=True):
            assert_allclose(slope[i], (high - low) / (0.5 * sizes[i]), rtol=1e-9, atol=1e-10 * np.abs(high).max())


def test_anti_roll_bar_feels_roll_and_wheels_but_not_bounce_or_pitch() -> None:
    p = dict.fromkeys(ALL_NAMES, 1.0)
    with_bar = model_of(ALL_NAMES, OWN_EXTRAS).matrices(list(p.values())).K
    p["k_af"] = 0.0
    bar = with_bar - model_of(ALL_NAMES, OWN_EXTRAS).matrices(list(p.values())).K
    # Left minus right travel is 2 t_f2 (φ + L q_w/2) - (z_uA - z_uB), here with t_f2 = 1 and the wheelbase L = 2.7.
    g = np.zeros(len(bar))
    g[2:5] = 2.0, -1.0, 1.0
    g[coordinates(ALL_NAMES).index("q_w")] = 2.7
    assert_allclose(bar, np.outer(g, g), atol=1e-14)


def test_a_parameter_that_is_not_listed_is_an_error() -> None:
    with pytest.raises(KeyError, match="t_f1"):
        model_of(tuple(name for name in NAMES if name != "t_f1"))
