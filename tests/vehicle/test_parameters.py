"""The vehicle record: its parameters, and what it says when they cannot be."""

import math

import pytest
from numpy.testing import assert_allclose

from sprung.errors import InputError
from sprung.simulation import static_wheel_loads
from sprung.vehicle import DERIVED, EMPTY, SCHOOL_BUS, TABLE_1_CAR, Vehicle, with_separate_tracks

TABLE_1 = TABLE_1_CAR.parameters


def test_from_parameters_is_the_inverse_of_parameters() -> None:
    for vehicle in (TABLE_1_CAR, SCHOOL_BUS):
        again = Vehicle.from_parameters(vehicle.parameters, name=vehicle.name)
        assert again == vehicle


def test_half_distances_shared_or_separate() -> None:
    assert TABLE_1_CAR.tracks == "shared"
    assert {"t_f", "t_r"} <= TABLE_1_CAR.parameters.keys()
    assert SCHOOL_BUS.tracks == "separate"
    assert {"t_f1", "t_r1", "t_f2", "t_r2"} <= SCHOOL_BUS.parameters.keys()
    assert not {"t_f", "t_r"} & SCHOOL_BUS.parameters.keys()
    apart = {name: value for name, value in TABLE_1.items() if not name.startswith("t_")}
    same = Vehicle.from_parameters(apart | {"t_f1": 0.74, "t_f2": 0.74, "t_r": 0.74}, name=TABLE_1_CAR.name)
    assert same == TABLE_1_CAR


def test_parted_half_distances_make_the_same_vehicle() -> None:
    apart = with_separate_tracks(TABLE_1)
    assert {"t_f1", "t_f2", "t_r1", "t_r2"} <= apart.keys()
    assert not {"t_f", "t_r"} & apart.keys()
    assert Vehicle.from_parameters(apart, name=TABLE_1_CAR.name) == TABLE_1_CAR
    assert with_separate_tracks(SCHOOL_BUS.parameters) == SCHOOL_BUS.parameters


def test_extras_are_parameters_only_where_they_are_not_zero() -> None:
    assert "k_af" not in TABLE_1
    barred = Vehicle.from_parameters(TABLE_1 | {"k_ar": 5000.0})
    assert barred.parameters["k_ar"] == 5000
    assert barred.parameters["k_af"] == 0
    assert "c_tf" not in barred.parameters
    roll_stiffness = barred.matrices().K[2, 2] - TABLE_1_CAR.matrices().K[2, 2]
    assert roll_stiffness == pytest.approx(5000 * (2 * 0.74) ** 2)  # k_ar times (2 t_r)²


def test_derived_quantities() -> None:
    # Table 4: 5240 kg on a wheelbase of 2.22 + 1.73 m.
    assert SCHOOL_BUS.total_mass == pytest.approx(5240)
    assert SCHOOL_BUS.wheelbase == pytest.approx(3.95)
    for vehicle in (TABLE_1_CAR, SCHOOL_BUS):
        front, rear = (DERIVED[name].value(vehicle.parameters) for name in ("front_axle_mass", "rear_axle_mass"))
        assert_allclose(
            static_wheel_loads(vehicle, EMPTY, 2.0), [front, front, rear, rear], rtol=1e-12
        )  # half of 2 m/s²


def test_every_impossible_value_is_named_at_once() -> None:
    with pytest.raises(InputError) as caught:
        Vehicle.from_parameters(TABLE_1 | {"m_s": -1.0, "k_tf": math.nan, "I_xx": 0.0, "c_tf": -2.0}, name="van")
    assert [problem.where for problem in caught.value.problems] == [
        "vehicle van: m_s",
        "vehicle van: I_xx",
        "vehicle van: k_tf",
        "vehicle van: c_tf",
    ]
    assert "found -1.0; expected a positive number, kg" in str(caught.value)


def test_unknown_and_missing_names_are_named_at_once() -> None:
    given = {name: value for name, value in TABLE_1.items() if name != "m_uf"} | {"K_SF": 3.0}
    with pytest.raises(InputError) as caught:
        Vehicle.from_parameters(given, name="van")
    unknown, missing = caught.value.problems
    assert unknown.found == "'K_SF'"
    assert unknown.do == "Did you mean 'k_sf'?"
    assert missing.found == "no 'm_uf'"
    assert missing.expected == "the unsprung mass, each front wheel in kg"


@pytest.mark.parametrize("half_distances", [{}, {"t_f1": 0.7}, {"t_f": 0.7, "t_f2": 0.6}])
def test_half_distances_missing_or_contradictory(half_distances: dict[str, float]) -> None:
    given = {name: value for name, value in TABLE_1.items() if name != "t_f"} | half_distances
    with pytest.raises(InputError, match=r"either t_f, or t_f1 \(dampers\) and t_f2 \(springs\)") as caught:
        Vehicle.from_parameters(given)
    assert len(caught.value.problems) == 1


def test_an_undamped_vehicle_is_a_vehicle() -> None:
    assert not Vehicle.from_parameters(TABLE_1 | {"c_sf": 0.0, "c_sr": 0.0}).matrices().C.any()


def test_tables_of_the_paper() -> None:
    # Table 1.
    assert list(TABLE_1.values()) == [
        *(1380, 2440, 380, 40.5, 45.4),
        *(17_000, 22_000, 192_000, 192_000, 1500, 1500),
        *(1.25, 1.51, 0.74, 0.74),
    ]
    # Table 5, then a, b of Table 4, t_f1 and t_r1 of Table 5, t_f2 and t_r2 of Table 4.
    assert list(SCHOOL_BUS.parameters.values()) == [
        *(4320, 8800, 3450, 130, 330),
        *(155_000, 260_000, 880_000, 1_760_000, 4000, 5000),
        *(2.22, 1.73, 0.64, 0.64, 0.4, 0.5),
    ]
