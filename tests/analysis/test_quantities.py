"""Campaigns with sensors of displacement, velocity, suspension travel and angular rate."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from quantities import TESTS, case_of

import sprung
from sprung.errors import InputError
from sprung.report import write_report
from sprung.simulation import default_sensors
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import TABLE_1_CAR, Sensor, Vehicle

CAR = TABLE_1_CAR
ANY = pytest.mark.parametrize("name", TESTS)

BEHIND_MOUNTS = CAR.with_values(k_df=2.5e5, k_dr=2.5e5)


def simulated(vehicle: Vehicle, sensors: tuple[Sensor, ...], noise: float = 0.0) -> sprung.Campaign:
    """A campaign with a bag of sand off the middle: suspension travel over the wheels alone shows no length across."""
    bag = {"name": "bag", "items": [{"mass": 0.1 * vehicle.total_mass, "position": (-1.0, 0.3, 0.5)}]}
    return sprung.simulate(vehicle, sensors=sensors, loads=[bag], noise=noise, duration=2.5, seed=1)


@ANY
def test_without_noise_identification_returns_what_was_simulated(name: str) -> None:
    vehicle, sensors = TESTS[name]
    result = sprung.identify(simulated(vehicle, sensors), extras=[], tracks=vehicle.tracks)
    for parameter, value in vehicle.parameters.items():
        assert result.parameters[parameter].value == pytest.approx(value, rel=1e-6), parameter


def test_states_without_mass_are_no_exception() -> None:
    """Travels of dampers behind mounts: their velocities are no states, and no sensor reads them."""
    _, sensors = TESTS["eight accelerometers, suspension travel"]
    result = sprung.identify(simulated(BEHIND_MOUNTS, sensors), extras=BEHIND_MOUNTS.extras)
    for parameter, value in BEHIND_MOUNTS.parameters.items():
        assert result.parameters[parameter].value == pytest.approx(value, rel=1e-6), parameter


@pytest.mark.long
def test_forces_with_steps_read_any_quantity() -> None:
    """The fit steps more coarsely than the simulation, which a tenth of a thousandth allows for."""
    vehicle = CAR.with_values(F_f=60.0, F_r=50.0, s_f=2e5, s_r=2e5)
    _, sensors = TESTS["suspension travel, wheels' accelerometers"]
    result = sprung.identify(simulated(vehicle, sensors), extras=vehicle.extras)
    for parameter, value in vehicle.parameters.items():
        assert result.parameters[parameter].value == pytest.approx(value, rel=1e-3), parameter


@ANY
@pytest.mark.slow
def test_noise_leaves_what_there_is(name: str) -> None:
    """Errors over the Cramér-Rao bound of one campaign; the model is selected."""
    case = case_of(name)
    result = sprung.identify(case.campaign(3), fall=False)
    assert result.verdict.state == "accept"
    assert not result.faults
    assert np.nanmax(np.abs(case.judge(result).error)) < 5.0
    assert result.fit.model == case.vehicle.extras


@pytest.mark.slow
def test_a_campaign_survives_being_written_and_its_report_names_units(tmp_path: Path) -> None:
    sensors = (
        *default_sensors(CAR),
        Sensor(channel="travel", on="body", relative_to="fl", quantity="displacement", unit="mm"),
        Sensor(channel="turning", on="body", quantity="angular-rate", axis="roll", unit="deg/s"),
    )
    campaign = simulated(CAR, sensors, 0.02)
    again = sprung.read(sprung.write(campaign, tmp_path / "campaign"))
    assert again.sensors == campaign.sensors
    assert again.recordings[0].values == pytest.approx(campaign.recordings[0].values, abs=1e-7)
    result = sprung.identify(again)
    result.save(tmp_path / "results")
    write_report(tmp_path / "results")
    page = (tmp_path / "results" / "report.html").read_text(encoding="utf-8")
    assert "displacement relative to fl" in page
    assert "angular rate in roll" in page
    assert "rad/s rms" not in page  # each channel has its own unit
    assert result.setup.describe_noise(result.fit.noise)[1].count(" m/s²") == 8
    loaded = sprung.load(tmp_path / "results")
    assert loaded.setup.units["turning"] == "rad/s"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('unit *= "mm"', ""), ("more recordings: travel", "no unit", "a unit of displacement", 'unit = "mm"')),
        (('unit *= "mm"', 'unit = "g"'), ("unit", "'g'", "a unit of displacement")),
        (('axis *= "roll"', ""), ("axis", "angular rate")),
        (('relative_to *= "fl"', 'relative_to = "left"'), ("relative_to", "'left'", "any of fl, fr, rl, rr")),
        (('relative_to *= "fl"', ""), ("no position",)),
    ],
)
@pytest.mark.slow
def test_what_is_missing_is_named(change: tuple[str, str], words: tuple[str, ...], tmp_path: Path) -> None:
    sensors = (
        *default_sensors(CAR),
        Sensor(channel="travel", on="body", relative_to="fl", quantity="displacement", unit="mm"),
        Sensor(channel="turning", on="body", quantity="angular-rate", axis="roll", unit="deg/s"),
    )
    path = sprung.write(simulated(CAR, sensors, 0.02), tmp_path / "campaign")
    path = path if path.is_file() else path / "campaign.toml"
    text = path.read_text(encoding="utf-8")
    assert re.search(change[0], text)
    path.write_text(re.sub(*change, text), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        sprung.read(path)
    for word in words:
        assert word in str(caught.value)


def test_wheels_that_stand_lower_in_the_end_have_been_dropped() -> None:
    _, sensors = TESTS["eight displacements"]
    campaign = simulated(CAR, sensors, 0.02)
    drops = [replace(drop, wheels=("fl", "fr")) if i == 0 else drop for i, drop in enumerate(campaign.drops)]
    found = sprung.check(replace(campaign, drops=tuple(drops)))
    assert [fault.code for fault in found.faults] == ["wheels"]
    assert "fl, fr, rl, rr to have fallen" in found.faults[0].what


@pytest.mark.slow
def test_a_unit_that_is_taken_for_another_one_is_named() -> None:
    """Neither is the SI unit: travel in millimetres, stated to be in centimetres."""
    travel = Sensor(channel="travel", on="body", relative_to="fl", quantity="displacement", unit="cm")
    campaign = simulated(CAR, (*default_sensors(CAR), travel), 0.02)
    scale = np.array([1.0] * 8 + [10.0])[:, None]
    recordings = [replace(one, values=scale * one.values) for one in campaign.recordings]
    (fault,) = sprung.identify(campaign.with_recordings(recordings)).faults
    assert (fault.code, fault.where) == ("unit", "travel")
    assert "in mm, not in cm" in fault.what


@pytest.mark.slow
def test_a_channel_that_was_converted_twice_is_named() -> None:
    """From m/s² to g; its coupling does not show gravity."""
    sensors = [replace(one, unit="g", high_pass=0.1) for one in default_sensors(CAR)]
    campaign = simulated(CAR, tuple(sensors), 0.02)
    scale = np.ones((8, 1))
    scale[2] /= STANDARD_GRAVITY
    recordings = [replace(one, values=scale * one.values) for one in campaign.recordings]
    (fault,) = sprung.identify(campaign.with_recordings(recordings)).faults
    assert (fault.code, fault.where) == ("unit", sensors[2].channel)
    assert "were converted from m/s² to g twice" in fault.what


@pytest.mark.slow
def test_a_displacement_in_another_unit_is_found() -> None:
    _, sensors = TESTS["eight accelerometers, suspension travel"]
    campaign = simulated(CAR, sensors, 0.02)
    factor = np.ones((len(sensors), 1))
    factor[8] = 1000.0
    wrong = [replace(one, values=one.values * factor) for one in campaign.recordings]
    result = sprung.identify(campaign.with_recordings(wrong))
    assert [(fault.code, fault.where) for fault in result.faults] == [("unit", "travel_fl")]
    assert "in mm" in result.faults[0].what


@pytest.mark.slow
def test_a_plan_tells_what_further_sensors_are_worth() -> None:
    plan = sprung.plan(CAR, loads=[{"name": "bag", "added": {"mass": 140.0}}])
    bounds = {row.label: row.bound for row in plan.rows}
    planned, travel, gyroscopes = (bounds[name] for name in ("as planned", "+ front travel", "+ gyroscopes"))
    assert planned is not None
    assert travel is not None
    assert gyroscopes is not None
    before, after = dict(planned.percents), dict(travel.percents)
    assert all((after[name] or 0.0) <= 1.0001 * (before[name] or 0.0) for name in before)
    assert (travel.percents["t_f"] or 0.0) < 0.8 * (planned.percents["t_f"] or 0.0)
    done = sprung.plan(CAR, sensors=TESTS["eight accelerometers, suspension travel"][1])
    assert not any("travel" in row.label for row in done.rows)
