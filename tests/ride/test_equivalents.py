"""Quarter and half cars of a vehicle, and the modes of each axle."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sprung.ride import ride_numbers
from sprung.ride.equivalents import axle_numbers
from sprung.ride.ride_model import RideModel
from sprung.vehicle import TABLE_1_CAR, Item, Load, Vehicle

CAR = TABLE_1_CAR


def test_quarter_car_of_an_axle_is_the_quarter_car() -> None:
    """Every number of it, and its poles as those of the vehicle that has these parameters."""
    own = {name: one.value for name, one in ride_numbers(CAR, roads="C").axles["front"].items()}
    share = CAR.b / (CAR.a + CAR.b)
    expected = {"m_s": CAR.m_s * share / 2, "m_u": CAR.m_uf, "k_s": CAR.k_sf, "k_t": CAR.k_tf, "c_s": CAR.c_sf}
    assert {name: own[name] for name in expected} == pytest.approx(expected, rel=1e-9)
    poles = np.linalg.eigvals(Vehicle(expected, model="quarter").matrices().state)
    body, hop = sorted((pole for pole in poles if pole.imag > 0), key=abs)
    for mode, pole in (("body", body), ("hop", hop)):
        assert own[f"{mode}_frequency"] == pytest.approx(abs(pole) / (2 * np.pi), rel=1e-9)
        assert own[f"{mode}_damping"] == pytest.approx(-pole.real / abs(pole), rel=1e-9)


@pytest.mark.parametrize(
    "further",
    [
        {"k_d": 3e5, "c_d": 60.0},
        {"k_z": 4000.0, "c_z": 300.0},
        {"c_t": 100.0},
    ],
)
def test_quarter_car_with_further_parts_has_its_own_modes(further: dict[str, float]) -> None:
    """Mounts and Zener branches of both axles: those of the quarter car that has them."""
    whole = CAR.with_values(**{f"{name}{axle}": value for name, value in further.items() for axle in "fr"})
    found = ride_numbers(whole, roads="C").axles["rear"]
    own = {name: found[name].value or 0.0 for name in ("m_s", "m_u", "k_s", "k_t")}
    quarter = Vehicle({**own, "c_s": CAR.c_sr, **further}, model="quarter")
    poles = np.linalg.eigvals(quarter.matrices().state)
    vibrating = sorted((pole for pole in poles if pole.imag > 0), key=abs)
    assert found["body_frequency"].value == pytest.approx(abs(vibrating[0]) / (2 * np.pi), rel=1e-8)
    assert found["hop_damping"].value == pytest.approx(-vibrating[-1].real / abs(vibrating[-1]), rel=1e-8)


def test_anti_roll_bars_and_interconnection_are_not_part_of_it() -> None:
    plain = ride_numbers(CAR, roads="C").axles
    stiff = ride_numbers(CAR.with_values(k_af=9000.0, k_xr=5000.0, c_xr=200.0), roads="C").axles
    for axle, own in plain.items():
        for name, estimate in own.items():
            assert stiff[axle][name].value == pytest.approx(estimate.value, rel=1e-9)


def test_friction_is_a_spring_and_a_damper_in_series() -> None:
    """Statistically linearised friction is the Zener branch of its rate and damping, with the same poles."""
    vehicle = CAR.with_values(F_f=90.0, F_r=90.0, s_f=1.5e5, s_r=1.5e5)
    model, values = RideModel.of(vehicle), np.array(list(vehicle.parameters.values()))
    from sprung.ride.road import Road  # noqa: PLC0415
    from sprung.ride.road_response import Drive, respond  # noqa: PLC0415

    equivalents = respond(model, values, Drive(Road.of_class("B"), 20.0)).equivalents
    assert equivalents is not None
    found = axle_numbers(model, values, equivalents)["f"]
    rate = float((equivalents.sliding * equivalents.memory_gain)[0])
    quarter = Vehicle(
        {name: found[name] for name in ("m_s", "m_u", "k_s", "k_t", "c_s")}
        | {"k_z": rate, "c_z": rate / float(equivalents.cutoff[0])},
        model="quarter",
    )
    poles = sorted((pole for pole in np.linalg.eigvals(quarter.matrices().state) if pole.imag > 0), key=abs)
    assert found["body_frequency"] == pytest.approx(abs(poles[0]) / (2 * np.pi), rel=1e-6)
    assert found["body_damping"] == pytest.approx(-poles[0].real / abs(poles[0]), rel=1e-6)


def test_half_cars_of_a_loaded_vehicle() -> None:
    """A load at a place moves the centre of gravity, and adds to the pitch inertia by Steiner's theorem."""
    x, mass = -2.2, 200.0
    load = Load(name="boot", items=(Item(mass=mass, position=(x, 0.0, 0.6)),))
    pitch = ride_numbers(CAR, roads="C", load=load).half_cars["pitch"]
    total = CAR.m_s + mass
    a = (CAR.m_s * CAR.a - mass * x) / total
    inertia = CAR.I_yy + CAR.m_s * (a - CAR.a) ** 2 + mass * (a + x) ** 2
    expected = {"m_s": total / 2, "I_yy": inertia / 2, "a": a, "b": CAR.a + CAR.b - a}
    assert {name: pitch[name].value for name in expected} == pytest.approx(expected, rel=1e-9)
    assert pitch["dynamic_index"].value == pytest.approx(inertia / (total * a * expected["b"]), rel=1e-9)


def test_roll_plane_has_the_roll_stiffness_of_the_vehicle() -> None:
    car = CAR.with_values(t_f=0.76, t_r=0.71)
    roll = ride_numbers(car, roads="C").half_cars["roll"]
    stiffness = 2 * (car.k_sf * car.t_f**2 + car.k_sr * car.t_r**2)
    assert 2 * roll["k_s"].value * roll["t"].value ** 2 == pytest.approx(stiffness, rel=1e-12)  # type: ignore[operator]


def test_engine_and_people_are_carried_by_the_body() -> None:
    """They are part of the sprung mass: at the frequencies of the body they move with it."""
    plain = ride_numbers(CAR, roads="C")
    with_engine = ride_numbers(CAR.with_values(m_e=160.0, k_e=4e5, c_e=1500.0, x_e=0.1), roads="C")
    for axle in ("front", "rear"):
        assert with_engine.axles[axle]["m_s"].value == pytest.approx(plain.axles[axle]["m_s"].value, rel=1e-9)
    pitch, other = plain.half_cars["pitch"], with_engine.half_cars["pitch"]
    assert_allclose(
        [one.value or 0.0 for one in other.values()], [one.value or 0.0 for one in pitch.values()], rtol=1e-9
    )


@pytest.mark.parametrize("model", ["pitch-plane", "roll-plane", "quarter"])
def test_parts_of_a_vehicle_have_what_they_can(model: str) -> None:
    parts = {
        "pitch-plane": Vehicle(
            model="pitch-plane", m_s=690, I_yy=1220, m_uf=40, m_ur=45, k_sf=17e3, k_sr=22e3, k_tf=19e4, k_tr=19e4,
            c_sf=1500, c_sr=1500, a=1.25, b=1.51,
        ),
        "roll-plane": Vehicle(model="roll-plane", m_s=690, I_xx=200, m_u=40, k_s=17e3, k_t=19e4, c_s=1500, t=0.74),
        "quarter": Vehicle(model="quarter", m_s=345, m_u=40, k_s=17e3, k_t=19e4, c_s=1500),
    }  # fmt: skip
    found = ride_numbers(parts[model], roads="AC")
    assert list(found.axles) == (["front", "rear"] if model == "pitch-plane" else ["axle"])
    assert list(found.half_cars) == (["pitch"] if model == "pitch-plane" else [])
    assert len(found.plates) == len(parts[model].layout.wheels)
    assert {*found.on("C").body} == {"pitch-plane": {"pitch"}, "roll-plane": {"roll"}, "quarter": set()}[model]
    for _, estimate in found.items():
        assert estimate.value is not None
        assert estimate.std == 0
    # The road scales a linear vehicle: from class A to C by four.
    for place, own in found.on("A").places.items():
        for name, estimate in own.items():
            assert found.on("C").places[place][name].value == pytest.approx(4 * estimate.value, rel=1e-12)  # type: ignore[operator]
