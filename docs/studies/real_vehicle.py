"""A car as it is: masses, and what real suspensions, tyres and bodies have beside springs and dampers.

Nothing here or in `real_motion` comes from `sprung.vehicle`: it is the truth against which that room is held.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Pair = tuple[float, float]
"""A front and a rear value."""

GRAVITY = 9.80665
"""m/s²."""

Station = Literal["fl", "fr", "rl", "rr"]
"""A wheel: front left, front right, rear left, rear right."""

STATIONS: tuple[Station, ...] = ("fl", "fr", "rl", "rr")
"""Wheels in the order of all arrays."""

AXLE, SIDE = np.array([0, 0, 1, 1]), np.array([1.0, -1.0, 1.0, -1.0])
"""Of each station: which axle, and 1 on the left, -1 on the right."""


@dataclass(frozen=True)
class BodyMode:
    """One elastic mode of the body.

    Attributes
    ----------
    kind
        ``twist``: the shape is the product of both distances from the middle; ``bending``: a parabola along the body.
    frequency, damping
        Hz, and a part of critical damping, of the unloaded body that floats freely.
    mass
        Modal mass as a part of the sprung mass, with the shape 1 at the wheel stations.
    """

    kind: Literal["twist", "bending"]
    frequency: float
    damping: float = 0.02
    mass: float = 0.25

    def shape(self, x: Real, y: Real, wheelbase: float, half_track: Pair) -> Real:
        """Return the shape at points x forward of the front axle and y left of the centreline, m; ±1 at the wheels."""
        along = 1 + 2 * np.asarray(x, dtype=float) / wheelbase
        if self.kind == "twist":
            half = 0.5 * ((1 + along) * half_track[0] + (1 - along) * half_track[1])
            return np.asarray(along * np.asarray(y) / half, dtype=float)
        return np.asarray((along**2 - NODES**2) / (1 - NODES**2) + 0 * np.asarray(y), dtype=float)


NODES = 0.6
"""Nodes of the bending mode, from the middle between the axles, as a part of half the wheelbase."""


@dataclass(frozen=True)
class Occupant:
    """A person on a seat: a mass that moves on a spring and a damper.

    Attributes
    ----------
    x, y
        Forward of the front axle, and left of the centreline, m.
    mass, frequency, damping
        kg; Hz and part of critical damping with the body held.
    """

    x: float
    y: float
    mass: float = 75.0
    frequency: float = 4.5
    damping: float = 0.3


@dataclass(frozen=True, kw_only=True)
class RealCar:
    """All of a car, SI; neutral where nothing else is stated. The names of plain parameters are the paper's.

    Attributes
    ----------
    m_s, I_yy, I_xx
        Of the sprung mass with its occupants, as if these were fixed to it.
    k_sf, k_sr
        Spring rates at the rest position of the empty car, of slow motion: without the Zener branch.
    k_tf, k_tr
        Tyre rates where the tyre just touches the ground.
    c_sf, c_sr
        Compression damping below the knee.
    mount, mount_damping
        Rate of the rubber mount in series with each damper, N/m, and its own damping, N s/m.
    knee, rounding, slope, rebound
        Of the damper curve: velocity of the knee, m/s, and half the width over which a hyperbola rounds it; damping beyond
        over damping before it; rebound over compression.
    zener, relaxation
        Rate of the branch beside the spring as a part of the spring rate, and its time constant, s.
    hard, tyre_damping
        Growth h of the tyre's secant rate k (1 + h d) with its deflection d, 1/m, and damping while it touches, N s/m.
    friction, presliding
        Dahl's friction of each suspension, N, and its stiffness before it slides, N/m.
    column
        Effective height of the air column of a polytropic air spring, m; infinite for steel.
    progressive
        Growth of the spring rate per metre of compression, as a part of it.
    stop, clearance
        Rate of the bump stop, N/m, and the compression at which it is met, m.
    anti_roll
        Rate of the bar, N per metre of difference in travel.
    play, play_rate
        For no vehicle: a wheel that strikes a stop: free travel each way, m, and the rate of the stop, N/m.
    body_mode, occupants
        Elastic mode, and people.
    """

    name: str = "car"
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
    t_f: float
    t_r: float
    mount: Pair = (math.inf, math.inf)
    mount_damping: Pair = (0.0, 0.0)
    knee: Pair = (math.inf, math.inf)
    rounding: Pair = (0.0, 0.0)
    slope: Pair = (1.0, 1.0)
    rebound: Pair = (1.0, 1.0)
    zener: Pair = (0.0, 0.0)
    relaxation: Pair = (0.05, 0.05)
    hard: Pair = (0.0, 0.0)
    tyre_damping: Pair = (0.0, 0.0)
    friction: Pair = (0.0, 0.0)
    presliding: Pair = (3e5, 3e5)
    column: Pair = (math.inf, math.inf)
    progressive: Pair = (0.0, 0.0)
    stop: Pair = (0.0, 0.0)
    clearance: Pair = (0.0, 0.0)
    anti_roll: Pair = (0.0, 0.0)
    play: Mapping[str, float] = field(default_factory=dict)
    play_rate: float = 0.0
    body_mode: BodyMode | None = None
    occupants: tuple[Occupant, ...] = ()

    @property
    def wheelbase(self) -> float:
        """Distance of the axles, m."""
        return self.a + self.b

    @property
    def axle_masses(self) -> Pair:
        """Masses on the axles, kg."""
        return (
            self.m_s * self.b / self.wheelbase + 2 * self.m_uf,
            self.m_s * self.a / self.wheelbase + 2 * self.m_ur,
        )

    @property
    def parameters(self) -> dict[str, float]:
        """The fifteen of the plain vehicle."""
        return {name: float(getattr(self, name)) for name in PLAIN}

    def damper_force(self, rate: Real, axle: int) -> Real:
        """Return the force of one damper, N, at rates of extension, m/s; shape of the rates."""
        damping, knee, round_ = (self.c_sf, self.c_sr)[axle], self.knee[axle], self.rounding[axle]
        size = np.abs(rate)
        beyond = np.zeros_like(size)
        if math.isfinite(knee):
            beyond = softened(size - knee, round_) - softened(np.array(-knee), round_)
        force = damping * (size - (1 - self.slope[axle]) * beyond)
        return np.asarray(np.where(rate > 0, self.rebound[axle], -1.0) * force)

    def spring_force(self, travel: Real, axle: int) -> Real:
        """Return the change of one spring's force, N, positive in tension, at extensions from rest, m; shape of the travel."""
        rate, column = (self.k_sf, self.k_sr)[axle], self.column[axle]
        force = rate * (travel - 0.5 * self.progressive[axle] * travel**2)
        if math.isfinite(column):
            # A polytropic column of height h and rate k at rest carries k h/n more than nothing.
            force = rate * column / POLYTROPIC * (1 - (1 + travel / column) ** -POLYTROPIC)
        return np.asarray(force - self.stop[axle] * np.maximum(-travel - self.clearance[axle], 0.0))


def softened(u: Real, width: Real | float) -> Real:
    """Return max(u, 0) rounded by a hyperbola over a width on both sides."""
    return np.asarray(0.5 * (u + np.sqrt(u**2 + width**2)))


POLYTROPIC = 1.3
"""Exponent of an air spring in motion."""

PLAIN = ("m_s", "I_yy", "I_xx", "m_uf", "m_ur", "k_sf", "k_sr", "k_tf", "k_tr", "c_sf", "c_sr", "a", "b", "t_f", "t_r")
"""Parameters of the plain vehicle."""
