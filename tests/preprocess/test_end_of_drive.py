"""Where a push or a bump has ended, as the recordings alone show it, and what is no release in them."""

from dataclasses import replace

import pytest

import sprung
from sprung.preprocess import find_flights, prepare
from sprung.simulation import Acting, Bump, Push
from sprung.vehicle import EMPTY, TABLE_1_CAR, Vehicle

CASES = [
    ("push", "hand", "half-sine"),
    ("push", "rope", "half-sine"),
    ("pass", "hand", "half-sine"),
    ("pass", "hand", "kerb"),
]


def excited(
    excitation: str, push: str, bump: str, vehicle: Vehicle = TABLE_1_CAR, noise: float = 0.02
) -> tuple[sprung.Campaign, list[float]]:
    """A campaign of pushes or passes, and when the free decay of each begins."""
    wheels = [("fl", "fr", "rl", "rr"), ("fl", "rl")]
    drops = [{"excitation": excitation, "wheels": list(own)} for own in wheels]
    shapes: dict[str, dict[str, str]] = {"push": {"shape": push}, "bump": {"shape": bump}}
    campaign = sprung.simulate(vehicle, drops=drops, noise=noise, seed=1, **shapes)  # type: ignore[arg-type]
    acting = Acting(Push(shape=push), Bump(shape=bump))  # type: ignore[arg-type]
    starts = [0.4 + acting.motion(vehicle, EMPTY, drop, 3.2).decay_start for drop in campaign.drops]
    return campaign, starts


@pytest.mark.parametrize(("excitation", "push", "bump"), CASES)
def test_a_decay_begins_when_the_motion_dies_away(excitation: str, push: str, bump: str) -> None:
    campaign, starts = excited(excitation, push, bump)
    prepared = prepare(campaign)
    assert not prepared.left_out
    for decay, start in zip(prepared.decays, starts, strict=True):
        assert decay.is_driven
        assert not decay.faults
        assert start - 0.4 < decay.start < start + 0.7
        assert decay.start - decay.earlier.shape[1] / decay.rate <= start
        assert decay.events.release == pytest.approx(0.4, abs=0.1)
        assert decay.rest.noise.std(axis=1) == pytest.approx(0.02, rel=0.3)


def test_nothing_fell() -> None:
    campaign, _ = excited("pass", "hand", "half-sine")
    prepared = prepare(campaign)
    assert all(not seen.dropped for seen in prepared.observations)
    assert find_flights(prepared.decays, prepared.observations) == [None, None]


def test_a_stated_start_is_used() -> None:
    campaign, _ = excited("pass", "hand", "half-sine")
    drops = tuple(replace(drop, start=1.3) for drop in campaign.drops)
    prepared = prepare(replace(campaign, drops=drops))
    assert [decay.start for decay in prepared.decays] == pytest.approx([1.3, 1.3])
    assert not any(decay.is_driven for decay in prepared.decays)


def test_a_recording_that_begins_on_the_bump_shows_no_rest_and_that_is_no_fault() -> None:
    campaign, starts = excited("pass", "hand", "half-sine")
    cut = [replace(one, values=one.values[:, 210:], start=0.42) for one in campaign.recordings]
    prepared = prepare(campaign.with_recordings(cut))
    assert all(seen.release is None for seen in prepared.observations)
    assert [fault.code for decay in prepared.decays for fault in decay.faults] == []
    assert all(abs(decay.start - start) < 0.3 for decay, start in zip(prepared.decays, starts, strict=True))
