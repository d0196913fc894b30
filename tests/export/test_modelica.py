"""Modelica text: a compiler accepts and simulates it, and the drop in it is ours."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from exported_vehicles import CASES, USUAL, WITHIN, case, greatest_difference
from other_programs import RELEASE, drop_modelica, moving_names

from marks import all_the_others_are_long
from sprung import export
from sprung.errors import InputError
from sprung.vehicle import PARAMETERS, TABLE_1_CAR, Sensor, Vehicle

rumoca = pytest.importorskip("rumoca")


@pytest.mark.parametrize("name", all_the_others_are_long(CASES))
def test_a_drop_is_ours(name: str, tmp_path: Path) -> None:
    vehicle, load = case(name)
    moved = drop_modelica(export.modelica(vehicle, load).text, tmp_path)
    assert greatest_difference(name, np.array([moved[one] for one in moving_names(vehicle)])) < WITHIN / 10


def test_every_parameter_is_one_with_unit_and_meaning() -> None:
    for name in USUAL:
        vehicle, load = case(name)
        lines = export.modelica(vehicle, load).text.splitlines()
        for parameter, value in vehicle.parameters.items():
            (line,) = [one for one in lines if one.strip().startswith(f"parameter Real {parameter}(")]
            assert float(line.split(" = ")[1].split(' "')[0]) == value
            assert PARAMETERS[parameter].meaning in line


def test_it_begins_at_rest(tmp_path: Path) -> None:
    path = tmp_path / "x.mo"
    text = export.modelica(TABLE_1_CAR, height=0.02).text
    path.write_text(text, encoding="utf-8")
    model = rumoca.Session().load(str(path), model=f"{text.split()[1]}.Drop")
    found = model.simulate(t=(0, RELEASE / 2), config=rumoca.SimConfig(rtol=1e-8, atol=1e-10, dt=0.01))
    for name, value in (("heave", 0.02), ("wheel_rl", 0.02), ("pitch", 0.0), ("acceleration_heave", 0.0)):
        assert np.abs(np.array(found[f"vehicle.{name}"]) - value).max() < 1e-9
    forces = [np.array(found[f"vehicle.tyre_force_{wheel}"])[0] for wheel in ("fl", "fr", "rl", "rr")]
    assert sum(forces) == pytest.approx(TABLE_1_CAR.total_mass * 9.80665)


def test_a_sensor_is_an_output(tmp_path: Path) -> None:
    sensor = Sensor(channel="front axle", on="body", position=(0.0, 0.0, 0.5))
    moved = drop_modelica(export.modelica(TABLE_1_CAR, sensors=[sensor]).text, tmp_path)
    # Above the front axle, a ahead of the centre of gravity; positive pitch is nose down.
    expected = moved["acceleration_heave"] - TABLE_1_CAR.a * moved["acceleration_pitch"]
    assert np.allclose(moved["sensor_front_axle"], expected, atol=1e-9)


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
