"""FMUs: valid for FMPy, and a drop in them is ours; their interface refuses what it cannot do."""

from __future__ import annotations

import io
import shutil
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_vehicles import CASES, WITHIN, case, dropped, greatest_difference
from numpy.typing import NDArray
from other_programs import drop_fmu, moving_names, names_at_wheels, simulate_fmu

from marks import all_the_others_are_long
from sprung import export
from sprung.export.functional_mockup import _built
from sprung.simulation import Bump, drive_over_bump
from sprung.simulation.excitation import bump_arcs
from sprung.vehicle import EMPTY, TABLE_1_CAR, Readout, Sensor

fmpy = pytest.importorskip("fmpy")
if shutil.which("cc") is None:
    pytest.skip("needs a compiler for C", allow_module_level=True)


@pytest.fixture(scope="module")
def car(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU of the paper's car."""
    return export.fmu(TABLE_1_CAR).save(tmp_path_factory.mktemp("car") / "x.fmu")


@pytest.mark.parametrize("name", all_the_others_are_long(CASES))
@pytest.mark.slow
def test_a_drop_is_ours(name: str, tmp_path: Path) -> None:
    vehicle, load = case(name)
    moved = drop_fmu(export.fmu(vehicle, load).save(tmp_path / "x.fmu"), vehicle)
    assert greatest_difference(name, np.array([moved[one] for one in moving_names(vehicle)])) < WITHIN / 10


@pytest.mark.long
def test_fmpy_builds_it_from_its_source(tmp_path: Path) -> None:
    build = pytest.importorskip("fmpy.build")
    vehicle, load = case("curve")
    folder = tmp_path / "unzipped"
    fmpy.extract(str(export.fmu(vehicle, load, build=False).save(tmp_path / "x.fmu")), str(folder))
    (tmp_path / "build").mkdir()
    build.build_platform_binary(str(folder), str(tmp_path / "build"))
    moved = drop_fmu(folder, vehicle)
    assert greatest_difference("curve", np.array([moved[one] for one in moving_names(vehicle)])) < WITHIN / 10


@pytest.mark.parametrize("name", all_the_others_are_long(["car", "mount", "rounded", "pitch-plane", "attached"]))
def test_it_is_valid(name: str, tmp_path: Path) -> None:
    validation = pytest.importorskip("fmpy.validation")
    path = export.fmu(*case(name)).save(tmp_path / "x.fmu")
    assert validation.validate_fmu(str(path)) == []


def test_sensors_travels_and_forces_are_outputs(tmp_path: Path) -> None:
    sensors = [
        Sensor(channel="floor 1", on="body", position=(-0.4, 0.5, 0.6)),
        Sensor(channel="rl", on="rl"),
        Sensor(channel="rate", on="body", quantity="angular-rate", axis="pitch"),
    ]
    path = export.fmu(TABLE_1_CAR, sensors=sensors).save(tmp_path / "x.fmu")
    found, motion = drop_fmu(path, TABLE_1_CAR), dropped("car")
    names, values = tuple(TABLE_1_CAR.parameters), list(TABLE_1_CAR.parameters.values())
    read = Readout.of(sensors, names).read(values, motion)
    for name, ours in zip(("sensor_floor_1", "sensor_rl", "sensor_rate"), read, strict=True):
        # The first sample is that of the release, before and after which the forces differ.
        assert np.abs(found[name][1:] - ours[1:]).max() < WITHIN * np.ptp(ours)
    forces = np.array([found[name] for name in names_at_wheels(TABLE_1_CAR, "tyre_force")])
    assert forces.min() == 0.0  # in the air
    weight = TABLE_1_CAR.total_mass * 9.80665
    mass = np.array([TABLE_1_CAR.m_s, *2 * (TABLE_1_CAR.m_uf,), *2 * (TABLE_1_CAR.m_ur,)])
    moving = np.vstack([motion.acceleration[:1], motion.acceleration[3:]])
    # Newton's second law of the whole vehicle.
    assert np.abs(forces.sum(axis=0) - weight - mass @ moving)[1:].max() < WITHIN * weight
    travel = motion.displacement[0] - TABLE_1_CAR.a * motion.displacement[1] - motion.displacement[3]
    assert np.abs(found["travel_fl"] - travel).max() < WITHIN * np.ptp(travel)


def test_a_road_is_followed_with_its_rate(tmp_path: Path) -> None:
    vehicle, _ = case("tyre-damping")
    bump = Bump(height=0.02, length=1.0)
    speed, step = 5.0, 1e-3
    arcs = bump_arcs(bump, speed)
    times: NDArray[np.float64] = np.asarray(np.arange(1000) * step)
    delays = {"fl": 0.0, "fr": 0.0, "rl": vehicle.wheelbase / speed, "rr": vehicle.wheelbase / speed}
    passage = arcs[1].start

    def road(delay: float, derivative: int) -> NDArray[np.float64]:
        since = times - delay
        shape = [np.sin, np.cos][derivative](np.pi / passage * since) * (np.pi / passage) ** derivative
        return np.where((since >= 0) & (since < passage), bump.height * shape, 0.0)

    roads = {f"road_{wheel}": road(delay, 0) for wheel, delay in delays.items()}
    rates = {f"road_rate_{wheel}": road(delay, 1) for wheel, delay in delays.items()}
    path = export.fmu(vehicle).save(tmp_path / "x.fmu")
    found = simulate_fmu(path, {**roads, **rates}, times)
    ours = drive_over_bump(vehicle, EMPTY, vehicle.layout.wheels, speed=speed, bump=bump).motion(step, len(times))
    assert np.abs(found["heave"] - ours.displacement[0]).max() < WITHIN * np.ptp(ours.displacement[0])
    assert np.abs(found["wheel_rl"] - ours.displacement[5]).max() < WITHIN * np.ptp(ours.displacement[5])


def test_parameters_can_be_set(car: Path, tmp_path: Path) -> None:
    other = TABLE_1_CAR.with_values(c_sf=900.0, m_s=1500.0)
    exported, set_later = export.fmu(other).save(tmp_path / "x.fmu"), car
    ours, found = drop_fmu(exported, other), drop_fmu(set_later, other, start_values={"c_sf": 900.0, "m_s": 1500.0})
    for name in ("heave", "pitch", "wheel_fl"):
        # Displacements count from the rest of the vehicle as it was exported.
        difference = (found[name] - found[name][0]) - (ours[name] - ours[name][0])
        assert np.abs(difference).max() < 1e-6 * np.ptp(ours[name])


def test_equal_vehicles_give_equal_files(car: Path) -> None:
    assert export.fmu(TABLE_1_CAR).content == car.read_bytes()


def test_without_a_compiler_the_source_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    file = export.fmu(TABLE_1_CAR)
    with zipfile.ZipFile(io.BytesIO(file.content)) as archive:
        names = archive.namelist()
    assert {"sources/fmu.c", "sources/vehicle.c", "sources/model.h", "sources/buildDescription.xml"} < set(names)
    assert not [name for name in names if name.startswith("binaries")]
    assert "source in C only" in file.notes[0]
    monkeypatch.setenv("CC", "no-such-compiler")
    assert "source in C only" in export.fmu(TABLE_1_CAR).notes[0]
    assert _built({"fmu.c": ""}) is None


class Instance:
    """An instance of an FMU, by its C interface."""

    def __init__(self, path: Path, folder: Path) -> None:
        unzipped = fmpy.extract(str(path), str(folder))
        self.description = fmpy.read_model_description(str(path))
        self.references = {one.name: one.valueReference for one in self.description.modelVariables}
        slave = pytest.importorskip("fmpy.fmi3").FMU3Slave
        self.logged: list[str] = []
        self.slave: Any = slave(
            guid=self.description.guid,
            unzipDirectory=unzipped,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="x",
        )

    def get(self, name: str) -> float:
        return float(self.slave.getFloat64([self.references[name]])[0])

    def set(self, name: str, value: float) -> None:
        self.slave.setFloat64([self.references[name]], [value])


@pytest.fixture
def instance(car: Path, tmp_path: Path) -> Instance:
    made = Instance(car, tmp_path / "unzipped")
    made.slave.instantiate()
    made.slave.enterInitializationMode()
    return made


def test_a_state_can_be_kept(instance: Instance) -> None:
    instance.set("road_fl", 0.02)
    instance.slave.exitInitializationMode()
    instance.set("road_fl", 0.0)
    kept = instance.slave.getFMUState()
    instance.slave.doStep(currentCommunicationPoint=0.0, communicationStepSize=0.1)
    first = instance.get("wheel_fl")
    instance.slave.setFMUState(kept)
    instance.slave.doStep(currentCommunicationPoint=0.0, communicationStepSize=0.1)
    assert instance.get("wheel_fl") == first != 0.0
    instance.slave.freeFMUState(kept)
    instance.slave.terminate()
    instance.slave.reset()
    instance.slave.enterInitializationMode()
    instance.slave.exitInitializationMode()
    assert abs(instance.get("wheel_fl")) < 1e-9  # at rest on flat road again


@pytest.mark.parametrize(("name", "value"), [("heave", 1.0), ("time", 1.0), ("road_fl", float("nan"))])
def test_what_cannot_be_set_is_refused(instance: Instance, name: str, value: float) -> None:
    with pytest.raises(Exception, match="fmi3SetFloat64"):
        instance.set(name, value)


def test_parameters_are_fixed_once_it_runs(instance: Instance) -> None:
    instance.set("m_s", 1400.0)
    instance.slave.exitInitializationMode()
    with pytest.raises(Exception, match="fmi3SetFloat64"):
        instance.set("m_s", 1500.0)


def test_a_vehicle_without_rest_is_refused(instance: Instance) -> None:
    for axle in "fr":
        instance.set(f"k_s{axle}", 0.0)
    with pytest.raises(Exception, match="fmi3ExitInitializationMode"):
        instance.slave.exitInitializationMode()


def test_a_foreign_token_makes_no_instance(car: Path, tmp_path: Path) -> None:
    made = Instance(car, tmp_path / "unzipped")
    made.slave.guid = "another"
    with pytest.raises(Exception, match=r"[Ii]nstantiate"):
        made.slave.instantiate()
