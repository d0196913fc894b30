"""State spaces: poles, responses and nonlinear elements against the vehicle, closed forms and simulated motions."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from exported_vehicles import CASES, VEHICLES, case, is_linear
from hypothesis import given, settings
from numpy.typing import NDArray

from sprung import export
from sprung.errors import InputError
from sprung.simulation import drive_on_pads
from sprung.vehicle import EMPTY, TABLE_1_CAR, Item, Load, Readout, Sensor, Vehicle
from strategies import vehicles

LINEAR = [name for name in CASES if is_linear(case(name)[0]) or name == "tyre-curve"]
WHEELS = ("fl", "fr", "rl", "rr")


def greatest_pole_difference(system: export.StateSpace, vehicle: Vehicle, load: Load) -> float:
    """Return the greatest distance of a pole from the nearest of the vehicle's, over its size."""
    poles, ours = system.poles, np.linalg.eigvals(vehicle.matrices(load).state)
    assert len(poles) == len(ours)
    distances = np.abs(poles[:, None] - ours).min(axis=1)
    return float((distances / np.maximum(np.abs(poles), 1.0)).max())


@pytest.mark.parametrize("name", LINEAR)
def test_the_poles_are_the_vehicles(name: str) -> None:
    vehicle, load = case(name)
    assert greatest_pole_difference(export.state_space(vehicle, load), vehicle, load) < 1e-9  # by the issue


@settings(max_examples=30, deadline=None)
@given(vehicles)
def test_the_poles_of_any_vehicle(vehicle: Vehicle) -> None:
    assert greatest_pole_difference(export.state_space(vehicle), vehicle, EMPTY) < 1e-9


@pytest.mark.parametrize("name", [name for name in LINEAR if name != "tyre-curve"])
@pytest.mark.parametrize("frequency", [1.5, 12.0])
def test_the_frequency_response_is_that_of_a_simulated_motion(name: str, frequency: float) -> None:
    vehicle, load = case(name)
    system = export.state_space(vehicle, load)
    # A damper whose spring in series has no rate stays where it is: a pole of 0 that nothing excites.
    slowest = min(-pole.real for pole in system.poles if abs(pole) > 1e-6)
    rate, periods = 40 * frequency, 4
    # Until what is left of the beginning is below 1e-9 of it.
    settled = math.ceil(math.log(1e9) / slowest * frequency) * 40
    wheel = vehicle.layout.wheels[0]
    omega = 2 * math.pi * frequency
    moved = drive_on_pads(vehicle, load, (wheel,), (lambda t: np.sin(omega * t),), rate, settled + periods * 40)
    times = np.arange(settled, settled + periods * 40) / rate
    inputs: dict[str, complex] = {system.inputs[0].name: 1.0}
    if "tyre-damping" in vehicle.extras:
        inputs[system.inputs[len(vehicle.layout.wheels)].name] = 1j * omega
    response = system.response(np.array([frequency]))[0]
    names = [one.name for one in system.inputs]
    found = sum(
        (value * response[:, names.index(one)] for one, value in inputs.items()), np.zeros(len(response), complex)
    )
    by_name = dict(zip([one.name for one in system.outputs], found, strict=True))
    body = {"z_s": "heave", "theta": "pitch", "phi": "roll"}
    stations = ["wheel" if one == "wheel" else f"wheel_{one}" for one in vehicle.layout.wheels]
    for i, output in enumerate([*(body[one] for one in vehicle.layout.body), *stations]):
        for part, prefix in ((moved.motion.displacement, ""), (moved.motion.acceleration, "acceleration_")):
            wave = part[i, settled:]
            harmonic = 2j * np.mean(wave * np.exp(-1j * omega * times))  # of a sine: 1
            largest = max(abs(harmonic), omega ** (2 * bool(prefix)) * 1e-3)
            assert abs(by_name[prefix + output] - harmonic) < 1e-6 * largest


@pytest.mark.parametrize("name", ["car", "tyre-damping", "roll-axis", "roll-plane", "quarter"])
def test_tyre_forces_travels_and_accelerations_agree(name: str) -> None:
    vehicle, load = case(name)
    system = export.state_space(vehicle, load)
    response = dict(
        zip([one.name for one in system.outputs], system.response(np.array([0.7, 8.0])).swapaxes(0, 1), strict=True)
    )
    wheels = ["wheel" if one == "wheel" else f"wheel_{one}" for one in vehicle.layout.wheels]
    masses = [getattr(vehicle, f"m_u{one[6:7] if vehicle.layout.pitches else ''}") for one in wheels]
    # Newton's second law of the whole vehicle.
    accelerated = vehicle.m_s * response["acceleration_heave"]
    accelerated = accelerated + sum(m * response[f"acceleration_{one}"] for m, one in zip(masses, wheels, strict=True))
    pressed = sum(response[one.replace("wheel", "tyre_force", 1)] for one in wheels)
    assert np.allclose(accelerated, pressed, rtol=1e-9, atol=1e-9 * np.abs(pressed).max())
    if vehicle.layout.pitches and vehicle.layout.rolls:
        travel = (
            response["heave"] - vehicle.a * response["pitch"] + vehicle.t_f * response["roll"] - response["wheel_fl"]
        )
        assert np.allclose(response["travel_fl"], travel, rtol=1e-9, atol=1e-12)


def test_a_slow_road_lifts_everything_alike() -> None:
    system = export.state_space(TABLE_1_CAR)
    static = dict(
        zip([one.name for one in system.outputs], system.response(np.array([0.0]))[0].real.sum(axis=1), strict=True)
    )
    assert all(abs(static[name] - 1) < 1e-9 for name in ("heave", "wheel_fl", "wheel_rr"))
    assert all(abs(static[name]) < 1e-6 for name in ("pitch", "travel_fl", "tyre_force_rl", "acceleration_heave"))


def test_outputs_are_those_wanted_in_their_order() -> None:
    sensor = Sensor(channel="floor", on="body", position=(0.4, 0.2, 0.5))
    pad = Sensor(channel="pad", on="pad fl", quantity="force", unit="N")
    wanted = ["tyre_force_fl", "sensor_floor", "heave", "sensor_pad"]
    system = export.state_space(TABLE_1_CAR, outputs=wanted, sensors=[sensor, pad])
    assert [one.name for one in system.outputs] == wanted
    assert np.array_equal(system.C[0], system.C[3])
    assert np.array_equal(system.D[0], system.D[3])
    highest = (system.A @ np.eye(14))[7:]
    row = Readout.of([sensor], tuple(TABLE_1_CAR.parameters)).at(list(TABLE_1_CAR.parameters.values()))[0]
    assert np.allclose(system.C[1], row @ highest)
    assert [one.unit for one in system.outputs] == ["N", "m/s^2", "m", "N"]


def test_it_is_a_system_of_scipy_and_control() -> None:
    control = pytest.importorskip("control")
    system = export.state_space(VEHICLES["tyre-damping"])
    in_control, in_scipy = system.to_control(), system.to_scipy()
    assert in_control.output_labels == [one.name for one in system.outputs]
    assert in_control.input_labels[:5] == ["road_fl", "road_fr", "road_rl", "road_rr", "road_rate_fl"]
    for name in "ABCD":
        assert np.array_equal(getattr(in_control, name), getattr(system, name))
        assert np.array_equal(getattr(in_scipy, name), getattr(system, name))
    frequency = 3.0
    assert np.allclose(in_control(2j * math.pi * frequency), system.response(np.array([frequency]))[0])
    assert np.allclose(sorted(control.poles(in_control), key=abs), sorted(system.poles, key=abs))


def test_the_mat_file_holds_everything(tmp_path: Path) -> None:
    system = export.state_space(VEHICLES["friction"], amplitude=0.01, frequency=1.2)
    path = system.mat().save(tmp_path)
    read = scipy.io.loadmat(str(path), simplify_cells=True)
    for name in "ABCD":
        assert np.array_equal(read[name], getattr(system, name))
    assert list(read["output_names"]) == [one.name for one in system.outputs]
    assert list(read["state_units"]) == [one.unit for one in system.states]
    assert read["amplitude"] == 0.01
    assert "10 mm" in str(read["notes"])


X0, OMEGA = 0.012, 2 * math.pi * 1.3
"""Amplitude, m, and angular frequency, rad/s, of the linearisations below."""


def equivalent(vehicle: Vehicle, load: Load | None = None) -> list[export.EquivalentElement]:
    system = export.state_space(vehicle, load, amplitude=X0, frequency=OMEGA / (2 * math.pi))
    assert system.linearisation is not None
    assert (system.linearisation.amplitude, round(system.linearisation.frequency, 9)) == (X0, 1.3)
    return list(system.linearisation.elements)


def test_rebound_damping_becomes_the_mean() -> None:
    # Half of the period is rebound.
    for one in equivalent(VEHICLES["rebound"]):
        assert one.damping == pytest.approx(0.8 / 2 * 1500, rel=1e-3)
        assert abs(one.stiffness) < 1e-6 * 17000


def test_sliding_friction_becomes_the_damper_of_equal_work() -> None:
    # 4 F / (π ω X): den Hartog, Trans. ASME 53 (1931) 107; it slides after 1e-6 m.
    vehicle = Vehicle({**VEHICLES["friction"].parameters, "s_f": 6e7, "s_r": 6e7})
    for one in equivalent(vehicle):
        assert one.damping == pytest.approx(4 * 60 / (math.pi * OMEGA * X0), rel=2e-3)


def test_friction_that_does_not_slide_is_a_spring() -> None:
    # The tangent of the Dahl model at rest is its presliding stiffness: F/s is a thousand times the amplitude.
    vehicle = Vehicle({**VEHICLES["friction"].parameters, "F_f": 2e5 * X0 * 1000, "F_r": 2e5 * X0 * 1000})
    for one in equivalent(vehicle):
        assert one.stiffness == pytest.approx(2e5, rel=2e-3)


def dead_zone(limit: float, amplitude: float) -> float:
    """Return the describing function of a dead zone of slope one (Gelb and Vander Velde, 1968, appendix B)."""
    ratio = min(limit / amplitude, 1.0)
    return 1 - 2 / math.pi * (math.asin(ratio) + ratio * math.sqrt(1 - ratio**2))


@pytest.mark.parametrize("velocity", [0.02, 0.05, 0.2])
def test_a_knee_takes_off_a_dead_zone(velocity: float) -> None:
    vehicle = Vehicle({**TABLE_1_CAR.parameters, "v_kf": velocity, "v_kr": velocity, "q_f": 0.4, "q_r": 0.4})
    for one in equivalent(vehicle):
        expected = -1500 * 0.6 * dead_zone(velocity, OMEGA * X0)
        assert one.damping == pytest.approx(expected, rel=2e-3, abs=1e-6)


def test_a_progressive_spring_has_its_rate_under_the_load() -> None:
    # Over a sine the square has no first harmonic: the tangent k (1 - p x) at the rest remains.
    vehicle = VEHICLES["progressive"]
    load = Load(name="sandbags", items=(Item(mass=300, position=(-TABLE_1_CAR.a, 0.0, 0.5)),))
    for one, rate, weight in zip(
        equivalent(vehicle, load),
        (17000, 17000, 22000, 22000),
        2 * (TABLE_1_CAR.b,) + 2 * (TABLE_1_CAR.a,),
        strict=True,
    ):
        carried = 300 * 9.80665 / 2 * weight / TABLE_1_CAR.wheelbase
        # k d + k p d²/2 = W has the deflection d and the tangent k sqrt(1 + 2 p W/k).
        tangent = rate * math.sqrt(1 + 2 * 3.0 * carried / rate)
        assert one.stiffness == pytest.approx(tangent - rate, rel=1e-6)


def test_elements_add_to_the_matrices() -> None:
    plain, other = export.state_space(VEHICLES["car"]), export.state_space(VEHICLES["rebound"], amplitude=X0)
    with_mean = export.state_space(TABLE_1_CAR.with_values(c_sf=1.4 * 1500, c_sr=1.4 * 1500))
    assert not np.allclose(plain.A, other.A)
    assert np.allclose(other.A, with_mean.A, rtol=1e-3, atol=1e-3 * np.abs(with_mean.A).max())


def test_a_friction_damped_car_moves_as_its_linearisation(tmp_path: Path) -> None:
    # The first harmonic of a simulated motion with the amplitude for which it was linearised; harmonics are left out.
    fmpy = pytest.importorskip("fmpy")
    vehicle = Vehicle(
        model="quarter", m_s=300, m_u=40, k_s=2e4, k_t=2e5, c_s=1200, F=60.0, s=4e5, r=1.6, v_k=0.1, q=0.6
    )
    file = export.fmu(vehicle)
    if "library" not in file.notes[0]:
        pytest.skip("needs a compiler for C")
    frequency, height, step = 1.1, 0.008, 1e-3
    omega = 2 * math.pi * frequency
    times = np.arange(round(14 / frequency / step)) * step
    signal = np.zeros(len(times), dtype=[("time", float), ("road", float), ("road_rate", float)])
    signal["time"], signal["road"], signal["road_rate"] = (
        times,
        height * np.sin(omega * times),
        height * omega * np.cos(omega * times),
    )
    found = fmpy.simulate_fmu(
        str(file.save(tmp_path / "x.fmu")), stop_time=times[-1], step_size=step, output_interval=step, input=signal
    )
    last = slice(round(7 / frequency / step), round(14 / frequency / step))  # seven periods, those before settled

    def harmonic(name: str) -> complex:
        wave: NDArray[np.complex128] = found[name][last] * np.exp(-1j * omega * found["time"][last])
        return complex(2j * np.mean(wave))

    system = export.state_space(vehicle, amplitude=abs(harmonic("travel")), frequency=frequency)
    linear = export.state_space(Vehicle(model="quarter", m_s=300, m_u=40, k_s=2e4, k_t=2e5, c_s=1200))
    names = [one.name for one in system.outputs]
    for name in ("heave", "travel"):
        simulated = harmonic(name) / height
        errors = [
            abs(one.response(np.array([frequency]))[0, names.index(name), 0] - simulated) for one in (system, linear)
        ]
        assert errors[0] < 0.03 * abs(simulated)
        assert errors[0] < errors[1] / 5


@pytest.mark.parametrize("name", [name for name in CASES if name not in LINEAR and "stop" not in name])
def test_nonlinear_elements_need_an_amplitude(name: str) -> None:
    vehicle, load = case(name)
    with pytest.raises(InputError, match=r"amplitude=0\.01"):
        export.state_space(vehicle, load)
    system = export.state_space(vehicle, load, amplitude=0.005)
    assert "5 mm" in system.notes[0]
    assert np.isfinite(system.A).all()


def test_bump_stops_are_no_linear_element() -> None:
    vehicle = VEHICLES["bump-stop"]
    with pytest.raises(InputError) as caught:
        export.state_space(vehicle, amplitude=0.04)
    assert len(caught.value.problems) == 2
    assert "30 mm from rest" in caught.value.problems[0].found
    system = export.state_space(vehicle, amplitude=0.029)  # not met
    assert np.allclose(system.A, export.state_space(TABLE_1_CAR).A)
    for mass, found in (
        (100, r"met 14\.\d mm"),
        (300, "on which the vehicle rests"),
    ):  # the load takes up the clearance
        load = Load(name="sandbags", items=(Item(mass=mass, position=(-1.25, 0.0, 0.5)),))
        with pytest.raises(InputError, match=found):
            export.state_space(vehicle, load, amplitude=0.029)


def test_all_that_is_wrong_is_said_at_once() -> None:
    with pytest.raises(InputError) as caught:
        export.state_space(VEHICLES["curve"], outputs=["haeve"], frequency=-1.0)
    assert [problem.found for problem in caught.value.problems] == ["output 'haeve'", "-1.0"]
    assert "heave" in caught.value.problems[0].do
    with pytest.raises(InputError) as caught:
        export.state_space(VEHICLES["curve"])
    assert [problem.found.split(" (")[0] for problem in caught.value.problems] == [
        "dampers stiffer in rebound",
        "damper curves with knees",
    ]
