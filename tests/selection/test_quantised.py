"""Recordings of few bits: what quantisation leaves is no noise, and no term of the model either."""

import pytest
from coloured import coarse
from fleet import FLEET

import sprung
from sprung.vehicle import TABLE_1_CAR


@pytest.mark.parametrize("seed", [1057, 1097])
@pytest.mark.slow
def test_a_term_that_is_not_determined_in_the_end_is_left_out(seed: int) -> None:
    """A Zener branch is accepted on the way; in the end nothing determines its relaxation times."""
    result = sprung.identify(FLEET[2].campaign(seed, coarse))
    assert result.fit.model == ()
    assert not result.faults
    assert result.verdict.state == "accept"


def test_an_unknown_scale_speaks_against_no_term() -> None:
    """Nothing weighed and no load: every rate is as uncertain as itself, their ratios are not."""
    car = TABLE_1_CAR.with_values(k_zf=3000.0, k_zr=3600.0, c_zf=150.0, c_zr=250.0)
    result = sprung.identify(sprung.simulate(car, noise=0.005, seed=1))
    assert not result.scale.known
    assert result.fit.model == ("zener",)
