"""The table of model terms: what a vehicle may have beside the paper's linear seven degrees of freedom.

A new term is one row here, its law and parameters in `sprung.vehicle`, and one test. Sizes are ratios to what the term acts
beside; usual sizes and their spread are those of road vehicles (Dixon, The Shock Absorber Handbook, 2007; Gillespie,
Fundamentals of Vehicle Dynamics, 1992; Reimpell, The Automotive Chassis, 2001), rounded. A size is negligible where leaving
the term out moves no other parameter by more than about one percent (tests/selection/test_practical_effect.py).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sprung.estimation import USUAL_ENGINE, USUAL_MOUNT, USUAL_RELAXATION, usual_rubber
from sprung.selection.description import TermDescription, Values
from sprung.selection.structure import SEAT_LOAD, ModelStructure
from sprung.vehicle import COORDINATES, LINEAR_EXTRAS, NEUTRAL, PARAMETERS, Tracks, coordinates, parameters_of_term

StartValues = Callable[[Values, ModelStructure], Values]
"""From the fitted vehicle and the structure to fit, values of some parameters."""

SEPARATE_TRACKS = "tracks apart"
"""Springs and dampers at half-distances of their own."""

ENGINE, BUMP_STOP, FRICTION = "engine", "bump-stop", "friction"
"""Terms with starts of their own."""

OCCUPANTS, TWIST, BENDING = "occupants", "twist", "bending"
"""Likewise, of a body that is not one rigid mass."""

STARTED_LATER = frozenset({ENGINE, OCCUPANTS, TWIST, BENDING, SEAT_LOAD})
"""Terms that are put into a vehicle which is fitted already: nothing determines them before."""

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

_REBOUND, _TYRE_DAMPING, _TYRE_GROWTH = 0.8, 0.06, 0.2
"""Usual excess of rebound over compression damping, damping of a tyre over that of the damper, and growth of its rate."""

_ALMOST_NO_ENGINE = 1e-5
"""Part of the sprung mass that is nothing in practice: with no mass at all, an engine's place would be undefined."""


_USUAL_OCCUPANTS, _SEAT_FREQUENCY, _SEAT_DAMPING = 0.06, 4.5, 0.3
"""People on seats as a part of the sprung mass, the natural frequency of a seat, Hz, and its damping ratio (Griffin, Handbook
of Human Vibration, 1990)."""

_SEAT_LOSS = 2 * _SEAT_DAMPING * 2 * np.pi * _SEAT_FREQUENCY
"""Damping of a seat over the mass on it, 1/s."""

_MODAL_INERTIA, _MODAL_MASS, _BODY_DAMPING = 0.08, 0.6, 0.03
"""Modal inertia of a usual twist over I_xx, modal mass of a usual bending over m_s, and damping ratio of both."""

_AT_REST = 1e4
"""Factor on a usual modal mass that is an infinite one in practice."""

_ZENER = ("k_zf", "k_zr", "c_zf", "c_zr")

_ALMOST_NONE = 0.01
"""Part of a usual Zener branch that is nothing in practice: without any, its relaxation time would be undefined."""

_MOST_LOSS = 0.008
"""s: damping of a rubber mount over its rate, at the most. With more, a damper behind a mount moves as one beside a Zener
branch:
their forces are the same function of frequency."""

_RIGID = 1e5
"""Rate of a damper mount over that of the spring, from which it is rigid in practice: no matrix holds an infinite one."""


def natural_frequency(rate: float, mass: float) -> float:
    """Return the undamped natural frequency of a mass on a spring, or of a modal mass, Hz; rate and mass in SI."""
    return float(np.sqrt(rate / mass) / (2 * np.pi))


@dataclass(frozen=True)
class ModelTerm:
    """One term that the model may have.

    Attributes
    ----------
    name
        As in campaign.toml and results.json.
    size
        Practical effect, dimensionless, from the parameters of a vehicle that has it; a sign means a direction only.
    typical, spread
        Usual size where the term is present, and the factor by which one standard deviation lies above or below it.
    description
        How a sentence states it.
    negligible
        Size, dimensionless, below which it changes nothing in practice: it is left out, however significant.
    explains_all
        Whether it resembles many a fault of sensors and loads, so that it has to explain the whole misfit.
    refines
        Term without which it is nothing, and whose law it changes.
    resembles_others
        Whether records of a vehicle with it resemble those of every other term, so that it is tried first.
    usual
        Values that its parameters usually have, of a term that most vehicles have.
    held
        First letters of parameters that mean little where the term is small: a search that may find it small holds them close
        to their usual values.
    undefined
        Values of those parameters that have none where the term is absent.
    first
        Values with which a fit begins instead of the neutral ones.
    equal_tracks
        Parameters that are equal to another one where the term is absent.
    character
        What tells it from other things that move alike: a natural frequency, Hz, or relaxation times, s; None where nothing
        does.
    band
        Lowest and highest value that its character has.
    counterpart
        Term that takes its place where its character is none of its kind: both move alike.
    """

    name: str
    size: Callable[[Values], float]
    typical: float
    spread: float
    negligible: float
    description: TermDescription
    explains_all: bool = False
    refines: str = ""
    resembles_others: bool = False
    usual: StartValues | None = None
    held: str = ""
    undefined: StartValues | None = None
    first: StartValues | None = None
    equal_tracks: tuple[tuple[str, str], ...] = ()
    character: Callable[[Values], Sequence[float]] | None = None
    band: tuple[float, float] = (0.0, np.inf)
    counterpart: str = ""

    @property
    def is_linear(self) -> bool:
        """Whether mass, damping and stiffness matrices carry it."""
        return self.name in LINEAR_EXTRAS or bool(self.equal_tracks)

    @property
    def adds_coordinates(self) -> bool:
        """Whether a vehicle with it moves in more coordinates than the paper's."""
        return len(coordinates(self.parameters("shared"))) > len(COORDINATES)

    def parameters(self, tracks: Tracks) -> tuple[str, ...]:
        """Return the parameters that a model with the term has and one without it has not, or not free.

        Parameters
        ----------
        tracks
            Whether springs and dampers share their half-distance.
        """
        if self.equal_tracks:
            return tuple(name for name, _ in self.equal_tracks)
        return parameters_of_term(self.name, tracks)

    def neutral(self, tracks: Tracks) -> list[tuple[str, str | float]]:
        """Return what each parameter is where the term is absent: a value, or another parameter.

        Parameters
        ----------
        tracks
            As for `parameters`.
        """
        if self.equal_tracks:
            return list(self.equal_tracks)
        return [(name, NEUTRAL[name]) for name in self.parameters(tracks) if name in NEUTRAL]

    def not_negative(self, tracks: Tracks) -> tuple[str, ...]:
        """Return the parameters that physics does not allow to be negative, though the fit does.

        Parameters
        ----------
        tracks
            As for `parameters`.
        """
        about = {name: PARAMETERS[name] for name in self.parameters(tracks)}
        return tuple(name for name, one in about.items() if not (one.positive or one.signed))

    def is_something_else(self, values: Values) -> bool:
        """Whether a part vibrates or relaxes as none of its kind does.

        Parameters
        ----------
        values
            Of the vehicle that has it, SI.
        """
        if self.character is None:
            return False
        lowest, highest = self.band
        return not all(lowest <= one <= highest for one in self.character(values))

    def implausibility(self, size: float) -> float:
        """Minus twice the logarithm of the prior density of a size, 0 at the usual one.

        Log-normal with `typical` and `spread`; a size that is negligible is as implausible as the smallest that is not.
        """
        ratio = max(abs(size), self.negligible) / self.typical
        return float((np.log(ratio) / np.log(self.spread)) ** 2)


def _of_axles(ratio: Callable[[Values, str], float]) -> Callable[[Values], float]:
    """Return the larger of both axles' sizes."""
    return lambda values: max(abs(ratio(values, axle)) for axle in "fr")


def _half_distance(values: Values, axle: str) -> float:
    """Half-distance of an axle's springs, m."""
    return values[f"t_{axle}"] if f"t_{axle}" in values else values[f"t_{axle}2"]


def _asymmetry(values: Values, axle: str) -> float:
    rates = [values[f"d_{rate}{axle}"] / values[f"{rate[0]}_{rate[1:]}{axle}"] for rate in ("ks", "kt", "cs")]
    return max(abs(values["y_s"]) / _half_distance(values, axle), *map(abs, rates))


def _inboard_share(values: Values, axle: str) -> float:
    """Place of the springs on a rigid axle, as a part of its wheels' half-distance."""
    return values[f"n_{axle}" if f"n_{axle}" in values else f"n_{axle}2"]


def _gravity(values: Values) -> float:
    """Share of the roll stiffness of all springs."""
    return values["w_h"] / _roll_rate(values)


def _roll_rate(values: Values) -> float:
    """Roll stiffness of the springs of both axles, N m."""
    return 2 * sum(values[f"k_s{axle}"] * _half_distance(values, axle) ** 2 for axle in "fr")


def _usual_twist(own: Values, structure: ModelStructure, factor: float = 1.0) -> Values:
    """Return a usual twist of the body, its modal mass multiplied by a factor."""
    inertia, omega = factor * _MODAL_INERTIA * own["I_xx"], 2 * np.pi * structure.body_frequency
    return {"I_w": inertia, "k_w": inertia * omega**2, "c_w": 2 * _BODY_DAMPING * inertia * omega, "a_w": 0.0}


def _usual_bending(own: Values, structure: ModelStructure, factor: float = 1.0) -> Values:
    """Return a usual bending of the body, its modal mass multiplied by a factor."""
    mass, omega = factor * _MODAL_MASS * own["m_s"], 2 * np.pi * structure.body_frequency
    rates = {"m_v": mass, "k_v": mass * omega**2, "c_v": 2 * _BODY_DAMPING * mass * omega}
    return {**rates, "b_v": 0.3, "p_v": 0.0}


def _usual_occupants(own: Values, structure: ModelStructure, share: float = _USUAL_OCCUPANTS) -> Values:
    """Return people who are a part of the sprung mass, on usual seats."""
    mass, omega = share * own["m_s"], 2 * np.pi * _SEAT_FREQUENCY
    place = -structure.seat_place * (own["a"] + own["b"])
    rates = {"m_o": mass, "k_o": mass * omega**2, "c_o": 2 * _SEAT_DAMPING * mass * omega}
    return {**rates, "x_o": place, "y_o": 0.0}


TERMS: Mapping[str, ModelTerm] = {
    term.name: term
    for term in (
        ModelTerm(
            SEPARATE_TRACKS,
            _of_axles(lambda p, axle: p[f"t_{axle}1"] / p[f"t_{axle}2"] - 1),
            typical=0.15,
            spread=2.0,
            negligible=0.01,
            description=TermDescription(
                "{axle} dampers at {0} times the half-distance of the springs",
                ((lambda p, axle: p[f"t_{axle}1"] / p[f"t_{axle}2"], "1"),),
                again="{axle} ones at {0} times",
                neutral=1.0,
            ),
            equal_tracks=(("t_f1", "t_f2"), ("t_r1", "t_r2")),
        ),
        ModelTerm(
            "anti-roll",
            _of_axles(lambda p, axle: p[f"k_a{axle}"] / p[f"k_s{axle}"]),
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
            _of_axles(lambda p, axle: p[f"c_t{axle}"] / p[f"c_s{axle}"]),
            usual=lambda own, _: {f"c_t{axle}": _TYRE_DAMPING * own[f"c_s{axle}"] for axle in "fr"},
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
            "gravity",
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
            _of_axles(_asymmetry),
            typical=0.05,
            spread=2.0,
            negligible=0.01,
            description=TermDescription(
                "left and right sides that differ by up to {0}",
                ((lambda p, _: 200 * max(_asymmetry(p, axle) for axle in "fr"), "%"),),
            ),
            explains_all=True,
        ),
        ModelTerm(
            "rigid-axle",
            _of_axles(lambda p, axle: 1 - _inboard_share(p, axle)),
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
            undefined=lambda own, structure: structure.engine_mounting.engine(_ALMOST_NO_ENGINE * own["m_s"]),
            first=lambda own, structure: structure.engine_mounting.engine(USUAL_ENGINE * own["m_s"]),
            character=lambda p: [natural_frequency(p["k_e"], p["m_e"])],
            band=(5.5, 30.0),
        ),
        ModelTerm(
            "damper-mount",
            _of_axles(lambda p, axle: p[f"k_s{axle}"] / p[f"k_d{axle}"]),
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
            undefined=lambda own, _: {
                **{f"k_d{axle}": _RIGID * own[f"k_s{axle}"] for axle in "fr"},
                **dict.fromkeys(("c_df", "c_dr"), 0.0),
            },
            first=lambda own, _: usual_rubber(own),
            character=lambda p: [p[f"c_d{axle}"] / p[f"k_d{axle}"] for axle in "fr"],
            band=(-np.inf, _MOST_LOSS),
            counterpart="zener",
        ),
        ModelTerm(
            "zener",
            _of_axles(lambda p, axle: p[f"k_z{axle}"] / p[f"k_s{axle}"]),
            usual=lambda own, _: usual_rubber(own),
            typical=USUAL_RELAXATION,
            spread=2.0,
            negligible=0.01,
            description=TermDescription(
                "{axle} springs stiffer by {0} in fast motion, which relaxes in {1}",
                (
                    (lambda p, axle: 100 * p[f"k_z{axle}"] / p[f"k_s{axle}"], "%"),
                    (lambda p, axle: 1e3 * p[f"c_z{axle}"] / p[f"k_z{axle}"], "ms"),
                ),
                again="{axle} ones by {0}, which relaxes in {1}",
            ),
            held="c_z",
            undefined=lambda own, _: {name: _ALMOST_NONE * usual_rubber(own)[name] for name in _ZENER},
            first=lambda own, _: usual_rubber(own),
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
            undefined=lambda own, structure: _usual_twist(own, structure, _AT_REST),
            first=_usual_twist,
        ),
        ModelTerm(
            BENDING,
            lambda p: 2 * (p["k_sf"] + p["k_sr"]) / p["k_v"],
            typical=0.015,
            spread=2.5,
            negligible=0.0015,
            description=TermDescription(
                "a body that bends at {0}",
                ((lambda p, _: natural_frequency(p["k_v"], p["m_v"]), "Hz"),),
                neutral=None,
            ),
            explains_all=True,
            undefined=lambda own, structure: _usual_bending(own, structure, _AT_REST),
            first=_usual_bending,
        ),
        ModelTerm(
            OCCUPANTS,
            lambda p: p["m_o"] / p["m_s"],
            typical=_USUAL_OCCUPANTS,
            spread=2.0,
            negligible=0.005,
            description=TermDescription("{0} of people on soft seats", ((lambda p, _: p["m_o"], "kg"),)),
            explains_all=True,
            undefined=lambda own, structure: _usual_occupants(own, structure, _ALMOST_NO_ENGINE),
            first=_usual_occupants,
            character=lambda p: [natural_frequency(p["k_o"], p["m_o"])],
            band=(2.0, 7.5),
        ),
        ModelTerm(
            SEAT_LOAD,
            lambda p: 1 / natural_frequency(p["w_l"], 1.0),
            typical=1 / _SEAT_FREQUENCY,
            spread=1.5,
            negligible=0.01,
            description=TermDescription(
                "loads on seats that move at {0}",
                ((lambda p, _: natural_frequency(p["w_l"], 1.0), "Hz"),),
                neutral=None,
            ),
            undefined=lambda _, __: {"w_l": _RIGID * (2 * np.pi * _SEAT_FREQUENCY) ** 2, "c_l": _SEAT_LOSS},
            first=lambda _, __: {"w_l": (2 * np.pi * _SEAT_FREQUENCY) ** 2, "c_l": _SEAT_LOSS},
        ),
        ModelTerm(
            FRICTION,
            _of_axles(lambda p, axle: p[f"F_{axle}"] / (_TRAVEL * p[f"k_s{axle}"])),
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
            "rebound",
            _of_axles(lambda p, axle: p[f"r_{axle}"] - 1),
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
            _of_axles(lambda p, axle: 1 - p[f"q_{axle}"]),
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
            _of_axles(lambda p, axle: p[f"w_k{axle}"] / p.get(f"v_k{axle}", _KNEE)),
            typical=0.3,
            spread=2.0,
            negligible=0.05,
            description=TermDescription(
                "{axle} damper knees rounded over {0} on both sides",
                ((lambda p, axle: p[f"w_k{axle}"], "m/s"),),
                again="{axle} ones over {0}",
            ),
            refines="damper-curve",
            first=lambda own, _: {f"w_k{axle}": _ROUNDING * own.get(f"v_k{axle}", _KNEE) for axle in "fr"},
        ),
        ModelTerm(
            "progressive",
            _of_axles(lambda p, axle: _STROKE * p[f"p_{axle}"]),
            typical=0.2,
            spread=2.5,
            negligible=0.02,
            description=TermDescription(
                "{axle} springs whose rate grows by {0} over 5 cm of compression",
                ((lambda p, axle: 100 * _STROKE * p[f"p_{axle}"], "%"),),
                again="{axle} ones by {0}",
            ),
        ),
        ModelTerm(
            "air",
            _of_axles(lambda p, axle: _STROKE * _AIR_GROWTH * p[f"e_{axle}"]),
            typical=0.6,
            spread=1.6,
            negligible=0.02,
            description=TermDescription(
                "{axle} air springs with a column of {1}",
                ((lambda p, axle: p[f"e_{axle}"], "1/m"), (lambda p, axle: 1e3 / p[f"e_{axle}"], "mm")),
                again="{axle} ones with a column of {1}",
            ),
        ),
        ModelTerm(
            "levelled-air",
            _of_axles(lambda p, axle: _STROKE * _AIR_GROWTH * p[f"e_l{axle}"]),
            typical=0.6,
            spread=1.6,
            negligible=0.02,
            description=TermDescription(
                "{axle} air springs, levelled under every load, with a column of {1}",
                ((lambda p, axle: p[f"e_l{axle}"], "1/m"), (lambda p, axle: 1e3 / p[f"e_l{axle}"], "mm")),
                again="{axle} ones with a column of {1}",
            ),
        ),
        ModelTerm(
            "tyre-curve",
            _of_axles(lambda p, axle: _TYRE_STROKE * p[f"h_t{axle}"]),
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
            _of_axles(lambda p, axle: p[f"k_b{axle}"] / p[f"k_s{axle}"]),
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
}
"""Every term by its name, in the order in which they are listed."""
