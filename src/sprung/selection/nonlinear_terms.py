"""The table of model terms, second part: those whose forces are nonlinear."""

from __future__ import annotations

import math

import numpy as np

from sprung.selection.description import TermDescription, Values
from sprung.selection.model_term import ModelTerm, axles_of, of_axles
from sprung.selection.structure import ModelStructure
from sprung.vehicle import parameter_name

BUMP_STOP, DAMPER_CURVE = "bump-stop", "damper-curve"
"""Terms with starts of their own."""

DAMPER_LAW = ("rebound", DAMPER_CURVE, "rounded-knee")
"""Terms that together are the law of most dampers."""

KNEE_RATIOS = (0.5, 2.0)
"""Usual slope of a damper's curve beyond its knee over that before it: of most, whose valves open there, and of those that an
orifice makes the harder the faster they move."""

_TRAVEL = 0.002
"""m of travel at which a spring's force is that of a usual friction."""

_PRESLIDING_RATIO = 10.0
"""Stiffness of a friction before it slides, over that of the spring, at the start of a fit."""

_STROKE, _TYRE_STROKE = 0.05, 0.02
"""m of travel over which a progressive spring and a progressive tyre are judged."""

_AIR_GROWTH = 2.3
"""Growth of an air spring's rate per compression by the height of its column: the polytropic exponent plus one."""

_KNEE, _KNEE_LOSS, _ROUNDING = 0.12, 0.5, 0.3
"""m/s at which the curve of a damper usually has its knee, the usual change of its slope there as a part of it, and half the
width of its rounding as a part of the velocity."""

_FAST = 0.3
"""m/s: velocity of dampers in a drop, at which their damping is usual."""

_SLOWEST_KNEE = 0.01
"""m/s: a knee at a lower velocity is the force of a friction."""

_NEXT_KNEE = 2.5
"""Velocity of a further knee over that of the one before, at the start of a fit."""

_REBOUND, _TYRE_GROWTH = 0.8, 0.2
"""Usual excess of rebound over compression damping, and growth of a tyre's rate."""


def _air_springs(name: str, height: str, levelled: str) -> ModelTerm:
    """Return the row of air springs, given the symbol of the parameter that is one over the height of their columns."""
    return ModelTerm(
        name,
        of_axles(lambda p, axle: _STROKE * _AIR_GROWTH * p[parameter_name(height, axle)]),
        typical=0.6,
        spread=1.6,
        negligible=0.02,
        description=TermDescription(
            f"{{axle}} air springs{levelled} with a column of {{1}}",
            (
                (lambda p, axle: p[parameter_name(height, axle)], "1/m"),
                (lambda p, axle: 1e3 / p[parameter_name(height, axle)], "mm"),
            ),
            again="{axle} ones with a column of {1}",
        ),
        part="spring",
    )


def _usual_rounding(own: Values, _: ModelStructure) -> Values:
    """Return over which velocities the knees of dampers are usually rounded: a valve opens little by little."""
    return {f"w_k{axle}": _ROUNDING * own.get(f"v_k{axle}", _KNEE) for axle in axles_of(own)}


def _usual_curve(own: Values, structure: ModelStructure) -> Values:
    """Return the usual curve of dampers; one that steepens has less damping before its knee, and as much in a usual drop."""
    ratio = KNEE_RATIOS[structure.dampers_steepen]
    flat, present = (_KNEE + (_FAST - _KNEE) * slope for slope in (KNEE_RATIOS[0], ratio))
    usual: dict[str, float] = {}
    for axle in axles_of(own):
        damping = parameter_name("c_s", axle)
        usual |= {damping: own[damping] * flat / present, f"v_k{axle}": _KNEE, parameter_name("q", axle): ratio}
    return usual


def _further_knee(number: int, word: str, before: str, ratio: str) -> ModelTerm:
    """Return the term of a further knee of the damper curves; of the one before, the velocity's index, the ratio's symbol."""

    def first(own: Values, _: ModelStructure) -> Values:
        axles = axles_of(own)
        velocities = {f"v_{number}{axle}": _NEXT_KNEE * own.get(f"v_{before}{axle}", _KNEE) for axle in axles}
        ratios = {axle: own.get(parameter_name(ratio, axle), 1.0) for axle in axles}
        return velocities | {f"q_{number}{axle}": math.sqrt(before) for axle, before in ratios.items()}

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
        undefined=lambda own, _: {f"v_{number}{axle}": _NEXT_KNEE * _KNEE for axle in axles_of(own)},
        first=first,
    )


NONLINEAR_TERMS = (
    ModelTerm(
        "friction",
        of_axles(lambda p, axle: p[parameter_name("F", axle)] / (_TRAVEL * p[f"k_s{axle}"])),
        usual=lambda own, _: {parameter_name("F", axle): _TRAVEL * own[f"k_s{axle}"] for axle in axles_of(own)},
        typical=1.0,
        spread=3.0,
        negligible=0.01,
        description=TermDescription(
            "dry friction of {0} at each {axle} wheel",
            ((lambda p, axle: p[parameter_name("F", axle)], "N"),),
            again="{0} at each {axle} wheel",
        ),
        resembles_others=True,
        held="s_",
        undefined=lambda own, _: {
            parameter_name("s", axle): _PRESLIDING_RATIO * own[f"k_s{axle}"] for axle in axles_of(own)
        },
        first=lambda own, _: {parameter_name("F", axle): _TRAVEL * own[f"k_s{axle}"] for axle in axles_of(own)},
    ),
    ModelTerm(
        "load-friction",
        of_axles(lambda p, axle: p[parameter_name("u", axle)]),
        typical=0.05,
        spread=2.0,
        negligible=0.005,
        description=TermDescription(
            "dry friction that grows by {0} of the load on each {axle} wheel",
            ((lambda p, axle: 100 * p[parameter_name("u", axle)], "%"),),
            again="by {0} on each {axle} wheel",
        ),
    ),
    ModelTerm(
        "uneven-friction",
        of_axles(lambda p, axle: p[parameter_name("d_F", axle)] / (_TRAVEL * p[f"k_s{axle}"])),
        typical=0.2,
        spread=2.0,
        negligible=0.01,
        description=TermDescription(
            "dry friction of the left {axle} wheel that is {0} above the mean of both sides",
            ((lambda p, axle: p[parameter_name("d_F", axle)], "N"),),
            again="{0} of the left {axle} wheel",
        ),
        on_request=True,
    ),
    ModelTerm(
        "rebound",
        of_axles(lambda p, axle: p[parameter_name("r", axle)] - 1),
        usual=lambda own, _: {parameter_name("r", axle): 1 + _REBOUND for axle in axles_of(own)},
        typical=_REBOUND,
        spread=2.0,
        negligible=0.01,
        description=TermDescription(
            "{axle} dampers {0} times as stiff in rebound as in compression",
            ((lambda p, axle: p[parameter_name("r", axle)], "1"),),
            again="{axle} ones {0} times",
            neutral=1.0,
        ),
    ),
    ModelTerm(
        DAMPER_CURVE,
        of_axles(lambda p, axle: 1 - p[parameter_name("q", axle)]),
        usual=_usual_curve,
        typical=_KNEE_LOSS,
        spread=1.6,
        negligible=0.02,
        description=TermDescription(
            "{axle} dampers with {0} of their rate beyond {1}",
            ((lambda p, axle: p[parameter_name("q", axle)], "1"), (lambda p, axle: p[f"v_k{axle}"], "m/s")),
            again="{axle} ones with {0} beyond {1}",
            neutral=1.0,
        ),
        undefined=lambda own, _: {f"v_k{axle}": _KNEE for axle in axles_of(own)},
        character=lambda p: [p[f"v_k{axle}"] for axle in axles_of(p)],
        band=(_SLOWEST_KNEE, np.inf),
        counterpart="friction",
    ),
    ModelTerm(
        "rebound-knee",
        lambda p: math.hypot(*(p[f"b_{symbol}{axle}"] - 1 for symbol in "kq" for axle in axles_of(p))),
        typical=0.2,
        spread=2.0,
        negligible=0.02,
        description=TermDescription(
            "{axle} damper knees that lie at {0} times the velocity in rebound, with {1} times the rate beyond",
            ((lambda p, axle: p[f"b_k{axle}"], "1"), (lambda p, axle: p[f"b_q{axle}"], "1")),
            again="{axle} ones at {0} times, with {1} times",
            neutral=1.0,
        ),
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
        first=_usual_rounding,
        usual=_usual_rounding,
    ),
    _further_knee(2, "second", "k", "q"),
    _further_knee(3, "third", "2", "q_2"),
    ModelTerm(
        "progressive",
        of_axles(lambda p, axle: _STROKE * p[parameter_name("p", axle)]),
        typical=0.2,
        spread=2.5,
        negligible=0.02,
        description=TermDescription(
            "{axle} springs whose rate grows by {0} over 5 cm of compression",
            ((lambda p, axle: 100 * _STROKE * p[parameter_name("p", axle)], "%"),),
            again="{axle} ones by {0}",
        ),
        part="spring",
    ),
    _air_springs("air", "e", ""),
    _air_springs("levelled-air", "e_l", ", levelled under every load,"),
    ModelTerm(
        "tyre-curve",
        of_axles(lambda p, axle: _TYRE_STROKE * p[f"h_t{axle}"]),
        usual=lambda own, _: {f"h_t{axle}": _TYRE_GROWTH / _TYRE_STROKE for axle in axles_of(own)},
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
        undefined=lambda own, structure: {f"x_b{axle}": structure.stop_gap for axle in axles_of(own)},
    ),
)
