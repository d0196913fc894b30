"""Recordings of few bits: what quantisation leaves is no noise, and no term of the model either."""

from coloured import coarse
from fleet import FLEET

import sprung


def test_a_term_that_is_not_determined_in_the_end_is_left_out() -> None:
    """A Zener branch is accepted on the way; once the fit has moved, nothing determines its relaxation time."""
    result = sprung.identify(FLEET[2].campaign(1057, coarse))
    assert result.fit.model == ()
    assert not result.faults
    assert result.verdict.state == "accept"
