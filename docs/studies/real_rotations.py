"""Drop tests with finite rotations: a rigid body in space, and wheels that slide along the body's own vertical axis.

The ground is without friction and presses vertically on the wheel centres, so a tall body turns with its centre of gravity
moving sideways and sinking. Springs, dampers and anti-roll bars are linear. Equations after Kane: every force and every
inertial force is projected on the partial velocities of the point at which it acts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from real_motion import Motion, Row, Rows
from real_sensors import RealSensor
from real_vehicle import GRAVITY, SIDE, STATIONS, Real

STEP = 5e-4
"""s of a step, at most: nothing here is faster than wheel hop."""

YAW = 1.05
"""Yaw inertia of the body over its pitch inertia; hardly anything turns about the vertical."""


class Pose(NamedTuple):
    """Where everything is and how it moves.

    Attributes
    ----------
    place, turned
        Centre of gravity of the body in space, (row, 3), m, and the axes of the body as columns, (row, 3, 3).
    slid
        How far the wheels are up from their places in the car at rest, along the body's axis, (row, station), m.
    speed, spin, sliding
        Velocities: of the centre of gravity in space, angular in the body's axes, and of the wheels along them.
    """

    place: Real
    turned: Real
    slid: Real
    speed: Real
    spin: Real
    sliding: Real

    def ahead(self, step: float, slope: Pose) -> Pose:
        """Return the pose a step further along a slope."""
        return Pose(*(mine + step * its for mine, its in zip(self, slope, strict=True)))


class Space:
    """Bodies in space: the sprung mass, the items on it as points, and the wheels as points."""

    def __init__(self, rows: Sequence[Row], cg_height: float, wheel_height: float) -> None:
        cars = [row.car for row in rows]
        self.cg_height = cg_height
        self.flat = Rows(rows)
        self.body = np.array([c.m_s for c in cars])
        self.inertia = np.array([np.diag([c.I_xx, c.I_yy, YAW * c.I_yy]) for c in cars])
        most = max((len(row.items) for row in rows), default=0)
        self.items, self.item_masses = np.zeros((len(rows), most, 3)), np.zeros((len(rows), most))
        for i, row in enumerate(rows):
            for j, one in enumerate(row.items):
                # Items lie level with the centre of gravity of the body; their own inertias turn with it.
                self.items[i, j] = one.x + row.car.a, one.y, 0.0
                self.item_masses[i, j] = one.mass
                self.inertia[i] += np.diag([*one.inertia, 0.0])
        self.wheels = np.empty((len(rows), 4, 3))
        for i, c in enumerate(cars):
            self.wheels[i] = np.column_stack(
                [
                    np.repeat([c.a, -c.b], 2),
                    SIDE * np.repeat([c.t_f, c.t_r], 2),
                    np.full(4, wheel_height - cg_height),
                ]
            )
        self.masses = np.concatenate([self.flat.m_u, self.item_masses], axis=1)
        self.carried = self.flat.tyre_load - GRAVITY * self.flat.m_u

    def points(self, at: Pose) -> Real:
        """Return the places of wheels and items in the body's axes, (row, point, 3)."""
        wheels = self.wheels.copy()
        wheels[:, :, 2] += at.slid
        return np.concatenate([wheels, self.items], axis=1)

    def accelerations(self, at: Pose, ground: Real) -> tuple[Real, Real]:
        """Return those of body (3), spin (3) and wheels (4) in the body's axes, (row, 10), and the forces of the ground.

        Parameters
        ----------
        at
            The pose.
        ground
            Height of what is under the wheels, (row, station), m.
        """
        r = self.points(at)
        up = at.turned[:, 2, :]  # the vertical, in the body's axes
        heights = at.place[:, 2, None] + np.einsum("rpi,ri->rp", r[:, :4], up) - self.wheels[:, :, 2]
        moving = np.cross(at.spin[:, None], r[:, :4])
        moving[:, :, 2] += at.sliding
        rising = at.speed[:, 2, None] + np.einsum("rpi,ri->rp", moving, up)
        pressed = self.flat.tyre(ground - heights, -rising)
        x, v = -at.slid, -at.sliding
        tension = self.flat.spring(x) + self.flat.damper(v) - self.carried

        count, many = r.shape[:2]
        partial = np.zeros((count, many, 3, 10))
        partial[:, :, range(3), range(3)] = 1.0
        for axis, (one, other) in enumerate(((1, 2), (2, 0), (0, 1))):
            # The velocity of a point by the spin about an axis: e x r.
            partial[:, :, other, 3 + axis] = r[:, :, one]
            partial[:, :, one, 3 + axis] = -r[:, :, other]
        partial[:, range(4), 2, range(6, 10)] = 1.0
        spin = at.spin[:, None]
        drift = np.cross(spin, np.cross(spin, r))
        along = np.zeros_like(r[:, :4])
        along[:, :, 2] = at.sliding
        drift[:, :4] += 2 * np.cross(spin, along)
        force = -self.masses[:, :, None] * (GRAVITY * up[:, None] + drift)
        force[:, :4] += pressed[:, :, None] * up[:, None]
        weighted = (partial * self.masses[:, :, None, None]).reshape(count, -1, 10)
        flat = partial.reshape(count, -1, 10)
        inertia = np.swapaxes(flat, 1, 2) @ weighted
        inertia[:, range(3), range(3)] += self.body[:, None]
        inertia[:, 3:6, 3:6] += self.inertia
        total = (np.swapaxes(flat, 1, 2) @ force.reshape(count, -1, 1))[..., 0]
        total[:, :3] -= GRAVITY * self.body[:, None] * up
        turning = np.einsum("rij,rj->ri", self.inertia, at.spin)
        total[:, 3:6] -= np.cross(at.spin, turning)
        total[:, 6:] += tension
        return np.linalg.solve(inertia, total[:, :, None])[..., 0], pressed

    def slope_of(self, at: Pose, ground: Real) -> tuple[Pose, Real, Real]:
        """Return the derivative of the pose, the accelerations and the forces of the ground."""
        A, pressed = self.accelerations(at, ground)
        x, y, z = at.spin.T
        none = np.zeros_like(x)
        crossing = np.array([[none, -z, y], [z, none, -x], [-y, x, none]]).transpose(2, 0, 1)
        speeding = np.einsum("rij,rj->ri", at.turned, A[:, :3])
        return Pose(at.speed, at.turned @ crossing, at.sliding, speeding, A[:, 3:6], A[:, 6:]), A, pressed

    def rest(self, ground: Real) -> Pose:
        """Return the pose of rest, by Newton's method over height, pitch, roll and the four wheels."""

        def pose(q: Real) -> Pose:
            c, s = np.cos(q[:, 1:3]), np.sin(q[:, 1:3])
            one, zero = np.ones(len(q)), np.zeros(len(q))
            pitch = np.array([[c[:, 0], zero, s[:, 0]], [zero, one, zero], [-s[:, 0], zero, c[:, 0]]])
            roll = np.array([[one, zero, zero], [zero, c[:, 1], -s[:, 1]], [zero, s[:, 1], c[:, 1]]])
            turned = pitch.transpose(2, 0, 1) @ roll.transpose(2, 0, 1)
            place = np.column_stack([zero, zero, q[:, 0]])
            still = np.zeros((len(q), 3))
            return Pose(place, turned, q[:, 3:], still, still, np.zeros((len(q), 4)))

        def pull(q: Real) -> Real:
            A = self.accelerations(pose(q), ground)[0]
            return np.asarray(A[:, [2, 3, 4, 6, 7, 8, 9]])

        # Small angles are nearly right, and from anywhere else wheels may hang.
        flat = self.flat.rest(ground).X
        q = np.concatenate([flat[:, :3], -self.flat.travel(flat)], axis=1)
        for _ in range(40):
            force = pull(q)
            J = np.stack([(pull(q + 1e-7 * e) - pull(q - 1e-7 * e)) / 2e-7 for e in np.eye(7)], axis=2)
            step = np.linalg.solve(J, force[:, :, None])[..., 0]
            q = q - step
            if np.abs(step).max() < 1e-12:
                break
        return pose(q)

    def readings(self, at: Pose, A: Real, sensors: Sequence[RealSensor], front: Real) -> Real:
        """Return the specific force along the body's vertical axis at each sensor, (row, channel), m/s².

        Parameters
        ----------
        at, A
            Pose and accelerations.
        sensors
            Those of the body, then those of the wheels, in the order of the stations.
        front
            Distance from the centre of gravity to the front axle, (row,), m.
        """
        up, spin = at.turned[:, 2, :], at.spin[:, None]
        corners = [one for one in sensors if one.on == "body"]
        r = np.array([[one.x, one.y, one.z - self.cg_height] for one in corners])
        r = r[None] + front[:, None, None] * [1.0, 0.0, 0.0]
        r = np.concatenate([r, self.points(at)[:, :4]], axis=1)
        felt = A[:, None, :3] + np.cross(A[:, None, 3:6], r) + np.cross(spin, np.cross(spin, r))
        felt[:, len(corners) :, 2] += A[:, 6:]
        # What slides along the body's axis has its Coriolis acceleration across it.
        return np.asarray(felt[:, :, 2] + GRAVITY * up[:, None, 2])


def follow_turning(
    rows: Sequence[Row],
    sensors: Sequence[RealSensor],
    cg_height: float,
    wheel_height: float,
    rate: float,
    duration: float,
    step: float = STEP,
) -> Motion:
    """Follow drops from rest on the blocks, with finite rotations.

    Parameters
    ----------
    rows
        The drops.
    sensors
        Whose readings are wanted: the body's first, then those of the four wheels.
    cg_height, wheel_height
        Of the body's centre of gravity and of the wheel centres at rest, m above the ground.
    rate, duration, step
        As for `real_motion.follow`.

    Returns
    -------
    Motion
        With the readings of the sensors.
    """
    space = Space(rows, cg_height, wheel_height)
    fine = int(np.ceil(1 / (rate * step) - 1e-9))
    h, count = 1 / (rate * fine), int(duration * rate) * fine
    blocks = np.array([[row.height * (s in row.wheels) for s in STATIONS] for row in rows])
    release = np.array([round(row.release / h) for row in rows])
    front = np.array([row.car.a for row in rows])
    at = space.rest(blocks)
    shape, none = (len(rows), 4, count), np.zeros((len(rows), 0, 0))
    rate_of, travel, lifted = np.empty(shape), np.empty(shape), np.empty(shape, dtype=bool)
    readings = np.empty((len(rows), len(sensors), count))
    for k in range(count):
        falling = k >= release
        ground = np.where(falling[:, None], 0.0, blocks)
        one, A, pressed = space.slope_of(at, ground)
        readings[:, :, k] = space.readings(at, A, sensors, front)
        rate_of[:, :, k], travel[:, :, k], lifted[:, :, k] = -at.sliding, -at.slid, pressed <= 0
        if not falling.any():
            continue
        two = space.slope_of(at.ahead(h / 2, one), ground)[0]
        three = space.slope_of(at.ahead(h / 2, two), ground)[0]
        four = space.slope_of(at.ahead(h, three), ground)[0]
        mean = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(one, two, three, four, strict=True)]
        moves = [np.where(falling.reshape(-1, *(1,) * (each.ndim - 1)), each, 0.0) for each in mean]
        at = at.ahead(h, Pose(*moves))
    return Motion(h, none, none, rate_of, travel, lifted, np.zeros((len(rows), 0)), readings)
