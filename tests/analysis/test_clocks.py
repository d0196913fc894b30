"""Campaigns of several loggers, from the files to the parameters."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from wireless import Wireless, wireless

import sprung
from sprung.analysis import identify_campaign
from sprung.campaign import Campaign
from sprung.results import Result
from sprung.vehicle import TABLE_1_CAR

LATE = 0.3e-3
"""s within which every clock is to be found that the records determine (the issue's figure)."""


def off(found: Wireless, result: Result) -> tuple[list[float], list[float]]:
    """Return the error of every clock, s, and its standard uncertainty."""
    channels = found.campaign.recordings[0].channels
    missed, stated = [], []
    for drop, ahead, report in zip(found.campaign.drops, found.ahead, result.drops, strict=True):
        of = {clock.logger: clock for clock in report.clocks}
        position = {f"{drop.files[i]}": i for i in range(len(channels))}
        first = position[report.clocks[0].logger]
        for logger, clock in of.items():
            missed.append(clock.ahead - float(ahead[position[logger]] - ahead[first]))
            stated.append(clock.std)
    return missed, stated


@pytest.mark.parametrize(
    "rates",
    [
        pytest.param((500.0,) * 8, marks=pytest.mark.long, id="one rate"),
        pytest.param((200.0, 400.0, 500.0, 512.0, 1000.0, 800.0, 600.0, 500.0), id="many rates"),
    ],
)
@pytest.mark.slow
def test_eight_loggers_give_the_vehicle_and_their_clocks(rates: tuple[float, ...]) -> None:
    simulated = wireless(rates=rates, seed=2)
    result = sprung.identify(simulated.campaign)
    assert result.verdict.state == "accept", result.verdict.reasons
    for name, truth in TABLE_1_CAR.parameters.items():
        found = result.parameters[name]
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - truth) < 4 * found.std, name
        assert found.std < 0.005 * truth, name
    missed, stated = off(simulated, result)
    well = np.array(stated) < LATE / 4
    assert well.sum() > 50  # of 80, less the wheels that hardly move
    assert np.abs(np.array(missed))[well].max() < LATE
    assert np.all(np.abs(missed) < 5 * np.array(stated) + 1e-9)


def jolted(simulated: Wireless, size: float) -> Campaign:
    """Add to each wheel's flight what no vehicle does: half a sine of 10 ms, m/s², beginning 10 ms after the release."""
    recordings = []
    for recording, ahead in zip(simulated.campaign.recordings, simulated.ahead, strict=True):
        parts = list(recording.parts)
        for i in range(4, 8):
            part = parts[i]
            since = part.time - ahead[i] - 0.01
            jolt = size * np.sin(np.pi * since / 0.01) * ((since > 0) & (since < 0.01))
            parts[i] = replace(part, values=part.values + jolt)
        recordings.append(replace(recording, parts=tuple(parts)))
    return simulated.campaign.with_recordings(recordings)


@pytest.mark.long
def test_a_flight_that_no_vehicle_has_tells_nothing_of_it() -> None:
    simulated = wireless(seed=5, drift=0.0)
    plain, shaken = (identify_campaign(one, extras=()) for one in (simulated.campaign, jolted(simulated, 0.3)))
    assert any("flights" in remark for remark in plain.remarks)
    assert not any("flights" in remark for remark in shaken.remarks)
    truth = np.array([TABLE_1_CAR.parameters[name] for name in shaken.uncertainty.names])
    open_ = np.array([name != "b" for name in shaken.uncertainty.names])  # it follows from a, the wheelbase being exact
    std = np.sqrt(np.diag(shaken.uncertainty.covariance))
    assert np.all(np.abs(shaken.uncertainty.values - truth)[open_] < 4 * std[open_])
    # What they tell where they are sound is much.
    assert np.median(np.sqrt(np.diag(plain.uncertainty.covariance)) / std) < 0.95


@pytest.mark.slow
def test_files_of_eight_loggers_are_read_back(tmp_path: Path) -> None:
    simulated = wireless(seed=3).campaign
    read = sprung.read(sprung.write(simulated, tmp_path))
    assert [sensor.channel for sensor in read.sensors] == [sensor.channel for sensor in simulated.sensors]
    for one, other in zip(read.recordings, simulated.recordings, strict=True):
        assert len(one.parts) == 8
        for part, original in zip(one.parts, other.parts, strict=True):
            assert part.rate == pytest.approx(original.rate, rel=1e-9)
            assert part.start == pytest.approx(original.start, abs=1e-9)
            np.testing.assert_allclose(part.values, original.values, rtol=1e-8)
