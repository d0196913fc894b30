"""The command line called in this process, and campaign folders to spoil."""

from __future__ import annotations

import contextlib
import io
import json
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from sprung.cli import main
from sprung.files.ownership import MANIFEST

SEDAN = Path(__file__).resolve().parent / "data" / "sedan"
LEAFBUS = SEDAN.with_name("leafbus")
DROPS = ("empty_bounce", "empty_pitch_front", "empty_roll_left", "loaded_bounce")


@dataclass(frozen=True)
class Run:
    """What one call of the command line left."""

    status: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """Standard output, which must be exactly one JSON document, without the NaN and Infinity of Python's own."""
        return json.loads(self.out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))


def run(*arguments: str | Path, columns: int = 80, **environment: str) -> Run:
    """Call the command line in this process."""
    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        patch.setattr(sys, "argv", ["sprung", *map(str, arguments)])
        for name in ("NO_COLOR", "FORCE_COLOR", "TTY_COMPATIBLE"):
            patch.delenv(name, raising=False)
        for name, value in {"COLUMNS": str(columns), **environment}.items():
            patch.setenv(name, value)
        try:
            main()
        except SystemExit as leaving:
            return Run(int(leaving.code or 0), out.getvalue(), err.getvalue())
    return Run(0, out.getvalue(), err.getvalue())


@dataclass(frozen=True)
class Folder:
    """A campaign folder to spoil."""

    path: Path

    def edit(self, old: str, new: str, file: str = "campaign.toml") -> Folder:
        """Replace the first occurrence of a text, which must be there."""
        text = (self.path / file).read_text(encoding="utf-8")
        assert old in text, f"the test replaces {old!r}, which is not there"
        (self.path / file).write_text(text.replace(old, new, 1), encoding="utf-8")
        return self

    def lines(self, change: Callable[[list[str]], list[str]], file: str = "empty_bounce.csv") -> Folder:
        """Change the lines of a recording."""
        lines = (self.path / file).read_text().splitlines()
        (self.path / file).write_text("\n".join((*change(lines), "")))
        return self

    def column(self, name: str, change: Callable[[int, str], str], file: str = "empty_bounce.csv") -> Folder:
        """Change the cells of one column, by the number of the sample."""

        def changed(lines: list[str]) -> list[str]:
            place = lines[0].split(",").index(name)
            rows = [line.split(",") for line in lines[1:]]
            for sample, row in enumerate(rows):
                row[place] = change(sample, row[place])
            return [lines[0], *(",".join(row) for row in rows)]

        return self.lines(changed, file)

    def listing(self) -> list[str]:
        """Everything in the folder but sprung's lists of its own files."""
        return sorted(str(path.relative_to(self.path)) for path in self.path.rglob("*") if path.name != MANIFEST)


def linear_leafbus(folder: Path) -> Path:
    """Copy some recordings of the bus with leaf springs, with the plain linear model asked for."""
    return _linear(_copied(LEAFBUS, folder, DROPS[:3]))


def copy_sedan(folder: Path, drops: tuple[str, ...] = DROPS) -> Folder:
    """Copy some drops of the sedan into a folder of their own, with the plain linear model asked for: no search for others."""
    return Folder(_linear(_copied(SEDAN, folder, drops)))


def _linear(campaign: Path) -> Path:
    file = campaign / "campaign.toml"
    model = '[model]\ntracks = "shared"\nextras = []\nfall = false\n\n[known]'
    text = file.read_text(encoding="utf-8")
    assert "[known]" in text
    file.write_text(text.replace("[known]", model), encoding="utf-8")
    return campaign


def _copied(campaign: Path, folder: Path, drops: tuple[str, ...]) -> Path:
    folder.mkdir(parents=True)
    head, *entries = (campaign / "campaign.toml").read_text().split("[[drop]]")
    kept = [entry for entry in entries if any(f'"{drop}.csv"' in entry for drop in drops)]
    (folder / "campaign.toml").write_text("[[drop]]".join((head, *kept)))
    for drop in drops:
        shutil.copy(campaign / f"{drop}.csv", folder)
    return folder


@dataclass(frozen=True)
class Identified:
    """A campaign, what identifying it printed, as text and as JSON, and the results folder."""

    text: Run
    json: Run
    results: Path


def identified(campaign: Path, results: Path) -> Identified:
    return Identified(
        run("identify", campaign, "-o", results),
        run("identify", campaign, "--json", "--no-report", "-o", results / "again"),
        results,
    )
