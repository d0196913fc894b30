"""Drop tests of real cars: Newton's and Euler's equations of each body, followed by the method of Runge and Kutta.

Every row of the arrays is one drop of one car; all rows are followed at once. Displacements and forces are changes from the
rest of the empty car on flat ground. Angles are small: pitch is positive with the nose down, roll with the left side up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from real_vehicle import AXLE, GRAVITY, POLYTROPIC, SIDE, STATIONS, Pair, Real, RealCar, Station, softened

STEP = 2.5e-4
"""s of a step, at most."""

BODY, WHEEL, SEAT = slice(0, 4), slice(4, 8), slice(8, 10)
"""Places among the ten coordinates: heave, pitch, roll and elastic mode of the body; wheels; two occupants."""


@dataclass(frozen=True)
class BallastItem:
    """A rigid item on the body: kg; m forward of the front axle and left of the centreline; own [I_xx, I_yy], kg m²."""

    mass: float
    x: float
    y: float
    inertia: Pair = (0.0, 0.0)


@dataclass(frozen=True)
class Row:
    """One drop of one car.

    Attributes
    ----------
    car, items
        What is dropped.
    wheels, height
        Stations on blocks, and the height of these, m.
    release
        When the blocks are pulled away, s.
    """

    car: RealCar
    items: tuple[BallastItem, ...] = ()
    wheels: tuple[Station, ...] = STATIONS
    height: float = 0.05
    release: float = 0.4


class Motion(NamedTuple):
    """What happened, at every step.

    Attributes
    ----------
    step
        Interval, s.
    acceleration
        Of the ten coordinates, (row, coordinate, step), m/s² and rad/s².
    angles
        Pitch and roll, (row, 2, step), rad.
    rate, travel
        Of each suspension, extension positive, (row, station, step), m/s and m; of the damper itself where it has a mount.
    lifted
        Whether a tyre carries nothing, (row, station, step).
    energy
        Kinetic energy, and that stored in linear springs, tyres, bars, body and the field of gravity, (row, step), J; NaN
        unless asked for.
    readings
        Of each sensor without errors, (row, channel, step), m/s², where angles are finite; None where they are small.
    """

    step: float
    acceleration: Real
    angles: Real
    rate: Real
    travel: Real
    lifted: NDArray[np.bool_]
    energy: Real
    readings: Real | None = None

    def of_rows(self, rows: slice) -> Motion:
        """Return what happened in some of the rows."""
        return self._replace(
            acceleration=self.acceleration[rows],
            angles=self.angles[rows],
            rate=self.rate[rows],
            travel=self.travel[rows],
            lifted=self.lifted[rows],
            energy=self.energy[rows],
            readings=None if self.readings is None else self.readings[rows],
        )


class State(NamedTuple):
    """Displacements and velocities (row, coordinate), and internal displacements of mounts and branches (row, station)."""

    X: Real
    V: Real
    mount: Real
    zener: Real

    def ahead(self, step: float, slope: State) -> State:
        """Return the state a step further along a slope."""
        return State(*(mine + step * its for mine, its in zip(self, slope, strict=True)))


class Rows:
    """The constants of all rows, and the forces between their bodies.

    Parameters
    ----------
    rows
        The drops; an effect is computed for all of them if one of the cars has it.
    """

    def __init__(self, rows: Sequence[Row]) -> None:
        cars = [row.car for row in rows]

        def stations(front: str, rear: str = "") -> Real:
            pairs = [(getattr(c, front), getattr(c, rear)) if rear else getattr(c, front) for c in cars]
            return np.array(pairs, dtype=float)[:, AXLE]

        self.m_u, self.k_s = stations("m_uf", "m_ur"), stations("k_sf", "k_sr")
        self.k_t, self.c_s = stations("k_tf", "k_tr"), stations("c_sf", "c_sr")
        knee = stations("knee")
        self.knee, self.slope = (
            np.where(np.isfinite(knee), knee, 1.0),
            np.where(np.isfinite(knee), stations("slope"), 1.0),
        )
        self.rounding, self.rebound = stations("rounding"), stations("rebound")
        self.zener = stations("zener") * self.k_s
        self.relaxation = stations("relaxation")
        self.hard, self.c_t = stations("hard"), stations("tyre_damping")
        self.friction, self.presliding = stations("friction"), stations("presliding")
        self.column, self.progressive = stations("column"), stations("progressive")
        self.stop, self.clearance, self.bar = stations("stop"), stations("clearance"), stations("anti_roll")
        mount = stations("mount")
        self.mounted = np.isfinite(mount)
        self.mount, self.mount_damping = np.where(self.mounted, mount, 1.0), stations("mount_damping")
        self.play = np.array([[c.play.get(s, np.inf) for s in STATIONS] for c in cars])
        self.play_rate = np.array([[c.play_rate] for c in cars])
        self.has_mounts = bool(self.mounted.any())
        self.has_air, self.has_stop = bool(np.isfinite(self.column).any()), bool(self.stop.any())
        self.has_friction, self.has_play = bool(self.friction.any()), bool(self.play_rate.any())
        self.corner = np.array([_points(c, *_stations(c)) for c in cars])
        self.seat, self.k_o, self.c_o, self.m_o = _seats(cars)
        self.stiffness, self.damping = np.zeros((len(cars), 4)), np.zeros((len(cars), 4))
        for row, car in enumerate(cars):
            if (mode := car.body_mode) is not None:
                mass, turning = mode.mass * car.m_s, 2 * np.pi * mode.frequency
                self.stiffness[row, 3] = mass * turning**2
                self.damping[row, 3] = 2 * mode.damping * turning * mass
        self.mass, self.weight = _body_masses(rows, self.seat, self.m_o)
        self.inverse = np.linalg.inv(self.mass)
        corners = np.array([np.repeat([c.b, c.a], 2) * c.m_s / (2 * c.wheelbase) for c in cars])
        self.tyre_load = GRAVITY * (corners + self.m_u)
        # Deflection at rest d of k d (1 + h d) = W, free of cancellation where h is small.
        self.sunk = 2 * self.tyre_load / (self.k_t * (1 + np.sqrt(1 + 4 * self.hard * self.tyre_load / self.k_t)))

    def spring(self, x: Real) -> Real:
        """Return the tension of the springs at travels, (row, station), N."""
        force: Real = self.k_s * x * (1 - 0.5 * self.progressive * x)
        if self.has_air:
            air = np.isfinite(self.column)
            column = np.where(air, self.column, 1.0)
            gas = self.k_s * column / POLYTROPIC * (1 - np.maximum(1 + x / column, 0.05) ** -POLYTROPIC)
            force = np.where(air, gas, force)
        if self.has_stop:
            force = force - self.stop * np.maximum(-x - self.clearance, 0.0)
        return force + self.bar * (x - x[:, [1, 0, 3, 2]])

    def damper(self, v: Real) -> Real:
        """Return the tension of the dampers at rates, (row, station), N."""
        size = np.abs(v)
        beyond = softened(size - self.knee, self.rounding) - softened(-self.knee, self.rounding)
        force = self.c_s * (size - (1 - self.slope) * beyond)
        return np.where(v > 0, self.rebound, -1.0) * force

    def damper_rate(self, force: Real) -> Real:
        """Return the rates at which dampers with the mounts' damping beside them have tensions, (row, station), m/s.

        Beyond the knee u satisfies B/2 sqrt(u² + w²) = p u + q, a quadratic equation.
        """
        damping = self.c_s * np.where(force > 0, self.rebound, 1.0)
        A, B = damping + self.mount_damping, damping * (1 - self.slope)
        p, q = A - 0.5 * B, A * self.knee + B * softened(-self.knee, self.rounding) - np.abs(force)
        bent = A * (A - B)
        u = (np.sqrt(p**2 * q**2 - bent * (q**2 - 0.25 * (B * self.rounding) ** 2)) - p * q) / bent
        return np.asarray(np.sign(force) * (u + self.knee))

    def tyre(self, u: Real, v: Real) -> Real:
        """Return the forces of the ground at compressions beyond that at rest, (row, station), N; none in the air."""
        deep = np.maximum(self.sunk + u, 0.0)
        spring: Real = self.k_t * deep * (1 + self.hard * deep)
        return np.where(deep > 0, np.maximum(spring + self.c_t * v, 0.0), 0.0)

    def rub(self, x: Real, x_0: Real, f_0: Real) -> Real:
        """Return Dahl's friction where it was f_0 at the travel x_0, and the travel grew or shrank steadily since then."""
        dx = x - x_0
        end = self.friction * np.sign(dx)
        with np.errstate(divide="ignore", invalid="ignore"):
            length = np.where(self.friction > 0, self.friction / self.presliding, 1.0)
        return np.asarray(end + (f_0 - end) * np.exp(-np.abs(dx) / length))

    def travel(self, X: Real) -> Real:
        """Return what belongs to each suspension: the body above it less the wheel, (row, station)."""
        return np.asarray((self.corner @ X[:, BODY, None])[..., 0] - X[:, WHEEL])

    def slope_of(self, at: State, ground: Real, x_0: Real, f_0: Real) -> tuple[State, Real, Real]:
        """Return the derivative of the state, the rates of the dampers and the forces of the ground.

        Parameters
        ----------
        at
            The state.
        ground
            Height of what is under the wheels, (row, station), m.
        x_0, f_0
            Travel and friction at the start of the step.
        """
        x, v = self.travel(at.X), self.travel(at.V)
        # A mount's rate and damping act on what the damper leaves of the travel; without one it leaves nothing.
        pull = self.mount * (x - at.mount) + self.mount_damping * v
        rate = np.where(self.mounted, self.damper_rate(pull), v) if self.has_mounts else v
        tension = self.spring(x) + self.damper(rate)
        tension += self.zener * (x - at.zener)
        if self.has_friction:
            tension += self.rub(x, x_0, f_0)
        if self.has_play:
            tension += self.play_rate * np.sign(x) * np.maximum(np.abs(x) - self.play, 0.0)
        ground_force = self.tyre(ground - at.X[:, WHEEL], -at.V[:, WHEEL])
        below, below_rate = ((self.seat @ y[:, BODY, None])[..., 0] for y in (at.X, at.V))
        seat = self.k_o * (below - at.X[:, SEAT]) + self.c_o * (below_rate - at.V[:, SEAT])
        body = -(tension[:, None] @ self.corner + seat[:, None] @ self.seat)[:, 0] - self.weight
        body -= self.stiffness * at.X[:, BODY] + self.damping * at.V[:, BODY]
        A = np.empty_like(at.X)
        A[:, BODY] = (self.inverse @ body[:, :, None])[..., 0]
        # The weights of body and wheel are in the forces at rest, and only what changes these accelerates.
        A[:, WHEEL] = (tension + ground_force - self.tyre_load) / self.m_u
        A[:, SEAT] = seat / self.m_o
        return State(at.V, A, rate, (x - at.zener) / self.relaxation), rate, ground_force

    def energy(self, at: State, ground: Real) -> Real:
        """Return the energy of motion and of linear springs, tyres, bars, body and seats, with that of gravity, (row,), J."""
        x, u = self.travel(at.X), ground - at.X[:, WHEEL]
        pressed = np.maximum(u, -self.sunk)
        stored = 0.5 * self.k_s * x**2 + 0.25 * self.bar * (x - x[:, [1, 0, 3, 2]]) ** 2
        stored += 0.5 * self.k_t * pressed**2 + self.tyre_load * (pressed + at.X[:, WHEEL])
        stored += 0.5 * self.m_u * at.V[:, WHEEL] ** 2
        seat = (self.seat @ at.X[:, BODY, None])[..., 0] - at.X[:, SEAT]
        people = 0.5 * self.k_o * seat**2 + 0.5 * self.m_o * at.V[:, SEAT] ** 2
        body = 0.5 * np.einsum("ri,rij,rj->r", at.V[:, BODY], self.mass, at.V[:, BODY])
        body += (self.weight * at.X[:, BODY] + 0.5 * self.stiffness * at.X[:, BODY] ** 2).sum(axis=1)
        return np.asarray(body + stored.sum(axis=1) + people.sum(axis=1))

    def rest(self, ground: Real) -> State:
        """Return the state of rest on the ground, by Newton's method.

        Springs carry their curves; mounts and branches are relaxed, and friction carries nothing.
        """
        count = len(ground)
        X, none = np.zeros((count, 10)), np.zeros((count, 4))
        X[:, WHEEL] = ground

        def pull(X: Real) -> Real:
            x = self.travel(X)
            still = State(X, np.zeros_like(X), x, x)
            # Coordinates that nothing moves (no mode, no occupant) are held by a spring of their own.
            masses = np.concatenate([np.ones((count, 4)), self.m_u, self.m_o], axis=1)
            A = self.slope_of(still, ground, x, none)[0].V
            A[:, BODY] = (self.mass @ A[:, BODY, None])[..., 0]
            return np.asarray(A * masses)

        for _ in range(30):
            force = pull(X)
            J = np.stack([(pull(X + 1e-7 * e) - pull(X - 1e-7 * e)) / 2e-7 for e in np.eye(10)], axis=2)
            free = np.abs(J).sum(axis=2) < 1e-9
            J[:, range(10), range(10)] -= free
            step = np.linalg.solve(J, force[:, :, None])[..., 0]
            X = X - step
            if np.abs(step).max() < 1e-13:
                break
        x = self.travel(X)
        return State(X, np.zeros_like(X), x, x)


def follow(
    rows: Sequence[Row], rate: float, duration: float, step: float = STEP, *, with_energy: bool = False
) -> Motion:
    """Follow drops from rest on the blocks.

    Parameters
    ----------
    rows
        The drops.
    rate
        Samples per second, of which steps are whole parts.
    duration
        Of the recording, s; the release is a whole number of steps after its start.
    step
        Longest step, s.
    with_energy
        Whether the energy is computed.

    Returns
    -------
    Motion
    """
    system = Rows(rows)
    fine = int(np.ceil(1 / (rate * step) - 1e-9))
    h, count = 1 / (rate * fine), int(duration * rate) * fine
    blocks = np.array([[row.height * (s in row.wheels) for s in STATIONS] for row in rows])
    release = np.array([round(row.release / h) for row in rows])
    at = system.rest(blocks)
    friction, shape = np.zeros((len(rows), 4)), (len(rows), 4, count)
    found = Motion(
        h,
        np.empty((len(rows), 10, count)),
        np.empty((len(rows), 2, count)),
        np.empty(shape),
        np.empty(shape),
        np.empty(shape, dtype=bool),
        np.full((len(rows), count), np.nan),
    )
    for k in range(count):
        falling = (k >= release)[:, None]
        ground = np.where(falling, 0.0, blocks)
        x = system.travel(at.X)
        one, rates, carried = system.slope_of(at, ground, x, friction)
        found.acceleration[:, :, k], found.angles[:, :, k] = one.V, at.X[:, 1:3]
        found.rate[:, :, k], found.travel[:, :, k], found.lifted[:, :, k] = rates, x, carried <= 0
        if with_energy:
            found.energy[:, k] = system.energy(at, ground)
        if not falling.any():
            continue
        two = system.slope_of(at.ahead(h / 2, one), ground, x, friction)[0]
        three = system.slope_of(at.ahead(h / 2, two), ground, x, friction)[0]
        four = system.slope_of(at.ahead(h, three), ground, x, friction)[0]
        mean = State(*((a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(one, two, three, four, strict=True)))
        # Nothing moves before the release, not even by rounding.
        after = at.ahead(h, State(*(np.where(falling, each, 0.0) for each in mean)))
        if system.has_friction:
            friction = system.rub(system.travel(after.X), x, friction)
        at = after
    return found


def _stations(car: RealCar) -> tuple[Real, Real]:
    """Return the places of the wheels, forward of the front axle and left of the centreline, m."""
    return np.array([0.0, -car.wheelbase])[AXLE], np.array([car.t_f, car.t_r])[AXLE] * SIDE


def _points(car: RealCar, x: Real, y: Real) -> Real:
    """Return how far points of the body move with each of its coordinates, (point, 4)."""
    mode = np.zeros(len(x))
    if car.body_mode is not None:
        mode = car.body_mode.shape(x, y, car.wheelbase, (car.t_f, car.t_r))
    return np.column_stack([np.ones(len(x)), -(x + car.a), y, mode])


def points(car: RealCar, x: Sequence[float], y: Sequence[float]) -> Real:
    """Return how far points of the body move with the ten coordinates, (point, 10)."""
    moved = np.zeros((len(x), 10))
    moved[:, BODY] = _points(car, np.array(x, dtype=float), np.array(y, dtype=float))
    return moved


def _seats(cars: Sequence[RealCar]) -> tuple[Real, Real, Real, Real]:
    """Return points, rates, damping and masses of two seats for each car; an empty seat has no rate."""
    place, spring, damping = np.zeros((len(cars), 2, 4)), np.zeros((len(cars), 2)), np.zeros((len(cars), 2))
    mass = np.ones((len(cars), 2))
    for row, car in enumerate(cars):
        for i, one in enumerate(car.occupants):
            turning = 2 * np.pi * one.frequency
            place[row, i] = _points(car, np.array([one.x]), np.array([one.y]))[0]
            mass[row, i], spring[row, i] = one.mass, one.mass * turning**2
            damping[row, i] = 2 * one.damping * turning * one.mass
    return place, spring, damping, mass


def _body_masses(rows: Sequence[Row], seats: Real, people: Real) -> tuple[Real, Real]:
    """Return the inertia of each body with items and without occupants, (row, 4, 4), and the items' weights, (row, 4)."""
    inertia, weight = np.zeros((len(rows), 4, 4)), np.zeros((len(rows), 4))
    for row, one in enumerate(rows):
        car, mode = one.car, one.car.body_mode
        inertia[row] = np.diag([car.m_s, car.I_yy, car.I_xx, 1.0 if mode is None else mode.mass * car.m_s])
        for i in range(len(car.occupants)):
            rigid = seats[row, i] * [1, 1, 1, 0]
            inertia[row] -= people[row, i] * np.outer(rigid, rigid)
        for item in one.items:
            place = _points(car, np.array([item.x]), np.array([item.y]))[0]
            inertia[row] += item.mass * np.outer(place, place) + np.diag([0.0, item.inertia[1], item.inertia[0], 0.0])
            weight[row] += GRAVITY * item.mass * place
    return inertia, weight
