"""Modes of recordings that nothing else is known of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from modal_records import CAR, bumps, noisy

import sprung
from sprung.errors import InputError
from sprung.modal import identify_modes
from sprung.vehicle import TABLE_1_CAR, Vehicle
from sprung.vibration import compute_modes

LIVELY = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"c_sf": 700.0, "c_sr": 700.0}, name="lively")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for i, record in enumerate(noisy(bumps(rate=250.0), 40.0, 2)):
        time = np.arange(record.shape[1]) / 250.0
        head = ",".join(["time", *(f"a{k}" for k in range(7))])
        np.savetxt(
            tmp_path / f"drop{i}.csv", np.column_stack([time, record.T]), delimiter=",", header=head, comments=""
        )
    return tmp_path


def test_a_folder_of_tables_gives_the_modes(folder: Path) -> None:
    assert sprung.is_recordings(folder)
    found = sprung.modes(folder)["recordings"]
    assert [mode.name for mode in found] == [f"mode {i}" for i in range(1, 8)]
    assert found.drops == ("drop0", "drop1", "drop2", "drop3")
    for mode in found:
        nearest = min(abs(complex(*mode.pole) - true.pole) for true in CAR)
        assert nearest < 0.01 * mode.frequency * 2 * np.pi


def test_one_file_will_do_and_begins_where_it_is_told(folder: Path) -> None:
    whole = sprung.modes(folder / "drop0.csv", start=0.0)["recordings"]
    later = sprung.modes(folder / "drop0.csv", start=0.5)["recordings"]
    assert whole[0].frequency == pytest.approx(later[0].frequency, rel=0.02)
    assert whole[0].frequency_std is not None
    assert later[0].frequency_std is not None
    assert later[0].frequency_std > whole[0].frequency_std


@pytest.mark.parametrize("start", [-1.0, 100.0, np.nan])
def test_a_start_outside_of_the_recordings_is_refused(folder: Path, start: float) -> None:
    with pytest.raises(InputError, match=r"drop0\.csv: start: found .* s; expected a time of this recording, 0 to"):
        sprung.modes(folder, start=start)
    with pytest.raises(InputError, match="modes: start: found"):
        sprung.modes(np.zeros((2, 100)), rate=100.0, start=start)


def test_a_campaign_is_none(folder: Path) -> None:
    (folder / "campaign.toml").write_text("schema = 1\n")
    assert not sprung.is_recordings(folder)
    assert not sprung.is_recordings(folder / "campaign.toml")


def test_what_does_not_go_together_is_refused_at_once(folder: Path) -> None:
    (folder / "other.csv").write_text("time,a0\n" + "".join(f"{i / 100},{i % 3}\n" for i in range(50)))
    with pytest.raises(InputError) as caught:
        sprung.modes(folder)
    said = str(caught.value)
    assert "1 channels that all 5 files have" in said
    assert "other.csv 100 Hz" in said


@pytest.fixture(scope="module")
def lively(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One high bounce of a car with weak dampers, whose wheels hop again, in a file that nothing is known of."""
    folder = tmp_path_factory.mktemp("lively")
    bounce = [{"wheels": ["fl", "fr", "rl", "rr"], "height": 0.1}]
    sprung.write(sprung.simulate(LIVELY, drops=bounce, noise=0.02, seed=1), folder)
    [file] = folder.glob("*.csv")
    return file


def test_a_recording_of_a_drop_is_used_after_its_landing(lively: Path) -> None:
    """From its largest reading on, with tyres off the ground, twenty modes came out, sixteen of which the car does not have."""
    found = sprung.modes(lively, amplitude=True)["recordings"]
    truth = [mode.frequency for mode in compute_modes(LIVELY.matrices())]
    for mode in found:
        assert mode.frequency_std is not None
        # Two modes of unlike axles that lie within 2 % may appear as one.
        assert min(abs(mode.frequency / one - 1) for one in truth) < 0.02 + 3 * mode.frequency_std / mode.frequency
    assert min(abs(mode.frequency / truth[0] - 1) for mode in found) < 0.005  # body bounce
    assert all(row[1] < 0.9 * 250 for mode in found for row in mode.amplitudes)


def test_a_recording_in_g_without_a_unit_has_its_drop_too(lively: Path, tmp_path: Path) -> None:
    head, *rows = lively.read_text(encoding="utf-8").splitlines()
    cells = np.array([row.split(",") for row in rows], dtype=float)
    cells[:, 1:] /= 9.80665
    names = ["time", *(f"ch{i}" for i in range(cells.shape[1] - 1))]
    assert len(names) == len(head.split(","))
    np.savetxt(tmp_path / "one.csv", cells, delimiter=",", header=",".join(names), comments="")
    one = sprung.modes(tmp_path / "one.csv")["recordings"]
    other = sprung.modes(lively)["recordings"]
    assert [mode.frequency for mode in one] == pytest.approx([mode.frequency for mode in other], rel=1e-3)


def test_nothing_is_reported_next_to_half_the_sampling_rate() -> None:
    rate, time = 500.0, np.arange(1000) / 500.0
    noise = 1e-3 * np.random.default_rng(1).standard_normal((2, time.size))
    slow = np.exp(-3 * time) * np.cos(2 * np.pi * 5 * time)
    fast = 0.5 * np.exp(-3 * time) * np.cos(2 * np.pi * 245 * time)
    found = identify_modes([np.array([[1.0, 1.0], [0.6, -0.8]]) @ [slow, fast] + noise], rate)
    assert [mode.frequency for mode in found] == pytest.approx([5.02], rel=0.01)  # |λ| = √(3² + (2π 5)²)
    assert any("sampling rate" in one.reason for one in found.rejected)
