"""Pads under the tyres: forces on the wheels and readings of the pads' sensors, as functions of the pads' displacements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.display import shown
from sprung.vehicle.kinematics import wheel
from sprung.vehicle.layout import Wheel, rates_of_tyre
from sprung.vehicle.model import Rows
from sprung.vehicle.sensor import Sensor

Array = NDArray[np.float64]


@shown
@dataclass(frozen=True, eq=False)
class PadInputs:
    """What displacements of pads add to the equations of motion and to the readings of a vehicle that stands on them.

    A tyre is a spring, and with the term `tyre-damping` a damper, between a pad and a wheel: a pad's displacement z adds the
    force k_t z + c_t ż to the equation of its wheel, and to the reading of a force sensor in the pad, positive up.

    Attributes
    ----------
    wheels
        The wheel stations whose pads move.
    rows
        Their wheels' rows, dimensionless, shape (wheel, coordinate).
    rates
        Coefficients of the parameters in k_t and in c_t of each tyre, dimensionless, shape (2, wheel, parameter).
    displacement, force
        1 where a channel is the displacement of a pad, or the force in it; dimensionless, shape (channel, wheel).
    """

    wheels: tuple[Wheel, ...]
    rows: Array
    rates: Array
    displacement: Array
    force: Array

    @classmethod
    def of(cls, wheels: Sequence[Wheel], sensors: Sequence[Sensor], names: Sequence[str]) -> PadInputs:
        """Return the inputs of the pads under some wheels.

        Parameters
        ----------
        wheels
            Whose pads move.
        sensors
            In the order of the channels.
        names
            The parameters.
        """
        of_tyres = [rates_of_tyre(one, names) for one in wheels]
        rates = np.array(
            [[[rate.get(order, {}).get(name, 0.0) for name in names] for rate in of_tyres] for order in (0, 1)]
        )
        over = np.array([[one.pad == own for own in wheels] for one in sensors], dtype=np.bool_).reshape(
            len(sensors), len(wheels)
        )
        is_force = np.array([one.quantity == "force" for one in sensors], dtype=np.bool_)[:, None]
        rows = Rows.of([wheel(one) for one in wheels], names).affine[:, :, 0]
        return cls(tuple(wheels), rows, rates, (over & ~is_force).astype(float), (over & is_force).astype(float))

    def forces(self, values: ArrayLike) -> Array:
        """Return the forces on the coordinates by the pads' displacements, and by their velocities.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).

        Returns
        -------
        ndarray
            N/m and N s/m, shape (2, coordinate, wheel).
        """
        return np.asarray(self.rows.T * (self.rates @ np.asarray(values, dtype=float))[:, None, :])

    @property
    def force_slopes(self) -> Array:
        """Derivatives of `forces` by the parameters, shape (parameter, 2, coordinate, wheel)."""
        return np.asarray(np.moveaxis(self.rates, -1, 0)[:, :, None, :] * self.rows.T)

    def readings(self, values: ArrayLike) -> Array:
        """Return the readings of the pads' sensors by the pads' displacements, and by their velocities.

        Parameters
        ----------
        values
            Parameters, SI, shape (parameter,).

        Returns
        -------
        ndarray
            SI, gains left out, shape (2, channel, wheel); zero for channels of other sensors.
        """
        found = self.force * (self.rates @ np.asarray(values, dtype=float))[:, None, :]
        found[0] += self.displacement
        return np.asarray(found)

    @property
    def reading_slopes(self) -> Array:
        """Derivatives of `readings` by the parameters, shape (parameter, 2, channel, wheel)."""
        return np.asarray(np.moveaxis(self.rates, -1, 0)[:, :, None, :] * self.force)
