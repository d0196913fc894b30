"""Parts of a vehicle: the same elements in fewer coordinates."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sprung.errors import InputError
from sprung.simulation import static_wheel_loads
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import (
    LAYOUTS,
    LINEAR_EXTRAS,
    REFINED,
    STATIONS,
    TABLE_1_CAR,
    Item,
    Layout,
    LinearModel,
    Load,
    Vehicle,
    coordinates,
    layout_of,
    linear_elements,
    parameter_name,
    parameter_names,
    parameters_of_term,
    terms_of,
)
from sprung.vibration import MODE_NAMES, compute_modes

QUARTER = Vehicle(model="quarter", m_s=350.0, m_u=40.0, k_s=2e4, k_t=2e5, c_s=1500.0, c_t=90.0)
ROLL_PLANE = Vehicle(
    {
        "m_s": 600.0,
        "I_xx": 150.0,
        "m_u": 45.0,
        "k_s": 3e4,
        "k_t": 3e5,
        "c_s": 2000.0,
        "t_1": 0.6,
        "t_2": 0.5,
        "k_a": 4e3,
    },
    model="roll-plane",
)
PITCH_PLANE = Vehicle(
    {
        "m_s": 650.0,
        "I_yy": 900.0,
        "m_uf": 40.0,
        "m_ur": 35.0,
        "k_sf": 2e4,
        "k_sr": 2.4e4,
        "k_tf": 2e5,
        "k_tr": 1.9e5,
        "c_sf": 1500.0,
        "c_sr": 1700.0,
        "a": 1.1,
        "b": 1.5,
    },
    model="pitch-plane",
)
PARTS = {vehicle.model: vehicle for vehicle in (QUARTER, ROLL_PLANE, PITCH_PLANE)}
LAYOUT = pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
PART = pytest.mark.parametrize("vehicle", PARTS.values(), ids=PARTS)


def test_a_quarter_car_has_the_textbooks_matrices() -> None:
    """Gillespie, Fundamentals of Vehicle Dynamics, chapter 5."""
    M, C, K = QUARTER.matrices()
    assert_allclose(M, np.diag([350.0, 40.0]))
    assert_allclose(C, [[1500.0, -1500.0], [-1500.0, 1590.0]])
    assert_allclose(K, [[2e4, -2e4], [-2e4, 2.2e5]])


def test_a_roll_plane_is_a_car_whose_axles_are_alike() -> None:
    """Front and rear axle move alike: what belongs to both of them counts together, and pitch and bounce do not meet."""
    of_axle = {name: value for name, value in ROLL_PLANE.parameters.items() if name not in ("m_s", "I_xx")}
    of_axles = {
        parameter_name(name[:1] if name[0] == "t" else name, axle, name[2:] if name[0] == "t" else ""): value
        if name[0] == "t"
        else value / 2
        for name, value in of_axle.items()
        for axle in "fr"
    }
    car = Vehicle({"m_s": 600.0, "I_xx": 150.0, "I_yy": 900.0, "a": 1.3, "b": 1.3, **of_axles})
    both = np.zeros((7, 4))
    both[0, 0] = both[2, 1] = both[3, 2] = both[5, 2] = both[4, 3] = both[6, 3] = 1.0
    for ours, whole in zip(ROLL_PLANE.matrices(), car.matrices(), strict=True):
        assert_allclose(ours, both.T @ whole @ both, rtol=1e-13, atol=1e-9)


def test_a_pitch_plane_is_a_car_whose_sides_are_alike() -> None:
    parameters = {
        name: value / 2 if name[0] in "kc" or name.startswith("m_u") else value
        for name, value in PITCH_PLANE.parameters.items()
    }
    car = Vehicle({**parameters, "I_xx": 300.0, "t_f": 0.7, "t_r": 0.6})
    both = np.zeros((7, 4))
    both[0, 0] = both[1, 1] = both[3, 2] = both[4, 2] = both[5, 3] = both[6, 3] = 1.0
    for ours, whole in zip(PITCH_PLANE.matrices(), car.matrices(), strict=True):
        assert_allclose(ours, both.T @ whole @ both, rtol=1e-13, atol=1e-9)


@PART
def test_names_tell_the_part(vehicle: Vehicle) -> None:
    assert layout_of(vehicle.parameters) == vehicle.layout
    assert Vehicle.from_parameters(vehicle.parameters) == vehicle
    assert hash(vehicle) == hash(vehicle.with_values())


@LAYOUT
def test_every_term_of_a_layout_has_parameters_there(layout: Layout) -> None:
    for term in terms_of(layout):
        names = parameter_names("shared", (term,), layout)
        assert set(parameters_of_term(term, "shared", layout)) <= set(names)
        assert layout_of(names) == layout
        assert coordinates(names)[: len(layout.coordinates)] == layout.coordinates


@LAYOUT
def test_every_parameter_of_a_term_changes_the_equations_of_motion(layout: Layout) -> None:
    """But for those of loads on seats, which an empty vehicle has not, and of the place of an axis that sensors alone show."""
    for term in {*LINEAR_EXTRAS} & {*terms_of(layout)} - {"seat-load"}:
        extras = (term, REFINED[term]) if term in REFINED else (term,)
        names = parameter_names("shared", extras, layout)
        model = LinearModel.of(linear_elements("shared", extras, wheelbase=2.5, layout=layout), names)
        slopes = np.sum(
            [np.abs(own).sum(axis=(1, 2)) for own in model.slopes(np.linspace(1.0, 2.0, len(names)))], axis=0
        )
        idle = {name for name, slope in zip(names, slopes, strict=True) if slope == 0}
        assert idle <= {"u_w", "e_w"}, term


def test_parts_have_the_terms_that_make_sense_there() -> None:
    missing = {layout.model: {*terms_of(LAYOUTS["full"])} - {*terms_of(layout)} for layout in LAYOUTS.values()}
    across = {"anti-roll", "asymmetry", "uneven-friction", "uneven-occupants", "interconnection", "rigid-axle", "twist"}
    assert missing == {
        "full": set(),
        "pitch-plane": across,
        "roll-plane": {"twist", "bending"},
        "quarter": across | {"bending", "gravity"},
    }


@PART
def test_the_wheels_carry_the_weight(vehicle: Vehicle) -> None:
    load = Load(name="bag", items=(Item(mass=30.0, position=(-0.4 if vehicle.layout.pitches else 0.0, 0.0, 0.5)),))
    weight = STANDARD_GRAVITY * (vehicle.total_mass + load.total_mass(vehicle.layout))
    assert static_wheel_loads(vehicle, load).sum() == pytest.approx(weight, rel=1e-12)
    carried = load.mass_at_wheels(vehicle.wheelbase, vehicle.layout)
    assert sum(carried[STATIONS[wheel].axle] for wheel in vehicle.layout.wheels) == pytest.approx(30.0)


@PART
def test_every_mode_has_a_name_of_its_own(vehicle: Vehicle) -> None:
    names = [
        mode.name for mode in compute_modes(vehicle.matrices(), coordinates(vehicle.parameters)) if mode.pole.imag >= 0
    ]
    expected = {
        "quarter": {"body bounce", "wheel hop"},
        "roll-plane": {"body bounce", "body roll", "axle hop", "axle tramp"},
        "pitch-plane": {"body bounce", "body pitch", "front axle hop", "rear axle hop"},
    }
    assert set(names) == expected[vehicle.model]
    assert {*names} <= {*MODE_NAMES}


def test_what_a_part_has_not_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        Vehicle({**QUARTER.parameters, "m_uf": 3.0, "t": 0.7}, model="quarter")
    assert [problem.found for problem in caught.value.problems] == ["'m_uf'", "'t'"]
    with pytest.raises(InputError, match="no 'I_xx'"):
        Vehicle(QUARTER.parameters, model="roll-plane")
    with pytest.raises(InputError, match="model 'half'"):
        Vehicle(QUARTER.parameters, model="half")  # type: ignore[arg-type]


def test_other_values_leave_the_rest_as_it_is() -> None:
    """A half-distance of the springs alone parts it from that of the dampers; one for both joins them again."""
    apart = TABLE_1_CAR.with_values(t_f2=0.6)
    assert (apart.t_f1, apart.t_f2, apart.t_r, apart.t_f) == (0.74, 0.6, 0.74, None)
    assert apart.with_values(t_f=0.74) == TABLE_1_CAR
    assert TABLE_1_CAR.with_values(F_f=20.0).extras == ("friction",)
    assert TABLE_1_CAR.with_values(F_f=20.0).with_values(F_f=None, F_r=None, s_f=None, s_r=None) == TABLE_1_CAR
