"""Every model term has ride numbers: finite, of the size of those without it, and the same from left and right."""

from __future__ import annotations

import numpy as np
import pytest

from sprung.ride import ride_numbers
from sprung.vehicle import EXTRAS, TABLE_1_CAR, Item, Load, Vehicle, parameters_of_term

TERMS = {
    "anti-roll": {"k_af": 9000.0, "k_ar": 3000.0},
    "tyre-damping": {"c_tf": 120.0, "c_tr": 90.0},
    "asymmetry": {"y_s": 0.03, "d_ksf": 300.0, "d_ktr": 4000.0, "d_csr": 60.0},
    "rigid-axle": {"n_r": 0.7, "m_xr": 12.0},
    "engine": {"m_e": 150.0, "k_e": 3e5, "c_e": 1500.0, "x_e": 0.1},
    "mount": {"k_df": 3e5, "k_dr": 3e5, "c_df": 80.0, "c_dr": 80.0},
    "zener": {"k_zf": 2500.0, "k_zr": 2500.0, "c_zf": 200.0, "c_zr": 200.0},
    "interconnection": {"k_xf": 6000.0, "k_xr": 6000.0, "c_xf": 300.0, "c_xr": 300.0},
    "twist": {"I_w": 90.0, "k_w": 4e5, "c_w": 500.0, "a_w": 0.1, "u_w": 0.05, "e_w": -0.02},
    "bending": {"m_v": 200.0, "k_v": 6e6, "c_v": 5e3, "b_v": 0.6, "p_v": 0.0},
    "occupants": {"m_o": 160.0, "k_o": 9e4, "c_o": 2500.0, "x_o": -1.5, "y_o": 0.0, "t_o": 0.35},
    "uneven occupants": {"m_o": 160.0, "k_o": 9e4, "c_o": 2500.0, "x_o": -1.5, "d_mo": 10.0, "d_ko": -6e3, "d_co": 200.0},
    "gravity": {"w_h": 4000.0},
    "friction": {"F_f": 60.0, "F_r": 60.0, "s_f": 1.5e5, "s_r": 1.5e5},
    "uneven friction": {"F_f": 60.0, "F_r": 60.0, "s_f": 1.5e5, "s_r": 1.5e5, "d_Ff": 15.0, "d_Fr": -10.0},
    "rebound": {"r_f": 2.0, "r_r": 2.0},
    "every knee": {
        "v_kf": 0.1, "v_kr": 0.1, "q_f": 0.5, "q_r": 0.5, "b_kf": 1.4, "b_kr": 1.4, "b_qf": 0.8, "b_qr": 0.8,
        "v_2f": 0.3, "v_2r": 0.3, "q_2f": 0.7, "q_2r": 0.7, "v_3f": 0.6, "v_3r": 0.6, "q_3f": 0.9, "q_3r": 0.9,
    },
    "damper curve": {"v_kf": 0.1, "v_kr": 0.1, "q_f": 0.5, "q_r": 0.5, "w_kf": 0.03, "w_kr": 0.03},
    "progressive": {"p_f": 3.0, "p_r": 3.0},
    "air": {"e_f": 4.0, "e_r": 4.0},
    "levelled air": {"e_lf": 4.0, "e_lr": 4.0, "g_f": 20.0, "g_r": 20.0},
    "bump stop": {"k_bf": 8e4, "k_br": 8e4, "x_bf": 0.04, "x_br": 0.04},
    "tyre curve": {"h_tf": 6.0, "h_tr": 6.0},
    "everything that rubs": {
        "F_f": 60.0, "F_r": 60.0, "s_f": 1.5e5, "s_r": 1.5e5, "r_f": 2.0, "r_r": 2.0, "k_df": 3e5, "k_dr": 3e5,
        "v_kf": 0.1, "v_kr": 0.1, "q_f": 0.5, "q_r": 0.5, "p_f": 2.0, "p_r": 2.0, "k_bf": 8e4, "k_br": 8e4,
        "x_bf": 0.05, "x_br": 0.05, "h_tf": 3.0, "h_tr": 3.0, "u_f": 0.02, "u_r": 0.02,
    },
}  # fmt: skip

LONG = "everything that rubs"
NAMES = [pytest.param(name, marks=pytest.mark.long) if name == LONG else name for name in TERMS]

BOOT = Load(name="boot", items=(Item(mass=120.0, position=(-2.4, 0.0, 0.6)),))


def test_every_term_is_among_them() -> None:
    stated = {name for values in TERMS.values() for name in values}
    assert [term for term in EXTRAS if not stated & {*parameters_of_term(term, "shared")}] == ["seat-load"]


@pytest.mark.parametrize("load", [None, BOOT], ids=["empty", "loaded"])
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.slow
def test_numbers_are_finite_and_of_usual_size(name: str, load: Load | None) -> None:
    car = TABLE_1_CAR.with_values(**TERMS[name])
    plain, found = (
        dict(ride_numbers(one, roads="AE", **({} if load is None else {"load": load})).items())  # type: ignore[arg-type]
        for one in (TABLE_1_CAR, car)
    )
    lost = {key for key in plain.keys() - found.keys() if not key.startswith("peaks.wheel")}
    assert not lost, lost
    for key, estimate in found.items():
        assert estimate.value is not None, key
        assert np.isfinite(estimate.value)
        if key in plain and not key.endswith(("k_s", "c_s", "c_t", "I_xx", "least_load")):
            assert 0.3 < estimate.value / (plain[key].value or 1.0) < 3.5, key


@pytest.mark.parametrize("name", ["friction", pytest.param(LONG, marks=pytest.mark.long)])
def test_sides_are_alike(name: str) -> None:
    """Computed with all four wheels told apart, by a negligible asymmetry, left is right."""
    car = TABLE_1_CAR.with_values(**TERMS[name], d_csf=1e-9)
    plates = ride_numbers(car, roads="B").plates
    for number, estimate in plates["fl"].items():
        assert estimate.value == pytest.approx(plates["fr"][number].value, rel=1e-5), number


@pytest.mark.parametrize("name", ["friction", "bump stop", pytest.param(LONG, marks=pytest.mark.long)])
def test_heavier_vehicles_ride_alike(name: str) -> None:
    """Ten times as heavy, stiff and damped, a vehicle with nonlinear elements has the same ride numbers but for forces."""
    car = TABLE_1_CAR.with_values(**TERMS[name])
    scaling = {"m_s", "I_yy", "I_xx", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr", "F_f", "F_r", "s_f",
    "s_r",
               "k_df", "k_dr", "k_bf", "k_br"}  # fmt: skip
    heavy = Vehicle({name: value * (10.0 if name in scaling else 1.0) for name, value in car.parameters.items()})
    one, other = (dict(ride_numbers(vehicle, roads="C").items()) for vehicle in (car, heavy))
    for key, estimate in one.items():
        factor = (
            10.0 if key.endswith(("m_s", "m_u", "k_s", "k_t", "c_s", "I_xx", "I_yy", "static_load", ".load")) else 1.0
        )
        assert other[key].value == pytest.approx(factor * (estimate.value or 0.0), rel=1e-5), key
