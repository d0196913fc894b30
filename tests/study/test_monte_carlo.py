"""Monte Carlo of a planned test: the same campaigns as by hand, resumed, with honest figures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import binom, binomtest

import sprung
from command_line import run
from sprung.batch import read_rows
from sprung.errors import InputError
from sprung.report import monte_carlo_view, text_of
from sprung.study.monte_carlo_summary import accuracy_of, share
from sprung.uncertainty import KnownValue
from sprung.vehicle import TABLE_1_CAR, Vehicle

DROPS = ({"wheels": ("fl", "fr")}, {"wheels": ("fl", "rl")})
TEST: dict[str, Any] = {
    "drops": DROPS,
    "duration": 1.5,
    "model": {"extras": (), "tracks": "shared", "fall": False},
    "known": {"total_mass": {"std": 5.0}},
}
VEHICLE = (
    "[vehicle]\nname = 'Car'\nwheelbase = 2.76\n[model]\nextras = []\ntracks = 'shared'\n[parameters]\n"
    + "".join(f"{name} = {value}\n" for name, value in TABLE_1_CAR.parameters.items())
    + "[known]\ntotal_mass = { value = 1551.8, std = 5 }\n[[drop]]\nwheels = ['fl', 'fr']\n[[drop]]\nwheels = ['fl', 'rl']\n"
)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, sprung.study.MonteCarlo]:
    folder = tmp_path_factory.mktemp("study")
    return folder, sprung.study.monte_carlo(TABLE_1_CAR, TEST, 8, 2, output=folder)


Study = tuple[Path, sprung.study.MonteCarlo]


@pytest.mark.slow
def test_figures_are_those_of_the_estimates(study: Study) -> None:
    folder, found = study
    values = np.array(_column(folder, "k_sf"))
    stds = np.array(_column(folder, "k_sf_std"))
    one = found.parameters["k_sf"]
    errors = 100 * (values / 17000 - 1)
    assert (one.estimated, one.undetermined, one.unit, one.true) == (8, 0, "N/m", 17000)
    assert one.bias == pytest.approx(errors.mean())
    assert one.scatter == pytest.approx(errors.std(ddof=1))
    assert one.bias_std == pytest.approx(errors.std(ddof=1) / np.sqrt(8))
    assert one.stated == pytest.approx(100 * np.sqrt(np.mean((stds / 17000) ** 2)))
    inside = np.abs(np.log(values / 17000)) < 1.96 * stds / values
    assert one.coverage.count == inside.sum()
    assert found.verdicts["accept"].of == 8
    assert sum(verdict.count for verdict in found.verdicts.values()) == 8


def _column(folder: Path, name: str) -> list[float]:
    return [row[name] for row in read_rows(folder, (name,))]


def test_every_campaign_has_its_own_noise_and_weighing(study: Study) -> None:
    folder, _ = study
    masses, springs = (np.array(_column(folder, name)) for name in ("total_mass", "front_ride_frequency"))
    assert len(set(springs)) == 8
    assert 1.5 < masses.std(ddof=1) < 11  # 5 kg from eight: 95 % between 3.3 and 10.2
    assert abs(masses.mean() - TABLE_1_CAR.total_mass) < 4 * 5 / np.sqrt(8)


@pytest.mark.slow
def test_more_campaigns_go_on(study: Study) -> None:
    folder, found = study
    more = sprung.study.monte_carlo(TABLE_1_CAR, TEST, 9, 1, output=folder)
    assert (more.computed, more.counts.done) == (1, 9)
    fewer = sprung.study.monte_carlo(TABLE_1_CAR, TEST, 8, 1, output=folder)
    assert (fewer.computed, fewer.document()["parameters"]) == (0, found.document()["parameters"])


def test_another_study_in_the_folder_is_refused_and_what_differs_is_named(study: Study) -> None:
    folder, _ = study

    def descriptions(*, vehicle: Vehicle = TABLE_1_CAR, seed: int = 1, **changes: object) -> list[list[str]]:
        """Return the parts of both descriptions: vehicle, options and seed."""
        with pytest.raises(InputError) as refused:
            sprung.study.monte_carlo(vehicle, {**TEST, **changes}, 8, 1, output=folder, seed=seed)
        (problem,) = refused.value.problems
        texts = (problem.found.removeprefix("rows of "), problem.expected.removeprefix("rows of "))
        return [text.removeprefix("a Monte Carlo study (").rstrip(")").split("; ") for text in texts]

    there, wanted = descriptions(noise=0.05)
    assert (there[0], there[2]) == (wanted[0], wanted[2])
    assert (there[1][:14], wanted[1][:14]) == ("duration 1.5, ", "duration 1.5, ")
    assert ("noise" in there[1], "noise 0.05, " in wanted[1]) == (False, True)
    there, wanted = descriptions(seed=2)
    assert (there[:2], there[2], wanted[2]) == (wanted[:2], "seed 1", "seed 2")
    worn = Vehicle.from_parameters({**TABLE_1_CAR.parameters, "c_sf": 1300.0}, name="worn")
    there, wanted = descriptions(vehicle=worn)
    assert (there[1:], there[0][:21], wanted[0][:12]) == (wanted[1:], "vehicle Table 1 car, ", "vehicle worn")
    there, wanted = descriptions(drops=DROPS[:1])
    assert (there[0], there[2]) == (wanted[0], wanted[2])
    assert there[1].partition("other options ")[2] != wanted[1].partition("other options ")[2]


def test_a_test_that_cannot_be_done_is_refused_before_any_campaign(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="simulate: drops"):
        sprung.study.monte_carlo(TABLE_1_CAR, {"drops": [{"wheels": ("fl",), "load": "sand"}]}, 5, output=tmp_path)
    with pytest.raises(InputError, match="found 0; expected 1 or more"):
        sprung.study.monte_carlo(TABLE_1_CAR, n=0)
    with pytest.raises(InputError, match="found seed; expected other arguments"):
        sprung.study.monte_carlo(TABLE_1_CAR, {"seed": 3})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("count", "of"), [(0, 20), (19, 20), (190, 200), (20, 20)])
def test_the_interval_of_a_share_is_wilsons(count: int, of: int) -> None:
    """SciPy's as the independent computation."""
    expected = binomtest(count, of).proportion_ci(0.95, method="wilson")
    assert (share(count, of).low, share(count, of).high) == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_a_rejected_campaign_has_no_estimates() -> None:
    rows = [
        {"verdict": "reject", "k_sf": None, "k_sf_std": None},
        {"verdict": "doubtful", "k_sf": None, "k_sf_std": None},
    ]
    one = accuracy_of("k_sf", 17000.0, rows)
    assert (one.estimated, one.undetermined, one.bias, one.coverage.of) == (0, 1, None, 0)


def test_a_bias_is_significant_as_often_as_three_standard_errors_are() -> None:
    """Unbiased estimates: 0.27 % of studies, also of two campaigns, of which |bias| > 3 standard errors in 20 %."""
    random = np.random.default_rng(5)
    for count in (2, 6):
        found = 0
        for _ in range(1000):
            values = 17000 + 100 * random.standard_normal(count)
            rows = [{"verdict": "accept", "k_sf": float(value), "k_sf_std": 100.0} for value in values]
            found += accuracy_of("k_sf", 17000.0, rows).is_biased
        assert found <= binom.isf(1e-3, 1000, 0.0027)
    assert accuracy_of("k_sf", 15000.0, rows).is_biased
    assert not accuracy_of("k_sf", 15000.0, rows[:1]).is_biased


def test_what_is_said_of_bias(study: Study) -> None:
    _, found = study
    assert "no bias of the 15 estimated parameters is significant (Student's t" in _shown(found)
    known = accuracy_of("m_s", 345.0, [{"verdict": "accept", "m_s": 345.0, "m_s_std": 0.0}] * 8)
    parameters = {**found.parameters, "m_s": known, "k_sf": replace(found.parameters["k_sf"], bias=5.0, bias_std=0.1)}
    assert "significant bias: k_sf (" in _shown(replace(found, parameters=parameters))
    assert "no bias of the 14 " in _shown(replace(found, parameters={**found.parameters, "m_s": known}))
    alone = accuracy_of("k_sf", 17000.0, [{"verdict": "accept", "k_sf": 17100.0, "k_sf_std": 100.0}])
    assert "nothing can be said of bias" in _shown(replace(found, parameters={"k_sf": alone, "m_s": known}))


def _shown(found: sprung.study.MonteCarlo) -> str:
    return " ".join(text_of(monte_carlo_view(found)).split())


@pytest.mark.slow
def test_the_command(tmp_path: Path) -> None:
    (tmp_path / "car.toml").write_text(VEHICLE)
    said = run("study", tmp_path / "car.toml", "--campaigns", "3", "-o", tmp_path / "out", "--workers", "1")
    assert said.status == 0
    assert "Car: 3 campaigns simulated and identified, 0 failed." in said.out
    assert "coverage %" in said.out
    again = run("study", tmp_path / "car.toml", "--campaigns", "3", "-o", tmp_path / "out", "--json")
    assert again.json["campaigns"] == {"done": 3, "failed": 0, "computed": 0}
    assert again.json["parameters"]["k_sf"]["true"] == 17000


@pytest.mark.slow
def test_known_values_without_uncertainty_are_the_same_in_all() -> None:
    known = {"total_mass": KnownValue(TABLE_1_CAR.total_mass)}
    found = sprung.study.monte_carlo(TABLE_1_CAR, {**TEST, "known": known}, 2, 1)
    assert found.folder is None
    assert found.counts.done == 2
