"""Rigs of the study of parts of vehicles as they are that were once misjudged: what each lacked is named beside it."""

from __future__ import annotations

import pytest
from parts_as_they_are import try_rig

WIDE = 4.5
"""Standard errors; the largest of 60 to 150 errors is expected at 3."""

LIMIT = 1200.0
"""s of processor time, which none reaches on any machine."""


@pytest.mark.parametrize(
    ("number", "terms"),
    [
        # Friction left tyres that stiffen: large and small motions disagreed, and that spoke against what makes them so.
        pytest.param(4, ("friction", "tyre-curve"), marks=pytest.mark.slow, id="friction, tyre curve"),
        pytest.param(49, ("friction", "progressive"), marks=pytest.mark.long, id="friction, progressive"),
        # Springs of three laws were tried, and no tyre: neither the spring nor the tyre explains most of the misfit.
        pytest.param(12, ("progressive", "tyre-curve"), marks=pytest.mark.long, id="progressive, tyre curve"),
        # A wrong weight and a sensor 8 % off seemed to explain what a rubber mount does.
        pytest.param(21, ("damper-mount",), marks=pytest.mark.slow, id="mount"),
        # A healthy drop was left out, which moved most: that it differs spoke against the knee that makes it differ.
        pytest.param(15, ("tyre-damping", "zener", "damper-curve"), marks=pytest.mark.long, id="largest drop"),
        # Another one, as a vehicle without friction had let its decay begin in the air.
        pytest.param(112, ("friction", "rebound"), marks=pytest.mark.long, id="decay from the air"),
        # A Zener branch stood for a mount, a tyre that damps and a spring.
        pytest.param(35, ("tyre-damping", "damper-mount", "progressive"), marks=pytest.mark.long, id="three, not one"),
        # With a Zener branch and a spring a mount shows in no score, and tyres with damping below zero explained more of it.
        pytest.param(122, ("damper-mount", "zener", "progressive"), marks=pytest.mark.long, id="mount beside Zener"),
        # All usual terms together left the spring, of which no size is usual.
        pytest.param(129, ("friction", "rebound", "progressive"), marks=pytest.mark.long, id="spring beside all"),
        # Of damping and stiffening of the tyre neither alone leaves what is more like noise.
        pytest.param(183, ("tyre-damping", "progressive", "tyre-curve"), marks=pytest.mark.slow, id="two of a tyre"),
        # A Zener branch that turned out to be nothing had taken the place of a mount.
        pytest.param(187, ("damper-mount", "progressive"), marks=pytest.mark.long, id="mount in place of Zener"),
        # A sound drop was left out, a gyroscope was late and then early, a sensor moved: beside models that lacked something.
        pytest.param(184, ("tyre-damping", "friction"), marks=pytest.mark.long, id="drop taken back"),
        pytest.param(180, ("damper-mount", "tyre-curve"), marks=pytest.mark.long, id="delays taken back"),
        pytest.param(166, ("zener", "tyre-curve"), marks=pytest.mark.long, id="place taken back"),
        # A fit that ended a little beside its optimum seemed to leave what is no more like noise with a tyre that damps.
        pytest.param(300, ("tyre-damping", "zener", "friction"), marks=pytest.mark.slow, id="damping beside friction"),
        # Without rubber no law explains much, nor rubber without the law: two vehicles were blamed.
        pytest.param(306, ("damper-mount", "rebound", "progressive"), marks=pytest.mark.long, id="rubber beside a law"),
        # Two vehicles were blamed, each of which explained its drops: from where one of them ends, it explains all.
        pytest.param(
            320, ("friction", "damper-curve", "tyre-curve"), marks=pytest.mark.long, id="one vehicle, not two"
        ),
    ],
)
def test_each_property_is_found_and_no_other(number: int, terms: tuple[str, ...]) -> None:
    _, outcome = try_rig(number, LIMIT)
    assert (outcome.verdict, outcome.model, outcome.faults) == ("accept", terms, ())
    assert len(outcome.errors) >= 6
    assert outcome.worst_scaled[0] < WIDE


@pytest.mark.long
@pytest.mark.parametrize(
    "number",
    [
        pytest.param(101, id="the only drop with its load left out"),
        pytest.param(111, id="motion without bounds in a first fit"),
        pytest.param(115, id="motion without bounds once a term is left out"),
        pytest.param(326, id="motion without bounds that determines no sensor"),
    ],
)
def test_there_is_a_result(number: int) -> None:
    """These ended with a KeyError, a LinAlgError or a ZeroDivisionError."""
    _, outcome = try_rig(number, LIMIT)
    assert (outcome.verdict, outcome.faults) == ("accept", ())
