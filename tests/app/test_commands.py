"""What the page runs is what it shows: arguments of sprung, with names in the folder only."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from command_line import run
from served import served
from sprung.app import commands
from sprung.app.workspace import OutsideError, Workspace


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    folder = tmp_path / "work"
    (folder / "car").mkdir(parents=True)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "drop.csv").write_text("secret")
    (folder / "car" / "campaign.toml").write_text('[[drop]]\nfile = "drop.csv"\n')
    return Workspace(folder)


def test_the_arguments_are_what_a_shell_would_give(workspace: Workspace) -> None:
    options: dict[str, commands.Value] = {"fall": False, "profile": ("k_sf", "k_tf"), "json": True, "force": False}
    found = commands.arguments(workspace, "identify", "car", output="car/my results", options=options)
    assert found[1:4] == ("car", "-o", "car/my results")
    assert found[4:] == ("--no-fall", "--profile", "k_sf", "--profile", "k_tf", "--json")
    assert shlex.split(commands.as_typed(found)) == ["sprung", *found]
    ride = commands.arguments(workspace, "ride", "car", options={"speed": ("80",), "hours": 0.1, "load": None})
    assert ride == ("ride", "car", "--speed", "80", "--hours", "0.1")


@pytest.mark.parametrize("command", commands._OPTIONS)
def test_every_option_exists(command: str) -> None:
    help_text = run(command, "--help", columns=200).out
    for option in commands._OPTIONS[command]:
        assert f"--{option}" in help_text
        assert (f"--no-{option}" in help_text) == (option in commands._TWO_WAY)


def test_a_name_is_never_an_option(workspace: Workspace) -> None:
    (workspace.folder / "--force").mkdir()
    assert commands.arguments(workspace, "check", "--force") == ("check", "./--force")
    assert commands.arguments(workspace, "check", "", output="--json") == ("check", ".", "-o", "./--json")
    with pytest.raises(ValueError, match="--o"):
        commands.arguments(workspace, "check", "car", options={"o": "/etc"})
    with pytest.raises(ValueError, match="fleet"):
        commands.arguments(workspace, "fleet", "car")


@pytest.mark.parametrize(
    "file", ["../../other/drop.csv", "/etc/passwd", "link.csv", "folder/drop.csv", "../car/../../other/drop.csv"]
)
@pytest.mark.parametrize("key", ['file = "{}"', 'files = ["drop.csv", "{}"]'])
def test_a_recording_outside_the_folder_is_not_read(workspace: Workspace, file: str, key: str) -> None:
    car = workspace.folder / "car"
    (car / "campaign.toml").write_text(f"[[drop]]\n{key.format(file)}\n")
    if file == "link.csv":
        (car / "link.csv").symlink_to(workspace.folder.parent / "other" / "drop.csv")
    if file == "folder/drop.csv":
        (car / "folder").symlink_to(workspace.folder.parent / "other")
    for name in ("car", "car/campaign.toml"):
        with pytest.raises(OutsideError, match="start sprung app in a folder above both"):
            commands.arguments(workspace, "identify", name)


def test_a_link_to_a_folder_elsewhere_is_not_written_through(workspace: Workspace) -> None:
    (workspace.folder / "car" / "results").symlink_to(workspace.folder.parent / "other")
    with pytest.raises(OutsideError, match="car/results leads out"):
        commands.arguments(workspace, "identify", "car")
    with pytest.raises(OutsideError):
        commands.arguments(workspace, "identify", "car", output="car/results")


def test_a_recording_beside_the_campaign_is_permitted(workspace: Workspace) -> None:
    (workspace.folder / "drops").mkdir()
    (workspace.folder / "car" / "campaign.toml").write_text('[[drop]]\nfile = "../drops/a.csv"\n')
    assert commands.arguments(workspace, "check", "car/campaign.toml") == ("check", "car/campaign.toml")
    (workspace.folder / "car" / "campaign.toml").write_text("[[drop]\nno TOML")
    assert commands.arguments(workspace, "check", "car") == ("check", "car")  # the command says what is wrong


def test_a_recording_of_several_files_is_read_without_links_that_lead_out(tmp_path: Path) -> None:
    folder = tmp_path / "work"
    folder.mkdir()
    (folder / "a.mme").write_text("")
    (tmp_path / "secret").write_text("secret")
    form = {"Content-Type": "application/x-www-form-urlencoded"}
    with served(folder) as server:
        (folder / "a.001").symlink_to(tmp_path / "secret")
        assert "leads out" in server.ask("/recordings/channels?file=a.mme").text
        assert server.ask("/campaign?campaign=a.mme").status == 400
        saved = server.ask("/campaign?campaign=a.mme", "POST", b"text=x&version=&original=%22%22&action=save", form)
        assert saved.status == 400
    assert (folder / "a.mme").read_text() == ""
