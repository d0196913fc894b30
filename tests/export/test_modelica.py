"""Modelica text: a compiler accepts and simulates it, and the drop in it is ours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from exported_vehicles import CASES, RATE, SAMPLES, WITHIN, case, greatest_difference
from sprung import export
from sprung.errors import InputError
from sprung.vehicle import PARAMETERS, TABLE_1_CAR, Sensor, Vehicle

rumoca = pytest.importorskip("rumoca")

RELEASE = 0.1
"""s at which the model ``Drop`` releases the vehicle."""


def simulate(text: str, folder: Path) -> Any:
    """Compile and simulate the model of a drop."""
    path = folder / "x.mo"
    path.write_text(text, encoding="utf-8")
    model = rumoca.Session().load(str(path), model=f"{text.split()[1]}.Drop")
    config = rumoca.SimConfig(rtol=1e-8, atol=1e-10, dt=1 / RATE, max_wall_seconds=60.0)
    return model.simulate(t=(0, RELEASE + SAMPLES / RATE), config=config)


def sampled(found: Any, name: str) -> NDArray[np.float64]:
    """Return an output from the release on."""
    times = RELEASE + np.arange(SAMPLES) / RATE
    values = np.interp(times, np.array(found.time), np.array(found[f"vehicle.{name}"]))
    return np.asarray(values, dtype=np.float64)


def motions(found: Any, vehicle: Vehicle) -> NDArray[np.float64]:
    body = {"z_s": "heave", "theta": "pitch", "phi": "roll"}
    wheels = ["wheel" if wheel == "wheel" else f"wheel_{wheel}" for wheel in vehicle.layout.wheels]
    return np.array([sampled(found, name) for name in (*(body[one] for one in vehicle.layout.body), *wheels)])


@pytest.mark.parametrize("name", CASES)
def test_a_drop_is_ours(name: str, tmp_path: Path) -> None:
    vehicle, load = case(name)
    found = simulate(export.modelica(vehicle, load).text, tmp_path)
    assert greatest_difference(name, motions(found, vehicle)) < WITHIN / 10


def test_every_parameter_is_one_with_unit_and_meaning() -> None:
    for name in CASES:
        vehicle, load = case(name)
        lines = export.modelica(vehicle, load).text.splitlines()
        for parameter, value in vehicle.parameters.items():
            (line,) = [one for one in lines if one.strip().startswith(f"parameter Real {parameter}(")]
            assert float(line.split(" = ")[1].split(' "')[0]) == value
            assert PARAMETERS[parameter].meaning in line


def test_it_begins_at_rest(tmp_path: Path) -> None:
    found = simulate(export.modelica(TABLE_1_CAR, height=0.02).text, tmp_path)
    before = np.array(found.time) < RELEASE
    for name, value in (("heave", 0.02), ("wheel_rl", 0.02), ("pitch", 0.0), ("acceleration_heave", 0.0)):
        assert np.abs(np.array(found[f"vehicle.{name}"])[before] - value).max() < 1e-9
    assert abs(sum(np.array(found[f"vehicle.tyre_force_{wheel}"])[0] for wheel in ("fl", "fr", "rl", "rr")) - 15218) < 1


def test_a_sensor_is_an_output(tmp_path: Path) -> None:
    sensor = Sensor(channel="front axle", on="body", position=(0.0, 0.0, 0.5))
    found = simulate(export.modelica(TABLE_1_CAR, sensors=[sensor]).text, tmp_path)
    heave, pitch = sampled(found, "acceleration_heave"), sampled(found, "acceleration_pitch")
    # Above the front axle, a ahead of the centre of gravity; positive pitch is nose down.
    assert np.allclose(sampled(found, "sensor_front_axle"), heave - TABLE_1_CAR.a * pitch, atol=1e-9)


def test_pads_and_equal_names_are_refused() -> None:
    sensors = [
        Sensor(channel="pad", on="pad fl", quantity="displacement", unit="m"),
        Sensor(channel="a b", on="fl"),
        Sensor(channel="a_b", on="fr"),
    ]
    with pytest.raises(InputError) as caught:
        export.modelica(TABLE_1_CAR, sensors=sensors)
    assert [problem.found for problem in caught.value.problems] == [
        "sensor 'pad' on a pad",
        "several outputs named 'sensor_a_b'",
    ]


def test_a_name_of_the_vehicle_is_made_an_identifier() -> None:
    file = export.modelica(Vehicle(TABLE_1_CAR.parameters, name='3.5 t "Büs"'))
    assert file.name == "N35TBSModel.mo" or file.name.isascii()
    assert file.text.startswith(f"package {file.name[:-3]} ")
    assert '\\"B' in file.text
