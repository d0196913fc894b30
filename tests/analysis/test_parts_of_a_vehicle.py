"""Campaigns of a part of a vehicle: quarter cars and vehicles in the pitch or the roll plane."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from campaigns import Case
from parts_of_a_vehicle import PITCH_PLANE as PITCH_CAR

import sprung
from sprung.errors import InputError
from sprung.uncertainty import KnownValue
from sprung.vehicle import Vehicle, terms_of
from vehicle.test_layouts import PARTS, PITCH_PLANE, QUARTER, ROLL_PLANE

PART = pytest.mark.parametrize("vehicle", PARTS.values(), ids=PARTS)

WITH_TERMS = (
    QUARTER.with_values(k_d=2.4e5, k_z=3e3, c_z=150.0),
    ROLL_PLANE.with_values(k_x=15e3, c_x=4.8e3),
    ROLL_PLANE.with_values(y_s=0.02, d_ks=400.0, d_kt=2500.0, d_cs=30.0),
    PITCH_PLANE.with_values(m_e=60.0, k_e=60.0 * 75.0**2, c_e=700.0, x_e=0.1),
)
WITH_CURVES = (
    QUARTER.with_values(F=25.0, s=2e5, r=1.6),
    ROLL_PLANE.with_values(v_k=0.12, q=0.5),
    ROLL_PLANE.with_values(F=60.0, s=2e5, d_F=25.0),
)


def simulated(vehicle: Vehicle, noise: float = 0.0, seed: int = 1, rate: float = 500.0) -> sprung.Campaign:
    """A campaign with a bag of sand, 10 % of the vehicle, that is off the middle where that is possible."""
    position = (-0.6 if vehicle.layout.pitches else 0.0, 0.15 if vehicle.layout.rolls else 0.0, 0.5)
    load = {"name": "bag", "items": [{"mass": 0.1 * vehicle.total_mass, "position": position}]}
    return sprung.simulate(vehicle, loads=[load], noise=noise, seed=seed, rate=rate)


@pytest.mark.parametrize("vehicle", [*PARTS.values(), *WITH_TERMS], ids=lambda one: "-".join((one.model, *one.extras)))
def test_without_noise_identification_returns_what_was_simulated(vehicle: Vehicle) -> None:
    result = sprung.identify(simulated(vehicle), extras=vehicle.extras, tracks=vehicle.tracks)
    assert result.verdict.state == "accept"
    for name, value in vehicle.parameters.items():
        assert result.parameters[name].value == pytest.approx(value, rel=1e-6), name
    assert result.vehicle.layout == vehicle.layout


def test_what_is_known_to_be_alike_on_both_sides_may_be_stated_as_zero() -> None:
    """Exactly, or within an uncertainty: both agree with the recordings, and a centre of gravity that is 20 mm off does not."""
    vehicle = ROLL_PLANE.with_values(y_s=0.0, d_ks=0.0, d_kt=0.0, d_cs=60.0)
    campaign = sprung.simulate(vehicle, noise=0.02, seed=1)
    for y_s, faults in ((0.0, []), (0.02, ["known"])):
        values = {"m_s": (600.0, 0.0), "y_s": (y_s, 0.0), "d_ks": (0.0, 300.0), "d_kt": (0.0, 0.0)}
        known = {name: KnownValue(*one) for name, one in values.items()}
        result = sprung.identify(replace(campaign, known=known), extras=vehicle.extras, tracks="separate")
        assert [fault.code for fault in result.faults] == faults
        assert result.verdict.state == "accept"
        found = result.parameters["d_cs"]
        assert abs((found.value or 0.0) - 60.0) < 4 * (found.std or 0.0) < 4.0


def test_a_known_difference_between_both_sides_may_be_negative(tmp_path: Path) -> None:
    known = {"m_s": KnownValue(600.0), "y_s": KnownValue(-0.01, 0.005), "d_ks": KnownValue(-200.0)}
    campaign = replace(simulated(ROLL_PLANE), known=known)
    assert sprung.read(sprung.write(campaign, tmp_path / "campaign")).known == known


@pytest.mark.long
@pytest.mark.parametrize("vehicle", WITH_CURVES, ids=lambda one: "-".join((one.model, *one.extras)))
def test_nonlinear_terms_are_those_of_a_whole_vehicle(vehicle: Vehicle) -> None:
    """The fit steps more coarsely than the simulation: half a millisecond, from sample to sample, errs by less than 1e-4."""
    result = sprung.identify(simulated(vehicle, rate=2000.0), extras=vehicle.extras, tracks=vehicle.tracks)
    for name, value in vehicle.parameters.items():
        assert result.parameters[name].value == pytest.approx(value, rel=1e-4), name


@PART
@pytest.mark.slow
def test_recordings_alone_show_no_more_than_there_is(vehicle: Vehicle) -> None:
    result = sprung.identify(simulated(vehicle, 0.02))
    assert result.verdict.state == "accept"
    assert not result.faults
    assert set(result.fit.model) == set(vehicle.extras)
    off = [(result.parameters[name].value or 0.0) - value for name, value in vehicle.parameters.items()]
    stds = [result.parameters[name].std or 0.0 for name in vehicle.parameters]
    assert np.all(np.abs(off) < 4 * np.array(stds))


@PART
def test_a_campaign_survives_being_written(vehicle: Vehicle, tmp_path: Path) -> None:
    campaign = simulated(vehicle, 0.02)
    again = sprung.read(sprung.write(campaign, tmp_path / "campaign"))
    assert again.vehicle_model == vehicle.model
    assert again.layout == vehicle.layout
    assert [drop.wheels for drop in again.drops] == [drop.wheels for drop in campaign.drops]
    saved = sprung.identify(again, extras=vehicle.extras)
    saved.save(tmp_path / "results")
    assert sprung.load(tmp_path / "results").parameters == saved.parameters


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('= "wheel"\ngain', '= "fl"\ngain'), ("'fl'", "any of wheel", "state model")),
        (('model = "quarter"', 'model = "half"'), ("vehicle.model",)),
        (("[[sensor]]", "[known]\nm_uf = 40\n\n[[sensor]]"), ("known.m_uf", 'model = "quarter"')),
        (("[[sensor]]", '[model]\nextras = ["anti-roll"]\n\n[[sensor]]'), ("model.extras", "'anti-roll'")),
    ],
)
def test_what_a_quarter_car_has_not_is_named(change: tuple[str, str], words: tuple[str, ...], tmp_path: Path) -> None:
    path = sprung.write(simulated(QUARTER, 0.02), tmp_path / "campaign")
    path = path if path.is_file() else path / "campaign.toml"
    path.write_text(path.read_text().replace(*change, 1))
    with pytest.raises(InputError) as caught:
        sprung.read(path)
    assert len(caught.value.problems) == 1
    for word in words:
        assert word in str(caught.value)


@PART
def test_a_plan_compares_what_the_part_allows(vehicle: Vehicle) -> None:
    plan = sprung.plan(vehicle, known={"total_mass": {"value": vehicle.total_mass, "std": 1.0}})
    as_planned = plan.rows[0].bound
    assert as_planned is not None
    assert set(as_planned.percents) == set(vehicle.parameters)
    assert not any("axle" in row.label for row in plan.rows if not vehicle.layout.pitches)


@pytest.mark.long
@PART
def test_a_plan_knows_the_terms_of_the_part(vehicle: Vehicle) -> None:
    plan = sprung.plan(vehicle, known={"total_mass": {"value": vehicle.total_mass, "std": 1.0}}, terms=True)
    found = {one.name for one in plan.terms["as planned"]}
    assert {"damper-mount", "friction", "rebound"} <= found <= {*terms_of(vehicle.layout)}


def test_an_optimum_where_a_part_of_the_vehicle_vanishes_is_not_the_end() -> None:
    """From the direct start the centre of gravity goes above the front axle, which leaves nearly white noise."""
    result = sprung.identify(Case(PITCH_CAR, False, ("total_mass",), 0.1).campaign(112), fall=False)
    assert not result.faults
    assert result.verdict.state == "accept"
    assert result.parameters["a"].value == pytest.approx(PITCH_CAR.a, rel=0.1)
