"""A saved result comes back as it was, and one that is not as it was written is refused with the reason."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import sprung
from sprung.errors import ResultFileError
from sprung.results.checksums import arrays_checksum, document_checksum
from sprung.vehicle import TABLE_1_CAR

Document = dict[str, Any]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    campaign = sprung.simulate(TABLE_1_CAR, noise=0.02, seed=1, known={"total_mass": TABLE_1_CAR.total_mass})
    return sprung.identify(campaign, tracks="shared", extras=(), fall=False).save(tmp_path_factory.mktemp("results"))


@pytest.fixture
def copy(folder: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(folder, tmp_path / "copy"))


def change(folder: Path, by: Callable[[Document], object]) -> None:
    path = folder / "results.json"
    document = json.loads(path.read_text(encoding="utf-8"))
    by(document)
    path.write_text(json.dumps(document), encoding="utf-8")


def test_in_another_order_and_with_other_spaces_it_is_the_same(copy: Path, folder: Path) -> None:
    document = json.loads((copy / "results.json").read_text(encoding="utf-8"))
    document["parameters"] = dict(reversed(document["parameters"].items()))
    document["fit"]["samples"] = float(document["fit"]["samples"])  # as JavaScript's 1 is 1.0
    (copy / "results.json").write_text(json.dumps(dict(reversed(document.items()))), encoding="utf-8")
    assert sprung.load(copy).parameters == sprung.load(folder).parameters


def test_the_series_can_be_left_out(copy: Path) -> None:
    (copy / "series.npz").unlink()
    assert not sprung.load(copy, series=False).series
    with pytest.raises(ResultFileError, match=r"series\.npz: found no such file"):
        sprung.load(copy)


def test_a_result_that_was_written_before_these_keys_existed_is_read(copy: Path, folder: Path) -> None:
    def by(document: Document) -> None:
        for key in ("curves", "additional_terms"):
            del document[key]
        del document["setup"]["motion_ratio"]
        checksums = document.pop("checksums")
        document["checksums"] = {**checksums, "document": document_checksum(document)}

    change(copy, by)
    read = sprung.load(copy)
    assert (read.curves, read.additional_terms, read.setup.motion_ratio) == ({}, "", {})
    assert read.parameters == sprung.load(folder).parameters


def put(*path: str, value: object) -> Callable[[Document], None]:
    def by(document: Document) -> None:
        for key in path[:-1]:
            document = document[key]
        assert path[-1] in document
        document[path[-1]] = value

    return by


EDITS = {
    "newer schema": (put("schema", value=2), r"schema 2, of sprung .*Update sprung"),
    "no schema": (lambda document: document.pop("schema"), "without a schema number"),
    "another verdict": (put("verdict", "state", value="accept"), None),
    "a nicer number": (put("parameters", "k_sf", "value", value=17000.0), "changed after it was written"),
    "a smaller error bar": (put("parameters", "k_sf", "std", value=1.0), "changed after it was written"),
    "a word that is none": (put("verdict", "state", value="perfect"), r"verdict\.state"),
    "a parameter gone": (lambda document: document["parameters"].pop("k_sf"), "changed after it was written"),
    "a missing entry": (lambda document: document.pop("parameters"), "parameters: found no such entry"),
    "an unknown key": (lambda document: document.update(extra=1), "extra: found a key that no result has"),
    "no checksums": (lambda document: document.pop("checksums"), "changed after it was written"),
    "no checksums but text": (put("checksums", value="none"), "changed after it was written"),
}


@pytest.mark.parametrize("name", EDITS)
def test_an_edited_document_is_refused(copy: Path, name: str) -> None:
    by, reason = EDITS[name]
    change(copy, by)
    if reason is None:  # what stands there already is no edit
        assert sprung.load(copy).verdict.state == "accept"
        return
    with pytest.raises(ResultFileError, match=reason):
        sprung.load(copy)


def test_series_that_are_no_archive_are_named_in_plain_words(copy: Path) -> None:
    """Of a file that holds other bytes NumPy says that it can be loaded unsafely (once in the message)."""
    (copy / "series.npz").write_bytes(b"x")
    with pytest.raises(
        ResultFileError, match=r"no archive of NumPy arrays: cut off, damaged or another file"
    ) as refused:
        sprung.load(copy)
    assert not {"pickled", "unsafely"} & set(str(refused.value).split())


def test_every_reason_is_told_at_once(copy: Path) -> None:
    change(copy, put("verdict", "state", value="perfect"))
    change(copy, put("scale", "known", value="perhaps"))
    (copy / "series.npz").unlink()
    with pytest.raises(ResultFileError) as refused:
        sprung.load(copy)
    assert len(refused.value.problems) == 4  # two words, the checksum, the series


def test_a_later_release_of_the_same_schema_is_told(copy: Path) -> None:
    change(copy, lambda document: document.update(sprung="99.1.0", extra=1))
    with pytest.raises(ResultFileError, match=r"written by sprung 99\.1\.0: update sprung"):
        sprung.load(copy)


@pytest.mark.parametrize("kept", [0.0, 0.01, 0.3, 0.7, 0.999])
@pytest.mark.parametrize("file", ["results.json", "series.npz"])
def test_a_truncated_file_is_refused(copy: Path, file: str, kept: float) -> None:
    content = (copy / file).read_bytes()
    (copy / file).write_bytes(content[: int(kept * len(content))])
    with pytest.raises(ResultFileError, match=file.replace(".", r"\.")):
        sprung.load(copy)


@pytest.mark.parametrize("text", ["[]", "1", '{"schema": NaN}', "[" * 100_000, "\udcff"])
def test_what_is_no_result_is_refused(copy: Path, text: str) -> None:
    (copy / "results.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(ResultFileError, match=r"results\.json"):
        sprung.load(copy)


def test_series_of_another_result_are_refused(copy: Path) -> None:
    with np.load(copy / "series.npz") as archive:
        arrays = {name: archive[name] for name in archive.files}
    first = next(name for name in arrays if name.endswith("/measured"))
    arrays[first][0, 0] += 1e-9
    np.savez(copy / "series.npz", **arrays)
    with pytest.raises(ResultFileError, match="do not belong to this result"):
        sprung.load(copy)


def test_series_with_something_missing_are_refused(copy: Path) -> None:
    alone: dict[str, Any] = {"one/time": np.arange(3.0)}
    np.savez(copy / "series.npz", **alone)
    change(copy, put("checksums", "series", value=arrays_checksum(alone)))
    with pytest.raises(ResultFileError, match="one/body_measured, one/body_simulated, one/channels unknown or missing"):
        sprung.load(copy)


def test_one_array_is_no_series(copy: Path) -> None:
    with (copy / "series.npz").open("wb") as file:
        np.save(file, np.arange(3.0))
    with pytest.raises(ResultFileError, match=r"series\.npz"):
        sprung.load(copy)


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
@given(
    st.sampled_from(["results.json", "series.npz"]), st.floats(0, 1, exclude_max=True), st.booleans(), st.integers(0, 7)
)
@pytest.mark.slow
def test_a_changed_bit_is_refused_or_means_nothing(
    folder: Path, copy: Path, file: str, place: float, at_ends: bool, bit: int
) -> None:
    """An archive's own bookkeeping is at its ends; a bit there may mean nothing, as an upper case letter in a number does."""
    content = bytearray((folder / file).read_bytes())
    within = 1000 if at_ends else len(content)
    position = int(place * within) - within // 2 if at_ends else int(place * within)
    content[position] ^= 1 << bit
    (copy / file).write_bytes(content)
    with suppress(ResultFileError):
        assert sprung.load(copy).to_json() == sprung.load(folder).to_json()
    (copy / file).write_bytes((folder / file).read_bytes())
