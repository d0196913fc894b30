"""Campaigns of pushes and of passes over a bump, alone and mixed with drops."""

import numpy as np
import pytest

import sprung
from preprocess.test_end_of_drive import CASES
from sprung.analysis import AnalysisOptions
from sprung.analysis.analysis import Analysis
from sprung.analysis.stages import STAGES
from sprung.simulation import Acting, Bump, PadMotion, Push, default_sensors
from sprung.vehicle import EMPTY, TABLE_1_CAR, Sensor, Vehicle
from vehicle.test_layouts import PARTS

EVERY_WAY = (("fl", "fr", "rl", "rr"), ("fl", "fr"), ("rl", "rr"), ("fl", "rl"), ("fr", "rr"))
OVER_A_BUMP = (("fl", "fr", "rl", "rr"), ("fl", "rl"), ("fr", "rr"))


def simulated(vehicle: Vehicle, excitation: str, push: str, bump: str, noise: float, seed: int = 1) -> sprung.Campaign:
    """Pushes or passes in every way that the vehicle allows, its total mass weighed, exactly where there is no noise."""
    ways = EVERY_WAY if excitation == "push" else OVER_A_BUMP
    own = [tuple(wheel for wheel in way if wheel in vehicle.layout.wheels) for way in ways]
    wheels = own if vehicle.model == "full" else [vehicle.layout.wheels]
    if vehicle.model == "roll-plane" or (vehicle.model == "pitch-plane" and excitation == "push"):
        wheels.append(vehicle.layout.wheels[:1])
    return sprung.simulate(
        vehicle,
        drops=[{"excitation": excitation, "wheels": list(one)} for one in wheels],
        push={"shape": push},
        bump={"shape": bump},
        known={"total_mass": {"value": vehicle.total_mass, "std": 0.05 * noise * vehicle.total_mass}},
        noise=noise,
        seed=seed,
    )


@pytest.mark.parametrize(("excitation", "push", "bump"), CASES)
@pytest.mark.parametrize("vehicle", [TABLE_1_CAR, *PARTS.values()], ids=lambda one: one.model)
def test_without_noise_identification_returns_what_was_simulated(
    vehicle: Vehicle, excitation: str, push: str, bump: str
) -> None:
    result = sprung.identify(
        simulated(vehicle, excitation, push, bump, 0.0), extras=vehicle.extras, tracks=vehicle.tracks
    )
    assert result.verdict.state == "accept"
    assert not result.faults
    for name, value in vehicle.parameters.items():
        assert result.parameters[name].value == pytest.approx(value, rel=1e-6), name


@pytest.mark.parametrize("noise", [0.02, pytest.param(0.1, marks=pytest.mark.long)])
@pytest.mark.parametrize(("excitation", "push", "bump"), CASES)
@pytest.mark.slow
def test_the_fitted_vehicle_shows_when_its_motion_becomes_free(
    excitation: str, push: str, bump: str, noise: float
) -> None:
    """A rope and a bump end at once; the force of a hand fades like a sine: F² adds up to what is seen as σ² does, in t³."""
    campaign = simulated(TABLE_1_CAR, excitation, push, bump, noise)
    run = Analysis.start(campaign, AnalysisOptions(), STAGES[:3]).run()
    acting = Acting(Push(shape=push), Bump(shape=bump))  # type: ignore[arg-type]
    for decay, drop in zip(run.decays, campaign.drops, strict=True):
        free = 0.4 + acting.motion(TABLE_1_CAR, EMPTY, drop, 3.2).decay_start
        fades = 0.02 * (noise / 0.02) ** (2 / 3) if (excitation, push) == ("push", "hand") else 0.003
        assert free - fades <= decay.start <= free + fades


@pytest.mark.parametrize(("excitation", "push", "bump"), CASES)
@pytest.mark.slow
def test_recordings_alone_show_no_more_than_there_is(excitation: str, push: str, bump: str) -> None:
    result = sprung.identify(simulated(TABLE_1_CAR, excitation, push, bump, 0.02))
    assert result.verdict.state == "accept"
    assert not result.faults
    assert not result.fit.model
    off = [(result.parameters[name].value or 0.0) - value for name, value in TABLE_1_CAR.parameters.items()]
    stds = [result.parameters[name].std or 0.0 for name in TABLE_1_CAR.parameters]
    assert np.all(np.abs(off) < 4 * np.array(stds))


@pytest.mark.slow
def test_a_campaign_may_mix_drops_pushes_and_passes() -> None:
    drops: list[dict[str, object]] = [
        {"excitation": "push"},
        {"excitation": "pass", "speed": 5.0},
        {"wheels": ["fl", "fr"]},
        {"wheels": ["fl", "rl"]},
    ]
    for noise, tolerance in ((0.0, 1e-6), (0.02, 0.02)):
        known = {"total_mass": {"value": TABLE_1_CAR.total_mass, "std": 50 * noise}}
        result = sprung.identify(sprung.simulate(TABLE_1_CAR, drops=drops, known=known, noise=noise, seed=3))
        assert result.verdict.state == "accept"
        assert not result.faults
        for name, value in TABLE_1_CAR.parameters.items():
            assert result.parameters[name].value == pytest.approx(value, rel=tolerance), name


@pytest.mark.slow
def test_a_push_by_hand_tells_the_body_and_the_wheels_hardly() -> None:
    """Fifteen pushes, both axles weighed, 1 mg of noise: the body to 2 %, the wheels less, and that is said."""
    car = TABLE_1_CAR
    front = car.m_s * car.b / car.wheelbase + 2 * car.m_uf
    axles = {"front_axle_mass": front, "rear_axle_mass": car.total_mass - front}
    result = sprung.identify(
        sprung.simulate(
            car,
            drops=[{"excitation": "push", "wheels": list(one)} for one in EVERY_WAY * 3],
            known={name: {"value": value, "std": 1.0} for name, value in axles.items()},
            noise=0.01,
            seed=4,
        )
    )
    assert not result.faults
    assert not result.fit.model
    for name, truth in car.parameters.items():
        found = result.parameters[name]
        if name in ("m_uf", "m_ur", "k_tf", "k_tr"):
            assert found.value is None or abs(found.value - truth) < 4 * (found.std or 0.0)
        else:
            assert found.value == pytest.approx(truth, rel=0.02), name
    stds = {name: (found.std or 0.0) / (found.value or 1.0) for name, found in result.parameters.items()}
    assert min(stds["m_uf"], stds["m_ur"]) > 3 * max(stds["m_s"], stds["I_yy"])


@pytest.mark.long
def test_dry_friction_is_found_behind_a_bump() -> None:
    """The linear model, with which the beginning is looked for, has errors then."""
    car = TABLE_1_CAR.with_values(F_f=40.0, s_f=2e5, F_r=35.0, s_r=2e5)
    result = sprung.identify(simulated(car, "pass", "hand", "half-sine", 0.02, seed=5))
    assert result.verdict.state == "accept"
    assert not result.faults
    assert result.fit.model == ("friction",)
    for name, value in car.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert abs(found.value - value) < 4 * (found.std or 0.0)


@pytest.mark.slow
def test_damper_mounts_are_found_behind_a_bump() -> None:
    car = TABLE_1_CAR.with_values(k_df=2.4e5, k_dr=2.6e5)
    result = sprung.identify(simulated(car, "pass", "hand", "half-sine", 0.02, seed=5))
    assert result.verdict.state == "accept"
    assert result.fit.model == ("damper-mount",)
    assert result.parameters["k_df"].value == pytest.approx(2.4e5, rel=0.05)


@pytest.mark.long
def test_a_campaign_may_mix_pads_with_pushes_and_passes() -> None:
    car = TABLE_1_CAR
    pads = [
        Sensor(channel=f"pad_{wheel}", on=f"pad {wheel}", quantity="displacement", unit="mm")  # type: ignore[arg-type]
        for wheel in car.layout.wheels
    ]
    sensors = default_sensors(car)
    campaign = sprung.simulate(
        car,
        sensors=[*sensors, *pads],
        drops=[{"excitation": "pads"}, {"excitation": "pass"}, {"excitation": "push", "wheels": ["fl", "fr"]}],
        noise={**{one.channel: 0.02 for one in sensors}, **{one.channel: 1e-5 for one in pads}},
        pads=PadMotion(duration=12.0),
        known={"total_mass": {"value": car.total_mass, "std": 1.0}},
        seed=1,
    )
    result = sprung.identify(campaign)
    assert result.verdict.state == "accept"
    assert not result.faults
    for name, value in car.parameters.items():
        assert result.parameters[name].value == pytest.approx(value, rel=0.01), name
