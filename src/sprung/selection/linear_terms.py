"""The table of model terms, first part: those that mass, damping and stiffness matrices carry."""

from __future__ import annotations

import numpy as np

from sprung.estimation import USUAL_ENGINE, USUAL_MOUNT, USUAL_RELAXATION, usual_engine, usual_rubber
from sprung.selection.description import TermDescription, Values
from sprung.selection.model_term import ModelTerm, axles_of, of_axles
from sprung.selection.structure import SEAT_LOAD, ModelStructure
from sprung.selection.usual_parts import (
    SEAT_FREQUENCY,
    SEAT_LOSS,
    USUAL_OCCUPANTS,
    natural_frequency,
    usual_bending,
    usual_occupants,
    usual_twist,
)
from sprung.vehicle import PARAMETERS, layout_of, parameter_name

SEPARATE_TRACKS = "tracks apart"
"""Springs and dampers at half-distances of their own."""

GRAVITY = "gravity"
"""What gravity takes off the roll stiffness: it tells how high the body is above its wheels."""

ENGINE, OCCUPANTS, TWIST, BENDING = "engine", "occupants", "twist", "bending"
"""Terms with starts of their own: masses on springs, and a body that is not one rigid mass."""

DAMPER_MOUNT = "damper-mount"
"""Rubber in series with the dampers."""

FLEXIBLE_BODIES = TWIST, BENDING
"""Bodies that are not rigid."""

INTERCONNECTION = "interconnection"
"""Left and right connected by a fluid line."""

STARTED_LATER = frozenset({ENGINE, INTERCONNECTION, OCCUPANTS, TWIST, BENDING, SEAT_LOAD})
"""Terms that are put into a vehicle which is fitted already: nothing determines them before."""

_TYRE_DAMPING = 0.06
"""Usual damping of a tyre over that of the damper."""

_ALMOST_NO_ENGINE = 1e-5
"""Part of the sprung mass that is nothing in practice: with no mass at all, an engine's place would be undefined."""

_AT_REST = 1e4
"""Factor on a usual modal mass that is an infinite one in practice."""

_ALMOST_NONE = 0.01
"""Part of a usual Zener branch that is nothing in practice: without any, its relaxation time would be undefined."""

_NEGLIGIBLE_BRANCH = 0.01
"""Rate of a Zener branch over that of the spring, below which it is left out."""

_MOST_LOSS = 0.008
"""s: damping of a rubber mount over its rate, at the most. With more, a damper behind a mount moves as one beside a Zener
branch, and with less the other way round: their forces are the same function of frequency."""

_MOST_RELAXATION = 0.5
"""s in which rubber relaxes, at the most, ten times what is usual: slower branches are drift of sensors."""

_HOP, _LOSS = 12.0, 0.1
"""Hz at which a wheel usually hops, and the loss factor of rubber there."""

_USUAL_FLOW = 0.3
"""s in which the rate between two sides usually relaxes that a fluid line connects."""

_RIGID = 1e5
"""Rate of a damper mount over that of the spring, from which it is rigid in practice: no matrix holds an infinite one."""


def _engine(own: Values, structure: ModelStructure, share: float = USUAL_ENGINE) -> Values:
    """Return an engine that is a part of the sprung mass, mounted as the structure has it."""
    return usual_engine(share * own["m_s"], structure.engine_frequency, structure.engine_place)


def _half_distance(values: Values, axle: str) -> float:
    """Half-distance of an axle's springs, m."""
    shared, own = parameter_name("t", axle), parameter_name("t", axle, "2")
    return values[shared if shared in values else own]


def _asymmetry(values: Values, axle: str) -> float:
    rates = [values[f"d_{rate}{axle}"] / values[f"{rate[0]}_{rate[1:]}{axle}"] for rate in ("ks", "kt", "cs")]
    return max(abs(values["y_s"]) / _half_distance(values, axle), *map(abs, rates))


def _inboard_share(values: Values, axle: str) -> float:
    """Place of the springs on a rigid axle, as a part of its wheels' half-distance."""
    shared, own = parameter_name("n", axle), parameter_name("n", axle, "2")
    return values[shared if shared in values else own]


def _gravity(values: Values) -> float:
    """Share of the roll stiffness of all springs."""
    return values["w_h"] / _roll_rate(values)


def _relaxation_times(values: Values) -> list[float]:
    """Relaxation times of the Zener branches that matter, s, and what damping over rate they had as mounts of dampers.

    Without sign: a negative rate is another matter. A damper c_s beside a branch moves as one of c_s + c_z behind a mount,
    whose damping over its rate is c_s/(c_s + c_z) of the relaxation time.
    """
    times = []
    for axle in axles_of(values):
        damping, branch, rate = (abs(values[f"{kind}{axle}"]) for kind in ("c_s", "c_z", "k_z"))
        if rate >= _NEGLIGIBLE_BRANCH * values[f"k_s{axle}"]:
            times += [branch / rate, branch / rate * damping / (damping + branch)]
    return times


def _interconnection(values: Values, part: float) -> Values:
    """Return an interconnection of left and right whose rate is a part of that of the springs, and relaxes in a usual time."""
    rates = {axle: part * values[f"k_s{axle}"] for axle in axles_of(values)}
    return {
        **{f"k_x{axle}": rate for axle, rate in rates.items()},
        **{f"c_x{axle}": _USUAL_FLOW * rate for axle, rate in rates.items()},
    }


def _roll_rate(values: Values) -> float:
    """Roll stiffness of all springs, N m; of a vehicle that does not roll their stiffness over half its wheelbase."""
    layout = layout_of(values)
    lever = {
        axle: _half_distance(values, axle) if layout.rolls else (values["a"] + values["b"]) / 2 for axle in layout.axles
    }
    return sum(len(layout.wheels_of(axle)) * values[f"k_s{axle}"] * lever[axle] ** 2 for axle in layout.axles)


def _bounce_rate(values: Values) -> float:
    """Rate of all springs together, N/m."""
    layout = layout_of(values)
    return sum(len(layout.wheels_of(axle)) * values[f"k_s{axle}"] for axle in layout.axles)


LINEAR_TERMS = (
    ModelTerm(
        SEPARATE_TRACKS,
        of_axles(lambda p, axle: p[parameter_name("t", axle, "1")] / p[parameter_name("t", axle, "2")] - 1),
        typical=0.15,
        spread=2.0,
        negligible=0.01,
        description=TermDescription(
            "{axle} dampers at {0} times the half-distance of the springs",
            ((lambda p, axle: p[parameter_name("t", axle, "1")] / p[parameter_name("t", axle, "2")], "1"),),
            again="{axle} ones at {0} times",
            neutral=1.0,
        ),
        separates_tracks=True,
    ),
    ModelTerm(
        "anti-roll",
        of_axles(lambda p, axle: p[f"k_a{axle}"] / p[f"k_s{axle}"]),
        typical=0.3,
        spread=2.5,
        negligible=0.01,
        description=TermDescription(
            "a {axle} anti-roll bar of {0}",
            ((lambda p, axle: p[f"k_a{axle}"] / 1e3, "N/mm"),),
            again="a {axle} one of {0}",
        ),
    ),
    ModelTerm(
        "tyre-damping",
        of_axles(lambda p, axle: p[f"c_t{axle}"] / p[f"c_s{axle}"]),
        usual=lambda own, _: {f"c_t{axle}": _TYRE_DAMPING * own[f"c_s{axle}"] for axle in axles_of(own)},
        accompanies="tyre-curve",
        typical=_TYRE_DAMPING,
        spread=2.5,
        negligible=0.005,
        description=TermDescription(
            "tyre damping of {0} at each {axle} wheel",
            ((lambda p, axle: p[f"c_t{axle}"], "N s/m"),),
            again="{0} at each {axle} wheel",
        ),
    ),
    ModelTerm(
        GRAVITY,
        _gravity,
        typical=0.1,
        spread=2.0,
        negligible=0.005,
        description=TermDescription(
            "gravity that takes {0} off the roll stiffness of the springs",
            ((lambda p, _: 100 * _gravity(p), "%"),),
        ),
    ),
    ModelTerm(
        "asymmetry",
        of_axles(_asymmetry),
        typical=0.05,
        spread=2.0,
        negligible=0.01,
        description=TermDescription(
            "left and right sides that differ by up to {0}",
            ((lambda p, _: 200 * max(_asymmetry(p, axle) for axle in axles_of(p)), "%"),),
        ),
        explains_all=True,
    ),
    ModelTerm(
        "rigid-axle",
        of_axles(lambda p, axle: 1 - _inboard_share(p, axle)),
        typical=0.3,
        spread=1.6,
        negligible=0.05,
        description=TermDescription(
            "a rigid {axle} axle with its springs at {0} of the half-distance of its wheels",
            ((_inboard_share, "1"),),
            again="a rigid {axle} axle with its springs at {0}",
            neutral=1.0,
        ),
        explains_all=True,
    ),
    ModelTerm(
        ENGINE,
        lambda p: p["m_e"] / p["m_s"],
        typical=USUAL_ENGINE,
        spread=1.6,
        negligible=0.02,
        description=TermDescription("an engine of {0} that moves on its mounts", ((lambda p, _: p["m_e"], "kg"),)),
        explains_all=True,
        undefined=lambda own, structure: _engine(own, structure, _ALMOST_NO_ENGINE),
        first=_engine,
        character=lambda p: [natural_frequency(p["k_e"], p["m_e"])],
        band=(5.5, 30.0),
    ),
    ModelTerm(
        DAMPER_MOUNT,
        of_axles(lambda p, axle: p[f"k_s{axle}"] / p[f"k_d{axle}"]),
        usual=lambda own, _: usual_rubber(own),
        typical=1 / USUAL_MOUNT,
        spread=2.0,
        negligible=0.003,
        description=TermDescription(
            "{axle} dampers on rubber mounts of {0}",
            ((lambda p, axle: p[f"k_d{axle}"] / 1e3, "N/mm"),),
            again="{axle} ones on mounts of {0}",
            neutral=None,
        ),
        undefined=lambda own, _: {f"k_d{axle}": _RIGID * own[f"k_s{axle}"] for axle in axles_of(own)},
        first=lambda own, _: usual_rubber(own),
    ),
    ModelTerm(
        "mount-damping",
        of_axles(lambda p, axle: 2 * np.pi * _HOP * p[f"c_d{axle}"] / p[f"k_d{axle}"]),
        usual=lambda own, _: usual_rubber(own),
        typical=_LOSS,
        spread=2.0,
        negligible=0.004,
        description=TermDescription(
            "damping of {0} in the mounts of the {axle} dampers",
            ((lambda p, axle: p[f"c_d{axle}"], "N s/m"),),
            again="{0} in those of the {axle} ones",
        ),
        character=lambda p: [p[f"c_d{axle}"] / p[f"k_d{axle}"] for axle in axles_of(p)],
        band=(-np.inf, _MOST_LOSS),
        counterpart="zener",
    ),
    ModelTerm(
        "zener",
        of_axles(lambda p, axle: p[f"k_z{axle}"] / p[f"k_s{axle}"]),
        usual=lambda own, _: usual_rubber(own),
        typical=USUAL_RELAXATION,
        spread=2.0,
        negligible=_NEGLIGIBLE_BRANCH,
        description=TermDescription(
            "{axle} springs stiffer by {0} in fast motion, which relaxes in {1}",
            (
                (lambda p, axle: 100 * p[f"k_z{axle}"] / p[f"k_s{axle}"], "%"),
                (lambda p, axle: 1e3 * p[f"c_z{axle}"] / p[f"k_z{axle}"], "ms"),
            ),
            again="{axle} ones by {0}, which relaxes in {1}",
        ),
        held="c_z",
        character=_relaxation_times,
        band=(_MOST_LOSS, _MOST_RELAXATION),
        counterpart=DAMPER_MOUNT,
        undefined=lambda own, _: {
            name: _ALMOST_NONE * value for name, value in usual_rubber(own).items() if name.startswith(("k_z", "c_z"))
        },
        first=lambda own, _: usual_rubber(own),
    ),
    ModelTerm(
        INTERCONNECTION,
        of_axles(lambda p, axle: p[f"k_x{axle}"] / p[f"k_s{axle}"]),
        typical=0.5,
        spread=2.5,
        negligible=0.01,
        description=TermDescription(
            "{axle} wheels interconnected by {0} against roll, which relaxes in {1}",
            (
                (lambda p, axle: p[f"k_x{axle}"] / 1e3, "N/mm"),
                (lambda p, axle: 1e3 * p[f"c_x{axle}"] / p[f"k_x{axle}"], "ms"),
            ),
            again="{axle} ones by {0}, which relaxes in {1}",
        ),
        undefined=lambda own, _: _interconnection(own, 1e-3),
        first=lambda own, _: _interconnection(own, 0.5),
        on_request=True,
    ),
    ModelTerm(
        TWIST,
        lambda p: _roll_rate(p) / p["k_w"],
        typical=0.05,
        spread=2.5,
        negligible=0.004,
        description=TermDescription(
            "a body that twists at {0}",
            ((lambda p, _: natural_frequency(p["k_w"], p["I_w"]), "Hz"),),
            neutral=None,
        ),
        explains_all=True,
        undefined=lambda own, structure: usual_twist(own, structure, _AT_REST),
        first=usual_twist,
    ),
    ModelTerm(
        BENDING,
        lambda p: _bounce_rate(p) / p["k_v"],
        typical=0.015,
        spread=2.5,
        negligible=0.0015,
        description=TermDescription(
            "a body that bends at {0}",
            ((lambda p, _: natural_frequency(p["k_v"], p["m_v"]), "Hz"),),
            neutral=None,
        ),
        explains_all=True,
        undefined=lambda own, structure: usual_bending(own, structure, _AT_REST),
        first=usual_bending,
    ),
    ModelTerm(
        OCCUPANTS,
        lambda p: p["m_o"] / p["m_s"],
        typical=USUAL_OCCUPANTS,
        spread=2.0,
        negligible=0.005,
        description=TermDescription("{0} of people on soft seats", ((lambda p, _: p["m_o"], "kg"),)),
        explains_all=True,
        undefined=lambda own, structure: usual_occupants(own, structure, _ALMOST_NO_ENGINE),
        first=usual_occupants,
        character=lambda p: [natural_frequency(p["k_o"], p["m_o"])],
        band=(2.0, 7.5),
    ),
    ModelTerm(
        "uneven-occupants",
        lambda p: max(abs(p[f"d_{rate}o"] / p[f"{rate}_o"]) for rate in "mk"),
        typical=0.1,
        spread=2.0,
        negligible=0.01,
        description=TermDescription(
            "people on the left and on the right who differ by {0}, on seats whose rates differ by {1}",
            (
                (lambda p, _: 2 * abs(p["d_mo"]), "kg"),
                (lambda p, _: 2 * abs(p["d_ko"]) / 1e3, "N/mm"),
            ),
            neutral=None,
        ),
        # By people who are alike both seem to sit in the middle, from where a fit leads to a mass below zero on one side.
        of_refined=lambda _, __: {"y_o": 0.0, "t_o": PARAMETERS["t_o"].usual},
        character=lambda p: [2 * abs(p["d_mo"]) / p["m_o"]],
        band=(0.0, 1.0),
    ),
    ModelTerm(
        SEAT_LOAD,
        lambda p: 1 / natural_frequency(p["w_l"], 1.0),
        typical=1 / SEAT_FREQUENCY,
        spread=1.5,
        negligible=0.01,
        description=TermDescription(
            "loads on seats that move at {0}",
            ((lambda p, _: natural_frequency(p["w_l"], 1.0), "Hz"),),
            neutral=None,
        ),
        undefined=lambda _, __: {"w_l": _RIGID * (2 * np.pi * SEAT_FREQUENCY) ** 2, "c_l": SEAT_LOSS},
        first=lambda _, __: {"w_l": (2 * np.pi * SEAT_FREQUENCY) ** 2, "c_l": SEAT_LOSS},
    ),
)
