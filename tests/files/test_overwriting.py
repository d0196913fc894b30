"""Nothing that sprung did not write is overwritten, and whatever stops a write leaves old files, new files or none."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sprung.errors import InputError
from sprung.files import atomic_write, overwriting_problems
from sprung.files.ownership import MANIFEST, checksum
from sprung.files.recovery import JOURNAL, temporary_path

OLD = {"series.npz": b"old", "results.json": b"old"}
NEW = {"series.npz": b"new", "results.json": b"new", "sub/more.svg": b"new"}
PDF = "report.pdf"


def contents(folder: Path) -> dict[str, bytes]:
    """Every file but the list of checksums, hidden ones included."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != MANIFEST)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


@pytest.mark.skipif(
    not Path("/proc").is_dir(), reason="there is no file system that refuses files in spite of its permissions"
)
def test_a_place_that_takes_no_files_is_named_before_anything_is_written() -> None:
    (problem,) = overwriting_problems(Path("/proc/results"), ())
    assert "a place that cannot be written to" in problem.found


def test_own_files_are_replaced_and_others_are_refused_by_name(tmp_path: Path) -> None:
    atomic_write(tmp_path, OLD)
    atomic_write(tmp_path, NEW)  # ours, as we wrote them
    (tmp_path / "results.json").write_bytes(b"edited")
    (tmp_path / "notes.txt").write_bytes(b"the user's")
    before = contents(tmp_path)
    with pytest.raises(InputError) as error:
        atomic_write(tmp_path, {**NEW, "notes.txt": b"ours"})
    said = str(error.value)
    assert "2 files that would be overwritten" in said
    assert "results.json (changed since sprung wrote it)" in said
    assert "notes.txt (not written by sprung)" in said
    assert "series.npz" not in said
    assert "--force" in said
    assert "overwrite=True" in said
    assert contents(tmp_path) == before
    atomic_write(tmp_path, {**NEW, "notes.txt": b"ours"}, overwrite=True)
    assert contents(tmp_path) == {**NEW, "notes.txt": b"ours"}
    atomic_write(tmp_path, {"notes.txt": b"ours again"})  # what was insisted on once is ours from then on


def test_the_same_content_overwrites_nothing(tmp_path: Path) -> None:
    (tmp_path / "campaign.toml").write_bytes(b"same")
    atomic_write(tmp_path, {"campaign.toml": b"same"})
    assert contents(tmp_path) == {"campaign.toml": b"same"}


def test_names_alone_can_be_asked_for_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "results.json").write_bytes(b"the user's")
    assert not list(overwriting_problems(tmp_path / "none yet", ["results.json"]))
    (problem,) = overwriting_problems(tmp_path, ["series.npz", "results.json"])
    assert "1 file that would be overwritten: results.json (not written by sprung)" in problem.found
    (problem,) = overwriting_problems(tmp_path / "results.json" / "deeper", ["results.json"])
    assert problem.found == "a file where the folder should be"


@pytest.mark.parametrize("listed", ["", "{", "[]", '{"files": 3}', '{"files": {"results.json": 3}}'])
def test_a_damaged_list_makes_every_file_the_users(tmp_path: Path, listed: str) -> None:
    atomic_write(tmp_path, OLD)
    (tmp_path / MANIFEST).write_text(listed)
    with pytest.raises(InputError, match="not written by sprung"):
        atomic_write(tmp_path, NEW)
    assert contents(tmp_path) == OLD


def test_obsolete_files_of_ours_go_and_those_of_others_stay(tmp_path: Path) -> None:
    atomic_write(tmp_path / "ours", {**OLD, PDF: b"of the old result"})
    atomic_write(tmp_path / "ours", NEW, obsolete=[PDF])
    assert contents(tmp_path / "ours") == NEW
    assert PDF not in json.loads((tmp_path / "ours" / MANIFEST).read_text())["files"]
    (tmp_path / "others").mkdir()
    (tmp_path / "others" / PDF).write_bytes(b"printed by the user")
    atomic_write(tmp_path / "others", NEW, obsolete=[PDF])
    assert contents(tmp_path / "others") == {**NEW, PDF: b"printed by the user"}


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[int, BaseException], None]:
    """Raise an error at the given step of a write, of all that touch the disk."""

    def arrange(at: int, trouble: BaseException) -> None:
        calls = iter(range(1000))

        def counted(original: Callable[..., Any]) -> Callable[..., Any]:
            def call(*arguments: Any) -> Any:
                if next(calls) == at:
                    raise trouble
                return original(*arguments)

            return call

        monkeypatch.setattr(os, "fsync", counted(lambda _: None))
        monkeypatch.setattr(Path, "replace", counted(Path.replace))

    return arrange


@pytest.mark.parametrize("trouble", [OSError(28, "No space left on device"), KeyboardInterrupt()])
# Two names and contents each way: 3 prepared, journal (2), old aside (3 with the PDF), new in place (3), list (2).
@pytest.mark.parametrize("at", range(13))
def test_an_error_at_any_step_leaves_the_folder_as_it_was(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    failing: Callable[[int, BaseException], None],
    trouble: BaseException,
    at: int,
) -> None:
    atomic_write(tmp_path, {**OLD, PDF: b"of the old result"})
    failing(at, trouble)
    with pytest.raises(InputError if isinstance(trouble, OSError) else KeyboardInterrupt):
        atomic_write(tmp_path, NEW, obsolete=[PDF])
    monkeypatch.undo()
    assert contents(tmp_path) == {**OLD, PDF: b"of the old result"}
    assert not (tmp_path / "sub").exists()
    atomic_write(tmp_path, NEW)  # the list is as it was too


DYING = """
import os, pathlib, sys
from sprung.files import atomic_write
old, new = {old!r}, {new!r}
root = pathlib.Path(sys.argv[1])
for moment in range({moments}):
    folder = root / str(moment)
    folder.mkdir()
    (folder / "mine.txt").write_bytes(b"the user's")
    if moment % 2:
        atomic_write(folder, old)
    child = os.fork()
    if child == 0:
        left = [moment // 2]
        def dying(original):
            def call(*arguments, **options):
                left[0] -= 1
                if left[0] < 0:
                    os._exit(9)
                return original(*arguments, **options)
            return call
        os.fsync = dying(os.fsync)
        pathlib.Path.replace = dying(pathlib.Path.replace)
        pathlib.Path.unlink = dying(pathlib.Path.unlink)
        atomic_write(folder, new)
        os._exit(0)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are killed in the middle of a write")
@pytest.mark.slow
def test_a_process_killed_at_any_step_leaves_old_new_or_none_and_the_next_puts_it_in_order(tmp_path: Path) -> None:
    """Without any clearing up, at every step that touches the disk, into an empty folder and over older files."""
    moments = 50
    program = DYING.format(old=OLD, new=NEW, moments=moments)
    done = subprocess.run([sys.executable, "-c", program, str(tmp_path)], capture_output=True, text=True, check=True)  # noqa: S603
    statuses = done.stdout.split()
    assert set(statuses) == {"9", "0"}  # the last ones outlive the write: every step was met
    for moment in range(moments):
        folder = tmp_path / str(moment)
        there = {name: content for name, content in contents(folder).items() if not name.startswith(".")}
        assert there.pop("mine.txt") == b"the user's"
        if "results.json" in there:
            assert {name: there[name] for name in OLD} in (OLD, {name: NEW[name] for name in OLD})
        atomic_write(folder, {"sub/other.svg": b"newest", "results.json": b"newest"})
        after = contents(folder)
        assert after.pop("sub/other.svg") == b"newest"
        assert after.pop("mine.txt") == b"the user's"
        assert after.pop("results.json") == b"newest"
        assert after in ({}, {"series.npz": b"old"}, {name: b"new" for name in NEW if name != "results.json"})


def leave(folder: Path, new: dict[str, bytes], before: dict[str, str]) -> None:
    """Leave what a process that is gone left after its journal was written."""
    token = f"{2**22 + 1:x}-00000000-00000000"  # a number that no process of Linux has
    for name, content in new.items():
        temporary_path(folder / name, token, "new").write_bytes(content)
    sums = {name: checksum(content) for name, content in new.items()}
    (folder / JOURNAL.format(token=token)).write_text(json.dumps({"files": sums, "before": before}))


@pytest.mark.skipif(os.name == "nt", reason="there, a process that is gone is told by the age of its files")
def test_a_file_that_the_user_made_after_a_kill_is_not_replaced_by_the_recovery(tmp_path: Path) -> None:
    leave(tmp_path, {"campaign.toml": b"ours", "a.csv": b"ours"}, {})
    (tmp_path / "campaign.toml").write_bytes(b"written anew by the user")
    atomic_write(tmp_path, {"b.csv": b"ours"})
    assert contents(tmp_path) == {"campaign.toml": b"written anew by the user", "a.csv": b"ours", "b.csv": b"ours"}
    with pytest.raises(InputError, match=r"campaign\.toml \(not written by sprung\)"):
        atomic_write(tmp_path, {"campaign.toml": b"ours"})


def test_files_of_a_process_that_runs_are_left_alone(tmp_path: Path) -> None:
    token = f"{os.getppid():x}-00000000-00000000"
    other = temporary_path(tmp_path / "a.csv", token, "new")
    other.write_bytes(b"being written")
    atomic_write(tmp_path, {"b.csv": b"ours"})
    assert other.read_bytes() == b"being written"


@pytest.fixture
def terminated() -> Iterator[list[int]]:
    """Let SIGTERM raise as in the commands."""
    got: list[int] = []

    def stop(number: int, _: object) -> None:
        got.append(number)
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    yield got
    signal.signal(signal.SIGTERM, before)


def test_a_signal_while_files_change_their_names_waits_until_they_have(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, terminated: list[int]
) -> None:
    atomic_write(tmp_path, OLD)
    original = Path.replace

    def signalled(path: Path, target: Path) -> Path:
        signal.raise_signal(signal.SIGTERM)
        return original(path, target)

    monkeypatch.setattr(Path, "replace", signalled)
    with pytest.raises(KeyboardInterrupt):
        atomic_write(tmp_path, NEW)
    assert terminated == [signal.SIGTERM]
    assert contents(tmp_path) == NEW
