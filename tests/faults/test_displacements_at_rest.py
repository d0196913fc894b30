"""What a displacement shows of the height of the blocks: its gain, sign and unit are not corrected against that."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.channel_prediction import ChannelPrediction
from sprung.preprocess import prepare
from sprung.selection import choose_structure
from sprung.simulation import default_sensors, simulate
from sprung.vehicle import Vehicle

RIG = Vehicle(model="quarter", m_s=340.0, m_u=42.0, k_s=21e3, k_t=195e3, c_s=1450.0)


def predicted(reads: float = 1.0, drops_left: int = 3) -> ChannelPrediction:
    """Return the channel of the body, which reads a multiple of its displacement, beside a fit in which some drops are left."""
    sensors = [replace(one, quantity="displacement") for one in default_sensors(RIG)]
    drops = [{"wheels": ("wheel",), "height": height} for height in (0.03, 0.05, 0.04)]
    campaign = simulate(RIG, sensors=sensors, drops=drops, noise=5e-5, seed=1, known={"total_mass": RIG.total_mass})
    scaled = [replace(one, values=one.values * [[reads], [1.0]]) for one in campaign.recordings]
    campaign = campaign.with_recordings(scaled)
    base = CandidateFit.of(choose_structure(campaign), prepare(campaign).decays)
    left = replace(
        base, structure=replace(base.structure, campaign=replace(campaign, drops=campaign.drops[:drops_left]))
    )
    return ChannelPrediction(left, 0, base.decays, base.fit.states)


@pytest.mark.parametrize("drops_left", [3, 2])
def test_a_displacement_that_falls_by_the_height_of_the_blocks_has_no_other_gain(drops_left: int) -> None:
    """In 0.05 mm of noise and 3 to 5 cm of height."""
    sound = predicted(drops_left=drops_left)
    assert sound.rest_allows(1.0)
    assert not any(sound.rest_allows(gain) for gain in (1.4, -1.0, 10.0))


def test_a_displacement_that_falls_by_more_may_have_that_gain() -> None:
    wrong = predicted(reads=1.4)
    assert wrong.rest_allows(1.4)
    assert not wrong.rest_allows(1.0)
