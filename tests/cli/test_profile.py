"""`sprung identify --profile`."""

from __future__ import annotations

import pytest

from command_line import Folder, run


@pytest.mark.slow
def test_intervals_are_shown_where_they_are_asked_for(folder: Folder) -> None:
    plain = run("identify", folder.path, "--no-report")
    said = run("identify", folder.path, "--profile", "c_sf", "--profile", "total_mass", "--no-report")
    assert said.status == plain.status == 0
    assert "95 % intervals" not in plain.out
    _, _, rest = said.out.partition("95 % intervals from likelihood profiles\n")
    rows = rest.split("\n\n", maxsplit=1)[0].splitlines()
    assert [row.split()[0] for row in rows] == ["parameter", "c_sf", "total_mass"]
    document = run("identify", folder.path, "--json", "--profile", "all", "--no-report").json
    assert {found["interval_from"] for found in document["parameters"].values()} == {"profile"}
    low, high = document["parameters"]["c_sf"]["interval95"]
    assert float(rows[1].split()[1]) < document["parameters"]["c_sf"]["value"] < float(rows[1].split()[2])
    assert low < document["parameters"]["c_sf"]["value"] < high


def test_an_unknown_name_is_bad_input_and_nothing_is_written(folder: Folder) -> None:
    before = folder.listing()
    said = run("identify", folder.path, "--profile", "total_mas", "--profile", "m_x")
    assert (said.status, said.out) == (2, "")
    assert "Did you mean 'total_mass'?" in said.err
    assert "'m_x'" in said.err
    assert folder.listing() == before
