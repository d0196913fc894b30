"""The vehicle on a road: its equations of motion, the road under its tyres, and what is observed of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle import (
    EMPTY,
    STATIONS,
    LinearModel,
    Load,
    Matrices,
    NonlinearForces,
    NonlinearModel,
    PadInputs,
    Rows,
    Tracks,
    Vehicle,
    Wheel,
    body_point,
    half_distances,
    inboard_shares,
    linear_elements,
    nonlinear_elements,
    stiffened_air_springs,
    travels,
    wheel_loads,
    with_tyre_rates_at_rest,
)

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_TYRE_CURVE = "tyre-curve"


@dataclass(frozen=True, eq=False)
class RideModel:
    """Equations of motion of a vehicle with a load on a road, as functions of parameter values, SI, shape (parameter,).

    A tyre whose rate grows with its deflection has its rate at rest: to first order that is its equivalent rate.

    Attributes
    ----------
    names
        The parameters.
    linear
        The loaded vehicle without nonlinear elements.
    nonlinear
        The same with them; None where it has none.
    pads
        What the heights of the road under the tyres add.
    travel, point
        Rows of the suspension travels, in the order of the wheels, and of places on the body.
    vehicle, load, tracks
        What it was made of.
    """

    names: tuple[str, ...]
    linear: LinearModel
    nonlinear: NonlinearModel | None
    pads: PadInputs
    travel: Rows
    point: Rows
    vehicle: Vehicle
    load: Load
    tracks: Tracks

    @classmethod
    def of(
        cls,
        vehicle: Vehicle,
        load: Load = EMPTY,
        places: Sequence[tuple[float, float]] = (),
        names: Sequence[str] | None = None,
        terms: Sequence[str] | None = None,
        tracks: Tracks | None = None,
    ) -> RideModel:
        """Return the model of a vehicle.

        Parameters
        ----------
        vehicle
            The vehicle.
        load
            What is on it.
        places
            On the body, m: forward of the front axle and left of the centreline.
        names
            The parameters, uncertain masses of the load among them; those of the vehicle unless given.
        terms, tracks
            Model terms, and whether springs and dampers of an axle share their half-distance; those of the vehicle unless
            given.
        """
        layout, wheelbase = vehicle.layout, vehicle.wheelbase
        terms = vehicle.extras if terms is None else tuple(terms)
        tracks = vehicle.tracks if tracks is None else tracks
        names = tuple(vehicle.parameters) if names is None else tuple(names)
        at_wheels = load.mass_at_wheels(wheelbase, layout)
        elements = [
            *linear_elements(tracks, terms, vehicle.heights, wheelbase, layout),
            *stiffened_air_springs(at_wheels, tracks, terms, wheelbase, layout),
        ]
        linear = LinearModel.of([*elements, *load.elements(vehicle.heights, names, wheelbase)], names)
        own_terms = [term for term in terms if term != _TYRE_CURVE]
        laws = nonlinear_elements(tracks, own_terms, wheelbase, at_wheels, layout)
        nonlinear = (
            NonlinearModel.of(elements, laws, names, load, vehicle.heights, wheelbase=wheelbase) if laws else None
        )
        travel = travels(tracks, terms, wheelbase)
        return cls(
            names,
            linear,
            nonlinear,
            PadInputs.of(layout.wheels, (), names),
            Rows.of([travel(wheel, "spring") for wheel in layout.wheels], names),
            Rows.of([body_point(*place, names, wheelbase) for place in places], names),
            vehicle,
            load,
            tracks,
        )

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """Its wheel stations."""
        return self.vehicle.layout.wheels

    @property
    def forces(self) -> NonlinearForces:
        """The nonlinear elements; there must be some."""
        assert self.nonlinear is not None  # noqa: S101 (asked for only where there are some)
        return self.nonlinear.forces

    def at_rest(self, values: Real) -> Real:
        """Return the parameters with the tyre rates at rest, SI, shape (parameter,)."""
        return with_tyre_rates_at_rest(self.linear, values)

    def matrices(self, values: Real) -> Matrices:
        """Return M, C and K without the nonlinear elements."""
        return self.linear.matrices(self.at_rest(values))

    def dynamic_stiffness(self, values: Real, omega: Real, of_rows: Complex | None = None) -> Complex:
        """Return the forces on the coordinates over their displacements at angular frequencies.

        Parameters
        ----------
        values
            Parameters.
        omega
            rad/s, shape (line,).
        of_rows
            Dynamic stiffness of each row of the nonlinear elements, N/m, shape (line, row).

        Returns
        -------
        ndarray of complex
            SI, shape (line, coordinate, coordinate).
        """
        M, C, K = self.matrices(values)
        iw = 1j * omega[:, None, None]
        found = K + iw * C + iw**2 * M
        if of_rows is not None:
            directions, rows = self.forces.directions(values), self.forces.rows.at(values)
            each = (directions[:, :, None] * rows[:, None, :]).reshape(len(rows), -1)
            found = found + (of_rows @ each).reshape(len(omega), *K.shape)
        return np.asarray(found)

    def tyre_stiffness(self, values: Real, omega: Real) -> Complex:
        """Return k_t + iω c_t of each tyre, N/m, shape (line, wheel)."""
        stiffness, damping = self.pads.rates @ self.at_rest(values)
        return np.asarray(stiffness + 1j * omega[:, None] * damping)

    def displacements(self, values: Real, omega: Real, of_rows: Complex | None = None) -> Complex:
        """Return the displacements of the coordinates over the heights of the road, shape (line, coordinate, wheel)."""
        forces = self.pads.rows.T * self.tyre_stiffness(values, omega)[:, None, :]
        return np.asarray(np.linalg.solve(self.dynamic_stiffness(values, omega, of_rows), forces))

    def tyre_forces(self, values: Real, omega: Real, displacements: Complex) -> Complex:
        """Return the dynamic wheel loads over the heights of the road, N/m, shape (line, wheel, wheel): load, road."""
        compression = np.eye(len(self.wheels)) - self.pads.rows @ displacements
        return np.asarray(self.tyre_stiffness(values, omega)[:, :, None] * compression)

    @property
    def is_symmetric(self) -> bool:
        """Whether left and right are alike, so that the wheels of a side tell everything."""
        sides = [item.position[1] if item.position else 1.0 for item in self.load.items]
        return not {"y_s", "d_ksf", "d_ks"} & {*self.names} and not any(sides)

    def horizontal(self, values: Real, place: tuple[float, float, float]) -> Real:
        """Return the rows of the displacements of a place forward and to the left, by pitch and roll alone.

        Parameters
        ----------
        values
            Parameters.
        place
            m: forward of the front axle, left of the centreline, above the ground.

        Returns
        -------
        ndarray
            Shape (2, coordinate).
        """
        x, y, height = place
        body = self.vehicle.layout.body
        of_roll, of_pitch = self.vehicle.heights.item_arms(height)
        forward, left, yaw = self.linear.unconstrained_motion(self.at_rest(values)).copy()
        by_name = dict(zip(self.names, values.tolist(), strict=True))
        forward, left = forward - y * yaw, left + (x + by_name.get("a", 0.0)) * yaw
        if "theta" in body:
            forward[body.index("theta")] += of_pitch
        if "phi" in body:
            left[body.index("phi")] -= of_roll
        return np.array([forward, left])

    def static_loads(self, values: Real) -> Real:
        """Return the static force of level ground on each wheel, N, shape (wheel,)."""
        return wheel_loads(self.linear, self.at_rest(values))[0]

    def wheel_places(self, values: Real) -> tuple[Real, Real]:
        """Return the places of the wheels, m: forward of the front axle, and left of the centreline; shape (wheel,) each."""
        by_name = dict(zip(self.names, values.tolist(), strict=True))
        layout = self.vehicle.layout
        wheelbase = by_name["a"] + by_name["b"] if layout.pitches else 0.0
        stations = [STATIONS[wheel] for wheel in layout.wheels]
        forward = np.array([-wheelbase if one.end < 0 else 0.0 for one in stations])
        left = [one.side * self._half_track(by_name, one.axle) for one in stations]
        return forward, np.array(left)

    def _half_track(self, values: Mapping[str, float], axle: str) -> float:
        """Return the half-distance of the wheels of an axle, m: that of its springs, which act at the wheels."""
        distance, share = (names(self.tracks)[axle, "spring"] for names in (half_distances, inboard_shares))
        return values.get(distance, 0.0) / values.get(share, 1.0)
