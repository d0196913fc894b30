"""What a user of Python meets: records that show themselves, doors that take paths, mistakes that are named."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sprung
from sprung.analysis.options import model_options
from sprung.errors import InputError, UnknownNameError, did_you_mean
from sprung.results import Result
from sprung.vehicle import PARAMETERS, TABLE_1_CAR, all_names

DATA = Path(__file__).resolve().parents[1] / "data"
SAVED = Path(__file__).resolve().parents[1] / "report"
ROOMS = (
    *("errors", "uncertainty", "campaign", "assessment", "planning", "checking"),
    *("results", "modal_survey", "study", "paper"),
)
LINES = 10  # of any record in a console, by the issue


def public_records() -> list[type]:
    """List every dataclass and mapping that a room exports and a user may be given."""
    found = {sprung.Vehicle, sprung.Sensor, sprung.Load}
    for room in ROOMS:
        module = importlib.import_module(f"sprung.{room}")
        names = getattr(module, "__all__", [name for name in vars(module) if name[0].isupper()])
        for value in (getattr(module, name) for name in names):
            if inspect.isclass(value) and (dataclasses.is_dataclass(value) or issubclass(value, dict)):
                found.add(value)
    return sorted(found, key=lambda one: one.__qualname__)


@pytest.fixture(scope="module")
def campaign() -> sprung.Campaign:
    known = {"total_mass": TABLE_1_CAR.total_mass}
    return sprung.simulate(
        TABLE_1_CAR, seed=1, duration=1.6, known=known, model={"extras": (), "tracks": "shared", "fall": False}
    )


@pytest.fixture(scope="module")
def result(campaign: sprung.Campaign) -> Result:
    return sprung.identify(campaign)


def nested(value: Any, seen: set[int]) -> list[Any]:
    """List a record and every record in it."""
    if id(value) in seen:
        return []
    seen.add(id(value))
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        inside = [getattr(value, field.name) for field in dataclasses.fields(value)]
        return [value, *(one for each in inside for one in nested(each, seen))]
    if isinstance(value, dict):
        return [value, *(one for each in value.values() for one in nested(each, seen))]
    return [one for each in value for one in nested(each, seen)] if isinstance(value, tuple | list) else []


@pytest.mark.parametrize("record", public_records(), ids=lambda one: one.__name__)
def test_every_public_record_shows_itself_and_nothing_foreign(record: type) -> None:
    names = {name for name in dir(record) if not name.startswith("_")}
    assert not {name for name in names if name.startswith("model_")} - {"model_"}
    assert not names & {"copy", "dict", "json", "construct", "schema", "parse_obj"} - set(dir(dict))
    assert hasattr(record, "_repr_html_")
    if dataclasses.is_dataclass(record):
        assert record.__dataclass_params__.frozen  # type: ignore[attr-defined]


def test_no_record_takes_more_than_ten_lines(result: Result, campaign: sprung.Campaign) -> None:
    plan = sprung.plan(TABLE_1_CAR)
    compared = sprung.compare([SAVED / "accept.json", SAVED / "doubtful.json"])
    shown = nested((result, campaign, sprung.check(campaign), plan, compared, result.covariance, result.vehicle), set())
    assert len({type(one) for one in shown}) > 25
    for one in shown:
        if type(one) is not dict:
            text = repr(one)
            assert len(text.split("\n")) <= LINES, text
            assert max(map(len, text.split("\n"))) <= 88
            assert one._repr_html_().count("<table") >= 1 or "<p>" in one._repr_html_()


def test_the_package_lists_its_rooms() -> None:
    assert {"plot", "report", "study", "__version__", "identify"} <= set(dir(sprung))


def test_a_change_of_a_result_is_a_replace(result: Result) -> None:
    assert replace(result, next_step="none").next_step == "none"
    with pytest.raises(dataclasses.FrozenInstanceError):
        result.next_step = "none"  # type: ignore[misc]


def test_estimates_format_as_numbers_or_with_uncertainty(result: Result) -> None:
    found = result.parameters["k_sf"]
    assert found.value is not None
    assert f"{found:.3g}" == f"{found.value:.3g}"
    assert f"{found}" == str(found)
    assert str(found).endswith(" N/m")
    assert " ± " in str(found)


def test_a_mistyped_name_is_told() -> None:
    result = sprung.load(SAVED / "accept.json", series=False)
    with pytest.raises(KeyError, match="Did you mean 'k_sr'") as caught:
        result.parameters["ksr"]
    assert isinstance(caught.value, UnknownNameError)
    assert result.parameters.get("ksr") is None


@pytest.mark.parametrize(
    ("written", "meant"),
    [("k_fs", "k_sf"), ("m_su", "m_s"), ("k_rt", "k_tr"), ("weelbase", "wheelbase"), ("M_S", "m_s")],
)
def test_exchanged_letters_are_one_typing_error(written: str, meant: str) -> None:
    names = [name for name in PARAMETERS if name in all_names("full")]
    assert did_you_mean(written, (*names, "wheelbase")) == f"Did you mean '{meant}'?"


def test_covariance_and_criteria_survive_saving(result: Result, campaign: sprung.Campaign, tmp_path: Path) -> None:
    again = sprung.load(result.save(tmp_path))
    for one in (result, again):
        assert one.covariance["m_s", "m_s"] == pytest.approx((one.parameters["m_s"].std or 0) ** 2, rel=1e-12)
        np.testing.assert_allclose(np.asarray(one.covariance), np.asarray(one.covariance).T, rtol=1e-6)
        assert one.loglikelihood is not None
        assert one.aic == 2 * (one.fit.unknowns or 0) - 2 * one.loglikelihood
        assert one.bic == pytest.approx((one.fit.unknowns or 0) * math.log(one.fit.samples) - 2 * one.loglikelihood)
    assert (again.aic, again.bic, again.vehicle) == (result.aic, result.bic, result.vehicle)
    # 15 parameters less two exact statements, a noise for each channel, and for each drop 14 initial values and 8 offsets.
    assert result.fit.unknowns == 13 + 8 + len(campaign.drops) * (14 + 8)
    # White residuals of estimated noise: the likelihood follows from the noise alone, to the part of the eliminated unknowns.
    expected = -sum(
        0.5 * result.fit.samples / 8 * (math.log(2 * math.pi * s**2) + 1) for s in result.fit.noise.values()
    )
    assert abs((result.loglikelihood or 0) - expected) < result.fit.unknowns


def test_tables_for_pandas(result: Result, campaign: sprung.Campaign) -> None:
    table = result.to_dataframe()
    assert list(table.columns) == ["value", "std", "lower95", "upper95", "unit", "status"]
    assert table.loc["m_s", "value"] == result.parameters["m_s"].value
    assert list(sprung.check(campaign).to_dataframe().index) == [drop.file for drop in campaign.drops]


def test_a_comparison_as_a_table(result: Result, tmp_path: Path) -> None:
    """Each number is that of the records; results that were saved say the same."""
    other = replace(result, parameters=result.parameters | {"k_sf": replace(result.parameters["k_sf"], value=2e4)})
    compared = sprung.compare([result, other], names=["before", "after"])
    table = compared.to_dataframe()
    assert list(table.columns)[:4] == ["value", "std", "unit", "difference"]
    assert len(table) == 2 * (len(compared.parameters) + len(compared.modes))
    assert table.loc[("k_sf", "after"), "value"] == 2e4
    assert table.loc[("k_sf", "after"), "difference"] == compared.parameters["k_sf"].differences[0].value
    assert table.loc[("k_sf", "after"), "finding"] == "certain"
    assert table["difference"].xs("before", level="result").isna().all()
    folders = [one.save(tmp_path / name) for one, name in ((result, "a"), (other, "b"))]
    saved = sprung.compare(folders, names=["before", "after"]).to_dataframe()
    assert saved["value"].to_list() == table["value"].to_list()


def test_small_mappings_are_written_out_and_large_ones_counted(result: Result) -> None:
    known = repr(sprung.simulate(TABLE_1_CAR, drops=[{}], duration=0.6, known={"total_mass": 1551.8}))
    assert "known={total_mass: KnownValue(value=1551.8)}" in " ".join(known.split())
    assert "noise=8 by name: body_fl, body_fr, body_rl, body_rr, ..." in " ".join(repr(result.fit).split())


def test_a_vehicle_shows_what_it_was_made_with() -> None:
    text = repr(TABLE_1_CAR)
    assert "t_f=0.74" in text
    assert "t_f1=" not in text
    assert "n_f=" not in text
    assert eval(text, {"Vehicle": sprung.Vehicle}) == TABLE_1_CAR  # noqa: S307 (our own text)
    assert "cg_height=0.5" in repr(replace(TABLE_1_CAR, cg_height=0.5))


def test_mappings_of_records_are_brief(result: Result) -> None:
    mapping: Any
    for mapping in (result.validation, result.series, result.recordings):
        assert len(repr(mapping).split("\n")) <= LINES
        assert "<table" in mapping._repr_html_()


def test_the_identified_vehicle_can_be_simulated_or_says_why_not(result: Result) -> None:
    assert result.vehicle.total_mass == pytest.approx(TABLE_1_CAR.total_mass, rel=1e-9)
    assert sprung.simulate(result.vehicle, drops=[{}], seed=1).name == result.name
    with pytest.raises(InputError, match="the verdict reject"):
        _ = replace(result, verdict=replace(result.verdict, state="reject")).vehicle
    with pytest.raises(InputError, match="no value of m_s"):
        _ = sprung.load(SAVED / "unidentifiable.json", series=False).vehicle


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"tracks": "seperate"}, "Did you mean 'separate'"),
        ({"extras": "frction"}, "Did you mean 'friction'"),
        ({"extras": ["friction", "rebond"]}, "Did you mean 'rebound'"),
        ({"start": {"k_s_f": 1.0}}, "Did you mean 'k_sf'"),
        ({"start": {"k_sf": "stiff"}}, "a number, SI"),
        ({"start": 3}, "a result, a vehicle, or values by name"),
    ],
)
def test_options_are_checked_before_anything_is_read(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        sprung.identify("no such file.toml", **options)


def test_one_extra_by_its_name() -> None:
    assert model_options(None, "friction") == (None, ("friction",))


def test_a_path_does_where_a_campaign_does(campaign: sprung.Campaign, tmp_path: Path) -> None:
    file = sprung.write(campaign, tmp_path)
    assert sprung.check(file).usable
    assert sprung.check(str(tmp_path)).usable
    with pytest.raises(TypeError, match="not int"):
        sprung.check(3)  # type: ignore[arg-type]


def test_known_quantities_become_records_and_impossible_ones_are_refused(campaign: sprung.Campaign) -> None:
    given: Any = {"total_mass": 1551.8, "m_s": {"value": 1380, "std": 2}}
    changed = replace(campaign, known=given, wheelbase=2.76)  # type: ignore[arg-type]
    assert changed.known["total_mass"].value == 1551.8
    assert changed.known["m_s"].std == 2
    assert changed.wheelbase is not None
    assert changed.wheelbase.is_exact
    bad: Any
    for bad, message in (({"total_mass": -1551.8}, "positive"), ({"totl_mass": 1.0}, "Did you mean 'total_mass'")):
        with pytest.raises(InputError, match=message):
            replace(campaign, known=bad)
        with pytest.raises(InputError, match=message):
            sprung.simulate(TABLE_1_CAR, known=bad)


def test_parts_of_a_campaign_may_be_mappings(campaign: sprung.Campaign) -> None:
    """As in a campaign file and in a simulation; what is wrong in them is named."""
    given: Any = {"extras": ["friction"], "tracks": "shared"}
    assert replace(campaign, model=given).model.extras == ("friction",)
    wrong: Any = {"model": {"tracks": "seperate"}, "sensors": [{"chanel": "a"}]}
    with pytest.raises(InputError) as caught:
        replace(campaign, **wrong)
    assert "Did you mean 'channel'" in str(caught.value)
    assert "tracks" in str(caught.value)
    with pytest.raises(UnknownNameError, match="Did you mean 'empty'"):
        campaign.load("emty")
    with pytest.raises(InputError, match="Did you mean 'friction'"):
        sprung.identify(replace(campaign, model={"extras": ("frction",)}))  # type: ignore[arg-type]


def test_records_name_what_is_wrong_with_their_keys() -> None:
    wrong: Any = {"chanel": "a", "on": "fl"}
    with pytest.raises(InputError, match="Did you mean 'channel'"):
        sprung.Sensor(**wrong)
    wrong = {"channel": "a", "on": "axle"}
    with pytest.raises(InputError, match=r"Sensor a\.on: found 'axle'; expected 'body', 'fl'"):
        sprung.Sensor(**wrong)
    wrong = {"name": "bags"}
    with pytest.raises(InputError, match="items"):
        sprung.Load(**wrong).elements()


def test_the_start_of_the_search_changes_no_result(result: Result, campaign: sprung.Campaign) -> None:
    far = {"m_s": 900.0, "k_sf": 4e4, "c_sr": 300.0}
    for start in (far, result):
        other = sprung.identify(campaign, start=start)
        for name, found in result.parameters.items():
            # The fit ends where the likelihood is within 1e-8 of its maximum: a ten-thousandth of a standard error.
            away = abs((other.parameters[name].value or 0) - (found.value or 0))
            assert away <= 1e-3 * (found.std or 0), name


def test_modes_of_an_array() -> None:
    """Two channels of one damped mode: s = -0.5 ± 12 j, by construction."""
    t = np.arange(600) / 200
    decay = np.exp(-0.5 * t) * np.array([np.cos(12 * t), 2 * np.sin(12 * t)])
    noisy = decay + 1e-3 * np.random.default_rng(2).standard_normal(decay.shape)
    (mode,) = sprung.modes(noisy, rate=200, order=2, channels=["left", "right"])["recordings"]
    assert mode.pole[0] == pytest.approx(-0.5, abs=5e-3)
    assert abs(mode.pole[1]) == pytest.approx(12, abs=5e-3)
    for wrong, message in (
        ({}, "rate: found nothing"),
        ({"rate": 200.0, "channels": ["one"]}, "1 names"),
    ):
        with pytest.raises(InputError, match=message):
            sprung.modes(noisy, **wrong)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="Transpose"):
        sprung.modes(noisy.T, rate=200)
    with pytest.raises(InputError, match="it is for arrays"):
        sprung.modes(DATA / "sedan", rate=200)
