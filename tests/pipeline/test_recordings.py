"""Modes of recordings that nothing else is known of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from modal_records import CAR, bumps, noisy

import sprung
from sprung.errors import InputError


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
