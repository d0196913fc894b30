"""Model terms that are in the vehicle are selected, requested ones fitted, and what comes out is what was simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.campaign import ModelChoice
from sprung.errors import InputError
from sprung.uncertainty import KnownValue
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR, Load, Vehicle, parse_record

HANGING = 2 * np.pi * 9.5  # 1/s of the engine on its mounts, the body held

WITH_ENGINE = TABLE_1_CAR.with_values(
    m_e=160.0, k_e=160.0 * HANGING**2, c_e=0.14 * 160.0 * HANGING, x_e=0.1, name="car with an engine"
)

BALLAST = parse_record(Load, {"name": "ballast", "items": [{"mass": 150.0, "position": [-1.1, 0.3, 0.5]}]})

UNEVEN = {"y_s": 0.03, "d_ksf": 800.0, "d_csr": 400.0, "d_ktr": -5000.0}
RIGID = {"n_r": 0.7, "m_xr": -12.0}
LOAD = {"name": "ballast", "items": [{"mass": 140.0, "position": (-1.0, 0.3, 0.5)}]}


@pytest.mark.parametrize(
    "vehicle",
    [
        pytest.param(WITH_ENGINE, marks=pytest.mark.long),
        WITH_ENGINE.with_values(x_e=-2.9, k_e=160 * (2 * np.pi * 7) ** 2),
    ],
)
@pytest.mark.slow
def test_an_engine_is_selected(vehicle: Vehicle) -> None:
    campaign = sprung.simulate(vehicle, loads=[BALLAST], noise=0.02, seed=1)
    result = sprung.identify(campaign)
    assert result.fit.model == ("engine",)
    assert result.verdict.state == "accept"
    for name, value in vehicle.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - value) < 4 * found.std
        assert found.std < 0.02 * max(abs(value), 1.0)
    assert len(result.modes["empty"]) == 8


@pytest.mark.slow
def test_a_requested_engine_is_fitted() -> None:
    campaign = sprung.simulate(WITH_ENGINE, loads=[BALLAST], noise=0.02, seed=1, duration=1.6)
    assert sprung.identify(campaign, extras=["engine"]).fit.model == ("engine",)


@pytest.mark.long
def test_an_engine_is_fitted_beside_friction() -> None:
    rubbing = WITH_ENGINE.with_values(F_f=80.0, F_r=80.0, s_f=4e5, s_r=4e5)
    drops = [
        {"wheels": wheels, "load": load} for wheels in (["fl", "fr"], ["rl", "rr"]) for load in ("empty", "ballast")
    ]
    campaign = sprung.simulate(rubbing, loads=[BALLAST], drops=drops, noise=0.02, seed=1, rate=250, duration=1.6)
    result = sprung.identify(campaign, extras=["engine", "friction"])
    assert result.verdict.state == "accept"
    for name in ("m_e", "k_e", "x_e", "F_f", "F_r", "m_s", "k_sf"):
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - rubbing.parameters[name]) < 4 * found.std


@pytest.mark.slow
def test_bump_stops_are_selected_though_the_linear_fit_went_astray() -> None:
    """Without them a vehicle is found of which no fit with them comes back: the wheels keep their masses at first."""
    stopped = TABLE_1_CAR.with_values(k_bf=30e3, k_br=25e3, x_bf=0.02, x_br=0.025, name="car on its stops")
    campaign = sprung.simulate(stopped, loads=[BALLAST], noise=0.02, seed=1, rate=250, duration=2.0)
    result = sprung.identify(campaign)
    assert result.fit.model == ("bump-stop",)
    assert result.verdict.state == "accept"
    for name, value in stopped.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - value) < 4 * found.std


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_half_distances_are_separated_in_much_noise(seed: int) -> None:
    """The model without them lets decays begin before the last tyre touches, and gravity explains nearly as much at first."""
    mass = KnownValue(SCHOOL_BUS.total_mass, 0.001 * SCHOOL_BUS.total_mass)
    wheels = [["fl", "fr", "rl", "rr"], ["fl", "fr"], ["rl", "rr"], ["fl", "rl"], ["fr", "rr"]]
    drops = [{"wheels": dropped} for dropped in wheels]
    campaign = sprung.simulate(SCHOOL_BUS, drops=drops, noise=0.2, seed=seed, known={"total_mass": mass})
    result = sprung.identify(campaign, fall=False)
    assert (result.fit.model, result.fit.tracks) == ((), "separate")
    assert result.fit.inflation < 1.1
    assert result.verdict.state == "accept"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_drift_is_no_rubber_that_relaxes_in_seconds(seed: int) -> None:
    mass = KnownValue(TABLE_1_CAR.total_mass, 0.001 * TABLE_1_CAR.total_mass)
    campaign = sprung.simulate(TABLE_1_CAR, loads=[BALLAST], noise=0.02, seed=seed, known={"total_mass": mass})
    random = np.random.default_rng(seed)
    recordings = []
    for recording in campaign.recordings:
        channels, samples = recording.values.shape
        drift = 0.05 * random.choice([-1.0, 1.0], (channels, 1)) * np.linspace(0.0, 1.0, samples)
        recordings.append(replace(recording, values=recording.values + drift))
    result = sprung.identify(campaign.with_recordings(tuple(recordings)), fall=False)
    assert "zener" not in result.fit.model
    assert result.verdict.state == "doubtful"
    mass_found = result.parameters["m_s"].value
    assert mass_found is not None
    assert abs(mass_found / TABLE_1_CAR.m_s - 1) < 0.01


@pytest.mark.long
def test_friction_and_rebound_of_a_van_are_selected() -> None:
    """From an ordinary vehicle, whose initial states have far to go: their steps must not be shortened without need."""
    van = TABLE_1_CAR.with_values(
        m_s=1950.0, I_yy=4600.0, I_xx=950.0, m_uf=55.0, m_ur=65.0, k_sf=38e3, k_sr=48e3, k_tf=260e3, k_tr=300e3, c_sf=2800.0,
        c_sr=3100.0, a=1.45, b=1.8, F_f=141.0, F_r=141.0, s_f=283e3, s_r=283e3, r_f=2.0, r_r=2.0, name="van",
    )  # fmt: skip
    known = {"total_mass": van.total_mass}
    result = sprung.identify(sprung.simulate(van, noise=0.02, seed=2, known=known))
    assert result.fit.model == ("friction", "rebound")
    assert result.verdict.state == "accept"


@pytest.mark.slow
def test_a_body_that_could_carry_no_usual_engine_is_identified() -> None:
    # Its mass sits in its middle: a tenth of it above either axle would have more pitch inertia than all of it.
    compact = TABLE_1_CAR.with_values(I_yy=200.0, name="compact")
    result = sprung.identify(sprung.simulate(compact, loads=[BALLAST], noise=0.02, seed=1))
    assert (result.verdict.state, result.fit.model) == ("accept", ())


@pytest.mark.parametrize(("more", "term"), [(UNEVEN, "asymmetry"), (RIGID, "rigid-axle")])
@pytest.mark.slow
def test_asymmetry_and_a_rigid_axle_are_selected(more: dict[str, float], term: str) -> None:
    """identify(simulate(p)) = p within five standard errors, the term selected and no other."""
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | more)
    result = sprung.identify(sprung.simulate(car, loads=[LOAD], rate=250, noise=0.02, seed=1))
    assert (result.verdict.state, result.fit.model) == ("accept", (term,))
    for name, truth in car.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - truth) < 5 * found.std


def test_a_requested_linear_term_is_fitted() -> None:
    stiff = Vehicle.from_parameters({**TABLE_1_CAR.parameters, "k_af": 9000.0, "k_ar": 4000.0})
    campaign = sprung.simulate(stiff, noise=0.02, seed=4, known={"total_mass": stiff.total_mass})
    result = sprung.identify(campaign, extras=["anti-roll"])
    assert result.fit.model == ("anti-roll",)
    for name in ("k_af", "k_ar", "k_sf"):
        one = result.parameters[name]
        assert one.value is not None
        assert one.std is not None
        assert abs(one.value - getattr(stiff, name)) < 4 * one.std


def test_contradictory_choices_of_the_model_are_refused_together() -> None:
    campaign = sprung.simulate(TABLE_1_CAR, seed=1, known={"t_f2": 0.7, "k_af": 100.0})
    clashing = replace(campaign, model=ModelChoice(tracks="shared", extras=("frction",)))
    with pytest.raises(InputError) as caught:
        sprung.identify(clashing)
    text = str(caught.value)
    assert "t_f2" in text
    assert "frction" in text


@pytest.mark.slow
def test_friction_is_selected() -> None:
    """The simplest campaign with friction: identify(simulate(p)) = p within five standard errors."""
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"F_f": 90.0, "F_r": 70.0, "s_f": 25e4, "s_r": 25e4})
    drops = [{"wheels": wheels} for wheels in (["fl", "fr", "rl", "rr"], ["rl", "rr"], ["fl", "rl"])]
    campaign = sprung.simulate(
        car, drops=drops, rate=250, duration=1.8, noise=0.02, seed=1, known={"total_mass": car.total_mass}
    )
    result = sprung.identify(campaign, fall=False)
    assert (result.verdict.state, result.fit.model) == ("accept", ("friction",))
    for name in ("F_f", "F_r", "k_sf", "c_sf"):
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - car.parameters[name]) < 5 * found.std
    step = next(step for step in result.fit.path if step.extra == "friction")
    assert step.text.startswith("friction (Δ2lnL = ")
    assert "model terms supported by the data: friction" in result.fit.why


@pytest.mark.long
def test_where_the_missing_term_is_forbidden_no_other_takes_its_place() -> None:
    """Friction of 180 N without a term for it: other nonlinear terms leave too much of the misfit, and are refused."""
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"F_f": 180.0, "F_r": 140.0, "s_f": 25e4, "s_r": 25e4})
    drops = [{"wheels": wheels} for wheels in (["fl", "fr", "rl", "rr"], ["rl", "rr"], ["fl", "rl"])]
    campaign = sprung.simulate(
        car, drops=drops, rate=200, duration=1.2, noise=0.02, seed=1, known={"total_mass": car.total_mass}
    )
    beside = ("air", "levelled-air", "engine", "twist", "bending", "occupants", "zener", "damper-mount")
    without = replace(campaign, model=ModelChoice(forbid=("friction", *beside)))
    result = sprung.identify(without, fall=False)
    assert result.verdict.state == "reject"
    assert not {"friction", "rebound", "progressive", "bump-stop"} & set(result.fit.model)
    assert any(step.fitted and not step.taken for step in result.fit.path if step.extra in ("rebound", "progressive"))
