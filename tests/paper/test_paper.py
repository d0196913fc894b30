"""The paper reproduced; expected values are the paper's own, or follow from exactness."""

import numpy as np
import pytest

from layouts import check_view_is_whole
from sprung.paper import PaperReproduction, reproduce
from sprung.paper.method import FIVE_BUMPS, bump_campaign
from sprung.paper.misprints import find_misprints, table_2_misfits, table_3_misfits
from sprung.paper.printed import TABLE_2, TABLE_3
from sprung.paper.reproduction import CAR_LOAD, fit_all_records
from sprung.report import paper_view
from sprung.vehicle import SCHOOL_BUS, TABLE_1_CAR


@pytest.fixture(scope="module")
def reproduction() -> PaperReproduction:
    return reproduce(joint_fit=None, noise_levels=(0.0, 1e-4, 1e-2), seeds=2)


def test_table_2_without_noise_is_exact(reproduction: PaperReproduction) -> None:
    # The paper's worst error is 1.493 %; its method, done in sixteen digits, has none.
    rows = reproduction.table2
    assert [row.name for row in rows] == list(TABLE_2)
    assert all(row.known == TABLE_2[row.name].known for row in rows)
    assert max(abs(row.error_percent) for row in rows) < 1e-6


def test_table_3_is_the_model_of_tables_4_and_5(reproduction: PaperReproduction) -> None:
    rows = {row.paper_name: row for row in reproduction.table3}
    assert list(rows) == list(TABLE_3)
    # Rows without a misprint whose mode the rounding of Table 5 leaves alone: all four printed digits.
    for mode in ("body roll", "wheel roll", "wheel articulation"):
        assert rows[mode].computed.natural_frequency == pytest.approx(rows[mode].paper.natural_frequency, abs=4e-4)
        assert rows[mode].computed.damping_ratio == pytest.approx(rows[mode].paper.damping_ratio, abs=1e-4)
    assert rows["body bounce"].computed.natural_frequency == pytest.approx(2.0074, rel=4e-3)


def test_the_bus_is_identified_back_where_equation_18_is_singular(reproduction: PaperReproduction) -> None:
    assert {row.name: row.known for row in reproduction.bus} == SCHOOL_BUS.parameters
    assert {row.name for row in reproduction.bus if row.given} == {"a", "b", "t_f2", "t_r2"}
    assert max(abs(row.error_percent) for row in reproduction.bus) < 1e-8


def test_noise_ruins_the_papers_method(reproduction: PaperReproduction) -> None:
    # 0.01 m/s² is half the noise of a usual sensor.
    errors = {point.noise: point.paper_method for point in reproduction.noise}
    assert errors[0.0] < 1e-6
    assert 0.01 < errors[1e-4] < 5
    assert errors[1e-2] > 20
    assert all(point.joint_fit is None for point in reproduction.noise)


def test_every_width_shows_all_of_it(reproduction: PaperReproduction) -> None:
    check_view_is_whole(paper_view(reproduction), tables=4)


def test_corners_that_the_vehicle_imitates_overflow_nothing() -> None:
    # The second draw of this noise: warnings are errors here.
    campaign = bump_campaign(TABLE_1_CAR, CAR_LOAD, FIVE_BUMPS, noise=0.01, seed=1)
    assert set(fit_all_records(campaign)) >= set(TABLE_2)


def test_the_joint_fit_stands_beside_it() -> None:
    told: list[str] = []
    result = reproduce(told.append, noise_levels=(0.02,), seeds=1)
    point = result.noise[0]
    assert point.joint_fit is not None
    assert point.joint_fit < 1 < point.paper_method
    assert any("Table 2" in text for text in told)


def test_a_joint_fit_that_misses_a_parameter_is_infinitely_wrong() -> None:
    some = {name: value for name, value in TABLE_1_CAR.parameters.items() if name != "t_r"}
    result = reproduce(joint_fit=lambda _: some, noise_levels=(0.0,))
    assert result.noise[0].joint_fit == np.inf


def test_the_misprinted_rows_are_found_and_no_others() -> None:
    # Table 2: 16600.17/17000 - 1 = -2.35 %. Table 3: 2.8995 √(1 - 0.1626²) = 2.8609 and so on, by a pocket calculator.
    assert table_2_misfits() == {"k_sf": pytest.approx(-2.3519, abs=1e-3)}
    assert table_3_misfits() == {
        "body pitch": pytest.approx(2.8609, abs=1e-4),
        "wheel bounce": pytest.approx(12.2746, abs=1e-4),
        "wheel pitch": pytest.approx(12.3946, abs=1e-4),
    }


def test_misprints_carry_their_numbers() -> None:
    found = {misprint.where: misprint for misprint in find_misprints()}
    assert len(found) == len(find_misprints())
    assert all(text for one in found.values() for text in (one.where, one.printed, one.should_be, one.reason))
    assert found["Table 2, k_sf"].should_be == "16900.17"
    assert "2.8584" in found["Table 3, body pitch"].should_be  # 2.8204 / √(1 - 0.1626²)
    assert found["Table 3, wheel bounce"].should_be.endswith("exchanged")
    assert "rank 6 in the 7 masses, so 1 number" in found["section 2.2, after eq. (14)"].reason
    assert "jumps to 0.09 m" in found["eq. (19)"].reason
    assert "-17000" in found["eq. (2), K, row 5"].reason
    assert "rank 3 of 7" in found["section 4.1 with eq. (18)"].reason
