"""The vehicle's parameters: names, units, meaning, and the record that holds their values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import NamedTuple

from sprung.errors import Problems, did_you_mean
from sprung.vehicle.elements import Tracks, half_distances, seven_degrees_of_freedom
from sprung.vehicle.load import EMPTY, Load
from sprung.vehicle.model import LinearModel, Matrices


class Parameter(NamedTuple):
    """What one parameter is."""

    unit: str
    meaning: str
    scales: bool
    """Whether it changes in proportion when every mass, rate and force is multiplied by one number."""
    positive: bool = True
    """Whether it must be positive; the others may be zero."""


PARAMETERS: Mapping[str, Parameter] = {
    "m_s": Parameter("kg", "sprung mass", True),
    "I_yy": Parameter("kg m^2", "pitch inertia of the sprung mass", True),
    "I_xx": Parameter("kg m^2", "roll inertia of the sprung mass", True),
    "m_uf": Parameter("kg", "unsprung mass, each front wheel", True),
    "m_ur": Parameter("kg", "unsprung mass, each rear wheel", True),
    "k_sf": Parameter("N/m", "spring rate, each front wheel", True),
    "k_sr": Parameter("N/m", "spring rate, each rear wheel", True),
    "k_tf": Parameter("N/m", "tyre rate, each front wheel", True),
    "k_tr": Parameter("N/m", "tyre rate, each rear wheel", True),
    "c_sf": Parameter("N s/m", "damper rate, each front wheel", True),
    "c_sr": Parameter("N s/m", "damper rate, each rear wheel", True),
    "a": Parameter("m", "centre of gravity of the sprung mass to front axle", False),
    "b": Parameter("m", "centre of gravity of the sprung mass to rear axle", False),
    "t_f": Parameter("m", "half-distance of springs and dampers, front", False),
    "t_r": Parameter("m", "half-distance of springs and dampers, rear", False),
    "t_f1": Parameter("m", "half-distance of the front dampers", False),
    "t_r1": Parameter("m", "half-distance of the rear dampers", False),
    "t_f2": Parameter("m", "half-distance of the front springs", False),
    "t_r2": Parameter("m", "half-distance of the rear springs", False),
    "c_tf": Parameter("N s/m", "tyre damping, each front wheel", True, False),
    "c_tr": Parameter("N s/m", "tyre damping, each rear wheel", True, False),
    "k_af": Parameter("N/m", "front anti-roll bar, per metre of left-right difference in travel", True, False),
    "k_ar": Parameter("N/m", "rear anti-roll bar, per metre of left-right difference in travel", True, False),
    "w_h": Parameter(
        "N m", "weight of the body times the height by which it stands above what carries it", True, False
    ),
    "F_f": Parameter("N", "dry friction, each front wheel", True, False),
    "F_r": Parameter("N", "dry friction, each rear wheel", True, False),
    "s_f": Parameter("N/m", "stiffness of the front friction before it slides, each wheel", True),
    "s_r": Parameter("N/m", "stiffness of the rear friction before it slides, each wheel", True),
    "r_f": Parameter("1", "rebound damping over compression damping, front", False),
    "r_r": Parameter("1", "rebound damping over compression damping, rear", False),
    "p_f": Parameter(
        "1/m", "growth of the front spring rate with compression, as a part of it per metre", False, False
    ),
    "p_r": Parameter("1/m", "growth of the rear spring rate with compression, as a part of it per metre", False, False),
}
"""Every parameter that the models know, in the order in which tables show them."""

EXTRA_PARAMETERS: Mapping[str, tuple[str, ...]] = {
    "anti-roll": ("k_af", "k_ar"),
    "tyre-damping": ("c_tf", "c_tr"),
    "gravity": ("w_h",),
    "friction": ("F_f", "F_r", "s_f", "s_r"),
    "rebound": ("r_f", "r_r"),
    "progressive": ("p_f", "p_r"),
}
"""The parameters that each extra brings."""

NEUTRAL: Mapping[str, float] = {
    **dict.fromkeys(("w_h", "k_af", "k_ar", "c_tf", "c_tr", "F_f", "F_r", "p_f", "p_r"), 0.0),
    **dict.fromkeys(("r_f", "r_r"), 1.0),
}
"""Values with which an extra does nothing; the others of its parameters then do not matter."""


def parameter_names(tracks: Tracks = "shared", extras: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Name the parameters of one model, in the order of `PARAMETERS`.

    Parameters
    ----------
    tracks
        Whether springs and dampers of an axle share their half-distance.
    extras
        Any of `EXTRA_PARAMETERS`.
    """
    absent = {"t_f", "t_r", "t_f1", "t_r1", "t_f2", "t_r2"} - set(half_distances(tracks).values())
    for extra, brought in EXTRA_PARAMETERS.items():
        if extra not in extras:
            absent.update(brought)
    return tuple(name for name in PARAMETERS if name not in absent)


def separate_names(name: str) -> tuple[str, ...]:
    """Give what a parameter is called where springs and dampers of an axle have half-distances of their own.

    Parameters
    ----------
    name
        Any parameter's.

    Returns
    -------
    tuple of str
        Two names for a half-distance that springs and dampers share; for any other parameter its own.

    Examples
    --------
    >>> separate_names("t_f"), separate_names("k_sf")
    (('t_f1', 't_f2'), ('k_sf',))
    """
    separate = half_distances("separate")
    return tuple(sorted(separate[of] for of, shared in half_distances("shared").items() if shared == name)) or (name,)


def separated(parameters: Mapping[str, float]) -> dict[str, float]:
    """Give the same vehicle with half-distances of springs and dampers each by their own names.

    Parameters
    ----------
    parameters
        Values by name, SI.
    """
    return {own: value for name, value in parameters.items() for own in separate_names(name)}


@dataclass(frozen=True, kw_only=True)
class Vehicle:
    """A two-axle road vehicle, by its parameters in SI units; named as in the paper.

    Give t_f and t_r where springs and dampers of an axle share their half-distance from the centreline, or t_f1, t_r1
    (dampers) and t_f2, t_r2 (springs). Rates, and unsprung masses, are those of one wheel.

    Attributes
    ----------
    m_s, I_yy, I_xx
        Sprung mass, kg, its pitch and roll inertia, kg m².
    m_uf, m_ur
        Unsprung mass of each front and rear wheel, kg.
    k_sf, k_sr, k_tf, k_tr
        Spring and tyre rates, N/m.
    c_sf, c_sr
        Damper rates, N s/m.
    a, b
        Centre of gravity of the sprung mass to the front and rear axle, m.
    t_f, t_r, t_f1, t_r1, t_f2, t_r2
        Half-distances, m; t_f and t_r are None where springs and dampers differ.
    c_tf, c_tr
        Tyre damping, N s/m.
    k_af, k_ar
        Anti-roll bars, N per metre of left-right difference in suspension travel.
    F_f, F_r, s_f, s_r
        Dry friction of each suspension, N, and its stiffness before it slides, N/m.
    r_f, r_r
        Rebound damping over compression damping; c_s is then that of compression.
    p_f, p_r
        Growth of the spring rates with compression, as a part of them per metre.
    cg_height
        Height of the sprung mass's centre of gravity, m; None places every load level with it.
    name
        For people to read.

    Raises
    ------
    InputError
        If a parameter is missing, not finite or not positive; all faults at once.

    Examples
    --------
    >>> car = Vehicle(m_s=1380, I_yy=2440, I_xx=380, m_uf=40.5, m_ur=45.4, k_sf=17000, k_sr=22000, k_tf=192000,
    ...               k_tr=192000, c_sf=1500, c_sr=1500, a=1.25, b=1.51, t_f=0.74, t_r=0.74)
    >>> M, C, K = car.matrices()
    >>> float(K[0, 0])
    78000.0
    """

    m_s: float
    I_yy: float
    I_xx: float
    m_uf: float
    m_ur: float
    k_sf: float
    k_sr: float
    k_tf: float
    k_tr: float
    c_sf: float
    c_sr: float
    a: float
    b: float
    t_f: float | None = None
    t_r: float | None = None
    t_f1: float | None = None
    t_r1: float | None = None
    t_f2: float | None = None
    t_r2: float | None = None
    c_tf: float = 0.0
    c_tr: float = 0.0
    k_af: float = 0.0
    k_ar: float = 0.0
    w_h: float = 0.0
    F_f: float = 0.0
    F_r: float = 0.0
    s_f: float = 1e6
    s_r: float = 1e6
    r_f: float = 1.0
    r_r: float = 1.0
    p_f: float = 0.0
    p_r: float = 0.0
    cg_height: float | None = None
    name: str = "vehicle"

    def __post_init__(self) -> None:
        problems = Problems()
        for axle in "fr":
            self._resolve_half_distances(axle, problems)
        for name in parameter_names("separate", tuple(EXTRA_PARAMETERS)):
            value = getattr(self, name)
            positive = PARAMETERS[name].positive and name not in ("c_sf", "c_sr")
            if value is not None and not (math.isfinite(value) and (value > 0 or (value == 0 and not positive))):
                problems.add(
                    f"vehicle {self.name}: {name}",
                    repr(value),
                    f"a {'positive' if positive else 'finite, not negative'} number, {PARAMETERS[name].unit}",
                    "Correct it.",
                )
        problems.raise_if_any()

    def _resolve_half_distances(self, axle: str, problems: Problems) -> None:
        shared, damper, spring = (getattr(self, f"t_{axle}{suffix}") for suffix in ("", "1", "2"))
        if shared is not None:
            damper = shared if damper is None else damper
            spring = shared if spring is None else spring
        if damper is None or spring is None or (shared is not None and not damper == spring == shared):
            problems.add(
                f"vehicle {self.name}: t_{axle}",
                f"t_{axle}={shared}, t_{axle}1={damper}, t_{axle}2={spring}",
                f"either t_{axle}, or t_{axle}1 (dampers) and t_{axle}2 (springs)",
                "Give one of the two.",
            )
            return
        object.__setattr__(self, f"t_{axle}1", damper)
        object.__setattr__(self, f"t_{axle}2", spring)
        object.__setattr__(self, f"t_{axle}", damper if damper == spring else None)

    @classmethod
    def from_parameters(
        cls, parameters: Mapping[str, float], *, cg_height: float | None = None, name: str = "vehicle"
    ) -> Vehicle:
        """Make a vehicle from a mapping of parameter names, as a vehicle file holds them.

        Raises
        ------
        InputError
            If a name is unknown, a needed one missing or a value impossible; all faults at once.
        """
        problems = Problems()
        where = f"vehicle {name}"
        for unknown in parameters.keys() - PARAMETERS.keys():
            problems.add(where, f"'{unknown}'", "the name of a parameter", did_you_mean(unknown, PARAMETERS))
        needed = set(parameter_names()) - {"t_f", "t_r"}
        for missing in [f.name for f in fields(cls) if f.name in needed and f.name not in parameters]:
            if PARAMETERS[missing].positive:
                unit, meaning, *_ = PARAMETERS[missing]
                problems.add(where, f"no '{missing}'", f"the {meaning} in {unit}", f"Add {missing} = ... to it.")
        problems.raise_if_any()
        return cls(**dict(parameters), cg_height=cg_height, name=name)

    @property
    def tracks(self) -> Tracks:
        """Whether springs and dampers share their half-distance on both axles."""
        return "separate" if self.t_f is None or self.t_r is None else "shared"

    @property
    def wheelbase(self) -> float:
        """Front axle to rear axle, m."""
        return self.a + self.b

    @property
    def total_mass(self) -> float:
        """Mass of the whole empty vehicle, kg."""
        return self.m_s + 2 * (self.m_uf + self.m_ur)

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the parameters by name: shared half-distances where they are shared, extras where not zero."""
        return {name: getattr(self, name) for name in parameter_names(self.tracks, self.extras)}

    @property
    def extras(self) -> tuple[str, ...]:
        """What it has beyond the paper's vehicle."""
        return tuple(
            extra
            for extra, names in EXTRA_PARAMETERS.items()
            if any(getattr(self, name) != NEUTRAL[name] for name in names if name in NEUTRAL)
        )

    def model(self, load: Load = EMPTY) -> LinearModel:
        """Give the equations of motion of this vehicle with a load, as functions of its parameters.

        Parameters
        ----------
        load
            What is on it.
        """
        elements = seven_degrees_of_freedom(self.tracks, self.extras) + load.elements(self.cg_height)
        return LinearModel.of(elements, tuple(self.parameters))

    def matrices(self, load: Load = EMPTY) -> Matrices:
        """Give mass, damping and stiffness matrices.

        Parameters
        ----------
        load
            What is on it; nothing unless given.

        Returns
        -------
        Matrices
            M, C and K, each of shape (7, 7), SI: eq. (2) of the paper.
        """
        return self.model(load).matrices(list(self.parameters.values()))
