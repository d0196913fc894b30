"""A body that turns by finite angles: where its points are, and the forces that the linear equations of motion leave out.

Pitch comes first, then roll: a point of the body at (x, y, h) from the centre of gravity is at the height
z - x sin θ + y cos θ sin φ + h cos θ cos φ. Wheels slide along the body's own vertical axis, tyres press vertically, and
nothing holds the vehicle sideways: the common centre of all masses moves vertically. Nothing is expanded in the angles.
Signals hold values and their first and second derivatives by time, shape (3, ..., time).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY

Array = NDArray[np.float64]

BODY, MOVING = 3, 7
"""Coordinates of the body, bounce, pitch and roll, and with those of the four wheels."""

_VALUE, _RATE, _SECOND = 0, 1, 2


class Points(NamedTuple):
    """Points of the body, or the wheels as such.

    Attributes
    ----------
    x, y, h
        From the centre of gravity forward, to the left and along the body's axis, m, shape (point,).
    mass
        kg, shape (point,).
    """

    x: Array
    y: Array
    h: Array
    mass: Array


class Struts(NamedTuple):
    """Springs or dampers between the body and its wheels.

    Attributes
    ----------
    y
        Left of the centreline, m, shape (wheel,).
    rate
        N/m or N s/m of each wheel's compression, shape (wheel, wheel): an anti-roll bar acts at both wheels of an axle.
    """

    y: Array
    rate: Array


@dataclass(frozen=True, eq=False)
class TurnedBody:
    """A vehicle with a load, whose body turns.

    Its motions are those of z_s, θ, φ and the four wheels from rest, SI, shape (3, 7, time).

    Attributes
    ----------
    mass
        Of body, wheels and items, kg.
    tilt
        Pitch and roll at rest, rad.
    wheels
        Unsprung masses at the places of the springs, as the body stands.
    springs, dampers
        Those of the suspension.
    preload
        Compressive force of each spring at rest, N, shape (wheel,).
    items
        Of the load.
    """

    mass: float
    tilt: tuple[float, float]
    wheels: Points
    springs: Struts
    dampers: Struts
    preload: Array
    items: Points

    def forces(self, motion: Array) -> Array:
        """Return the generalised forces against a motion, less those at rest, N and N m, shape (7, time).

        Those that are linear at any angle are left out: inertia and weight of the body itself, and the forces of the tyres.
        """
        return self._forces(motion) - self._forces_at_rest

    def readings(self, motion: Array, points: Points) -> Array:
        """Return the specific forces along the body's axis, less those at rest, at points of the body and at its wheels.

        Parameters
        ----------
        motion
            Of the vehicle.
        points
            Of the body.

        Returns
        -------
        ndarray
            m/s², shape (point + wheel, time).
        """
        return self._readings(motion, points) - self._readings(_AT_REST, points)

    def _forces(self, motion: Array) -> Array:
        turned = _Turned.of(motion, self.tilt)
        forces = np.zeros(motion.shape[1:])
        wheels = self._displaced_wheels(turned, motion, self.springs)
        damped = (
            wheels if np.array_equal(self.dampers.y, wheels.y) else self._displaced_wheels(turned, motion, self.dampers)
        )
        aside, items_aside = (turned.horizontal_accelerations(points) for points in (wheels, self.items))
        centre = self._centre(aside, items_aside)
        # Wheels move sideways with the body, and slide along its axis.
        push = wheels.mass[:, None] * (aside - centre)
        spring = self.preload[:, None] + self.springs.rate @ (wheels.h[_VALUE] - self.wheels.h[:, None])
        damper = self.dampers.rate @ damped.h[_RATE]
        forces[1:BODY] += turned.horizontal_moments(wheels, push)
        forces += turned.travel_forces(wheels, spring + turned.along_axis(push)) + turned.travel_forces(damped, damper)
        # Items move in all directions, and have weight.
        mass = self.items.mass[:, None]
        forces[1:BODY] += turned.horizontal_moments(self.items, mass * (items_aside - centre))
        lifted = mass * (turned.height(motion, self.items)[_SECOND] + STANDARD_GRAVITY)
        forces[:BODY] += turned.lift_forces(self.items, lifted)
        return forces

    def _readings(self, motion: Array, points: Points) -> Array:
        turned = _Turned.of(motion, self.tilt)
        wheels = self._displaced_wheels(turned, motion, self.springs)
        on_body, aside, items_aside = (turned.horizontal_accelerations(one) for one in (points, wheels, self.items))
        lifted = np.concatenate([turned.height(motion, points)[_SECOND], motion[_SECOND, BODY:]]) + STANDARD_GRAVITY
        freely = np.concatenate([on_body, aside], axis=1) - self._centre(aside, items_aside)
        readings: Array = turned.along_axis(freely) + turned.upright[_VALUE] * lifted
        return readings

    @cached_property
    def _forces_at_rest(self) -> Array:
        return self._forces(_AT_REST)

    @cached_property
    def _turned_at_rest(self) -> _Turned:
        return _Turned.of(_AT_REST, self.tilt)

    def _displaced_wheels(self, turned: _Turned, motion: Array, struts: Struts) -> Points:
        """Return the wheels as the suspension travel has displaced them along the body's axis, at the places of struts."""
        wheels = self.wheels._replace(y=struts.y)
        level = turned.height(motion, wheels._replace(h=np.zeros(len(struts.y))))
        above = motion[:, BODY:] + self._turned_at_rest.height(_AT_REST, wheels) - level
        return wheels._replace(h=_product(above, turned.upright_reciprocal))

    def _centre(self, wheels: Array, items: Array) -> Array:
        """Return the horizontal acceleration of the common centre, shape (2, 1, time), from those of wheels and items.

        All from the body's centre of gravity.
        """
        moved = self.wheels.mass @ wheels + self.items.mass @ items
        centre: Array = moved[:, None] / self.mass
        return centre


_AT_REST = np.zeros((3, MOVING, 1))


@dataclass(frozen=True, eq=False)
class _Turned:
    """Sines and cosines of pitch and roll, signals of shape (3, 1, time); `h` of points may be a signal, (3, point, time)."""

    sin_pitch: Array
    cos_pitch: Array
    sin_roll: Array
    cos_roll: Array

    @classmethod
    def of(cls, motion: Array, tilt: tuple[float, float]) -> _Turned:
        return cls(*_sine_and_cosine(motion[:, 1:2], tilt[0]), *_sine_and_cosine(motion[:, 2:3], tilt[1]))

    @cached_property
    def upright(self) -> Array:
        """Vertical part of the body's axis."""
        return _product(self.cos_pitch, self.cos_roll)

    @cached_property
    def upright_reciprocal(self) -> Array:
        """One over it."""
        value, rate, second = self.upright
        inverse = 1 / value
        return np.array([inverse, -rate * inverse**2, (2 * rate**2 * inverse - second) * inverse**2])

    @cached_property
    def forward(self) -> Array:
        """Part of the body's axis that points forward."""
        return _product(self.sin_pitch, self.cos_roll)

    @cached_property
    def leftward(self) -> Array:
        """Vertical part of the body's axis that points to the left."""
        return _product(self.cos_pitch, self.sin_roll)

    @cached_property
    def _sideways(self) -> Array:
        """Second derivative of that axis' part forward."""
        return _second_of_product(self.sin_pitch, self.sin_roll)

    def height(self, motion: Array, points: Points) -> Array:
        """Height above that of the centre of gravity at rest, (3, point, time)."""
        rolled = points.y[:, None] * self.leftward
        above: Array = motion[:, :1] - points.x[:, None] * self.sin_pitch + rolled + _scaled(points.h, self.upright)
        return above

    def horizontal_accelerations(self, points: Points) -> Array:
        """Accelerations forward and to the left, from the centre of gravity's, (2, point, time)."""
        x, y = points.x[:, None], points.y[:, None]
        up = [_second_of_scaled(points.h, axis) for axis in (self.forward, self.sin_roll)]
        return np.array([x * self.cos_pitch[_SECOND] + y * self._sideways + up[0], y * self.cos_roll[_SECOND] - up[1]])

    def along_axis(self, force: Array) -> Array:
        """Part along the body's axis of horizontal forces (2, point, time)."""
        along: Array = self.forward[_VALUE] * force[0] - self.sin_roll[_VALUE] * force[1]
        return along

    def horizontal_moments(self, points: Points, force: Array) -> Array:
        """Moments by pitch and by roll of horizontal forces (2, point, time)."""
        aside, up = self._pitched_places(points)
        x, sin, cos = points.x[:, None], self.sin_pitch[_VALUE], self.cos_pitch[_VALUE]
        pitch = (up * cos - x * sin) * force[0]
        roll = sin * aside * force[0] - up * force[1]
        return np.array([pitch.sum(axis=0), roll.sum(axis=0)])

    def lift_forces(self, points: Points, force: Array) -> Array:
        """Generalised forces on bounce, pitch and roll of vertical forces (point, time)."""
        aside, up = self._pitched_places(points)
        pitch = -(points.x[:, None] * self.cos_pitch[_VALUE] + up * self.sin_pitch[_VALUE]) * force
        return np.array([one.sum(axis=0) for one in (force, pitch, self.cos_pitch[_VALUE] * aside * force)])

    def travel_forces(self, wheels: Points, force: Array) -> Array:
        """Generalised forces of forces (wheel, time) along the body's axis on wheels that slide along it."""
        level = wheels._replace(h=np.zeros(len(wheels.x)))
        vertical = force * self.upright_reciprocal[_VALUE]
        body = -self.lift_forces(level, vertical)
        h = wheels.h[_VALUE]
        tangents = np.concatenate(
            [self.sin_pitch[_VALUE] / self.cos_pitch[_VALUE], self.sin_roll[_VALUE] / self.cos_roll[_VALUE]]
        )
        body[1:] += tangents * (h * force).sum(axis=0)
        return np.concatenate([body, vertical])

    def _pitched_places(self, points: Points) -> tuple[Array, Array]:
        """Places to the left and up in axes that pitch with the body and do not roll, (point, time) each."""
        y, h = points.y[:, None], points.h[_VALUE] if points.h.ndim == 3 else points.h[:, None]
        sin, cos = self.sin_roll[_VALUE], self.cos_roll[_VALUE]
        return y * cos - h * sin, y * sin + h * cos


def _product(one: Array, other: Array) -> Array:
    """Return the product of two signals, by Leibniz's rule."""
    product: Array = one * other[_VALUE]
    product[_RATE] += one[_VALUE] * other[_RATE]
    product[_SECOND] = _second_of_product(one, other)
    return product


def _second_of_product(one: Array, other: Array) -> Array:
    second: Array = one[_SECOND] * other[_VALUE] + 2 * one[_RATE] * other[_RATE] + one[_VALUE] * other[_SECOND]
    return second


def _scaled(h: Array, signal: Array) -> Array:
    """Return a signal times lengths of points, which are constant or signals themselves."""
    return _product(h, signal) if h.ndim == 3 else h[:, None] * signal


def _second_of_scaled(h: Array, signal: Array) -> Array:
    return _second_of_product(h, signal) if h.ndim == 3 else h[:, None] * signal[_SECOND]


def _sine_and_cosine(angle: Array, from_level: float) -> tuple[Array, Array]:
    """Return both of an angle at rest and a signal of its change."""
    sin, cos = np.sin(from_level + angle[_VALUE]), np.cos(from_level + angle[_VALUE])
    rate, second = angle[_RATE], angle[_SECOND]
    sine = np.array([sin, cos * rate, cos * second - sin * rate**2])
    return sine, np.array([cos, -sin * rate, -sin * second - cos * rate**2])
