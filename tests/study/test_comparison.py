"""Results compared: what differs is seen, what does not is not, and what cannot be compared is said."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom, kstest

import goldens
import sprung
from command_line import Run, run
from layouts import check_view_is_whole
from sprung.errors import InputError
from sprung.report import comparison_view, differences_picture, text_of
from sprung.study.scatter import estimate_scatter
from sprung.study.significance import holm, joint_test
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle

PLANE = ("m_s", "I_yy", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr", "a", "b")
"""Parameters of a pitch plane."""

WORN = Vehicle.from_parameters(TABLE_1_CAR.parameters | {"c_sf": 1400.0}, name="worn car")


def identified(vehicle: Vehicle, seed: int, weighed: bool = True, **options: object) -> sprung.Result:
    known = {"total_mass": KnownValue(vehicle.total_mass, 2.0)} if weighed else {}
    campaign = sprung.simulate(vehicle, noise=0.05, seed=seed, known=known, rate=250, duration=2)
    return sprung.identify(campaign, **{"tracks": "shared", "extras": (), "fall": False, **options})  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def same() -> list[sprung.Result]:
    """Campaigns of one vehicle, each weighed to the same number: their masses agree better than they say."""
    return [identified(TABLE_1_CAR, seed) for seed in range(24)]


@pytest.fixture(scope="module")
def worn() -> sprung.Result:
    return identified(WORN, 100)


@pytest.fixture(scope="module")
def rejected() -> sprung.Result:
    return goldens.stored_result("reject")


@pytest.fixture(scope="module")
def saved(same: list[sprung.Result], worn: sprung.Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("line")
    same[0].save(folder / "before" / "results")
    worn.save(folder / "after" / "results")
    same[1].save(folder / "again" / "results")
    return folder


def test_holm() -> None:
    # Worked example of S. Holm's procedure: 0.01, 0.04, 0.03, 0.005 of four give 0.03, 0.06, 0.06, 0.02.
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([]) == []
    assert holm([0.9, 0.8]) == [1.0, 1.0]


def test_one_vehicle_tested_twice_does_not_differ(same: list[sprung.Result]) -> None:
    """At the stated rate: 12 pairs of independent campaigns."""
    pairs = [sprung.compare(same[i : i + 2]) for i in range(0, len(same), 2)]
    of_modes = [row.differences[0].z or 0.0 for pair in pairs for row in pair.modes.values()]
    # Modes do not depend on the weighing. 12 pairs of 7 modes, 14 numbers that hang together: the RMS has 84 freedoms at best.
    assert 0.8 < float(np.sqrt(np.mean(np.square(of_modes)))) < 1.2
    together = [found.p for pair in pairs if (found := pair.joint[0]) is not None]
    assert len(together) == 12
    # The common weighing takes one of fourteen directions: what is left is as uniform as 12 numbers can show.
    assert kstest(together, "uniform").pvalue > 0.01
    differing = sum(
        any(row.differences[0].finding in ("likely", "certain") for row in rows.values())
        for pair in pairs
        for rows in (pair.parameters, pair.modes)
    )
    assert differing <= binom.isf(1e-3, 24, 0.05)  # 24 tables, each of which may differ in 5 of 100 cases


def test_a_damper_that_was_changed_is_found(same: list[sprung.Result], worn: sprung.Result) -> None:
    found = sprung.compare([same[0], worn], names=["new", "worn"])
    one = found.parameters["c_sf"].differences[0]
    assert one.finding == "certain"
    assert one.value is not None
    assert one.std is not None
    assert one.interval95 is not None
    assert abs(one.value + 100) < 4 * one.std  # 1500 to 1400 N s/m
    assert one.interval95[0] < one.value < one.interval95[1]
    assert one.percent == pytest.approx(100 * one.value / (same[0].parameters["c_sf"].value or 0))
    assert {name for name, row in found.parameters.items() if row.differences[0].finding == "certain"} == {"c_sf"}
    assert found.modes["empty, front axle hop, damping ratio"].differences[0].finding == "certain"
    together = found.joint[0]
    assert together is not None
    assert together.p < 1e-9


def test_turned_round_differences_change_their_signs(same: list[sprung.Result], worn: sprung.Result) -> None:
    there, back = sprung.compare([same[0], worn]), sprung.compare([worn, same[0]])
    for name, row in there.parameters.items():
        one, other = row.differences[0], back.parameters[name].differences[0]
        assert one.value == pytest.approx(-(other.value or 0.0))
        assert one.std == pytest.approx(other.std)
        assert one.finding == other.finding
    assert there.joint[0] is not None
    assert back.joint[0] is not None
    assert there.joint[0].chi_square == pytest.approx(back.joint[0].chi_square)


def test_an_exact_wheelbase_ties_two_parameters_together(same: list[sprung.Result]) -> None:
    # Its wheelbase is exact, so that b is what a leaves: 15 parameters have 14 directions in which they may differ.
    one = joint_test(same[0], same[1], list(same[0].parameters))
    assert one is not None
    assert len(one.names) == 15
    assert one.freedom == 14
    assert joint_test(same[0], same[1], ["a", "b"]).freedom == 1  # type: ignore[union-attr]
    assert joint_test(same[0], same[1], []) is None


def test_of_one_parameter_the_joint_chance_is_its_own(same: list[sprung.Result]) -> None:
    found = sprung.compare(same[:2]).parameters["k_tf"].differences[0]
    one = joint_test(same[0], same[1], ["k_tf"])
    assert one is not None
    assert found.z is not None
    assert one.chi_square == pytest.approx(found.z**2)
    assert one.p == pytest.approx(found.p)


def test_without_scale_parts_of_the_total_mass_are_compared(same: list[sprung.Result]) -> None:
    found = sprung.compare([same[0], identified(WORN, 101, weighed=False)], names=["weighed", "not"])
    assert found.per_total_mass
    assert any("scale of not is not known" in note for note in found.notes)
    row = found.parameters["c_sf / total mass"]
    assert row.unit == "1/s"
    assert row.values[0].value == pytest.approx(1500 / TABLE_1_CAR.total_mass, rel=0.02)
    assert row.differences[0].finding == "certain"
    assert found.parameters["a"].differences[0].finding == "none"  # lengths need no scale


def test_numbers_of_a_rejected_result_are_not_shown(same: list[sprung.Result], rejected: sprung.Result) -> None:
    found = sprung.compare([same[0], rejected], names=["car", "bus"])
    assert found.rejected == ("bus",)
    assert all(row.values[1].value is None for row in (*found.parameters.values(), *found.modes.values()))
    assert {row.differences[0].finding for row in found.parameters.values()} == {"not comparable"}
    assert {row.differences[0].why for row in found.parameters.values()} == {"bus was rejected"}
    assert found.joint == (None,)
    assert any(note.startswith("bus: reject") and "does not explain" in note for note in found.notes)
    assert not found.per_total_mass


def test_another_model_is_named(same: list[sprung.Result]) -> None:
    found = sprung.compare([same[0], identified(TABLE_1_CAR, 50, tracks="separate", extras=["anti-roll"])])
    assert any("different models" in note and "anti-roll" in note for note in found.notes)
    assert found.parameters["k_af"].differences[0].why == "Table 1 car (1) has another model"
    assert found.parameters["k_sf"].differences[0].p is not None


def test_what_was_known_in_both_is_given(same: list[sprung.Result]) -> None:
    def with_known(seed: int, k: float) -> sprung.Result:
        campaign = sprung.simulate(
            TABLE_1_CAR, noise=0.05, seed=seed, known={"k_tf": KnownValue(k)}, rate=250, duration=2
        )
        return sprung.identify(campaign, tracks="shared", extras=(), fall=False)

    found = sprung.compare([with_known(1, 192000.0), with_known(2, 192000.0), with_known(3, 200000.0), same[0]])
    row = found.parameters["k_tf"]
    assert [one.finding for one in row.differences[:2]] == ["given", "given"]
    assert [one.value for one in row.differences[:2]] == [0.0, 8000.0]
    assert row.differences[2].p is not None  # known here, estimated there: that can be held against each other


def test_about_other_axes_inertias_are_not_compared(same: list[sprung.Result]) -> None:
    other = replace(same[1], fit=replace(same[1].fit, axes="about something else"))
    found = sprung.compare([same[0], other])
    assert "different axes" in found.parameters["I_xx"].differences[0].why
    assert found.parameters["m_s"].differences[0].p is not None


def test_parts_of_a_vehicle_are_not_compared_with_another_part(same: list[sprung.Result]) -> None:
    """The spring of a pitch plane is two springs of the whole vehicle: a difference of 100 % would be certain."""
    plane = Vehicle.from_parameters(
        {
            name: TABLE_1_CAR.parameters[name] * (1 + (name[:2] in ("m_", "k_", "c_") and name != "m_s"))
            for name in PLANE
        }
    )
    other = identified(plane, 7)
    found = sprung.compare([same[0], other, *same[1:4]], names=["car", "plane", "2", "3", "4"])
    assert found.parameters["k_sf"].values[1].value == pytest.approx(34000, rel=0.05)
    rows = {**found.parameters, **found.modes}
    assert {row.differences[0].finding for row in rows.values()} == {"not comparable"}
    why = {row.differences[0].why for row in rows.values()}
    assert why == {"a whole vehicle and a pitch plane: the same name means another quantity"}
    assert found.joint[0] is None
    assert any("car is of a whole vehicle, plane of a pitch plane" in note for note in found.notes)
    assert not any("heights" in note or "different models" in note for note in found.notes)
    # The others are compared as ever, and scatter is that of the whole vehicles.
    assert found.parameters["k_sf"].differences[1].p is not None
    assert {scatter.names for scatter in found.scatter.values()} == {("car", "2", "3", "4")}
    shown = " ".join(text_of(comparison_view(found)).split())
    assert shown.count("(a whole vehicle and a pitch plane: the same name means another quantity).") == 1
    assert differences_picture(sprung.compare([same[0], other])) is None


def test_the_same_result_twice_is_noticed(same: list[sprung.Result]) -> None:
    found = sprung.compare([same[0], same[0]])
    assert any("are the same result" in note for note in found.notes)
    assert [one.name for one in found.results] == ["Table 1 car (1)", "Table 1 car (2)"]


def test_scatter_of_a_line(same: list[sprung.Result], worn: sprung.Result) -> None:
    alike = sprung.compare(same)
    assert not any(one.stands_out for one in alike.scatter.values())
    assert alike.scatter["c_sf"].spread < 0.003 * 1500
    found = sprung.compare([*same[:12], worn], names=[*(str(i) for i in range(12)), "worn"])
    assert found.scatter["c_sf"].furthest == "worn"
    assert found.scatter["c_sf"].stands_out
    assert found.scatter["c_sf"].p < 1e-9
    assert not found.scatter["k_sf"].stands_out


@pytest.mark.slow
def test_scatter_is_what_was_put_in() -> None:
    """Lines of 20 with a spread of 2 about 100 and errors of 1; on half of them one is 16 away."""
    random = np.random.default_rng(3)
    means, spreads, false, found = [], [], 0, 0
    for _ in range(400):
        values = 100 + random.normal(0, 2, 20) + random.normal(0, 1, 20)
        rows = [(str(i), float(value), 1.0) for i, value in enumerate(values)]
        one = estimate_scatter({"k": rows})["k"]
        false += one.stands_out
        means.append((one.mean - 100) / one.mean_std)
        spreads.append(one.spread)
        rows[7] = ("7", 116.0, 1.0)
        found += estimate_scatter({"k": rows})["k"].stands_out
    assert np.std(means) == pytest.approx(1, abs=0.12)  # three standard errors of 400
    assert np.sqrt(np.mean(np.square(spreads))) == pytest.approx(2, abs=0.1)
    assert false <= binom.isf(1e-3, 400, 0.05)
    assert found > 380
    assert estimate_scatter({"k": [("a", 1.0, 0.1), ("b", 2.0, 0.1)]}) == {}


def test_nothing_to_compare_is_said(same: list[sprung.Result]) -> None:
    with pytest.raises(InputError, match="found 1 result; expected two or more"):
        sprung.compare(same[:1])
    with pytest.raises(InputError, match="expected two or more"):
        sprung.compare("results")
    with pytest.raises(InputError, match="a unique name for each"):
        sprung.compare(same[:2], names=["a", "a"])
    with pytest.raises(InputError) as refused:
        sprung.compare(["nowhere", "here", same[0]])
    assert len(refused.value.problems) == 2


def test_the_command(saved: Path) -> None:
    said = run("compare", saved / "before" / "results", saved / "after" / "results" / "results.json")
    assert (said.status, said.err) == (0, "")
    assert "after minus before: 1 of 15 parameters differ" in said.out
    line = next(line for line in said.out.splitlines() if line.startswith("c_sf") and "certain" in line)
    assert line.split()[1].startswith("-")
    document = run("compare", saved / "before" / "results", saved / "after" / "results", "--json").json
    assert [one["name"] for one in document["results"]] == ["before", "after"]
    assert document["parameters"]["c_sf"]["differences"][0]["finding"] == "certain"
    many = run("compare", *(saved / name / "results" for name in ("before", "after", "again")), columns=50)
    assert "Scatter of 3 results" in many.out
    assert "again minus before: 0 of 15 parameters differ" in many.out


def test_every_width_shows_every_number(saved: Path) -> None:
    found = sprung.compare([saved / name / "results" for name in ("before", "after", "again")])
    check_view_is_whole(comparison_view(found), tables=5)


def test_a_rejected_result_leaves_with_status_3(saved: Path, rejected: sprung.Result, tmp_path: Path) -> None:
    rejected.save(tmp_path / "bus")
    for flags in ((), ("--json",)):
        assert run("compare", saved / "before" / "results", tmp_path / "bus", *flags).status == 3


def test_spoilt_files_leave_with_status_2(saved: Path, tmp_path: Path) -> None:
    text = (saved / "before" / "results" / "results.json").read_text(encoding="utf-8")
    newer, cut, edited = (tmp_path / f"{name}.json" for name in ("newer", "cut", "edited"))
    newer.write_text(text.replace('"schema": 1', '"schema": 2'), encoding="utf-8")
    cut.write_text(text[:1000], encoding="utf-8")
    document = json.loads(text)
    document["parameters"]["c_sf"]["std"] /= 10
    edited.write_text(json.dumps(document), encoding="utf-8")
    said = run("compare", newer, cut, edited, saved / "after" / "results")
    assert said == Run(2, "", said.err)
    assert "3 faults" in said.err
    assert all(word in said.err for word in ("schema 2", "cut off", "changed after it was written"))
    assert "Did you mean" in run("compare", saved / "before", saved / "after").err
