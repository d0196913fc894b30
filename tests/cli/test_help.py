"""The help and what the shell completes: in the order of work, nothing cut at any width, an example for every command."""

from __future__ import annotations

import io
import re
import sys
from pathlib import Path

import pytest
import typer

from command_line import run
from sprung.cli.app import ORDER
from sprung.cli.help_text import readable
from sprung.cli.program import app

GROUP = typer.main.get_command(app)
WIDTHS = (30, 40, 60, 80, 200)


def words(text: str) -> str:
    return " ".join(text.split())


def test_the_order_names_every_command() -> None:
    assert set(ORDER) == set(GROUP.commands)  # type: ignore[attr-defined]


@pytest.mark.parametrize("columns", WIDTHS)
def test_the_commands_come_in_the_order_of_work_each_with_an_example(columns: int) -> None:
    said = run("--help", columns=columns)
    assert said.status == 0
    shown = words(said.out)
    places = [shown.index(f" {name} {words(GROUP.commands[name].help)}") for name in ORDER]  # type: ignore[attr-defined]
    assert places == sorted(places)
    for name in ORDER:
        example = re.sub(r"\[/?bold\]", "", GROUP.commands[name].epilog).removeprefix("Example: ")  # type: ignore[attr-defined]
        assert example in shown
    assert max(map(len, said.out.splitlines())) <= max(columns, 40)


@pytest.mark.parametrize("columns", WIDTHS)
@pytest.mark.parametrize("name", ORDER)
def test_no_width_cuts_the_help_of_a_command(name: str, columns: int) -> None:
    said = run(name, "--help", columns=columns)
    assert said.status == 0
    for parameter in GROUP.commands[name].params:  # type: ignore[attr-defined]
        assert words(parameter.help) in words(said.out)
        assert all(flag in said.out for flag in parameter.opts if flag.startswith("-"))
    assert max(map(len, said.out.splitlines())) <= max(columns, 40)
    assert "…" not in said.out


def completed(line: str, monkeypatch: pytest.MonkeyPatch, folder: Path) -> list[str]:
    monkeypatch.chdir(folder)
    said = run(
        _SPRUNG_COMPLETE="complete_bash",
        COMP_WORDS=f"sprung {line}",
        COMP_CWORD=str(len(f"sprung {line}".split(" ")) - 1),
    )
    assert said.err == ""
    return said.out.split()


def test_the_shell_completes_campaigns_results_parameters_and_methods(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("car/campaign.toml", "car/results/results.json", "elsewhere/notes.txt", "vehicle.toml", "a.csv"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    assert completed("identify ", monkeypatch, tmp_path) == ["car", "elsewhere/", "vehicle.toml"]
    assert completed("check car/", monkeypatch, tmp_path) == ["car/campaign.toml", "car/results/"]
    assert completed("compare car/", monkeypatch, tmp_path) == ["car/results"]
    assert completed("identify nowhere/", monkeypatch, tmp_path) == []
    assert completed("identify --profile k_s", monkeypatch, tmp_path) == ["k_sf", "k_sr", "k_s"]
    assert completed("modal car --method ssi", monkeypatch, tmp_path) == ["ssi-cov", "ssi-data"]
    assert completed("val", monkeypatch, tmp_path) == ["validate"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_for_a_shell(shell: str) -> None:
    said = run(_SPRUNG_COMPLETE=f"source_{shell}")
    assert (said.status, said.err) == (0, "")
    assert "_SPRUNG_COMPLETE" in said.out


class Terminal(io.StringIO):
    """Standard error that somebody watches."""

    def isatty(self) -> bool:
        return True


def test_a_message_on_a_terminal_breaks_no_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a-folder-whose-name-is-longer-than-half-of-the-terminal" / "campaign.toml"
    plain = run("check", path).err
    assert len(plain.splitlines()) == 2  # nobody watches: one line for each fault
    assert readable(plain) == plain
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("COLUMNS", "40")
    said = readable(plain)
    assert words(said) == words(plain)
    assert str(path) in said
    assert all(len(line) <= 40 or str(path) in line for line in said.splitlines())
