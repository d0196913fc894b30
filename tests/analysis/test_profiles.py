"""Profiles on request, and which of the two enlarged the error bars."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sprung
from sprung.campaign import Campaign, ModelChoice
from sprung.errors import InputError
from sprung.vehicle import TABLE_1_CAR

DATA = Path(__file__).parents[1] / "data"


def campaign(noise: float = 0.02) -> Campaign:
    return sprung.simulate(TABLE_1_CAR, noise=noise, seed=1, known={"total_mass": TABLE_1_CAR.total_mass})


def asked_for(result: sprung.Result) -> set[str]:
    everything = {**result.parameters, **result.derived}
    return {name for name, found in everything.items() if found.interval_from == "profile"}


def test_only_what_was_asked_for_changes() -> None:
    without = sprung.identify(campaign())
    result = sprung.identify(campaign(), profile=["k_sf", "front_axle_mass", "total_mass"])
    assert asked_for(without) == set()
    assert {one.interval_from for one in without.derived.values()} <= {"curvature", None}
    assert asked_for(result) == {"k_sf", "front_axle_mass"}
    assert result.derived["total_mass"].status == "known"
    stiffness = result.parameters["k_sf"]
    assert replace(stiffness, interval95=None, interval_from=None) == replace(
        without.parameters["k_sf"], interval95=None, interval_from=None
    )
    assert {name: one for name, one in result.parameters.items() if name != "k_sf"} == {
        name: one for name, one in without.parameters.items() if name != "k_sf"
    }
    # Half the car's weight rests on each axle by b over the wheelbase.
    front = TABLE_1_CAR.m_s * TABLE_1_CAR.b / TABLE_1_CAR.wheelbase + 2 * TABLE_1_CAR.m_uf
    limits = result.derived["front_axle_mass"].interval95
    assert limits is not None
    low, high = limits
    assert low is not None
    assert high is not None
    assert low - (high - low) < front < high + (high - low)
    assert result.derived["front_axle_mass"].unit == "kg"


def test_all_and_single_names() -> None:
    assert asked_for(sprung.identify(campaign(), profile="all")) == set(TABLE_1_CAR.parameters)
    assert asked_for(sprung.identify(campaign(), profile="a")) == {"a"}


def test_half_distances_are_found_under_either_name_while_nobody_knows_which_there_are() -> None:
    assert asked_for(sprung.identify(campaign(), profile=["t_f1", "t_r"])) == {"t_f", "t_r"}
    separate = sprung.identify(campaign(), profile="t_f2", tracks="separate")
    assert asked_for(separate) == {"t_f2"}
    with pytest.raises(InputError, match="Did you mean 't_f"):
        sprung.identify(campaign(), profile="t_f", tracks="separate")


def test_what_the_model_has_not_is_refused_all_at_once_before_anything_is_fitted() -> None:
    told: list[str] = []
    with pytest.raises(InputError) as refused:
        sprung.identify(campaign(), profile=["k_fs", "k_sf", "c_tf", "mass"], progress=told.append)
    assert [problem.found for problem in refused.value.problems] == ["'k_fs'", "'c_tf'", "'mass'"]
    assert told == []
    bars = replace(campaign(), model=ModelChoice(extras=("tyre-damping",)))
    assert "c_tf" in sprung.identify(bars, profile="c_tf").parameters


def test_a_saved_profile_comes_back(tmp_path: Path) -> None:
    result = sprung.identify(campaign(), profile=["k_sf", "wheelbase"])
    found = result.parameters["k_sf"]
    assert found.interval95 is not None
    open_ended = replace(found, interval95=(None, found.interval95[1]))
    changed = replace(result, parameters={**result.parameters, "k_sf": open_ended})
    again = sprung.load(changed.save(tmp_path))
    assert again.parameters == changed.parameters
    assert again.derived == changed.derived


def coloured(channel: str) -> Campaign:
    """White noise everywhere, and in one channel noise that remembers."""
    clean = campaign()
    random = np.random.default_rng(5)
    recordings = []
    for recording in clean.recordings:
        values = recording.values.copy()
        noise = random.standard_normal((1, values.shape[1]))[0]
        for k in range(1, noise.size):
            noise[k] = 0.9 * noise[k - 1] + np.sqrt(1 - 0.81) * noise[k]
        values[list(recording.channels).index(channel)] += 0.03 * noise
        recordings.append(replace(recording, values=values))
    return clean.with_recordings(recordings)


@pytest.mark.slow
def test_the_result_says_what_enlarged_the_error_bars() -> None:
    white = sprung.identify(campaign()).fit
    assert (white.inflation, white.inflated_by, white.most_coloured) == (1.0, "nothing", None)
    one = sprung.identify(coloured("wheel_rl")).fit
    assert one.inflation > 1
    assert (one.inflated_by, one.most_coloured) == ("coloured residuals", "wheel_rl")
    # MuJoCo's sedan: geometry that depends on how far the wheels move, which the linear model lacks.
    moved = sprung.identify(sprung.read(DATA / "sedan")).fit
    assert moved.inflation > 1
    assert (moved.inflated_by, moved.most_coloured) == ("drops that disagree", None)
