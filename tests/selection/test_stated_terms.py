"""Fits of nonlinear terms that are stated: from where they begin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest

import sprung
from sprung.analysis import AnalysisOptions
from sprung.analysis.analysis import Analysis
from sprung.analysis.stages import STAGES
from sprung.selection.term_fits import fit_forced_terms
from sprung.selection.usual_terms import fit_usual_terms
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Sensor, Vehicle

RIG = Vehicle(model="roll-plane", m_s=433, I_xx=115, m_u=100, k_s=18e3, k_t=320e3, c_s=120, t=0.75, F=30, s=8e5)
BOTH_ENDS = [{"excitation": "push", "wheels": ["left", "right"]}, {"excitation": "push", "wheels": ["left"]}]


def sensors() -> list[Sensor]:
    """Displacements of both ends of the body and of both wheels."""
    exact = {"quantity": "displacement", "unit": "mm", "tilt_std": 0.0}
    on_body = [
        Sensor(channel=name, on="body", position=(0.0, y, 0.5), position_std=0.0, **exact)  # type: ignore[arg-type]
        for name, y in (("body_left", 0.75), ("body_right", -0.75))
    ]
    return [*on_body, *(Sensor(channel=f"wheel_{side}", on=side, **exact) for side in ("left", "right"))]  # type: ignore[arg-type]


def baseline_of(rig: Vehicle, known: Mapping[str, float | KnownValue], terms: tuple[str, ...]) -> Analysis:
    """Return the analysis of a rig that is let go from a rope at both ends, and at one, up to its first linear fit."""
    campaign = sprung.simulate(
        rig,
        sensors=sensors(),
        drops=BOTH_ENDS,
        push={"shape": "rope"},
        known=known,
        noise=2e-5,
        seed=1,
        duration=2,
        rate=250,
    )
    return Analysis.start(campaign, AnalysisOptions(tracks="shared", terms=terms), STAGES[:3]).run()


def test_a_fit_comes_back_from_wheels_heavier_than_the_body() -> None:
    """Begun where mass has moved from the body to the wheels, it ends at the rig's; straight from there at some 475 kg."""
    known: dict[str, float | KnownValue] = {"m_s": 433.0, "t": 0.75, "m_u": KnownValue(80.0, 40.0)}
    run = baseline_of(RIG, known, terms=RIG.extras)
    linear, requested = run.model, run.requested
    assert requested is not None
    heavy = {**linear.structure.known, "m_u": KnownValue(600.0)}
    astray = replace(linear.refit(replace(linear.structure, known=heavy)), structure=linear.structure)
    assert astray.fit.parameters["m_u"] == pytest.approx(600.0)
    found = fit_forced_terms(astray, requested).fit.parameters
    assert {name: found[name] for name in ("m_u", "k_t", "F")} == pytest.approx(
        {"m_u": 100.0, "k_t": 320e3, "F": 30.0}, rel=0.01
    )


def test_what_differs_between_the_sides_of_a_lost_friction_goes_with_it() -> None:
    """A vehicle without friction: without it nothing is stepped."""
    smooth = RIG.with_values(F=None, s=None, c_s=900.0)
    known: dict[str, float | KnownValue] = {"m_s": 433.0, "t": 0.75, "m_u": KnownValue(100.0, 5.0)}
    run = baseline_of(smooth, known, terms=())
    rich = run.model.structure.with_terms(("friction", "uneven-friction"))
    found = fit_usual_terms(run.model, rich)
    assert found is not None
    assert found.structure.terms == rich.terms
    assert abs(found.fit.parameters["F"]) < 1.0


@pytest.mark.slow
@pytest.mark.parametrize("friction", [KnownValue(60.0), KnownValue(60.0, 3.0)])
def test_what_is_known_of_a_nonlinear_term_waits_for_it(friction: KnownValue) -> None:
    """A friction measured beforehand, exactly or with an uncertainty: the linear fits before it have no such parameter."""
    car = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"F_f": 60.0, "F_r": 50.0})
    drops = [{"wheels": wheels} for wheels in (("fl", "fr"), ("rl", "rr"), ("fl", "rl"))]
    known = {"total_mass": KnownValue(TABLE_1_CAR.total_mass), "F_f": friction}
    campaign = sprung.simulate(car, drops=drops, noise=0.02, seed=1, duration=2, known=known)
    result = sprung.identify(campaign, tracks="shared", extras=["friction"])
    assert result.verdict.state == "accept"
    assert not result.faults
    # Three times what the noise leaves of it without the statement.
    assert result.parameters["F_f"].value == pytest.approx(60.0, abs=0.5)
    assert result.parameters["F_r"].value == pytest.approx(50.0, abs=0.5)
