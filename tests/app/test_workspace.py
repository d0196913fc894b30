"""Names in, paths out: nothing leads out of the folder, and no file is written over one that changed meanwhile."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from sprung.app.workspace import LARGEST_TEXT, NEW, ChangedError, OutsideError, Workspace
from sprung.errors import InputError

TRAVERSALS = (
    "..",
    "../outside.txt",
    "../../etc/passwd",
    "car/../../outside.txt",
    "car/..",
    "./car",
    "car/.",
    "car//campaign.toml",
    "/etc/passwd",
    "//etc/passwd",
    "/",
    "~/.ssh/id_rsa/..",
    "..\\outside.txt",
    "car\\..\\..\\outside.txt",
    "C:\\Windows\\win.ini",
    "\\\\server\\share",
    "car/\x00/../../outside.txt",
    "campaign.toml\x00.csv",
    ".sprung-files.json",
    ".git/config",
    "car/.hidden",
    "...",
    "out/outside.txt",
    "outside-link.txt",
    "loop",
    "loop/x",
    "car/\u202etxt.exe",
    "x" * 5000,
    "car/\n",
    "\udcff.csv",
)
"""Names that are refused: parts that go up, absolute ones, of other systems, hidden, links that lead out or to themselves."""


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    folder = tmp_path / "work"
    (folder / "car").mkdir(parents=True)
    (tmp_path / "outside.txt").write_text("secret")
    (folder / "car" / "campaign.toml").write_text("# mine\n")
    (folder / "out").symlink_to(tmp_path)
    (folder / "outside-link.txt").symlink_to(tmp_path / "outside.txt")
    (folder / "inside").symlink_to(folder / "car")
    (folder / "loop").symlink_to(folder / "loop")
    return Workspace(folder)


@pytest.mark.parametrize("name", TRAVERSALS)
def test_a_name_that_leads_out_is_refused(workspace: Workspace, name: str) -> None:
    with pytest.raises(OutsideError):
        workspace.path(name)
    with pytest.raises(OutsideError):
        workspace.read_text(name)
    with pytest.raises(OutsideError):
        workspace.write_text(name, "x", NEW)
    with pytest.raises(OutsideError):
        workspace.new_path(name)
    assert (workspace.folder.parent / "outside.txt").read_text() == "secret"


def test_names_inside_are_paths(workspace: Workspace) -> None:
    assert workspace.path("") == workspace.folder
    assert workspace.path("car/campaign.toml") == workspace.folder / "car" / "campaign.toml"
    assert workspace.path("inside/campaign.toml") == workspace.folder / "car" / "campaign.toml"
    assert workspace.path("Messung 3, Fahrwerk weich (b).csv").parent == workspace.folder
    assert workspace.name(workspace.path("car/campaign.toml")) == "car/campaign.toml"
    assert workspace.name(workspace.folder) == ""


@pytest.mark.parametrize("name", ["con.csv", "a:b.csv", "drop?.csv", "drop. ", "drop.", "a|b", "LPT1"])
def test_a_new_file_has_a_name_that_every_system_permits(workspace: Workspace, name: str) -> None:
    with pytest.raises(OutsideError, match="every system"):
        workspace.new_path(name)


def test_the_listing_names_what_is_there_and_what_leads_out(workspace: Workspace) -> None:
    (workspace.folder / ".hidden").write_text("")
    (workspace.folder / "car" / "drop.csv").write_text("0123")
    Path(os.fsdecode(os.fsencode(workspace.folder) + b"/Sto\xdf.csv")).write_text("")
    found = workspace.listing()
    assert [(entry.name, entry.is_folder, entry.size) for entry in found.entries] == [
        ("car", True, 0),
        ("car/campaign.toml", False, 7),
        ("car/drop.csv", False, 4),
        ("inside", True, 0),
    ]
    assert found.is_complete
    assert set(found.links_out) == {"loop", "out", "outside-link.txt"}
    assert found.unreadable_names == ("Sto\\udcdf.csv",)
    assert [entry.name for entry in workspace.listing("car").entries] == ["car/campaign.toml", "car/drop.csv"]
    assert not workspace.listing(deepest=0).is_complete


def test_a_text_is_replaced_only_in_the_version_that_was_read(workspace: Workspace) -> None:
    text, version = workspace.read_text("car/campaign.toml")
    assert text == "# mine\n"
    second = workspace.write_text("car/campaign.toml", "# a\n", version)
    with pytest.raises(ChangedError, match="another tab"):
        workspace.write_text("car/campaign.toml", "# b\n", version)
    assert workspace.read_text("car/campaign.toml") == ("# a\n", second)
    (workspace.folder / "car" / "campaign.toml").write_text("# an editor\n")
    with pytest.raises(ChangedError):
        workspace.write_text("car/campaign.toml", "# b\n", second)
    (workspace.folder / "car" / "campaign.toml").unlink()
    with pytest.raises(ChangedError):
        workspace.write_text("car/campaign.toml", "# b\n", second)
    assert list((workspace.folder / "car").iterdir()) == []


def test_a_new_text_replaces_nothing(workspace: Workspace) -> None:
    assert workspace.read_text("van/campaign.toml") == ("", NEW)
    version = workspace.write_text("van/campaign.toml", "1", NEW)
    assert workspace.read_text("van/campaign.toml") == ("1", version)
    with pytest.raises(ChangedError, match="exists already"):
        workspace.write_text("van/campaign.toml", "2", NEW)
    assert workspace.read_text("van/campaign.toml") == ("1", version)


def test_of_many_writers_of_one_version_one_succeeds(workspace: Workspace) -> None:
    _, version = workspace.read_text("car/campaign.toml")
    written: list[int] = []

    def write(number: int) -> None:
        try:
            workspace.write_text("car/campaign.toml", str(number), version)
        except ChangedError:
            return
        written.append(number)

    threads = [threading.Thread(target=write, args=(number,)) for number in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [workspace.read_text("car/campaign.toml")[0]] == [str(number) for number in written]


def test_line_ends_and_permissions_of_a_text_are_kept(workspace: Workspace) -> None:
    path = workspace.path("car/campaign.toml")
    path.write_bytes(b"# Windows\r\n")
    path.chmod(0o640)
    text, version = workspace.read_text("car/campaign.toml")
    workspace.write_text("car/campaign.toml", text + "x = 1\r\n", version)
    assert path.read_bytes() == b"# Windows\r\nx = 1\r\n"
    assert path.stat().st_mode & 0o777 == 0o640


def test_what_is_no_text_is_refused_without_waiting(workspace: Workspace) -> None:
    os.mkfifo(workspace.folder / "pipe")
    (workspace.folder / "latin.toml").write_bytes(b"# Sto\xdf\n")
    with (workspace.folder / "large.toml").open("wb") as file:
        file.truncate(LARGEST_TEXT + 1)
    for name, reason in (("pipe", "device"), ("car", "folder"), ("latin.toml", "UTF-8"), ("large.toml", "bytes")):
        with pytest.raises(InputError, match=reason):
            workspace.read_text(name)


def test_a_name_that_is_too_long_as_a_whole_is_refused_shortly(tmp_path: Path) -> None:
    with pytest.raises(OutsideError, match="cannot be a file") as refused:
        Workspace(tmp_path).path("/".join(["ab"] * 3000))
    assert len(str(refused.value)) < 400


def test_a_name_that_is_too_long_is_said_to_be(tmp_path: Path) -> None:
    with pytest.raises(OutsideError, match="is too long: a name has at most 255 bytes"):
        Workspace(tmp_path).new_path("x" * 252 + ".csv")
    assert Workspace(tmp_path).new_path("x" * 251 + ".csv").name == "x" * 251 + ".csv"


def test_a_hidden_upload_is_refused_with_a_remedy(tmp_path: Path) -> None:
    for name in (".hidden.csv", "a/.b"):
        with pytest.raises(OutsideError, match="Rename the file first"):
            Workspace(tmp_path).new_path(name)
