"""Nothing of the user's is lost: refusals before the work, results before their decoration, an orderly end on signals."""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import NoReturn

import pytest

import sprung
from command_line import DROPS, Folder, Identified, Run, copy_sedan, run
from sprung.files.ownership import MANIFEST
from sprung.study import demo_campaign

IDENTIFY = import_module("sprung.analysis.identify")  # the function of the same name hides it


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def failing(*_: object, **__: object) -> NoReturn:
    raise ValueError("Residuals are not finite in the initial point.")


def test_the_demo_overwrites_nothing_that_was_edited(tmp_path: Path) -> None:
    """Before anything is identified, with every file named, both of the campaign and of its results."""
    sprung.write(demo_campaign(), tmp_path)
    sprung.write(demo_campaign(), tmp_path)  # untouched: written again as it is
    (tmp_path / MANIFEST).unlink()
    sprung.write(demo_campaign(), tmp_path)  # the same content, whoever wrote it
    campaign = tmp_path / "campaign.toml"
    campaign.write_text(campaign.read_text() + "# my remark\n")
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "report.html").write_text("mine")
    before = contents(tmp_path)
    said = run("demo", tmp_path)
    assert (said.status, said.out) == (2, "")
    assert "1 file that would be overwritten: campaign.toml (changed since sprung wrote it)" in said.err
    assert "1 file that would be overwritten: report.html (not written by sprung)" in said.err
    assert "--force" in said.err
    assert contents(tmp_path) == before


def test_simulate_refuses_recordings_of_the_users(vehicle_file: Path, tmp_path: Path) -> None:
    folder = tmp_path / "measured"
    folder.mkdir()
    for name in ("campaign.toml", "empty_bounce.csv"):
        (folder / name).write_text("measured on the car")
    before = contents(folder)
    said = run("simulate", vehicle_file, "-o", folder)
    assert said.status == 2
    assert "empty_bounce.csv (not written by sprung), campaign.toml (not written by sprung)" in said.err
    assert contents(folder) == before
    assert run("simulate", vehicle_file, "-o", folder, "--force").status == 0
    assert run("simulate", vehicle_file, "-o", folder, "--seed", "2").status == 0  # ours by now


@pytest.mark.parametrize("command", ["identify", "validate", "check"])
def test_edited_results_are_refused_and_nothing_else_is_touched(tmp_path: Path, command: str) -> None:
    folder = copy_sedan(tmp_path / "campaign", DROPS[:1])
    name = {"identify": "results.json", "validate": "validation.json", "check": "check.html"}[command]
    output = tmp_path / "out"
    output.mkdir()
    (output / name).write_text("mine")
    said = run(command, folder.path, "-o", output)
    assert f"{name} (not written by sprung)" in said.err
    assert said.status == (0 if command == "check" else 2)  # drawings only decorate
    assert contents(output) == {name: b"mine"}


@pytest.fixture
def one_drop_folder(tmp_path: Path) -> Folder:
    return copy_sedan(tmp_path / "campaign", DROPS[:1])


@pytest.mark.slow
def test_a_decoration_that_fails_is_named_and_costs_nothing_else(
    one_drop_folder: Folder, one_drop: Identified, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The amplitude curves, a part of the report: on the terminal, in the report and in results.json."""
    monkeypatch.setattr(IDENTIFY, "amplitudes_of", failing)
    monkeypatch.setattr("sprung.report.page.sections.spectra", failing)
    said = run("identify", one_drop_folder.path)
    why = "could not be drawn: Residuals are not finite in the initial point. (ValueError)."
    sentences = [f"The amplitude curves {why}", f'The part "Spectra" of the report {why}']
    assert said.err.splitlines() == sentences
    assert said.status == one_drop.text.status
    results = one_drop_folder.path / "results"
    document = json.loads((results / "results.json").read_text())
    assert document["omissions"] == sentences
    assert document["parameters"] == json.loads((one_drop.results / "results.json").read_text())["parameters"]
    page = (results / "report.html").read_text()
    assert f"The amplitude curves {why}" in page
    assert 'id="spectra"' not in page
    assert 'id="parameters"' in page
    assert sprung.load(results).omissions == tuple(sentences)


def test_a_report_that_fails_costs_the_report_only(
    one_drop_folder: Folder, one_drop: Identified, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sprung.report.folder.render_report", failing)
    said = run("identify", one_drop_folder.path, "--json")
    assert said.status == one_drop.json.status
    (sentence,) = said.json["omissions"]
    assert said.err == f"{sentence}\n"
    assert sentence.startswith("The report could not be written: Residuals are not finite")
    names = {path.name for path in (one_drop_folder.path / "results").iterdir()}
    assert names == {"results.json", "series.npz", MANIFEST}


def test_a_pdf_that_fails_leaves_the_report(
    one_drop: Identified, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sprung.load(one_drop.results).save(tmp_path)
    monkeypatch.setattr("sprung.report.folder.pdf_of", failing)
    said = run("report", tmp_path, "--pdf")
    assert said.status == 1  # it was asked for
    assert said.err.startswith("The report as PDF could not be written: ")
    assert (tmp_path / "report.html").exists()


@pytest.fixture(autouse=True)
def interruptible() -> Iterator[None]:
    """Let Ctrl-C act, which a shell without job control has ignored in what it runs in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def stopping(number: int) -> object:
    def stop(*_: object, **__: object) -> None:
        signal.raise_signal(number)

    return stop


@pytest.mark.skipif(os.name == "nt", reason="there, nothing else can catch these signals")
@pytest.mark.parametrize(
    ("number", "status", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
@pytest.mark.slow
def test_a_signal_after_the_fit_leaves_the_results(
    one_drop_folder: Folder, monkeypatch: pytest.MonkeyPatch, number: int, status: int, word: str
) -> None:
    monkeypatch.setattr(IDENTIFY, "amplitudes_of", stopping(number))
    said = run("identify", one_drop_folder.path)
    results = one_drop_folder.path / "results"
    assert (said.status, said.out) == (status, "")
    assert said.err.splitlines() == [
        f"The results are complete: {results / 'results.json'}, {results / 'series.npz'}",
        f"The report is missing; write it with: sprung report {results}",
        f"sprung was {word}.",
    ]
    assert {path.name for path in results.iterdir()} == {"results.json", "series.npz", MANIFEST}
    sprung.load(results)
    assert run("report", results).status == 0


@pytest.mark.skipif(os.name == "nt", reason="there, nothing else can catch these signals")
def test_a_signal_before_the_results_leaves_nothing(one_drop_folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    before = contents(one_drop_folder.path)
    monkeypatch.setattr(IDENTIFY, "analyse", stopping(signal.SIGTERM))
    assert run("identify", one_drop_folder.path) == Run(143, "", "sprung was terminated.\n")
    assert contents(one_drop_folder.path) == before
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL  # as it was outside of a command


@pytest.fixture
def ignored() -> Iterator[None]:
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.mark.usefixtures("ignored")
def test_who_wants_sigterm_ignored_gets_it_ignored(one_drop_folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sprung.campaign.file_reading.check", stopping(signal.SIGTERM))
    assert run("check", one_drop_folder.path, "--no-drawings").status == 0


@pytest.mark.skipif(os.name == "nt", reason="there, nothing else can catch these signals")
@pytest.mark.parametrize(
    ("number", "status", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
def test_a_signal_before_the_command_begins(
    monkeypatch: pytest.MonkeyPatch, number: int, status: int, word: str
) -> None:
    monkeypatch.setattr(import_module("sprung.cli.app").Commands, "parse_args", stopping(number))
    assert run("schema") == Run(status, "", f"sprung was {word}.\n")


@pytest.mark.skipif(os.name == "nt", reason="there, nothing else can catch these signals")
@pytest.mark.parametrize(
    ("number", "status", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
def test_a_signal_while_the_commands_are_imported(
    monkeypatch: pytest.MonkeyPatch, number: int, status: int, word: str
) -> None:
    class Finder:
        @staticmethod
        def find_spec(name: str, *_: object) -> None:
            if name == "sprung.cli.program":
                signal.raise_signal(number)

    monkeypatch.delitem(sys.modules, "sprung.cli.program", raising=False)
    monkeypatch.setattr(sys, "meta_path", [Finder, *sys.meta_path])
    assert run("schema") == Run(status, "", f"sprung was {word}.\n")


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there, nothing can raise it once more")
@pytest.mark.parametrize(
    ("number", "status", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
def test_a_signal_where_no_exception_can_be_passed_on(
    monkeypatch: pytest.MonkeyPatch, number: int, status: int, word: str
) -> None:
    """As in a callback of Python's import system: the exception is lost there, and the program must stop all the same."""

    class Callback:
        def __del__(self) -> None:
            signal.raise_signal(number)

    def work() -> str:
        Callback()
        time.sleep(5.0)
        return "{}"

    monkeypatch.setattr("sprung.cli.studies.sprung.schema_text", work)
    assert run("schema") == Run(status, "", f"sprung was {word}.\n")
