"""The vehicle: values of its parameters, and the equations of motion that follow from them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from sprung.display import shown
from sprung.errors import Problems, did_you_mean
from sprung.vehicle.elements import Tracks, seven_degrees_of_freedom, stiffened_air_springs
from sprung.vehicle.heights import Heights
from sprung.vehicle.load import EMPTY, Load
from sprung.vehicle.model import LinearModel, Matrices
from sprung.vehicle.parameters import EXTRA_PARAMETERS, NEUTRAL, PARAMETERS, parameter_names, parameters_of_term
from sprung.vehicle.tyre_rates import with_tyre_rates_at_rest


@shown
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
        Dry friction of each suspension, N, and its presliding stiffness, N/m.
    u_f, u_r
        Growth of this friction with the load, over the weight that the wheel carries of it.
    r_f, r_r
        Rebound damping over compression damping; c_s is then that of compression.
    v_kf, v_kr, q_f, q_r, w_kf, w_kr
        Velocity at which the damper curves have their knee, m/s, the damping beyond it over that before it, and half the width
        over which it is rounded, m/s.
    v_2f, v_2r, q_2f, q_2r, v_3f, v_3r, q_3f, q_3r
        Velocities of a second and a third knee, m/s, and the damping beyond each over that before it.
    p_f, p_r
        Growth of the spring rates with compression, as a part of them per metre.
    e_f, e_r
        One over the effective height of the air column of a spring, 1/m.
    e_lf, e_lr, g_f, g_r
        The same of springs that a valve levels under every load, and the growth of their rate with what they carry, N/(m kg).
    h_tf, h_tr
        Growth of the tyre rates with compression, as a part of them per metre.
    k_bf, k_br, x_bf, x_br
        Stiffness of the bump stops, N/m, and the compression from rest at which they are met, m.
    w_h
        Weight of the body times the height of its centre of gravity above the lateral support, N m.
    y_s
        Centre of gravity of the sprung mass, m left of the centreline.
    d_ksf, d_ksr, d_ktf, d_ktr, d_csf, d_csr
        Excess of the left rate over the mean of left and right.
    n_f, n_r, n_f1, n_r1, n_f2, n_r2
        Place of springs and dampers (or dampers, 1, and springs, 2) on a rigid axle, as a part of its wheels' half-distance;
        1 for independent suspension.
    m_xf, m_xr
        Additional roll inertia of a rigid axle, as a mass at each wheel, kg: with the wheels T from the middle, the axle's roll
        inertia is 2 T² (m_u + m_x).
    m_e, k_e, c_e, x_e
        Engine on mounts of its own, kg, a part of the sprung mass and of its inertias; its mounts' rate, N/m, and damping,
        N s/m; and its place, m forward of the front axle.
    k_df, k_dr, c_df, c_dr
        Rates of the rubber mounts in series with the dampers, N/m, infinite without mounts; and their own damping, N s/m.
    k_zf, k_zr, c_zf, c_zr
        :term:`Zener branch` beside each spring: a rate k_z, N/m, in series with a damping c_z, N s/m, so that k_s is the rate
        at rest, k_s + k_z that of fast motion and c_z / k_z the relaxation time.
    I_w, k_w, c_w, a_w
        Twist of the body: modal inertia, kg m², stiffness, N m, and damping, N m s, for the angle between the axles, and its
        node, m ahead of the middle between them. An infinite inertia is that of a body that does not twist.
    m_v, k_v, c_v, b_v, p_v
        Bending of the body: modal mass, kg, stiffness, N/m, and damping, N s/m, for the rise of its middle above its axles;
        rise of the centre of gravity, 1, and mean pitch, 1/m, over that. An infinite mass is that of a body that does not bend.
    m_o, k_o, c_o, x_o, y_o
        People on soft seats, kg, a part of the sprung mass and of its inertias; rate, N/m, and damping, N s/m, of all seats
        together; and their place, m forward of the front axle and left of the centreline.
    w_l, c_l
        Rate, 1/s², and damping, 1/s, of the seats under items of loads, over the mass on them: the squared natural frequency,
        and twice that frequency times the damping ratio. An infinite rate is that of a floor.
    cg_height, wheel_height, roll_axis_height
        Of the sprung mass's centre of gravity, the wheel centres and the axis of roll, m; see `Heights`.
    name
        For messages and tables.

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
    u_f: float = 0.0
    u_r: float = 0.0
    r_f: float = 1.0
    r_r: float = 1.0
    v_kf: float = 1.0
    v_kr: float = 1.0
    q_f: float = 1.0
    q_r: float = 1.0
    w_kf: float = 0.0
    w_kr: float = 0.0
    v_2f: float = 1.0
    v_2r: float = 1.0
    q_2f: float = 1.0
    q_2r: float = 1.0
    v_3f: float = 1.0
    v_3r: float = 1.0
    q_3f: float = 1.0
    q_3r: float = 1.0
    p_f: float = 0.0
    p_r: float = 0.0
    e_f: float = 0.0
    e_r: float = 0.0
    e_lf: float = 0.0
    e_lr: float = 0.0
    g_f: float = 0.0
    g_r: float = 0.0
    h_tf: float = 0.0
    h_tr: float = 0.0
    k_bf: float = 0.0
    k_br: float = 0.0
    x_bf: float = 1.0
    x_br: float = 1.0
    y_s: float = 0.0
    d_ksf: float = 0.0
    d_ksr: float = 0.0
    d_ktf: float = 0.0
    d_ktr: float = 0.0
    d_csf: float = 0.0
    d_csr: float = 0.0
    n_f: float | None = None
    n_r: float | None = None
    n_f1: float | None = None
    n_r1: float | None = None
    n_f2: float | None = None
    n_r2: float | None = None
    m_xf: float = 0.0
    m_xr: float = 0.0
    m_e: float = 0.0
    k_e: float = 1e6
    c_e: float = 0.0
    x_e: float = 0.0
    k_df: float = math.inf
    k_dr: float = math.inf
    c_df: float = 0.0
    c_dr: float = 0.0
    k_zf: float = 0.0
    k_zr: float = 0.0
    c_zf: float = 1e3
    c_zr: float = 1e3
    I_w: float = math.inf
    k_w: float = 1e6
    c_w: float = 1e3
    a_w: float = 0.0
    m_v: float = math.inf
    k_v: float = 1e7
    c_v: float = 1e4
    b_v: float = 0.0
    p_v: float = 0.0
    m_o: float = 0.0
    k_o: float = 1e5
    c_o: float = 0.0
    x_o: float = 0.0
    y_o: float = 0.0
    w_l: float = math.inf
    c_l: float = 0.0
    cg_height: float | None = None
    wheel_height: float | None = None
    roll_axis_height: float | None = None
    name: str = "vehicle"

    def __post_init__(self) -> None:
        problems = Problems()
        for axle in "fr":
            self._resolve_places("t", axle, None, problems)
            self._resolve_places("n", axle, 1.0, problems)
        own = parameter_names("separate", self.extras)
        has_mounts = "damper-mount" in self.extras
        for name in parameter_names("separate", tuple(EXTRA_PARAMETERS)):
            value, parameter = getattr(self, name), PARAMETERS[name]
            positive = parameter.positive and (has_mounts or name not in ("c_sf", "c_sr"))
            possible = value is None or (
                (math.isfinite(value) or (value == NEUTRAL.get(name) and name not in own))
                and (value > 0 or parameter.signed or (value == 0 and not positive))
            )
            if not possible:
                kind = "positive" if positive else "finite" if parameter.signed else "finite, not negative"
                problems.add(
                    f"vehicle {self.name}: {name}", repr(value), f"a {kind} number, {parameter.unit}", "Correct it."
                )
        for name in ("cg_height", "wheel_height"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                problems.add(f"vehicle {self.name}: {name}", repr(value), "a positive number, m", "Correct it.")
        if not problems and self.m_e * (1 / self.m_s + (self.a + self.x_e) ** 2 / self.I_yy) >= 1:
            problems.add(
                f"vehicle {self.name}: m_e",
                f"an engine of {self.m_e:g} kg, {self.a + self.x_e:g} m ahead of the centre of gravity",
                "one that leaves the body some mass and pitch inertia, of which it is a part",
                "Correct m_e and x_e, or m_s and I_yy, which include the engine.",
            )
        problems.raise_if_any()

    def _resolve_places(self, letter: str, axle: str, default: float | None, problems: Problems) -> None:
        shared, damper, spring = (getattr(self, f"{letter}_{axle}{suffix}") for suffix in ("", "1", "2"))
        if shared is None and damper is None and spring is None:
            shared = default
        if shared is not None:
            damper = shared if damper is None else damper
            spring = shared if spring is None else spring
        if damper is None or spring is None or (shared is not None and not damper == spring == shared):
            problems.add(
                f"vehicle {self.name}: {letter}_{axle}",
                f"{letter}_{axle}={shared}, {letter}_{axle}1={damper}, {letter}_{axle}2={spring}",
                f"either {letter}_{axle}, or {letter}_{axle}1 (dampers) and {letter}_{axle}2 (springs)",
                "Give one of the two.",
            )
            return
        object.__setattr__(self, f"{letter}_{axle}1", damper)
        object.__setattr__(self, f"{letter}_{axle}2", spring)
        object.__setattr__(self, f"{letter}_{axle}", damper if damper == spring else None)

    @classmethod
    def from_parameters(
        cls, parameters: Mapping[str, float], *, name: str = "vehicle", **heights: float | None
    ) -> Vehicle:
        """Return the vehicle with the parameters of a mapping, as a vehicle file holds them.

        Parameters
        ----------
        parameters
            Values by name, SI.
        name
            For messages and tables.
        heights
            `cg_height`, `wheel_height` and `roll_axis_height`, m, as far as they are known.

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
        keywords: dict[str, Any] = {**parameters, **heights}
        return cls(**keywords, name=name)

    @classmethod
    def nearest(cls, values: Mapping[str, float], *, name: str = "vehicle", **heights: float | None) -> Vehicle:
        """Return the vehicle nearest to fitted values: a negative value of a parameter that cannot be negative becomes zero.

        Parameters
        ----------
        values, name, heights
            As for `from_parameters`; masses of loads among the values are ignored.
        """
        possible = {
            key: value if PARAMETERS[key].signed else max(value, 0.0)
            for key, value in values.items()
            if key in PARAMETERS
        }
        return cls.from_parameters(possible, name=name, **heights)

    @property
    def tracks(self) -> Tracks:
        """Whether springs and dampers share their half-distance, and their place on the axle, on both axles."""
        return "separate" if None in (self.t_f, self.t_r, self.n_f, self.n_r) else "shared"

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

    def __shown__(self) -> dict[str, float | str]:
        """Return what a console and a notebook show: parameters and heights, without the places that follow from others."""
        heights = {key: value for key, value in self.heights.by_key.items() if value is not None}
        return {"name": self.name, **self.parameters, **heights}

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of what it has beyond the paper's vehicle."""
        return tuple(
            extra
            for extra in EXTRA_PARAMETERS
            if any(
                getattr(self, name) != NEUTRAL[name]
                for name in parameters_of_term(extra, self.tracks)
                if name in NEUTRAL
            )
        )

    @property
    def heights(self) -> Heights:
        """Heights, as far as they are known."""
        return Heights(self.cg_height, self.wheel_height, self.roll_axis_height)

    def model(self, load: Load = EMPTY) -> LinearModel:
        """Return the equations of motion of this vehicle with a load, as functions of its parameters.

        Parameters
        ----------
        load
            What is on it.
        """
        elements = seven_degrees_of_freedom(self.tracks, self.extras, self.heights, self.wheelbase)
        elements += stiffened_air_springs(load.mass_at_wheels(self.wheelbase), self.tracks, self.extras, self.wheelbase)
        elements += load.elements(self.heights, tuple(self.parameters))
        return LinearModel.of(elements, tuple(self.parameters))

    def matrices(self, load: Load = EMPTY) -> Matrices:
        """Return mass, damping and stiffness matrices; of nonlinear springs and tyres as they are at rest.

        Parameters
        ----------
        load
            What is on it; empty unless given.

        Returns
        -------
        Matrices
            M, C and K, each of shape (7, 7), SI: eq. (2) of the paper.
        """
        model = self.model(load)
        return model.matrices(with_tyre_rates_at_rest(model, list(self.parameters.values())))
