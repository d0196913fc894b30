"""The table of model terms, second part: those whose forces are nonlinear."""

from __future__ import annotations

import math

from sprung.selection.description import TermDescription, Values
from sprung.selection.model_term import ModelTerm, of_axles
from sprung.selection.structure import ModelStructure

BUMP_STOP = "bump-stop"
"""A term with starts of its own."""

_TRAVEL = 0.002
"""m of travel at which a spring's force is that of a usual friction."""

_PRESLIDING_RATIO = 10.0
"""Stiffness of a friction before it slides, over that of the spring, at the start of a fit."""

_STROKE, _TYRE_STROKE = 0.05, 0.02
"""m of travel over which a progressive spring and a progressive tyre are judged."""

_AIR_GROWTH = 2.3
"""Growth of an air spring's rate per compression by the height of its column: the polytropic exponent plus one."""

_KNEE, _KNEE_LOSS, _ROUNDING = 0.12, 0.5, 0.3
"""m/s at which the curve of a damper usually has its knee, the part of its slope that it usually loses there, and half the
width of its rounding as a part of the velocity."""

_NEXT_KNEE = 2.5
"""Velocity of a further knee over that of the one before, at the start of a fit."""

_REBOUND, _TYRE_GROWTH = 0.8, 0.2
"""Usual excess of rebound over compression damping, and growth of a tyre's rate."""


def _air_springs(name: str, height: str, levelled: str) -> ModelTerm:
    """Return the row of air springs, given the first letters of the parameter that is one over the height of their columns."""
    return ModelTerm(
        name,
        of_axles(lambda p, axle: _STROKE * _AIR_GROWTH * p[f"{height}{axle}"]),
        typical=0.6,
        spread=1.6,
        negligible=0.02,
        description=TermDescription(
            f"{{axle}} air springs{levelled} with a column of {{1}}",
            ((lambda p, axle: p[f"{height}{axle}"], "1/m"), (lambda p, axle: 1e3 / p[f"{height}{axle}"], "mm")),
            again="{axle} ones with a column of {1}",
        ),
    )


def _further_knee(number: int, word: str, before: str, ratio: str) -> ModelTerm:
    """Return the term of a further knee of the damper curves, given the indices of the knee before it."""

    def first(own: Values, _: ModelStructure) -> Values:
        velocities = {f"v_{number}{axle}": _NEXT_KNEE * own.get(f"v_{before}{axle}", _KNEE) for axle in "fr"}
        return velocities | {f"q_{number}{axle}": math.sqrt(own.get(f"q_{ratio}{axle}", 1.0)) for axle in "fr"}

    return ModelTerm(
        f"{word}-knee",
        of_axles(lambda p, axle: 1 - p[f"q_{number}{axle}"]),
        typical=_KNEE_LOSS,
        spread=1.6,
        negligible=0.04,
        description=TermDescription(
            f"{{axle}} damper curves with a {word} knee, {{0}} of their rate beyond {{1}}",
            ((lambda p, axle: p[f"q_{number}{axle}"], "1"), (lambda p, axle: p[f"v_{number}{axle}"], "m/s")),
            again="{axle} ones with {0} beyond {1}",
            neutral=1.0,
        ),
        undefined=lambda _, __: {f"v_{number}{axle}": _NEXT_KNEE * _KNEE for axle in "fr"},
        first=first,
    )


NONLINEAR_TERMS = (
    ModelTerm(
        "friction",
        of_axles(lambda p, axle: p[f"F_{axle}"] / (_TRAVEL * p[f"k_s{axle}"])),
        usual=lambda own, _: {f"F_{axle}": _TRAVEL * own[f"k_s{axle}"] for axle in "fr"},
        typical=1.0,
        spread=3.0,
        negligible=0.01,
        description=TermDescription(
            "dry friction of {0} at each {axle} wheel",
            ((lambda p, axle: p[f"F_{axle}"], "N"),),
            again="{0} at each {axle} wheel",
        ),
        resembles_others=True,
        held="s_",
        undefined=lambda own, _: {f"s_{axle}": _PRESLIDING_RATIO * own[f"k_s{axle}"] for axle in "fr"},
        first=lambda own, _: {f"F_{axle}": _TRAVEL * own[f"k_s{axle}"] for axle in "fr"},
    ),
    ModelTerm(
        "load-friction",
        of_axles(lambda p, axle: p[f"u_{axle}"]),
        typical=0.05,
        spread=2.0,
        negligible=0.005,
        description=TermDescription(
            "dry friction that grows by {0} of the load on each {axle} wheel",
            ((lambda p, axle: 100 * p[f"u_{axle}"], "%"),),
            again="by {0} on each {axle} wheel",
        ),
    ),
    ModelTerm(
        "rebound",
        of_axles(lambda p, axle: p[f"r_{axle}"] - 1),
        usual=lambda _, __: dict.fromkeys(("r_f", "r_r"), 1 + _REBOUND),
        typical=_REBOUND,
        spread=2.0,
        negligible=0.01,
        description=TermDescription(
            "{axle} dampers {0} times as stiff in rebound as in compression",
            ((lambda p, axle: p[f"r_{axle}"], "1"),),
            again="{axle} ones {0} times",
            neutral=1.0,
        ),
    ),
    ModelTerm(
        "damper-curve",
        of_axles(lambda p, axle: 1 - p[f"q_{axle}"]),
        usual=lambda _, __: {"v_kf": _KNEE, "v_kr": _KNEE, "q_f": 1 - _KNEE_LOSS, "q_r": 1 - _KNEE_LOSS},
        typical=_KNEE_LOSS,
        spread=1.6,
        negligible=0.02,
        description=TermDescription(
            "{axle} dampers with {0} of their rate beyond {1}",
            ((lambda p, axle: p[f"q_{axle}"], "1"), (lambda p, axle: p[f"v_k{axle}"], "m/s")),
            again="{axle} ones with {0} beyond {1}",
            neutral=1.0,
        ),
        undefined=lambda _, __: {f"v_k{axle}": _KNEE for axle in "fr"},
    ),
    ModelTerm(
        "rounded-knee",
        of_axles(lambda p, axle: p[f"w_k{axle}"] / p.get(f"v_k{axle}", _KNEE)),
        typical=0.3,
        spread=2.0,
        negligible=0.05,
        description=TermDescription(
            "{axle} damper knees rounded over {0} on both sides",
            ((lambda p, axle: p[f"w_k{axle}"], "m/s"),),
            again="{axle} ones over {0}",
        ),
        is_stationary=True,
        first=lambda own, _: {f"w_k{axle}": _ROUNDING * own.get(f"v_k{axle}", _KNEE) for axle in "fr"},
    ),
    _further_knee(2, "second", "k", ""),
    _further_knee(3, "third", "2", "2"),
    ModelTerm(
        "progressive",
        of_axles(lambda p, axle: _STROKE * p[f"p_{axle}"]),
        typical=0.2,
        spread=2.5,
        negligible=0.02,
        description=TermDescription(
            "{axle} springs whose rate grows by {0} over 5 cm of compression",
            ((lambda p, axle: 100 * _STROKE * p[f"p_{axle}"], "%"),),
            again="{axle} ones by {0}",
        ),
    ),
    _air_springs("air", "e_", ""),
    _air_springs("levelled-air", "e_l", ", levelled under every load,"),
    ModelTerm(
        "tyre-curve",
        of_axles(lambda p, axle: _TYRE_STROKE * p[f"h_t{axle}"]),
        usual=lambda _, __: dict.fromkeys(("h_tf", "h_tr"), _TYRE_GROWTH / _TYRE_STROKE),
        typical=_TYRE_GROWTH,
        spread=2.0,
        negligible=0.01,
        description=TermDescription(
            "{axle} tyres whose rate grows by {0} over the first 2 cm of deflection",
            ((lambda p, axle: 100 * _TYRE_STROKE * p[f"h_t{axle}"], "%"),),
            again="{axle} ones by {0}",
        ),
    ),
    ModelTerm(
        BUMP_STOP,
        of_axles(lambda p, axle: p[f"k_b{axle}"] / p[f"k_s{axle}"]),
        typical=3.0,
        spread=3.0,
        negligible=0.02,
        description=TermDescription(
            "{axle} bump stops of {0}, met after {1} of compression",
            ((lambda p, axle: p[f"k_b{axle}"] / 1e3, "N/mm"), (lambda p, axle: 1e3 * p[f"x_b{axle}"], "mm")),
            again="{axle} ones of {0}, met after {1}",
        ),
        undefined=lambda _, structure: dict.fromkeys(("x_bf", "x_br"), structure.stop_gap),
    ),
)
