"""Corners of high-passes: only what the records determine beside the parameters counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import sprung
from sprung.estimation import fit_linear
from sprung.faults.high_pass import CornerScores, determined, score_corners
from sprung.preprocess import prepare
from sprung.selection.structure import choose_structure
from sprung.simulation.arguments import default_sensors
from sprung.vehicle import TABLE_1_CAR


def test_a_direction_that_the_parameters_imitate_tells_nothing() -> None:
    # Found in a campaign of the paper's car with 0.05 m/s² of noise: all corners together, rounding of either sign.
    common = np.ones(4) / 2
    others = np.linalg.svd(common[None, :])[2][1:]
    own = 1e5 * others.T @ others
    score = others.T @ np.array([300.0, -200.0, 100.0]) + 40.0 * common
    for rounding in (-81.0, -1e-9, 0.0):
        left, information = determined(score, own + rounding * np.outer(common, common))
        np.testing.assert_allclose(information, own, atol=1e-9 * 1e5)
        np.testing.assert_allclose(left, score - 40.0 * common, atol=1e-9 * 300)
        drops = np.stack([left * share for share in (0.2, 0.3, 0.5)])
        found = CornerScores(
            tuple("abcd"),
            drops,
            np.stack([own * 0.3, own * 0.3, own * 0.4]),
            left,
            information,
            np.zeros((1, 4)),
            np.zeros(4),
        )
        assert found.raw_gain > 0
        assert np.linalg.eigvalsh(found.covariance).min() > 0
        assert 0 < found.gain <= found.raw_gain
        np.testing.assert_allclose(found.step @ common, 0, atol=1e-9)


def test_records_that_determine_no_corner_gain_nothing() -> None:
    score, information = determined(np.array([3.0, -2.0]), np.zeros((2, 2)))
    found = CornerScores(
        ("a", "b"), np.ones((3, 2)), np.ones((3, 2, 2)), score, information, np.zeros((1, 2)), np.zeros(2)
    )
    assert found.gain == found.raw_gain == 0
    assert not found.is_relevant


def test_ramps_of_chance_are_as_large_as_the_noise_at_rest_makes_them() -> None:
    """An error of the level at rest is a ramp once the high-pass is undone; five drops hardly show how large."""
    sensors = [
        replace(one, high_pass=0.2) if one.channel in ("wheel_rl", "wheel_rr") else one
        for one in default_sensors(TABLE_1_CAR)
    ]
    squares = []
    for seed in range(12):
        campaign = sprung.simulate(TABLE_1_CAR, sensors=sensors, noise=0.02, seed=seed)
        structure, decays = choose_structure(campaign), prepare(campaign).decays
        fit = fit_linear(decays, structure.linear_models, campaign.sensors, structure.known, starts=1)
        scores = score_corners(decays, fit, campaign.sensors)
        assert scores is not None
        assert np.all(scores.ramps > 0.2)
        squares.append(scores.score**2 / np.diag(scores.information) / (1 + scores.ramps))
    # Of 24 squares of about unit mean the mean is known to 30 %.
    assert 0.4 < np.mean(squares) < 1.9
