"""The vehicle: values of its parameters, and the equations of motion that follow from them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from sprung.display import shown
from sprung.errors import Problems, did_you_mean
from sprung.vehicle.elements import linear_elements, stiffened_air_springs
from sprung.vehicle.heights import Heights
from sprung.vehicle.layout import LAYOUTS, Layout, Tracks, VehicleModel, wheelbase_of
from sprung.vehicle.load import EMPTY, Load
from sprung.vehicle.model import LinearModel, Matrices
from sprung.vehicle.parameter_values import (
    APART,
    all_names,
    check_values,
    complete_parameters,
    effective_terms,
    model_of,
    own_parameters,
)
from sprung.vehicle.parameters import ABSENT, PARAMETERS
from sprung.vehicle.tyre_rates import with_tyre_rates_at_rest


@shown
@dataclass(frozen=True, init=False)
class Vehicle:
    """A road vehicle or a part of one, by its parameters in SI units; named as in the paper.

    Give t_f and t_r where springs and dampers of an axle share their half-distance from the centreline, or t_f1, t_r1
    (dampers) and t_f2, t_r2 (springs). Rates, and unsprung masses, are those of one wheel station. A parameter that is not
    given has the value without effect; those of the paper's vehicle must be given.

    A part of a vehicle (``model``) has fewer parameters, and where it has one axle they lose the index of the axle: a quarter
    car has m_s, m_u, k_s, k_t and c_s; a roll plane I_xx and t, or t_1 and t_2, besides; a pitch plane has those of front and
    rear with I_yy, a and b.

    Attributes
    ----------
    parameters
        Every parameter that it has, by name, in the order of tables; each is an attribute as well:
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
    d_Ff, d_Fr
        Excess of the left wheel's friction over the mean of left and right, N.
    r_f, r_r
        Rebound damping over compression damping; c_s is then that of compression.
    v_kf, v_kr, q_f, q_r, w_kf, w_kr
        Velocity at which the damper curves have their knee, m/s, the damping beyond it over that before it, and half the width
        over which it is rounded, m/s.
    b_kf, b_kr, b_qf, b_qr
        Velocity of the knees in rebound over that in compression, and likewise what `q` is in rebound.
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
    k_xf, k_xr, c_xf, c_xr
        Interconnection of left and right, hydraulic or by air: a rate k_x against a difference in travel, N/m, in series with a
        damping c_x, N s/m, so that it resists roll and relaxes with c_x / k_x.
    I_w, k_w, c_w, a_w, u_w, e_w
        Twist of the body: modal inertia, kg m², stiffness, N m, and damping, N m s, for the angle between the axles, and its
        node, m ahead of the middle between them; and how unevenly it turns along its length, by a parabola and by a cubic that
        vanish at the axles, dimensionless. An infinite inertia is that of a body that does not twist.
    m_v, k_v, c_v, b_v, p_v
        Bending of the body: modal mass, kg, stiffness, N/m, and damping, N s/m, for the rise of its middle above its axles;
        rise of the centre of gravity, 1, and mean pitch, 1/m, over that. An infinite mass is that of a body that does not bend.
    m_o, k_o, c_o, x_o, y_o, t_o
        People on soft seats, kg, a part of the sprung mass and of its inertias; rate, N/m, and damping, N s/m, of all seats
        together; their place, m forward of the front axle and left of the centreline; and their half-distance, m.
    d_mo, d_ko, d_co
        Excess of the people and seats on the left over the mean of both sides.
    w_l, c_l
        Rate, 1/s², and damping, 1/s, of the seats under items of loads, over the mass on them: the squared natural frequency,
        and twice that frequency times the damping ratio. An infinite rate is that of a floor.
    model
        ``full``, ``pitch-plane``, ``roll-plane`` or ``quarter``.
    cg_height, wheel_height, roll_axis_height
        Of the sprung mass's centre of gravity, the wheel centres and the axis of roll, m; see `Heights`.
    name
        For messages and tables.

    Raises
    ------
    InputError
        If a parameter is unknown or missing, not finite or not positive; all faults at once.

    Examples
    --------
    >>> car = Vehicle(m_s=1380, I_yy=2440, I_xx=380, m_uf=40.5, m_ur=45.4, k_sf=17000, k_sr=22000, k_tf=192000,
    ...               k_tr=192000, c_sf=1500, c_sr=1500, a=1.25, b=1.51, t_f=0.74, t_r=0.74)
    >>> M, C, K = car.matrices()
    >>> float(K[0, 0])
    78000.0
    """

    parameters: dict[str, float]
    model: VehicleModel
    cg_height: float | None
    wheel_height: float | None
    roll_axis_height: float | None
    name: str

    def __init__(
        self,
        parameters: Mapping[str, float] | None = None,
        *,
        model: VehicleModel = "full",
        cg_height: float | None = None,
        wheel_height: float | None = None,
        roll_axis_height: float | None = None,
        name: str = "vehicle",
        **named: float | None,
    ) -> None:
        given = {key: value for key, value in {**(parameters or {}), **named}.items() if value is not None}
        where, problems = f"vehicle {name}", Problems()
        if model not in LAYOUTS:
            do = did_you_mean(model, LAYOUTS, listed=True)
            problems.add(where, f"model '{model}'", f"any of {', '.join(LAYOUTS)}", do)
            problems.raise_if_any()
        values = complete_parameters(given, LAYOUTS[model], where, problems)
        problems.raise_if_any()
        own = own_parameters(values, LAYOUTS[model])
        check_values(values, own, where, problems)
        heights = {"cg_height": cg_height, "wheel_height": wheel_height, "roll_axis_height": roll_axis_height}
        for key, height in heights.items():
            if key != "roll_axis_height" and height is not None and not (math.isfinite(height) and height > 0):
                problems.add(f"{where}: {key}", repr(height), "a positive number, m", "Correct it.")
        problems.raise_if_any()
        for key, value in {"parameters": own, "model": model, "name": name, **heights}.items():
            object.__setattr__(self, key, value)

    def __getattr__(self, name: str) -> Any:
        """Return a parameter; of an extra that the vehicle has not, the value without effect."""
        own = self.__dict__.get("parameters", {})
        if name in own:
            return own[name]
        if name not in all_names(self.__dict__.get("model", "full")):
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'")
        if name in APART and own.keys() & {*APART[name]}:
            damper, spring = (own[one] for one in APART[name])
            return damper if damper == spring else None
        shared = next((one for one, apart in APART.items() if name in apart), name)
        return own.get(shared, ABSENT.get(name))

    def __dir__(self) -> list[str]:
        """Return the names of all attributes, parameters included."""
        return [*super().__dir__(), *all_names(self.model)]

    def __hash__(self) -> int:
        """Return the hash of everything that two equal vehicles share."""
        return hash((self.model, self.name, self.heights, *self.parameters.items()))

    @classmethod
    def from_parameters(
        cls, parameters: Mapping[str, float], *, name: str = "vehicle", **heights: float | None
    ) -> Vehicle:
        """Return the vehicle with the parameters of a mapping; their names tell which part of a vehicle it is.

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
        return cls(parameters, name=name, model=model_of(parameters), **heights)

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
        return cls(possible, name=name, model=model_of(possible), **heights)

    def with_values(self, **changes: Any) -> Vehicle:
        """Return the vehicle with other values of some parameters, of its heights or its name.

        Parameters
        ----------
        changes
            By name, SI; None takes a parameter away. A half-distance of dampers or springs changes that of the other not.

        Returns
        -------
        Vehicle
        """
        own = dict(self.parameters)
        for shared, apart in APART.items():
            if shared in own and changes.keys() & {*apart}:
                own |= dict.fromkeys(apart, own.pop(shared))
            elif shared in changes:
                own = {name: value for name, value in own.items() if name not in apart}
        return replace(self, **{"parameters": own, **changes})

    @property
    def layout(self) -> Layout:
        """Its coordinates and wheel stations."""
        return LAYOUTS[self.model]

    @property
    def tracks(self) -> Tracks:
        """Whether springs and dampers share their half-distance, and their place on the axle, on all axles."""
        return "separate" if any(one in self.parameters for apart in APART.values() for one in apart) else "shared"

    @property
    def wheelbase(self) -> float:
        """Front axle to rear axle, m; 0 where front and rear are not told apart."""
        return wheelbase_of(tuple(self.parameters), self.parameters.values())

    @property
    def total_mass(self) -> float:
        """Mass of the whole empty vehicle, kg."""
        layout = self.layout
        return float(self.m_s + sum(getattr(self, f"m_u{axle}") * len(layout.wheels_of(axle)) for axle in layout.axles))

    def __shown__(self) -> dict[str, float | str]:
        """Return what a console and a notebook show: parameters and heights, without the places that follow from others."""
        heights = {key: value for key, value in self.heights.by_key.items() if value is not None}
        model = {} if self.model == "full" else {"model": self.model}
        return {"name": self.name, **model, **self.parameters, **heights}

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of what it has beyond the paper's vehicle."""
        return effective_terms(self.parameters, self.tracks, self.layout)

    @property
    def heights(self) -> Heights:
        """Heights, as far as they are known."""
        return Heights(self.cg_height, self.wheel_height, self.roll_axis_height)

    def linear_model(self, load: Load = EMPTY) -> LinearModel:
        """Return the equations of motion of this vehicle with a load, as functions of its parameters.

        Parameters
        ----------
        load
            What is on it.
        """
        elements = linear_elements(self.tracks, self.extras, self.heights, self.wheelbase, self.layout)
        at_wheels = load.mass_at_wheels(self.wheelbase, self.layout)
        elements += stiffened_air_springs(at_wheels, self.tracks, self.extras, self.wheelbase, self.layout)
        elements += load.elements(self.heights, tuple(self.parameters), self.wheelbase)
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
            M, C and K, each of shape (7, 7), SI: eq. (2) of the paper; of a part of a vehicle in its coordinates.
        """
        model = self.linear_model(load)
        return model.matrices(with_tyre_rates_at_rest(model, list(self.parameters.values())))
