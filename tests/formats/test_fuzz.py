"""Any file at all gives a result or a refusal in words; `python docs/studies/fuzz.py` looks for longer, and guided."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from damage import spoilt
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from readers import READERS, SMALL, Broken, Reader, sound_files, tried, used

from sprung.errors import InputError, Problem
from sprung.formats import SampleTable
from sprung.formats.sample_store import store_in_memory

if TYPE_CHECKING:
    from collections.abc import Iterator
    from random import Random

STUDIES = Path(__file__).resolve().parents[2] / "docs" / "studies"
HERE = [name for name, reader in READERS.items() if not reader.apart]

# Damaged files are not closed by some libraries before they are forgotten.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")


@pytest.fixture(autouse=True)
def traced() -> Iterator[None]:
    tracemalloc.start()
    yield
    tracemalloc.stop()


def reader_of(name: str) -> Reader:
    for needed in READERS[name].needs:
        pytest.importorskip(needed)
    return READERS[name]


@pytest.mark.parametrize("name", READERS)
def test_sound_files_are_read(tmp_path: Path, name: str) -> None:
    reader = reader_of(name)
    files = sound_files(reader)
    read = [tried(reader, tmp_path, data) for data in files]
    assert any(read) if name == "sep005" else all(read)


@pytest.mark.parametrize("name", HERE)
@pytest.mark.slow
def test_any_file_is_read_or_refused_in_words(tmp_path: Path, name: str) -> None:
    reader = reader_of(name)
    files = sound_files(reader)

    @settings(max_examples=settings().max_examples // 2, deadline=None, suppress_health_check=[HealthCheck.too_slow])
    @given(random=st.randoms(use_true_random=True))
    def any_file(random: Random) -> None:
        tried(reader, tmp_path, spoilt(files, random))

    any_file()


@pytest.mark.long
def test_damage_may_end_only_the_process_of_its_own(tmp_path: Path) -> None:
    names = [name for name, reader in READERS.items() if reader.apart and not reader.missing]
    if not names:
        pytest.skip("needs h5py")
    command = [sys.executable, str(STUDIES / "fuzz.py"), "--minutes", f"{len(names) / 60}", "--folder", str(tmp_path)]
    done = subprocess.run([*command, "--readers", *names], capture_output=True, text=True, timeout=120, check=False)  # noqa: S603
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [line.split() for line in done.stdout.splitlines()[2:-1]]
    assert [row[0] for row in rows] == names
    assert all(int(row[1]) >= 1 and int(row[4]) == 0 for row in rows)


def refusing(*problems: Problem) -> Reader:
    def use(_: Path) -> None:
        raise InputError(problems)

    return Reader(lambda _: [b""], "x.csv", use=use)


SOUND = Problem("x.csv: line 3", "'x'", "a number", "Correct it.")


@pytest.mark.parametrize(
    ("reader", "message"),
    [
        (Reader(lambda _: [b""], "x", use=lambda _: 1 / 0), "ZeroDivisionError"),
        (Reader(lambda _: [b""], "x", use=lambda _: np.float64(1e300) * 1e300), "RuntimeWarning"),
        (Reader(lambda _: [b""], "x", use=lambda _: np.zeros(8_000_000)), "64 MB for a file of 1 bytes"),
        (refusing(), "without a reason"),
        (refusing(Problem("line 3", "'x'", "a number", "Correct it.")), "does not name the file"),
        (refusing(SOUND, Problem("x.csv", "'x'", "a number", "Correct it")), "does not say what to do"),
        (refusing(Problem("x.csv", "'x'" * 999, "a number", "Correct it.")), "a refusal of 3"),
        (Reader(lambda _: [b""], "x", use=lambda _: used(lying(units=()), "x")), "0 units of 2 channels"),
        (Reader(lambda _: [b""], "x", use=lambda _: used(lying(clock=np.zeros(3)), "x")), "40 samples"),
    ],
)
def test_what_is_broken_is_seen(tmp_path: Path, reader: Reader, message: str) -> None:
    with pytest.raises(Broken, match=message):
        tried(reader, tmp_path, b"x")


def lying(**changes: Any) -> SampleTable:
    return replace(SampleTable(SMALL.names, ("g", "g"), store_in_memory(SMALL.values), 500.0), **changes)


def test_a_sound_refusal_is_none_of_it(tmp_path: Path) -> None:
    assert not tried(refusing(SOUND), tmp_path, b"x")
    used(lying(), "x")


def test_a_reader_that_does_not_come_back_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("readers.LONGEST", 0.05)

    def forever(_: Path) -> None:
        while True:
            pass

    with pytest.raises(Broken, match=r"not read within 0\.05 s"):
        tried(Reader(lambda _: [b""], "x", use=forever), tmp_path, b"x")
