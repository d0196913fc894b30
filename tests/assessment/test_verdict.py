"""The verdict: it accepts what is clean and says no to what is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign
from sprung.vehicle import TABLE_1_CAR

LOAD = {"name": "bags", "items": [{"mass": 150, "position": (-1.0, 0.2, 0.5)}]}


def campaign(noise: float = 0.02, seed: int = 1) -> Campaign:
    return sprung.simulate(
        TABLE_1_CAR, loads=[LOAD], noise=noise, seed=seed, known={"total_mass": TABLE_1_CAR.total_mass}
    )


@pytest.mark.parametrize("noise", [0.002, 0.02, 0.2])
def test_clean_campaigns_are_accepted(noise: float) -> None:
    assert [sprung.identify(campaign(noise, seed)).verdict.state for seed in range(2)] == ["accept"] * 2


def spoil_sign(clean: Campaign) -> Campaign:
    flipped = np.ones((8, 1))
    flipped[1] = -1
    return clean.with_recordings(replace(r, values=r.values * flipped) for r in clean.recordings)


def spoil_exchange(clean: Campaign) -> Campaign:
    order = [0, 1, 2, 3, 6, 5, 4, 7]  # front left and rear left wheels
    return clean.with_recordings(replace(r, values=r.values[order]) for r in clean.recordings)


def spoil_unit(clean: Campaign) -> Campaign:
    scale = np.ones((8, 1))
    scale[2] = 1 / 9.80665
    return clean.with_recordings(replace(r, values=r.values * scale) for r in clean.recordings)


def spoil_place(clean: Campaign) -> Campaign:
    x, y, z = clean.sensors[0].position or (0.0, 0.0, 0.0)
    moved = replace(clean.sensors[0], position=(x - 0.6, y, z))
    return replace(clean, sensors=(moved, *clean.sensors[1:]))


def spoil_friction(clean: Campaign) -> Campaign:
    """Add to each channel what depends on the sign of its velocity: a crude picture of something the model lacks."""
    spoilt = []
    for recording in clean.recordings:
        velocity = np.cumsum(recording.values - recording.values[:, :150].mean(axis=1, keepdims=True), axis=1)
        spoilt.append(replace(recording, values=recording.values - 0.3 * np.tanh(velocity)))
    return clean.with_recordings(spoilt)


@pytest.mark.parametrize(
    ("spoil", "code"),
    [
        (spoil_sign, "sign"),
        (spoil_unit, "unit"),
        pytest.param(spoil_exchange, "exchanged", marks=pytest.mark.long),
        pytest.param(spoil_place, "position", marks=pytest.mark.long),
    ],
)
def test_what_can_be_put_right_is_accepted_by_name_only(spoil: object, code: str) -> None:
    assert callable(spoil)
    result = sprung.identify(spoil(campaign()))
    assert result.verdict.state == "accept"
    assert [fault.code for fault in result.faults] == [code]


@pytest.mark.long
def test_what_the_model_does_not_explain_is_not_accepted() -> None:
    spoilt = spoil_friction(campaign())
    verdict = sprung.identify(replace(spoilt, drops=spoilt.drops[::2])).verdict
    assert verdict.state != "accept"
    assert "does not explain" in verdict.reasons[0] or "not converge" in verdict.reasons[0]


@pytest.mark.slow
def test_coloured_noise_is_not_taken_for_model_error() -> None:
    """The sensors do the same at rest, so it is their noise; but the error bars must grow."""
    random = np.random.default_rng(5)
    clean = campaign(0.0)
    coloured = []
    for recording in clean.recordings:
        noise = random.standard_normal(recording.values.shape)
        for k in range(1, noise.shape[1]):
            noise[:, k] = 0.9 * noise[:, k - 1] + np.sqrt(1 - 0.81) * noise[:, k]
        coloured.append(replace(recording, values=recording.values + 0.02 * noise))
    result = sprung.identify(clean.with_recordings(coloured))
    assert result.verdict.state == "accept"
    assert result.fit.inflation > 4
