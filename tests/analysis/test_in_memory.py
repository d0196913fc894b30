"""A campaign changed in memory is held to the same limits as a file, by every function that takes one, before any work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

import sprung
from sprung.analysis import identify_campaign
from sprung.campaign import require_plausible
from sprung.errors import InputError
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Vehicle

LOAD: Any = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.2, 0.5)}]}
TRUCK = Vehicle(
    name="Truck", m_s=5800, I_yy=15_500, I_xx=3300, m_uf=190, m_ur=340, k_sf=140_000, k_sr=260_000, k_tf=650_000,
    k_tr=1_300_000, c_sf=7500, c_sr=9500, a=1.75, b=1.95, t_f=0.52, t_r=0.47,
)  # fmt: skip

Change = Callable[[sprung.Campaign], dict[str, Any]]


@pytest.fixture(scope="module")
def campaign() -> sprung.Campaign:
    return sprung.simulate(TABLE_1_CAR, seed=1, loads=[LOAD], drops=[{}, {"load": "ballast"}], duration=1.0)


def in_millimetres(campaign: sprung.Campaign) -> dict[str, Any]:
    return {"sensors": tuple(scaled(sensor, 1e3, 1e3, 1e3) for sensor in campaign.sensors)}


def on_one_line(campaign: sprung.Campaign) -> dict[str, Any]:
    return {"sensors": tuple(scaled(sensor, 1, 0, 1) for sensor in campaign.sensors)}


def scaled(sensor: sprung.Sensor, *factors: float) -> sprung.Sensor:
    if sensor.position is None:
        return sensor
    x, y, z = (one * factor for one, factor in zip(sensor.position, factors, strict=True))
    return replace(sensor, position=(x, y, z))


def load_in_tonnes(campaign: sprung.Campaign) -> dict[str, Any]:
    return {"loads": (campaign.loads[0], sprung.Load(name="ballast", added={"mass": 0.14}))}  # type: ignore[arg-type]


@pytest.mark.parametrize("door", [sprung.identify, sprung.check, sprung.plan, sprung.modes])
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda _: {"known": {"total_mass": 1.5518}},
            r"known\.total_mass: found 1\.5518.*1551\.8 if it was stated in ton",
        ),
        (lambda _: {"wheelbase": 2760.0}, r"vehicle\.wheelbase: found 2760.*2\.76 if it was stated in mm"),
        (in_millimetres, r"sensor\[1\]\.position \(body_fl\) and 3 more: found \[100, 740.*if it was stated in mm"),
        (on_one_line, "on one line"),
        (load_in_tonnes, r"load\[1\]\.added\.mass \(ballast\): found 0\.14.*140 if it was stated in tonnes"),
        (
            lambda _: {"known": {"total_mass": 1551.8, "front_axle_mass": 700.0, "rear_axle_mass": 700.0}},
            "1551.8 kg, but front_axle_mass",
        ),
    ],
)
def test_what_a_file_may_not_state_a_campaign_in_memory_may_not_either(
    campaign: sprung.Campaign, change: Change, message: str, door: Callable[[sprung.Campaign], Any]
) -> None:
    with pytest.raises(InputError, match=message):
        door(replace(campaign, **change(campaign)))


def test_everything_at_once(campaign: sprung.Campaign) -> None:
    wrong: Any = in_millimetres(campaign) | {"known": {"total_mass": 1.5518}}
    with pytest.raises(InputError) as caught:
        sprung.identify(replace(campaign, **wrong))
    assert len(caught.value.problems) == 2


def test_a_simulation_refuses_the_same() -> None:
    with pytest.raises(InputError, match=r"simulate: vehicle\.m_s: found 1\.38.*1380 if it was stated in tonnes"):
        sprung.simulate(TABLE_1_CAR.with_values(m_s=1.38))
    known: Any = {"total_mass": 1.5518}
    for name, door in (("simulate", sprung.simulate), ("plan", sprung.plan)):
        with pytest.raises(InputError, match=rf"{name}: known\.total_mass"):
            door(TABLE_1_CAR, known=known)


@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, SCHOOL_BUS, TRUCK], ids=lambda one: one.name)
def test_sound_vehicles_pass(vehicle: Vehicle) -> None:
    require_plausible(sprung.simulate(vehicle, seed=1, drops=[{}], duration=1.0, known={"m_s": vehicle.m_s}))


def test_a_sound_campaign_is_prepared_once(campaign: sprung.Campaign, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was prepared to look for mistakes is what is fitted."""
    monkeypatch.setattr("sprung.analysis.preparation.prepare", lambda *_: pytest.fail("prepared again"))
    run = identify_campaign(campaign, extras=(), tracks="shared", fall=False)
    assert len(run.decays) == 2
    assert run.preparations == 1
