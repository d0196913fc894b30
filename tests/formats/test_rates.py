"""Channels of one file at different rates: what is identified does not depend on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import sprung
from sprung.campaign import Campaign
from sprung.formats import read_table
from sprung.vehicle import TABLE_1_CAR

Real = NDArray[np.float64]
Group = tuple[float, dict[str, Real]]
"""Samples per second, and channels by their names."""


def tdms(path: Path, groups: list[Group]) -> Path:
    nptdms = pytest.importorskip("nptdms")
    path = path.with_suffix(".tdms")
    with nptdms.TdmsWriter(str(path)) as writer:
        for number, (rate, channels) in enumerate(groups):
            properties = {"wf_increment": 1 / rate, "wf_start_offset": 0.0}
            writer.write_segment(
                [
                    nptdms.ChannelObject(f"g{number}", name, values, properties=properties)
                    for name, values in channels.items()
                ]
            )
    return path


def mdf(path: Path, groups: list[Group]) -> Path:
    asammdf = pytest.importorskip("asammdf")
    path = path.with_suffix(".mf4")
    with asammdf.MDF(version="4.10") as measurement:
        for rate, channels in groups:
            signals = [
                asammdf.Signal(values, np.arange(values.size) / rate, name=name) for name, values in channels.items()
            ]
            measurement.append(signals)
        measurement.save(path, overwrite=True)
    return path


def hdf5(path: Path, groups: list[Group]) -> Path:
    h5py = pytest.importorskip("h5py")
    path = path.with_suffix(".h5")
    with h5py.File(path, "w") as file:
        for number, (rate, channels) in enumerate(groups):
            group = file.create_group(f"g{number}")
            for name, values in channels.items():
                group[name] = values
            group["time"] = np.arange(len(next(iter(channels.values())))) / rate
    return path


Write = Callable[[Path, list[Group]], Path]
WRITERS: dict[str, Write] = {"TDMS": tdms, "MDF": mdf, "HDF5": hdf5}


@pytest.fixture(scope="module")
def fast() -> Campaign:
    """Recorded at 1000 Hz, of which the tests take every second or fourth sample."""
    return sprung.simulate(TABLE_1_CAR, rate=1000, noise=0.03, seed=4, known={"total_mass": TABLE_1_CAR.total_mass})


@pytest.fixture(scope="module")
def usual(fast: Campaign) -> sprung.Result:
    """All channels at 500 Hz."""
    return sprung.identify(
        fast.with_recordings(replace(one, values=one.values[:, ::2], rate=500) for one in fast.recordings)
    )


def written(fast: Campaign, folder: Path, write: Write, other: int, every: int) -> Campaign:
    """Write one channel with every so many samples, the others with every second one; and read the campaign back."""
    path = sprung.write(fast, folder)
    text = path.read_text()
    for drop, recording in zip(fast.drops, fast.recordings, strict=True):
        rows = dict(zip(recording.channels, recording.values, strict=True))
        odd = recording.channels[other]
        groups: list[Group] = [
            (500.0, {name: values[::2] for name, values in rows.items() if name != odd}),
            (1000.0 / every, {odd: rows[odd][::every]}),
        ]
        new = write(folder / drop.label, groups)
        text = text.replace(f'"{drop.file}"', f'"{new.name}"')
    path.write_text(text)
    return sprung.read(path)


@pytest.mark.parametrize("write", WRITERS.values(), ids=WRITERS.keys())
@pytest.mark.parametrize("every", [1, 4], ids=["twice the rate", "half the rate"])
@pytest.mark.slow
def test_a_channel_at_another_rate(
    fast: Campaign, usual: sprung.Result, tmp_path: Path, write: Write, every: int
) -> None:
    wheel = next(i for i, sensor in enumerate(fast.sensors) if sensor.on == "fl")
    campaign = written(fast, tmp_path, write, wheel, every)
    assert all(recording.usable.all() and not recording.faults for recording in campaign.recordings)
    assert {recording.rate for recording in campaign.recordings} == {500.0}
    assert any("interpolated to the times of the others: " in step for step in campaign.recordings[0].history)
    exact = np.array([one.values[wheel, ::2] for one in fast.recordings])
    read = np.array([one.values[wheel] for one in campaign.recordings])
    # Once the wheel has landed for good: 0.03 m/s² of noise in both.
    late = slice(500, read.shape[1])
    assert np.sqrt(np.mean((read - exact[:, : read.shape[1]])[:, late] ** 2)) < 0.06
    share = campaign.recordings[0].rate_ratios
    assert share == () if every == 1 else share[wheel] == pytest.approx(0.5, rel=1e-6)
    result = sprung.identify(campaign)
    assert result.verdict.state == "accept", result.verdict.reasons
    assert result.fit.inflation == 1.0
    for name, truth in TABLE_1_CAR.parameters.items():
        before, after = usual.parameters[name], result.parameters[name]
        assert before.value is not None
        assert before.std is not None
        assert after.value is not None
        assert after.std is not None
        assert abs(after.value - truth) < 4 * after.std, name
        # What fewer samples tell less is what the other result may be off by; beside it, the channel has other noise.
        less = max(after.std**2 - before.std**2, 0.0) ** 0.5
        assert abs(after.value - before.value) < 0.6 * before.std + 3 * less, name
        # A slower channel costs the first samples after the last contact, which tell most.
        assert after.std < (1.05 if every == 1 else 1.7) * before.std, name


def test_too_slow_a_channel_is_spoilt_only_where_it_is_needed(tmp_path: Path) -> None:
    fast, slow = np.sin(np.arange(2000.0)), np.arange(40.0)
    table = read_table(tdms(tmp_path / "x", [(1000.0, {"z": fast}), (20.0, {"temperature": slow})]), set())
    assert table.channels == ("z", "temperature")
    assert np.isnan(table.take([1])).all()
    assert "40 samples from 0 to 1.95 s at 20 Hz" in str(table.find_non_number(1))


def test_a_gap_of_the_slower_clock_stays_one(tmp_path: Path) -> None:
    time = np.arange(500) / 250
    slow = np.sin(2 * np.pi * 3 * time)
    slow[100:110] = np.nan
    table = read_table(tdms(tmp_path / "x", [(1000.0, {"z": np.zeros(2000)}), (250.0, {"a": slow})]), set())
    [read] = table.take([1])
    there = np.isfinite(read)
    assert not there[4 * 100 : 4 * 109].any()
    np.testing.assert_allclose(read[there], np.sin(2 * np.pi * 3 * table.time[there]), atol=1e-4)
    assert there.sum() > 1900
    # Stretch by stretch it is the same.
    pieces = np.concatenate([piece for _, piece in table.pieces([1], 100)], axis=1)[0]
    np.testing.assert_allclose(pieces, read, atol=1e-9)
