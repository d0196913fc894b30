"""`sprung export`: files, notes, statuses, and one JSON document for machines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.io

import sprung
from command_line import run

SAVED = Path(__file__).resolve().parents[1] / "report"


@pytest.fixture
def results(tmp_path: Path) -> Path:
    folder = tmp_path / "results"
    sprung.load(SAVED / "accept.json", series=False).save(folder)
    return folder


def test_a_file_is_written_where_it_is_asked_for(results: Path, tmp_path: Path) -> None:
    said = run("export", results, "--to", "state-space", "-o", tmp_path / "car.mat")
    assert (said.status, said.err) == (0, "")
    assert said.out == f"Written: {tmp_path / 'car.mat'}\n"
    assert scipy.io.loadmat(str(tmp_path / "car.mat"))["A"].shape == (14, 14)


def test_it_is_written_beside_the_results_otherwise(results: Path) -> None:
    for source in (results, results / "results.json"):
        said = run("export", source, "--to", "modelica", "--load", "ballast", "--json")
        assert said.json == {"format": "modelica", "written": str(results / "SedanModel.mo"), "notes": []}
    assert (results / "SedanModel.mo").read_text(encoding="utf-8").startswith("package SedanModel")


def test_draws_are_csv_or_parquet_by_the_name(results: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    for name in ("draws.csv", "draws.parquet"):
        assert (
            run("export", results, "--to", "draws", "--number", "5", "--seed", "1", "-o", tmp_path / name).status == 0
        )
    table = np.loadtxt(tmp_path / "draws.csv", delimiter=",", skiprows=1)
    assert np.array_equal(table, parquet.read_table(tmp_path / "draws.parquet").to_pandas().to_numpy())
    assert table.shape == (5, 15)


def test_what_is_approximated_is_said(results: Path) -> None:
    refused = run("export", results, "--to", "commonroad")
    assert refused.status == 2
    assert "--approximate" in refused.err
    said = run("export", results, "--to", "commonroad", "--approximate")
    assert said.status == 0
    assert "tyre rates" in said.err
    assert "Steering" in said.err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--to", "modelika"), "Did you mean 'modelica'?"),
        (("--to", "fmu", "--amplitude", "0.01"), "the option amplitude"),
        (("--to", "draws", "--number", "0"), "a whole number, 1 or more"),
        (("--to", "draws", "--number", "1000000000"), "no more than 10000000"),
        (("--to", "mjcf", "--load", "nothing"), "the load 'nothing'"),
    ],
)
def test_bad_input_writes_nothing(options: tuple[str, ...], words: str, results: Path) -> None:
    before = sorted(results.iterdir())
    said = run("export", results, *options)
    assert said.status == 2
    assert words in said.err
    assert "Traceback" not in said.err
    assert sorted(results.iterdir()) == before


def test_a_rejected_result_is_status_3_with_tables_and_without(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    sprung.load(SAVED / "reject.json", series=False).save(folder)
    refused = run("export", folder, "--to", "fmu")
    assert refused.status == 3
    assert "found the verdict reject" in refused.err
    assert run("export", folder, "--to", "fmu", "--number", "3").status == 2  # usage, whatever the result
    said = run("export", folder, "--to", "latex")
    assert said.status == 3
    assert "rejected" in said.err
    assert (folder / "leafbus.tex").is_file()


def test_a_file_of_the_users_is_kept(results: Path, tmp_path: Path) -> None:
    target = tmp_path / "car.md"
    target.write_text("mine", encoding="utf-8")
    said = run("export", results, "--to", "markdown", "-o", target)
    assert said.status == 2
    assert target.read_text(encoding="utf-8") == "mine"
    assert run("export", results, "--to", "markdown", "-o", target, "--force").status == 0


@pytest.mark.parametrize(
    ("to", "name", "words"),
    [
        ("modelica", "results.json", "found the ending .json; expected the ending .mo"),
        ("fmu", "campaign.toml", "found the ending .toml; expected the ending .fmu"),
        ("draws", "empty_bounce.csv", "found the name of a recording of this campaign"),
        ("draws", "d.xlsx", "expected the ending .csv"),
    ],
)
def test_nothing_of_another_kind_is_replaced(to: str, name: str, words: str, results: Path) -> None:
    before = (results / "results.json").read_bytes()
    said = run("export", results, "--to", to, "-o", results / name)
    assert said.status == 2
    assert words in " ".join(said.err.split())
    assert (results / "results.json").read_bytes() == before


def test_no_results_is_bad_input(tmp_path: Path) -> None:
    said = run("export", tmp_path, "--to", "fmu")
    assert said.status == 2
    assert "results.json" in said.err
