"""A drop's own name: shown in place of its recording's, unlike every other, written and read back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import sprung
from command_line import Folder, copy_sedan, run
from sprung.errors import InputError

DROPS = ("empty_bounce", "empty_pitch_front")


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    copied = copy_sedan(tmp_path / "campaign", DROPS)
    return copied.edit('file = "empty_bounce.csv"', 'file = "empty_bounce.csv"\nname = "bounce, 2nd try"')


def test_the_name_stands_wherever_the_recording_stood(folder: Folder) -> None:
    campaign = sprung.read(folder.path)
    assert [drop.label for drop in campaign.drops] == ["bounce, 2nd try", "empty_pitch_front"]
    assert [recording.name for recording in campaign.recordings] == ["bounce, 2nd try", "empty_pitch_front.csv"]
    said = run("check", "--no-drawings", folder.path)
    assert said.status == 0
    assert "bounce, 2nd try" in said.out
    assert "empty_bounce" not in said.out
    document = run("check", "--no-drawings", "--json", folder.path).json
    assert [(drop["name"], drop["file"]) for drop in document["drops"]] == [
        ("bounce, 2nd try", "empty_bounce.csv"),
        ("empty_pitch_front", "empty_pitch_front.csv"),
    ]


def test_the_name_is_written_and_read_back(folder: Folder, tmp_path: Path) -> None:
    campaign = sprung.read(folder.path)
    again = sprung.read(sprung.write(campaign, tmp_path / "again"))
    assert again.drops == campaign.drops
    assert 'name   = "bounce, 2nd try"' in (tmp_path / "again" / "campaign.toml").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_drop_with_a_name_is_fitted_like_any_other(folder: Folder) -> None:
    named = sprung.read(folder.path)
    plain = replace(
        named,
        drops=tuple(
            replace(drop, name=None, recording=replace(drop.recording, name=str(drop.file))) for drop in named.drops
        ),
    )
    results = [sprung.identify(campaign) for campaign in (named, plain)]
    assert results[0].parameters == results[1].parameters
    assert list(results[0].series) == ["bounce, 2nd try", "empty_pitch_front"]
    assert [drop.name for drop in results[0].drops] == list(results[0].series)
    assert [drop.file for drop in results[0].drops] == [drop.file for drop in results[1].drops]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "bounce, 2nd try",
            "found 'bounce, 2nd try', which drop[1] has too; expected a name of its own for every drop",
        ),
        ("a/b", "drop's name is printable text without / and"),
        ("", "name"),
    ],
)
def test_names_that_cannot_be(folder: Folder, name: str, words: str) -> None:
    folder.edit('file = "empty_pitch_front.csv"', f'file = "empty_pitch_front.csv"\nname = "{name}"')
    with pytest.raises(InputError, match=r"campaign\.toml: drop") as caught:
        sprung.read(folder.path)
    assert words in str(caught.value)


def test_simulated_drops_take_names() -> None:
    drops: list[dict[str, object]] = [{"name": "first", "wheels": ["fl", "fr"]}, {"wheels": ["rl", "rr"]}]
    campaign = sprung.simulate(sprung.Vehicle.from_parameters(_PARAMETERS), drops=drops)
    assert [recording.name for recording in campaign.recordings] == ["first", "empty_pitch_rear.csv"]
    with pytest.raises(InputError, match="'first' 2 times"):
        sprung.simulate(sprung.Vehicle.from_parameters(_PARAMETERS), drops=[drops[0], drops[0]])


_PARAMETERS = {
    "m_s": 1380.0,
    "I_yy": 2444.0,
    "I_xx": 380.0,
    "m_uf": 40.5,
    "m_ur": 45.4,
    "k_sf": 17000.0,
    "k_sr": 22000.0,
    "k_tf": 192000.0,
    "k_tr": 192000.0,
    "c_sf": 1500.0,
    "c_sr": 1500.0,
    "a": 1.25,
    "b": 1.51,
    "t_f": 0.74,
    "t_r": 0.74,
}
