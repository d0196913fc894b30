"""How the command line behaves on terminals, in pipes, in odd folders, when it is interrupted and when it is broken."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NoReturn

import pytest
from rich.console import Console

import sprung
from command_line import DROPS, Folder, Identified, copy_sedan, run
from sprung.report import result_view, text_of

ESCAPE = "\x1b["


def process(*arguments: str | Path, **environment: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(  # noqa: S603 (our own interpreter)
        [sys.executable, "-m", "sprung", *arguments],
        capture_output=True,
        env={**os.environ, "COLUMNS": "80", **environment},
        check=False,
        timeout=60,
    )


def numbers(text: str) -> set[str]:
    return set(re.findall(r"\d+\.\d+", text))


@pytest.mark.parametrize("columns", [20, 40, 60, 80, 100, 120, 200])
@pytest.mark.slow
def test_no_width_cuts_a_word_or_a_number(folder: Folder, one_drop: Identified, columns: int) -> None:
    wide = run("check", "--no-drawings", folder.path, columns=300)
    narrow = run("check", "--no-drawings", folder.path, columns=columns)
    starts = {f"{drop['start']:.3f}" for drop in run("check", "--no-drawings", folder.path, "--json").json["drops"]}
    assert starts <= numbers(narrow.out) <= numbers(wide.out)
    result = sprung.load(one_drop.results)
    shown = text_of(result_view(result), console_of(columns))
    assert "…" not in shown
    full = text_of(result_view(result), console_of(300))
    for line in full.split("\n\n", maxsplit=1)[0].splitlines()[2:]:
        name, value, *_ = line.split()
        assert name in shown
        assert value in shown
    if columns >= 80:
        assert max(map(len, shown.splitlines())) <= columns
    assert not any(line != line.rstrip() for line in shown.splitlines())


def console_of(columns: int) -> Console:
    return Console(width=columns, highlight=False, color_system=None)


def test_a_wide_terminal_says_what_a_parameter_means(one_drop: Identified) -> None:
    result = sprung.load(one_drop.results)
    wide, narrow = (text_of(result_view(result), console_of(columns)) for columns in (120, 80))
    said = "spring rate, each front wheel"
    assert [line.split()[0] for line in wide.splitlines() if said in line] == ["k_sf"]
    # On a narrow one in a table of its own below the numbers.
    assert [line.split() for line in narrow.splitlines() if said in line] == [["k_sf", *said.split()]]


@pytest.mark.long
@pytest.mark.slow
def test_long_reasons_hang_below_their_dash(leafbus: Identified) -> None:
    _, _, verdict = leafbus.text.out.partition("Verdict: ")
    reasons = verdict.split("\n\n", maxsplit=1)[0].splitlines()[1:]
    assert reasons[0].startswith("  - ")
    assert reasons[1].startswith("    ")
    assert all(line.startswith(("  - ", "    ")) for line in reasons)


@pytest.mark.slow
def test_colours_only_where_they_are_wanted(folder: Folder) -> None:
    quick = ("identify", folder.path, "--no-report")
    assert ESCAPE not in run(*quick).out
    coloured = run(*quick, FORCE_COLOR="1", TERM="xterm-256color")
    assert f"{ESCAPE}1;32maccept" in coloured.out
    plain = run(*quick, FORCE_COLOR="1", TERM="xterm-256color", NO_COLOR="1")
    assert "32m" not in plain.out


def test_json_is_json_even_where_colours_are_forced(folder: Folder) -> None:
    assert run("check", "--no-drawings", folder.path, "--json", FORCE_COLOR="1").json["faults"] == []


@pytest.mark.slow
def test_progress_stays_off_captured_streams(folder: Folder) -> None:
    for command in (("identify", "--no-report"), ("check", "--no-drawings"), ("modal",)):
        assert run(*command, folder.path).err == ""


@pytest.mark.parametrize("name", ["with spaces", "Prüfstand Ölwanne 試験", "percent%d {brace} [bold]"])
@pytest.mark.slow
def test_names_of_every_kind(tmp_path: Path, name: str) -> None:
    folder = copy_sedan(tmp_path / name)
    folder.edit('name = "sedan"\n', "").edit('"empty_bounce.csv"', f'"{name}.csv"')
    (folder.path / "empty_bounce.csv").rename(folder.path / f"{name}.csv")
    assert run("check", "--no-drawings", folder.path, "--json").json["drops"][0]["file"] == f"{name}.csv"
    assert f"{name}.csv" in run("check", "--no-drawings", folder.path, columns=120).out
    assert f"{name}: parameters" in run("identify", folder.path, "--no-report", columns=120).out
    assert json.loads((folder.path / "results" / "results.json").read_text("utf-8"))["vehicle"]["name"] == name


@pytest.mark.skipif(sys.platform != "linux", reason="other systems refuse such names")
@pytest.mark.slow
def test_a_folder_whose_name_is_no_text(tmp_path: Path) -> None:
    folder = copy_sedan(tmp_path / os.fsdecode(b"caf\xe9"), DROPS[:1])
    folder.edit('name = "sedan"\n', "")
    done = process("identify", folder.path, "--json", "--no-report")
    assert done.returncode == 0
    assert json.loads(done.stdout)["vehicle"]["name"] == "caf?"


@pytest.mark.slow
def test_relative_paths_from_anywhere(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    absolute = run("check", folder.path / "campaign.toml", "--json", "--no-drawings")
    monkeypatch.chdir(folder.path)
    for path in ("campaign.toml", ".", "./campaign.toml", "../campaign"):
        assert run("check", path, "--json", "--no-drawings") == absolute
    assert run("identify", "campaign.toml", "--no-report").status == 0
    assert (folder.path / "results" / "results.json").exists()
    monkeypatch.chdir(folder.path.parent)
    assert run("identify", "campaign", "-o", "elsewhere", "--no-report").status == 0
    assert (folder.path.parent / "elsewhere" / "series.npz").exists()


def test_the_name_of_the_folder_names_the_vehicle(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.edit('name = "sedan"\n', "")
    monkeypatch.chdir(folder.path)
    assert run("identify", ".", "--json", "--no-report").json["vehicle"]["name"] == "campaign"


def raising(error: BaseException) -> object:
    def fail(*_: object, **__: object) -> NoReturn:
        raise error

    return fail


@pytest.mark.parametrize("options", [(), ("--json",)])
def test_ctrl_c(folder: Folder, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...]) -> None:
    before = folder.listing()
    monkeypatch.setattr(sprung.analysis, "identify_campaign", raising(KeyboardInterrupt()))
    said = run("identify", folder.path, *options)
    assert (said.status, said.out, said.err) == (130, "", "sprung was interrupted.\n")
    assert folder.listing() == before


@pytest.mark.parametrize("error", [RuntimeError("boom"), IndexError(), OSError(5, "disk on fire")])
def test_a_defect_of_ours_asks_for_a_report(folder: Folder, monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    before = folder.listing()
    monkeypatch.setattr(sprung.analysis, "identify_campaign", raising(error))
    said = run("identify", folder.path, "--json")
    assert (said.status, said.out) == (1, "")
    assert "defect of sprung, not of your input" in said.err
    assert "Please report it" in said.err
    assert type(error).__name__ in said.err
    assert "Traceback" in said.err  # which the report needs
    assert folder.listing() == before


def test_too_little_memory_is_said_with_what_to_do(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    before = folder.listing()
    monkeypatch.setattr(sprung.analysis, "identify_campaign", raising(MemoryError()))
    said = run("identify", folder.path, "--json")
    assert (said.status, said.out) == (2, "")
    assert "not enough memory for this input" in " ".join(said.err.split())
    assert "Traceback" not in said.err
    assert folder.listing() == before


@pytest.mark.skipif(os.name == "nt", reason="there, file names are in Unicode whatever the locale")
@pytest.mark.parametrize("command", ["identify", "check"])
@pytest.mark.slow
def test_a_recording_whose_name_the_locale_cannot_write(folder: Folder, command: str) -> None:
    folder.edit('"empty_bounce.csv"', '"Leer Hüpfen 日本.csv"')
    said = process(command, folder.path, LC_ALL="C", PYTHONUTF8="0")
    text = " ".join((said.stdout + said.stderr).decode("ascii").split())
    assert "Traceback" not in text
    assert "a name in the encoding of file names" in text
    assert "PYTHONUTF8=1" in text


@pytest.mark.slow
def test_a_pipe_that_closes(folder: Folder) -> None:
    command = [sys.executable, "-m", "sprung", "identify", "--no-report", str(folder.path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:  # noqa: S603
        assert running.stdout is not None
        assert running.stderr is not None
        running.stdout.close()
        complaint = running.stderr.read()
    assert (running.returncode, complaint) == (0, b"")
    assert (folder.path / "results" / "results.json").exists()


@pytest.mark.long
def test_a_terminal_that_knows_only_ascii(folder: Folder) -> None:
    text = process("identify", folder.path, "--no-report", PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert (text.returncode, text.stderr) == (0, b"")
    assert b"kg m?" in text.stdout
    folder.edit('"empty_bounce.csv"', '"Käfer.csv"')
    (folder.path / "empty_bounce.csv").rename(folder.path / "Käfer.csv")
    document = process("check", folder.path, "--json", PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert json.loads(document.stdout.decode("utf-8"))["drops"][0]["file"] == "Käfer.csv"


@pytest.mark.slow
def test_as_a_module(folder: Folder) -> None:
    folder.edit("wheelbase", "wheelbse")
    refused = process("check", folder.path, "--json")
    assert (refused.returncode, refused.stdout) == (2, b"")
    assert refused.stderr.decode().startswith("sprung cannot use this input:")


def test_help_waits_for_no_numerics() -> None:
    script = """
import sys
sys.argv = ["sprung", "--help"]
from sprung.cli import main
try:
    main()
except SystemExit:
    pass
print("loaded:", *sorted({"numpy", "scipy", "pandas", "pydantic"} & sys.modules.keys()), file=sys.stderr)
"""
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, capture_output=True, check=True, text=True, timeout=60)  # noqa: S603
    assert "identify" in done.stdout
    assert done.stderr == "loaded:\n"
