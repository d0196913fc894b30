from __future__ import annotations

import os
from importlib.metadata import EntryPoint
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np
import pytest
from every_format import WAYS, Signals

from sprung.errors import InputError
from sprung.formats import SampleTable, formats, read_table, registry
from sprung.formats.sample_store import store_in_memory

if TYPE_CHECKING:
    from pathlib import Path

OWN = {"csv", "excel", "hdf5", "iso_mme", "lvm", "mat", "mdf", "parquet", "rpc", "tdms", "uff", "wav"}


class Greedy:
    """A format that claims everything."""

    def claims(self, path: Path, head: bytes) -> bool:
        return bool(path.name and head)

    def read(self, path: Path) -> SampleTable:
        return SampleTable((path.stem,), (None,), store_in_memory(np.zeros((1, 4))), clock=2.0)


class GreedyEntry:
    name = "greedy"

    @staticmethod
    def load() -> type[Greedy]:
        return Greedy


def installed(monkeypatch: pytest.MonkeyPatch, *entries: object) -> None:
    monkeypatch.setattr(registry, "entry_points", lambda *, group: entries if group == "sprung.formats" else ())


def test_the_formats_of_this_package(monkeypatch: pytest.MonkeyPatch) -> None:
    installed(monkeypatch)
    assert {*formats()} == OWN


@pytest.mark.skipif(not all(find_spec(way.needs) for way in WAYS.values() if way.needs), reason="needs every library")
def test_a_campaign_is_identified_in_every_format(tmp_path: Path) -> None:
    """Every format is among the ways of the study; workbooks are written by hand in their own test."""
    signals = Signals(("a", "b"), np.random.default_rng(0).standard_normal((2, 400)), 400.0)
    written = [way.write(signals, tmp_path / f"{number}") for number, way in enumerate(WAYS.values())]
    heads = {path: path.read_bytes()[: registry.HEAD] for path in written}
    claimed = {name for name, one in formats().items() if any(one.claims(*each) for each in heads.items())}
    assert claimed == OWN - {"excel"}


def test_an_empty_file_of_no_format_is_called_empty(tmp_path: Path) -> None:
    (tmp_path / "a.bin").touch()
    with pytest.raises(InputError, match="found an empty file"):
        read_table(tmp_path / "a.bin")


def test_a_format_that_another_package_registers_again_counts_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    entry = EntryPoint("csv", "sprung.formats.csv:CsvFormat", "sprung.formats")
    installed(monkeypatch, entry, entry)
    (tmp_path / "a.csv").write_text("time,a\n0,1\n1,2\n")
    assert read_table(tmp_path / "a.csv").channels == ("a",)


def test_two_claims_are_an_error_naming_both(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    installed(monkeypatch, GreedyEntry())
    (tmp_path / "a.csv").write_text("time,a\n0,1\n1,2\n")
    with pytest.raises(InputError, match="2 formats claim: csv, greedy"):
        read_table(tmp_path / "a.csv")


def test_the_one_that_claims_reads(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    installed(monkeypatch, GreedyEntry())
    (tmp_path / "a.bin").write_bytes(b"\0")
    table = read_table(tmp_path / "a.bin")
    assert table.time.tolist() == [0, 0.5, 1, 1.5]  # 2 samples per second from 0
    assert table.place(1) == "sample 2"


def test_no_claim_names_the_known_formats(tmp_path: Path) -> None:
    (tmp_path / "a.bin").write_bytes(b"\0")
    with pytest.raises(InputError, match="no known format; expected exactly one of the known formats: csv"):
        read_table(tmp_path / "a.bin")


@pytest.mark.skipif(os.name == "nt", reason="there, every name can be written")
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("\ud800.csv", "a name in the encoding of file names, utf-8. Set the environment variable"),
        ("a\0.csv", "null byte"),
    ],
)
def test_a_name_that_no_file_can_have_is_a_fault_of_the_input(tmp_path: Path, name: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_table(tmp_path / name)
