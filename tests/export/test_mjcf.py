"""MJCF: MuJoCo reads it, has our mass matrix, and its drop is ours; what it cannot hold is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from exported_vehicles import CASES, WITHIN, case, greatest_difference
from other_programs import drop_mjcf

from marks import all_the_others_are_long
from sprung import export
from sprung.errors import InputError
from sprung.vehicle import TABLE_1_CAR, Readout, Sensor, Vehicle

mujoco: Any = pytest.importorskip("mujoco")

LACKING = {
    "friction": "F_f",
    "front-friction": "F_f",
    "rubbing-heights": "F_f",
    "load-friction": "u_f",
    "uneven-friction": "d_Ff",
    "rounded": "w_kf",
    "rounded-rebound": "w_kf",
    "air": "e_f",
    "levelled-air": "e_lf",
    "air-and-stop": "e_f",
    "degressive": "e_lf",
    "tyre-curve": "h_tf",
    "mount": "k_df",
    "zener": "k_zf",
    "left-right": "k_xf",
    "uneven-seats": "d_mo",
    "heavy-axle": "m_xr",
    "flexible": "I_w",
    "pitch-plane": "F_f",
}
"""Vehicles that MuJoCo cannot hold, and a parameter that the refusal names."""

WHOLE = [name for name in CASES if name not in LACKING]


def model_of(text: str) -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


@pytest.mark.parametrize("name", all_the_others_are_long(WHOLE))
def test_a_drop_is_ours(name: str) -> None:
    vehicle, load = case(name)
    moved = drop_mjcf(export.mjcf(vehicle, load).text)[: len(vehicle.layout.coordinates)]
    assert greatest_difference(name, moved) < WITHIN / 10


@pytest.mark.parametrize("name", WHOLE)
def test_the_mass_matrix_is_ours(name: str) -> None:
    vehicle, load = case(name)
    model, data = model_of(export.mjcf(vehicle, load).text)
    mujoco.mj_forward(model, data)  # where no joint is turned
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    ours = vehicle.matrices(load).M
    assert np.abs(M - ours).max() < 1e-6 * ours.max()


@pytest.mark.parametrize("name", LACKING)
def test_what_mujoco_lacks_is_refused_or_approximated(name: str) -> None:
    vehicle, load = case(name)
    with pytest.raises(InputError, match=LACKING[name]) as caught:
        export.mjcf(vehicle, load)
    assert all("approximate=True" in problem.do for problem in caught.value.problems)
    file = export.mjcf(vehicle, load, approximate=True)
    assert len(file.notes) == len(caught.value.problems)
    assert all(note in file.text for note in file.notes)
    moved = drop_mjcf(file.text)
    assert np.isfinite(moved).all()
    assert np.ptp(moved[0]) > 0.01


def test_friction_becomes_a_friction_loss() -> None:
    file = export.mjcf(case("friction")[0], approximate=True)
    assert file.text.count('frictionloss="60.0"') == 4


def test_friction_of_each_side_becomes_a_friction_loss() -> None:
    text = export.mjcf(case("uneven-friction")[0], approximate=True).text
    assert [text.count(f'frictionloss="{friction}"') for friction in (85.0, 35.0, 45.0, 75.0)] == [1, 1, 1, 1]


def test_the_control_of_a_tyre_is_the_road() -> None:
    model, data = model_of(export.mjcf(TABLE_1_CAR).text)
    mujoco.mj_resetDataKeyframe(model, data, mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "rest"))
    mujoco.mj_forward(model, data)
    assert np.abs(data.qacc).max() < 1e-6  # at rest
    weight = TABLE_1_CAR.total_mass * 9.80665
    forces = [data.sensor(f"tyre_force_{wheel}").data[0] for wheel in ("fl", "fr", "rl", "rr")]
    assert abs(sum(forces) - weight) < 1e-6 * weight
    before = data.qpos.copy()
    data.ctrl[:4] = 0.03
    for _ in range(20_000):  # ten seconds: the oscillation decays by far more
        mujoco.mj_step(model, data)
    raised = data.qpos - before
    assert np.abs(raised[[0, 3, 4, 5, 6]] - 0.03).max() < 1e-6


def test_an_accelerometer_reads_what_ours_reads_and_gravity() -> None:
    sensors = [Sensor(channel="floor", on="body", position=(0.1, 0.6, 0.5)), Sensor(channel="wheel fl", on="fl")]
    model, data = model_of(export.mjcf(TABLE_1_CAR, sensors=sensors).text)
    mujoco.mj_resetDataKeyframe(model, data, mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "drop"))
    for _ in range(100):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    rows = Readout.of(sensors, tuple(TABLE_1_CAR.parameters)).at(list(TABLE_1_CAR.parameters.values()))
    expected = rows @ data.qacc + 9.80665
    read = [data.sensor(name).data[2] for name in ("floor", "wheel fl")]
    assert np.allclose(read, expected, rtol=2e-3)  # to the second order in the angles


def test_other_sensors_are_refused_with_the_terms() -> None:
    sensors = [Sensor(channel="wire", on="fl", quantity="displacement", unit="m")]
    with pytest.raises(InputError) as caught:
        export.mjcf(case("friction")[0], sensors=sensors)
    assert len(caught.value.problems) == 2


def test_a_name_in_the_text_is_escaped() -> None:
    vehicle = Vehicle(TABLE_1_CAR.parameters, name='a "b" <c> -- d')
    assert model_of(export.mjcf(vehicle).text)[0].nv == 7
