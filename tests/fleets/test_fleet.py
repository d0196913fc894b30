"""`sprung.fleet`: found campaigns, keys, rows, failures, resume and what the vehicles tell together."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

import sprung
from command_line import run
from sprung.batch import BatchCounts, read_rows
from sprung.errors import InputError, Problem
from sprung.fleets import COLUMNS, campaign_key, collect_estimates, find_campaigns, in_test_order, row_of, survey_types
from sprung.fleets.estimates import label_vehicles
from sprung.report import fleet_html, fleet_pictures, fleet_view, text_of
from sprung.simulation import simulate
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle

DROPS: Any = ({"wheels": ("fl", "fr")}, {"wheels": ("fl", "rl")})
# The linear model and no fall: the tests are about many campaigns, not about one.
OPTIONS: Any = {"extras": (), "tracks": "shared", "fall": False}


def write_car(folder: Path, number: int, **changes: float) -> Path:
    vehicle = Vehicle({**TABLE_1_CAR.parameters, **changes}, name="Table 1 car")
    campaign = simulate(
        vehicle, drops=DROPS, seed=number, duration=1.5, known={"total_mass": KnownValue(vehicle.total_mass, 5.0)}
    )
    return sprung.write(replace(campaign, identification=f"W{number:02d}"), folder / f"car_{number}", overwrite=True)


@pytest.fixture(scope="module")
def identified(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, sprung.fleets.Fleet]:
    """Return a folder with four cars and one unreadable campaign, and the fleet; the rows are in its folder out."""
    folder = tmp_path_factory.mktemp("fleet")
    for number in range(1, 5):
        write_car(folder / "cars", number, k_sf=17000.0 * (1 + 0.02 * number))
    (folder / "cars" / "unreadable").mkdir()
    (folder / "cars" / "unreadable" / "campaign.toml").write_text("[vehicle\n")
    return folder, sprung.fleet(folder / "cars", folder / "out", workers=2, **OPTIONS)


Identified = tuple[Path, sprung.fleets.Fleet]


def rows(folder: Path) -> dict[str, dict[str, Any]]:
    found = list(read_rows(folder, ("campaign", "key", "status", "message", *COLUMNS)))
    assert len({row["campaign"] for row in found}) == len(found)
    return {Path(row["campaign"]).parent.name: row for row in found}


def test_every_campaign_has_its_row(identified: Identified) -> None:
    folder, fleet = identified
    assert (fleet.counts.done, fleet.counts.failed, fleet.computed, fleet.gone) == (4, 1, 5, ())
    found = rows(folder / "out")
    assert found.keys() == {"car_1", "car_2", "car_3", "car_4", "unreadable"}
    assert "expected TOML" in found["unreadable"]["message"]
    assert list(fleet.failures) == [(folder / "cars" / "unreadable" / "campaign.toml").resolve().as_posix()]
    row = found["car_3"]
    assert (row["status"], row["vehicle"], row["identification"], row["drops"]) == ("done", "Table 1 car", "W03", 2)
    assert row["k_sf"] == pytest.approx(17000 * 1.06, abs=4 * row["k_sf_std"])


def test_a_row_is_the_result_of_identify(identified: Identified) -> None:
    folder, _ = identified
    result = sprung.identify(folder / "cars" / "car_2", **OPTIONS)
    row = rows(folder / "out")["car_2"]
    for name, estimate in {**result.parameters, "front_ride_frequency": result.derived["front_ride_frequency"]}.items():
        assert row[name] == pytest.approx(estimate.value, rel=1e-9)
        assert row[f"{name}_std"] == pytest.approx(estimate.std, rel=1e-6)
    # Position and covariance are those of the result, of logarithms.
    names = row["coordinates"]
    matrix = np.array(row["covariance"]).reshape(len(names), len(names))
    values = np.array([result.parameters[name].value for name in names])
    np.testing.assert_allclose(np.exp(row["position"]), values)
    own = result.covariance
    there = [names.index(name) for name in own.names]
    np.testing.assert_allclose(
        matrix[np.ix_(there, there)] * np.outer(values[there], values[there]), own.matrix, rtol=1e-6, atol=1e-12
    )


@pytest.mark.slow
def test_it_goes_on_and_does_a_changed_recording_anew(identified: Identified, tmp_path: Path) -> None:
    folder, _ = identified
    shutil.copytree(folder / "out", tmp_path / "out")
    again = sprung.fleet(folder / "cars", tmp_path / "out", workers=1, **OPTIONS)
    assert (again.computed, again.counts.done, again.counts.failed) == (0, 4, 1)
    before = rows(tmp_path / "out")
    recording = folder / "cars" / "car_1" / "empty_roll_left.csv"
    lines = recording.read_text().splitlines(keepends=True)
    try:
        recording.write_text("".join(lines[:-50]))
        changed = sprung.fleet(folder / "cars", tmp_path / "out", workers=1, **OPTIONS)
    finally:
        recording.write_text("".join(lines))
    after = rows(tmp_path / "out")
    assert changed.computed == 1
    assert after["car_1"]["key"] != before["car_1"]["key"]
    assert after["car_1"]["k_sf"] != before["car_1"]["k_sf"]
    assert {name: row for name, row in after.items() if name != "car_1"} == {
        name: row for name, row in before.items() if name != "car_1"
    }


def test_the_page_names_types_and_failures(identified: Identified, tmp_path: Path) -> None:
    _, fleet = identified
    page = fleet_html(fleet)
    assert page == fleet_html(fleet)
    assert "Table 1 car" in page
    assert "unreadable/campaign.toml" in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert "https://" not in page
    assert (
        page.count('<svg class="picture"') == 3 + len(fleet.types[0].estimates.names) - 1
    )  # none of the exact wheelbase
    shown = text_of(fleet_view(fleet))
    assert "4 campaigns identified (4 accept), 1 failed" in shown
    written = sprung.report.write_fleet(fleet, tmp_path)
    document = json.loads(written[1].read_text())
    assert document["types"][0]["parameters"]["k_sf"]["unit"] == "N/m"


def test_estimates_with_the_others_are_a_table(identified: Identified) -> None:
    folder, fleet = identified
    table = list(
        read_rows(
            folder / "out" / "hierarchical",
            ("type", "label", "parameter", "single", "hierarchical", "hierarchical_std"),
        )
    )
    assert {row["label"] for row in table} == {"W01", "W02", "W03", "W04"}
    assert {row["parameter"] for row in table} == {*fleet.types[0].estimates.names}
    springs = {row["label"]: row for row in table if row["parameter"] == "k_sf"}
    for row in springs.values():
        assert row["hierarchical"] == pytest.approx(row["single"], rel=0.01)
    assert springs["W04"]["hierarchical"] > springs["W01"]["hierarchical"]


def test_an_exact_wheelbase_is_shown_as_exact(identified: Identified) -> None:
    folder, fleet = identified
    spread = fleet.types[0].parameters["wheelbase"]
    assert spread.exact
    assert spread.mean == pytest.approx(2.76, rel=1e-12)
    assert (spread.mean_std, spread.error, spread.spread, spread.hierarchical_error) == (0.0, 0.0, 0.0, 0.0)
    shown = text_of(fleet_view(fleet), Console(width=120))
    line = next(line for line in shown.splitlines() if line.startswith("wheelbase"))
    assert line.split() == ["wheelbase", "2.76", "exact", "m", "-", "-", "-", "-", "-"]
    table = read_rows(folder / "out" / "hierarchical", ("parameter", "single_std", "hierarchical", "hierarchical_std"))
    rows = [row for row in table if row["parameter"] == "wheelbase"]
    assert {(row["single_std"], row["hierarchical_std"]) for row in rows} == {(0.0, 0.0)}
    assert [row["hierarchical"] for row in rows] == pytest.approx([2.76] * 4, rel=1e-12)
    assert not any(spread.exact for name, spread in fleet.types[0].parameters.items() if name != "wheelbase")


@pytest.mark.slow
def test_exact_values_that_differ_have_a_spread_but_no_error() -> None:
    """Wheels weighed exactly, one by one, and of one vehicle on scales with an error."""
    made = [estimated(number, "rig", "m_s", "m_u", "k_s") for number in range(6)]
    for one in made[1:]:
        one["covariance"] = np.diag([1e-4, 0.0, 1e-4]).ravel().tolist()
    ((found,), _, _) = survey_types(made)
    spread = found.parameters["m_u"]
    assert not spread.exact
    assert spread.error == spread.hierarchical_error == 0.0
    assert spread.spread > 0.1
    stds = {row["label"]: row["single_std"] for row in found.rows() if row["parameter"] == "m_u"}
    assert [std > 0 for std in stds.values()] == [True, *[False] * 5]
    assert fleet_pictures(found).keys() == {"spread", "rig", "vehicle", "m_s", "m_u", "k_s"}


def test_the_table_for_pandas(identified: Identified) -> None:
    pytest.importorskip("pandas")
    _, fleet = identified
    table = fleet.to_dataframe()
    assert len(table) == 5
    assert "k_sf_std" in table.columns
    assert "k_af" not in table.columns  # no vehicle has it


def test_campaigns_of_a_folder_a_list_and_paths(tmp_path: Path) -> None:
    for name in ("b", "a/deep", ".hidden"):
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / "campaign.toml").touch()
    expected = [(tmp_path / name / "campaign.toml").resolve() for name in ("a/deep", "b")]
    assert list(find_campaigns(tmp_path)) == expected
    (tmp_path / "list.txt").write_text("# two of them\n\na/deep\nb/campaign.toml\n  b\nmissing\n")
    found = find_campaigns(tmp_path / "list.txt")
    assert list(found) == [*expected, (tmp_path / "missing").resolve()]
    assert list(find_campaigns([tmp_path / "b", tmp_path / "a" / "deep"])) == expected[::-1]


def test_a_folder_without_campaigns(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found no campaign; expected one campaign"):
        sprung.fleet(tmp_path, tmp_path / "out")
    with pytest.raises(InputError, match="found no such file or folder"):
        sprung.fleet(tmp_path / "nowhere", tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_written_where_the_cluster_does_not_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_answer(*_: object) -> None:
        raise InputError([Problem("tcp://127.0.0.1:1", "no answer", "a scheduler", "Check the address.")])

    write_car(tmp_path / "cars", 1)
    for module in ("fleets.fleet", "study.monte_carlo"):
        monkeypatch.setattr(sys.modules[f"sprung.{module}"], "choose_executor", no_answer)
    with pytest.raises(InputError, match="no answer"):
        sprung.fleet(tmp_path / "cars", tmp_path / "out", scheduler="tcp://127.0.0.1:1")
    with pytest.raises(InputError, match="no answer"):
        sprung.study.monte_carlo(TABLE_1_CAR, n=2, output=tmp_path / "out", scheduler="tcp://127.0.0.1:1")
    assert not (tmp_path / "out").exists()


def test_the_key_follows_from_recordings_campaign_and_options(tmp_path: Path) -> None:
    path = write_car(tmp_path, 1)
    key = campaign_key(path, {})
    assert campaign_key(path, {}) == key
    assert campaign_key(path, {"fall": True}) != key
    recording = path.parent / "empty_roll_left.csv"
    content = recording.read_bytes()
    recording.write_bytes(content.replace(b"1", b"2", 1))
    assert campaign_key(path, {}) != key
    recording.unlink()
    missing = campaign_key(path, {})
    assert missing != key
    recording.write_bytes(content)
    assert campaign_key(path, {}) == key
    path.write_text(path.read_text() + "\n")
    assert campaign_key(path, {}) != key


def row(number: int, **changes: Any) -> dict[str, Any]:
    return {"campaign": f"/data/car_{number}/campaign.toml", "date": None, "identification": None, **changes}


def test_the_order_of_the_tests() -> None:
    unordered = [row(10), row(2), row(1)]
    assert [one["campaign"] for one in in_test_order(unordered)] == [row(n)["campaign"] for n in (1, 2, 10)]
    dated = [row(1, date="2026-11-03"), row(2, date="2026-10-01")]
    assert in_test_order(dated) == dated[::-1]
    assert in_test_order([*dated, row(3)]) == [*dated, row(3)]  # a date is missing: by the paths


def test_labels_of_vehicles() -> None:
    assert label_vehicles([row(1, identification="A"), row(2, identification="B")]) == ("A", "B")
    assert label_vehicles([row(1, identification="A"), row(2, identification="A")]) == ("car_1", "car_2")
    assert label_vehicles([row(1)]) == ("car_1",)


def test_types_are_names_or_all_vehicles() -> None:
    """A car that is not weighed, and one that has friction beside it: what is common to most is compared."""
    campaigns = [simulate(TABLE_1_CAR, drops=DROPS, seed=seed, duration=1.5) for seed in (1, 2)]
    weighed = {"total_mass": KnownValue(TABLE_1_CAR.total_mass, 5.0)}
    campaigns += [simulate(TABLE_1_CAR, drops=DROPS, seed=seed, duration=1.5, known=weighed) for seed in (3, 4, 5)]
    made = []
    for i, campaign in enumerate(campaigns):
        result = row_of(sprung.analysis.identify_campaign(replace(campaign, name=f"car {i % 2}"), **OPTIONS))
        made.append({**result, "status": "done", "campaign": f"/{i}/campaign.toml"})
    types, small, _ = survey_types(made)
    assert [one.name for one in types] == ["car 0"]
    assert small == {"car 1": 2}
    (one,), none, alike = survey_types(made, one_type=True)
    assert (one.name, one.estimates.count, none, alike) == ("all vehicles", 5, {}, {})
    # The scale of the two that were not weighed is that of the others.
    table = {(row["label"], row["parameter"]): row for row in one.rows()}
    assert table["0", "k_sf"]["single"] is None
    assert table["0", "k_sf"]["hierarchical"] == pytest.approx(17000, abs=4 * table["0", "k_sf"]["hierarchical_std"])
    assert collect_estimates([]) is None


@pytest.mark.slow
def test_without_any_scale_only_ratios_are_compared() -> None:
    """Three cars without weighing or load: m_s of 1380 ± 4000 kg would be invented."""
    made = [
        {
            **row_of(
                sprung.analysis.identify_campaign(
                    simulate(TABLE_1_CAR, drops=DROPS, seed=seed, duration=1.5), **OPTIONS
                )
            ),
            "status": "done",
            "campaign": f"/{seed}/campaign.toml",
        }
        for seed in (1, 2, 3)
    ]
    (one,), _, _ = survey_types(made)
    assert not one.estimates.has_scale
    assert not {"m_s", "k_sf", "c_sf"} & set(one.parameters)
    spread = one.parameters["k_sf/total_mass"]
    assert spread.unit == "1/s^2"
    assert spread.mean == pytest.approx(17000 / TABLE_1_CAR.total_mass, abs=4 * spread.mean_std)
    assert spread.mean_std < 0.05 * spread.mean
    assert one.parameters["t_f"].unit == "m"
    assert {row["parameter"] for row in one.rows()} == set(one.parameters)
    counts = BatchCounts(3, 0, 0)
    doubtful = {made_row["campaign"]: made_row["reasons"][0] for made_row in made}
    found = sprung.fleets.Fleet(Path("out"), counts, 3, (), {"doubtful": 3}, {}, {}, (one,), doubtful=doubtful)
    shown = " ".join(text_of(fleet_view(found)).split())
    assert "doubtful: 3 campaigns, the first /1/campaign.toml: these drops do not determine m_s" in shown
    assert "no vehicle was weighed or tested with a known load" in shown
    assert "k_sf/total_mass" in fleet_html(found)
    assert found.document()["doubtful"] == doubtful


def test_a_parameter_that_no_test_determines_is_left_out() -> None:
    rows = [estimated(number, "car", "m_s", "I_xx", "m_uf", "k_sf") for number in range(3)]
    covariance = np.diag([1e-4, 9.0, 1e-4, 1e-4]).ravel().tolist()
    (one,), _, _ = survey_types([{**row, "covariance": covariance} for row in rows])
    assert one.estimates.names == ("m_s", "m_uf", "k_sf")
    assert one.estimates.undetermined == ("I_xx",)


def estimated(number: int, vehicle: str, *names: str) -> dict[str, Any]:
    """Return the columns of a row that are compared; a few estimates, each known to 1 %, near zero."""
    position = np.random.default_rng(number).normal(0, 0.02, len(names)).tolist()
    covariance = (1e-4 * np.eye(len(names))).ravel().tolist()
    own = {"coordinates": list(names), "position": position, "covariance": covariance}
    return row(number, status="done", vehicle=vehicle, **own)


@pytest.mark.parametrize("one_type", [False, True])
@pytest.mark.slow
def test_parts_of_a_vehicle_are_types_of_their_own(one_type: bool) -> None:
    """k_s of a quarter car is no k_s of a roll plane, whatever the names of the vehicles are."""
    cars = [estimated(number, "car", "m_s", "I_xx", "m_uf", "k_sf") for number in range(3)]
    planes = [estimated(number, "car", "m_s", "I_xx", "m_u", "k_s") for number in range(3, 7)]
    quarters = [estimated(number, "car", "m_s", "m_u", "k_s") for number in range(7, 9)]
    types, small, parts = survey_types([*quarters, *planes, *cars], one_type)
    name = "all vehicles" if one_type else "car"
    assert [(one.name, one.estimates.count) for one in types] == [
        (f"{name}, roll plane", 4),
        (f"{name}, whole vehicle", 3),
    ]
    assert small == {f"{name}, quarter car": 2}
    assert parts == {name: {"quarter car": 2, "roll plane": 4, "whole vehicle": 3}}
    found = sprung.fleets.Fleet(
        Path("out"), BatchCounts(9, 0, 0), 9, (), {"accept": 9}, {}, {}, types=types, small_types=small, parts=parts
    )
    shown = " ".join(text_of(fleet_view(found)).split())
    assert f"{name}: different parts of a vehicle" in shown
    assert "quarter car (2), roll plane (4), whole vehicle (3)" in shown
    assert f"too few vehicles of one type to compare: {name}, quarter car (2)" in shown
    assert ("--one-type" in shown) is not one_type
    assert found.document()["parts"] == parts


@pytest.mark.slow
def test_the_command(identified: Identified, tmp_path: Path) -> None:
    folder, fleet = identified
    shutil.copytree(folder / "out", tmp_path / "out")
    said = run("fleet", folder / "cars" / "car_1", "-o", tmp_path / "out", "--workers", "1", "--no-fall", "--json")
    assert said.status == 0
    assert said.json["campaigns"] == {"done": 1, "failed": 0, "computed": 1}  # other options than above
    assert len(said.json["gone"]) == 4
    assert [json.loads(line)["done"] for line in said.err.splitlines()][-1] == 1
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"fleet.html", "fleet.json", "rows-00001.parquet"}
    empty = run("fleet", folder / "cars" / "unreadable", "-o", tmp_path / "other", "--workers", "1")
    assert empty.status == 2
    assert "unreadable/campaign.toml: found no result (campaign.toml: line 1" in empty.err
    assert "expected a campaign that can be identified" in empty.err
    assert not (tmp_path / "other" / "fleet.html").exists()
    assert fleet.counts.done == 4


@pytest.mark.slow
def test_a_rejected_and_a_missing_campaign_are_named(tmp_path: Path) -> None:
    """The path of a campaign that does not exist is named once, though its own message names it, too."""
    campaign = simulate(TABLE_1_CAR, drops=DROPS, seed=1, duration=1.5)
    others = [simulate(TABLE_1_CAR, drops=DROPS, seed=seed, duration=1.5, noise=5.0) for seed in (2, 3)]
    drops = [
        replace(drop, recording=other.drops[0].recording) for drop, other in zip(campaign.drops, others, strict=True)
    ]
    written = sprung.write(replace(campaign, drops=tuple(drops)), tmp_path / "noise")
    found = sprung.fleet([written, tmp_path / "none"], tmp_path / "out", workers=1, **OPTIONS)
    missing = (tmp_path / "none").resolve().as_posix()
    assert found.failures[missing].startswith("found no such file")
    assert f"{missing}: found no such file" in " ".join(text_of(fleet_view(found)).split())
    (reason,) = found.rejected.values()
    assert list(found.rejected) == [written.resolve().as_posix()]
    assert reason == sprung.identify(written, **OPTIONS).verdict.reasons[0]
    assert found.verdicts == {"reject": 1}
    assert "1 campaign identified (1 reject), 1 failed." in text_of(fleet_view(found))
