from __future__ import annotations

from pathlib import Path

import pytest
from car import CAR

from command_line import DROPS, SEDAN, Folder, Identified, copy_sedan, identified, linear_leafbus


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    """Four drops of the sedan, as they are."""
    return copy_sedan(tmp_path / "campaign")


@pytest.fixture
def vehicle_file(tmp_path: Path) -> Path:
    """The Table 1 car, with the usual sensors and drops."""
    path = tmp_path / "car.toml"
    path.write_text(CAR)
    return path


@pytest.fixture(scope="session")
def sedan(tmp_path_factory: pytest.TempPathFactory) -> Identified:
    """All drops of a linear car with a known load."""
    return identified(SEDAN, tmp_path_factory.mktemp("sedan") / "results")


@pytest.fixture(scope="session")
def leafbus(tmp_path_factory: pytest.TempPathFactory) -> Identified:
    """A bus whose leaf springs rub, which the linear model that is asked for does not explain."""
    folder = tmp_path_factory.mktemp("leafbus")
    return identified(linear_leafbus(folder / "campaign"), folder / "results")


@pytest.fixture(scope="session")
def one_drop(tmp_path_factory: pytest.TempPathFactory) -> Identified:
    """One drop of the empty car: no load, no scale, no roll."""
    folder = copy_sedan(tmp_path_factory.mktemp("one") / "campaign", DROPS[:1])
    return identified(folder.path, folder.path / "results")
