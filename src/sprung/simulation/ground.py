"""The vehicle on the ground: static wheel loads, tyre forces, and the equations of motion with wheels off the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EMPTY, STATIONS, Load, Matrices, Vehicle, Wheel, highest_derivatives

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
    """A loaded vehicle on flat ground, and its tyre forces as functions of Y = {X, Ẋ, 1}.

    Attributes
    ----------
    matrices
        M, C and K of the loaded vehicle with all wheels on the ground.
    stiffness, damping
        Of each tyre, N/m and N s/m, shape (wheel,).
    wheel_loads
        Static, N, shape (wheel,).
    wheels_at
        Positions of the wheels among the coordinates.
    """

    matrices: Matrices
    stiffness: Array
    damping: Array
    wheel_loads: Array
    wheels_at: slice

    @classmethod
    def under(cls, vehicle: Vehicle, load: Load, gravity: float) -> Ground:
        """Return a vehicle with its load on the ground; gravity in m/s²."""
        stiffness, damping = np.array(list(tyre_rates(vehicle).values())).T
        model = vehicle.linear_model(load)
        matrices = vehicle.matrices(load)
        sag = matrices.deflection(gravity * matrices.M @ model.heave)
        wheels_at = vehicle.layout.wheels_at
        return cls(matrices, stiffness, damping, stiffness * sag[wheels_at], wheels_at)

    @property
    def compression(self) -> Array:
        """Tyre rate times tyre compression, N: rows over Y, shape (wheel, n + m + 1) with n coordinates, m with mass."""
        rows = np.zeros((len(self.stiffness), len(self.matrices.M) + self.matrices.massive + 1))
        rows[:, self.wheels_at] = -np.diag(self.stiffness)
        rows[:, -1] = self.wheel_loads
        return rows

    @property
    def force(self) -> Array:
        """Force of each tyre if it is in contact, N: rows over Y, shape (wheel, n + m + 1)."""
        rows = self.compression
        rows[:, len(self.matrices.M) :][:, self.wheels_at] = -np.diag(self.damping)
        return rows

    def generator(self, contact: NDArray[np.bool_]) -> Array:
        """Return the generator of Ẏ = generator Y: eq. (3) without the tyre forces of the wheels off the ground.

        Parameters
        ----------
        contact
            Which wheels are on the ground, shape (wheel,).

        Returns
        -------
        ndarray
            Shape (n + m + 1, n + m + 1); its last column holds the constant force.
        """
        n, m = len(self.matrices.M), self.matrices.massive
        size = n + m + 1
        generator = np.zeros((size, size))
        generator[:-1, :-1] = self.matrices.state
        lost = np.linalg.solve(self.matrices.leading, self._wheels.T[:, ~contact] @ self.force[~contact])
        generator[highest_derivatives(n, m)] -= lost
        return generator

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
        m = self.matrices.massive
        X, V = np.split(Y[:-1], [len(M)])
        M = M[:m, :m]
        energy = 0.5 * (X @ K @ X + V @ M @ V)
        # Energy never grows, and by the Cauchy-Schwarz inequality |k z + c ż|² <= 2 E (k² / K_z + c² / M_z),
        # where 1 / K_z and 1 / M_z are the wheel's diagonal entries of K⁻¹ and M⁻¹: no tyre unloads by more.
        flexibility = np.diag(self.matrices.deflection(np.eye(len(K))))[self.wheels_at]
        mobility = np.diag(np.linalg.inv(M))[self.wheels_at]
        largest = np.sqrt(self.stiffness**2 * flexibility + self.damping**2 * mobility)
        return bool(np.all(math.sqrt(2 * energy) * largest < self.wheel_loads))
