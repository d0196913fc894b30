"""The vehicle on the ground, flat or with bumps: static wheel loads, tyre forces, motion with wheels off the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.simulation.excitation import Drive
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, STATIONS, Layout, Load, Matrices, Vehicle, Wheel, highest_derivatives

Array = NDArray[np.float64]

_FEWEST = 3
"""Wheels on which a vehicle stands anyhow: fewer than four are all on their blocks."""


def tyre_rates(vehicle: Vehicle) -> dict[Wheel, tuple[float, float]]:
    """Return stiffness and damping of the tyre at each wheel station, with those of uneven axles.

    Parameters
    ----------
    vehicle
        With its tyres.

    Returns
    -------
    dict
        By wheel station: stiffness, N/m, and damping, N s/m.
    """
    found = {}
    for wheel in vehicle.layout.wheels:
        _, axle, side, _ = STATIONS[wheel]
        own = [vehicle.parameters.get(f"{rate}{axle}", 0.0) for rate in ("k_t", "d_kt", "c_t")]
        found[wheel] = (own[0] + side * own[1], own[2])
    return found


def static_wheel_loads(vehicle: Vehicle, load: Load = EMPTY, gravity: float = STANDARD_GRAVITY) -> Array:
    """Return the force of flat ground on each wheel at rest.

    Parameters
    ----------
    vehicle, load
        The vehicle and what is on it.
    gravity
        m/s².

    Returns
    -------
    ndarray
        N, shape (wheel,), in the order of the wheel stations. Negative where the wheel would have to be held down.
    """
    return Ground.under(vehicle, load, gravity).wheel_loads


@dataclass(frozen=True, eq=False)
class Ground:
    """A loaded vehicle on the ground, and its tyre forces as functions of Y = {X, Ẋ, w, 1}.

    The signals that drive it are states of their own, w: the offset, sine and cosine of each.

    Attributes
    ----------
    matrices
        M, C and K of the loaded vehicle with all wheels on the ground.
    stiffness, damping
        Of each tyre, N/m and N s/m, shape (wheel,).
    wheel_loads
        Static, N, shape (wheel,).
    layout
        Of the vehicle.
    drive
        Signals that act on the body or lift the wheels.
    """

    matrices: Matrices
    stiffness: Array
    damping: Array
    wheel_loads: Array
    layout: Layout
    drive: Drive

    @classmethod
    def under(cls, vehicle: Vehicle, load: Load, gravity: float, drive: Drive | None = None) -> Ground:
        """Return a vehicle with its load on the ground, flat unless a drive is given; gravity in m/s²."""
        stiffness, damping = np.array(list(tyre_rates(vehicle).values())).T
        heave = vehicle.linear_model(load).heave
        matrices, empty = vehicle.matrices(load), vehicle.matrices()
        # The empty vehicle stands level: what a load weighs turns it from there, not what the vehicle weighs itself.
        sag = empty.deflection(gravity * empty.M @ heave) + matrices.deflection(
            gravity * (matrices.M - empty.M) @ heave
        )
        if drive is None:
            drive = Drive.nothing(len(matrices.M), len(stiffness))
        return cls(matrices, stiffness, damping, stiffness * sag[vehicle.layout.wheels_at], vehicle.layout, drive)

    @property
    def wheels_at(self) -> slice:
        """Positions of the wheels among the coordinates."""
        return self.layout.wheels_at

    @property
    def state_size(self) -> int:
        """Length n + m of {X, Ẋ}, with n coordinates, m with mass."""
        return len(self.matrices.M) + self.matrices.massive

    def _signals(self, parts: tuple[Array, Array, Array]) -> Array:
        """Return columns over w from those by the offset, the sine and the cosine of each signal, each (row, signal)."""
        return np.stack(parts, axis=2).reshape(len(parts[0]), -1)

    @property
    def compression(self) -> Array:
        """Tyre rate times tyre compression, N: rows over Y, shape (wheel, Y)."""
        rows = np.zeros((len(self.stiffness), self.state_size + 3 * len(self.drive.signals) + 1))
        rows[:, self.wheels_at] = -np.diag(self.stiffness)
        raised = self.stiffness[:, None] * self.drive.heights
        rows[:, self.state_size : -1] = self._signals((raised, raised, 0 * raised))
        rows[:, -1] = self.wheel_loads
        return rows

    def force(self, frequencies: Array) -> Array:
        """Return the force of each tyre if it is in contact, N: rows over Y, shape (wheel, Y).

        Parameters
        ----------
        frequencies
            Of the signals, rad/s, shape (signal,).
        """
        rows = self.compression
        rows[:, len(self.matrices.M) :][:, self.wheels_at] = -np.diag(self.damping)
        rising = self.damping[:, None] * self.drive.heights * frequencies
        rows[:, self.state_size : -1] += self._signals((0 * rising, 0 * rising, rising))
        return rows

    def generator(self, contact: NDArray[np.bool_], frequencies: Array) -> Array:
        """Return the generator of Ẏ = generator Y: eq. (3) with what drives it, without the tyres that are off the ground.

        Parameters
        ----------
        contact
            Which wheels are on the ground, shape (wheel,).
        frequencies
            Of the signals, rad/s, shape (signal,).

        Returns
        -------
        ndarray
            Shape (Y, Y); its last column holds the constant force.
        """
        n, m = len(self.matrices.M), self.matrices.massive
        force = self.force(frequencies)
        generator = np.zeros((force.shape[1], force.shape[1]))
        generator[: n + m, : n + m] = self.matrices.state
        for signal, frequency in enumerate(frequencies.tolist()):
            sine = n + m + 3 * signal + 1
            generator[sine, sine + 1], generator[sine + 1, sine] = frequency, -frequency
        driven = np.zeros((n, force.shape[1]))
        driven[:, n + m : -1] = self._signals((self.drive.forces, self.drive.forces, 0 * self.drive.forces))
        driven[:, n + m : -1] += self._wheels.T @ force[:, n + m : -1]
        driven -= self._wheels.T[:, ~contact] @ force[~contact]
        generator[highest_derivatives(n, m)] += np.linalg.solve(self.matrices.leading, driven)
        return generator

    def at_rest(self, signals: Array) -> Array:
        """Return Y at rest on the ground while the signals stay as they are.

        Parameters
        ----------
        signals
            N or m, shape (signal,).
        """
        force = self.drive.forces @ signals + self._wheels.T @ (self.stiffness * (self.drive.heights @ signals))
        w = np.column_stack([signals, np.zeros((len(signals), 2))]).ravel()
        return np.concatenate([self.matrices.deflection(force), np.zeros(self.matrices.massive), w, [1.0]])

    @property
    def _wheels(self) -> Array:
        """The rows of the wheels, shape (wheel, n)."""
        wheels: Array = np.eye(len(self.matrices.M))[self.wheels_at]
        return wheels

    def rest(self, blocks: Array) -> Array:
        """Return the rest position on blocks.

        Parameters
        ----------
        blocks
            Height under each wheel, m, shape (wheel,).

        Returns
        -------
        ndarray
            X, shape (n,). Of four wheels one at most is off its block: a vehicle that stands on flat ground rests on any three.
        """
        candidates = []
        wheels = len(self.stiffness)
        for lifted in range(-1, wheels if wheels > _FEWEST else 0):
            on = np.arange(wheels) != lifted
            K = self.matrices.K - np.diag(np.where(on, 0.0, self.stiffness) @ self._wheels)
            F = np.where(on, self.stiffness * blocks, -self.wheel_loads) @ self._wheels
            X = self.matrices._replace(K=K).deflection(F)
            force = self.wheel_loads - self.stiffness * (X[self.wheels_at] - blocks)
            candidates.append((float(np.min(np.where(on, force, -force))), X))
        # In one of them no tyre pulls and none sinks into the ground; where two are equal but for rounding, either will do.
        return max(candidates, key=lambda candidate: candidate[0])[1]

    def keeps_contact(self, Y: Array) -> bool:
        """Return whether, with all wheels on the ground, the energy left is too little for any tyre force to reach zero."""
        M, _, K = self.matrices
        m, size = self.matrices.massive, self.state_size
        # From where it rests in the end, which is raised behind a kerb.
        rest = self.at_rest(Y[size:-1:3])
        X, V = np.split((Y - rest)[:size], [len(M)])
        M = M[:m, :m]
        energy = 0.5 * (X @ K @ X + V @ M @ V)
        # Energy never grows, and by the Cauchy-Schwarz inequality |k z + c ż|² <= 2 E (k² / K_z + c² / M_z),
        # where 1 / K_z and 1 / M_z are the wheel's diagonal entries of K⁻¹ and M⁻¹: no tyre unloads by more.
        flexibility = np.diag(self.matrices.deflection(np.eye(len(K))))[self.wheels_at]
        mobility = np.diag(np.linalg.inv(M))[self.wheels_at]
        largest = np.sqrt(self.stiffness**2 * flexibility + self.damping**2 * mobility)
        return bool(np.all(math.sqrt(2 * energy) * largest < self.compression @ rest))
