"""The stationary response of a vehicle to random roads, in the frequency domain.

With the transfer functions T of a quantity from the heights of the road under all wheels and the spectral matrix S of these
heights, its mean square is ∫ T S Tᴴ df. Of a nonlinear vehicle the transfer functions are those of the linear one that replaces
it at the amplitudes of this very motion, which are found together with it: a fixed point, by Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sprung.ride.ride_model import RideModel
from sprung.ride.road import Road, Tracks, spectral_matrix
from sprung.vehicle import EquivalentElements, RandomTravel, linearise_random

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_RATIO = 1.008
"""Of neighbouring spectral lines: some 12 lines within the width of a resonance with a damping ratio of 5 %."""

_PER_PERIOD = 12
"""Lines per period of the interference of front and rear wheels."""

_ITERATIONS = 60
_CLOSED = 1e-10
"""Largest number of steps to the fixed point, and the change of a logarithm at which it is found."""

_NUDGE = 1e-5
"""Change of a logarithm over which the fixed point is differentiated."""


class NotConvergedError(ArithmeticError):
    """No amplitude was found at which the linearised vehicle moves as it was linearised."""


def spectral_lines(band: tuple[float, float], delay: float) -> tuple[Real, Real]:
    """Return frequencies, and the weights by which values at them add up to an integral.

    Parameters
    ----------
    band
        Lowest and highest frequency, Hz.
    delay
        Longest time between two wheels at one place, s.

    Returns
    -------
    frequency, weights
        Hz, shape (line,).
    """
    low, high = band
    widest = 1 / (_PER_PERIOD * delay) if delay > 0 else np.inf
    change = min(max(widest / (_RATIO - 1), low), high)
    logarithmic = np.geomspace(low, change, max(int(np.log(change / low) / np.log(_RATIO)), 1) + 1)
    linear = np.linspace(change, high, int((high - change) / widest) + 2)[1:] if change < high else np.empty(0)
    frequency = np.concatenate([logarithmic, linear])
    gaps = np.diff(frequency)
    weights = np.zeros(len(frequency))
    weights[:-1] += gaps / 2
    weights[1:] += gaps / 2
    return frequency, weights


def mean_squares(transfer: Complex, spectra: Complex) -> Real:
    """Return what each line adds to the mean squares of quantities.

    Parameters
    ----------
    transfer
        From the heights of the road, shape (line, quantity, wheel).
    spectra
        Spectral matrix times the weights of the lines, shape (line, wheel, wheel).

    Returns
    -------
    ndarray
        Shape (line, quantity).
    """
    return np.asarray(((transfer @ spectra) * transfer.conj()).sum(axis=2).real)


@dataclass(frozen=True, eq=False)
class Drive:
    """A drive on a random road at constant speed.

    Attributes
    ----------
    road
        The road.
    speed
        m/s.
    tracks
        What the left and the right track have in common.
    band
        Lowest and highest frequency that counts, Hz.
    """

    road: Road
    speed: float
    tracks: Tracks = "isotropic"
    band: tuple[float, float] = (0.1, 100.0)

    def lines(self, wheelbase: float) -> tuple[Real, Real]:
        """Return frequencies and weights for a vehicle with a wheelbase in m; see `spectral_lines`."""
        return spectral_lines(self.band, wheelbase / self.speed)


@dataclass(frozen=True, eq=False)
class TravelGuess:
    """Statistics of travels at neighbouring parameters, and the derivatives of those that follow from them.

    Attributes
    ----------
    travel
        The statistics.
    slopes
        Of those that follow, by those at which the vehicle is linearised.
    """

    travel: RandomTravel
    slopes: Real


@dataclass(frozen=True, eq=False)
class RoadResponse:
    """The response of a vehicle with some parameters to a drive.

    Attributes
    ----------
    model, values, drive
        What drives, its parameters, SI, and where.
    frequency, weights
        Spectral lines, Hz, shape (line,).
    equivalents
        Linear elements in place of the nonlinear ones; None of a linear vehicle.
    travel
        Statistics of the travels at which they are those.
    """

    model: RideModel
    values: Real
    drive: Drive
    frequency: Real
    weights: Real
    equivalents: EquivalentElements | None = None
    travel: RandomTravel | None = None

    @cached_property
    def omega(self) -> Real:
        """Angular frequencies, rad/s, shape (line,)."""
        return 2 * np.pi * self.frequency

    @cached_property
    def spectra(self) -> Complex:
        """Spectral matrix of the heights of the road times the weights, m², shape (line, wheel, wheel)."""
        places, drive = self.model.wheel_places(self.values), self.drive
        found = spectral_matrix(drive.road, self.frequency, drive.speed, places, drive.tracks)
        return np.asarray(found * self.weights[:, None, None])

    @cached_property
    def displacements(self) -> Complex:
        """Displacements of the coordinates over the heights of the road, shape (line, coordinate, wheel)."""
        of_rows = None if self.equivalents is None else self.equivalents.dynamic_stiffness(self.omega)
        return self.model.displacements(self.values, self.omega, of_rows)

    def accelerations(self, rows: Real) -> Real:
        """Return what each line adds to the mean square of the second derivative of rows.

        Parameters
        ----------
        rows
            Shape (row, coordinate).

        Returns
        -------
        ndarray
            m²/s⁴ of displacements in m, shape (line, row).
        """
        return mean_squares(rows @ self.displacements, self.spectra) * self.omega[:, None] ** 4

    @property
    def suspension_travel(self) -> Real:
        """Root-mean-square travel of each suspension, m, shape (wheel,)."""
        transfer = self.model.travel.at(self.values) @ self.displacements
        return np.asarray(np.sqrt(mean_squares(transfer, self.spectra).sum(axis=0)))

    @property
    def wheel_loads(self) -> Real:
        """Root-mean-square dynamic load of each wheel, N, shape (wheel,)."""
        transfer = self.model.tyre_forces(self.values, self.omega, self.displacements)
        return np.asarray(np.sqrt(mean_squares(transfer, self.spectra).sum(axis=0)))


def respond(model: RideModel, values: Real, drive: Drive, near: TravelGuess | None = None) -> RoadResponse:
    """Return the response of a vehicle to a drive.

    Parameters
    ----------
    model, values
        The vehicle.
    drive
        Road and speed.
    near
        What the response of nearly the same vehicle tells, from `guess_of`.

    Raises
    ------
    NotConvergedError
        If a nonlinear vehicle has no equivalent linear one at its own amplitudes.
    """
    frequency, weights = drive.lines(model.vehicle.wheelbase)
    response = RoadResponse(model, values, drive, frequency, weights)
    if model.nonlinear is None:
        return response
    fixed_point = _FixedPoint(response)
    travel = fixed_point.solve(near)
    equivalents = linearise_random(model.forces, values, travel)
    return RoadResponse(model, values, drive, frequency, weights, equivalents, travel)


def guess_of(response: RoadResponse) -> TravelGuess | None:
    """Return what a response tells of those of nearly the same vehicle; None of a linear one."""
    if response.travel is None:
        return None
    slopes = _FixedPoint(response).slopes(_packed(response.travel), response.model.forces.number)
    return TravelGuess(response.travel, slopes)


@dataclass(frozen=True, eq=False)
class _FixedPoint:
    """The statistics of the travels as functions of those at which the vehicle is linearised."""

    response: RoadResponse

    def start(self) -> RandomTravel:
        """Return travels of a usual size."""
        forces = self.response.model.forces
        size = np.ones(forces.number)
        return RandomTravel(self._rest(np.zeros(forces.number)), 0.01 * size, 0.1 * size, np.full(forces.memories, 0.4))

    def _rest(self, mean_force: Real) -> Real:
        """Return the mean travel of each row under mean forces, m."""
        model, values = self.response.model, self.response.values
        nonlinear = model.nonlinear
        assert nonlinear is not None  # noqa: S101 (made only then)
        weight = nonlinear.load.matrices(values).M @ nonlinear.linear.heave * nonlinear.gravity
        forces = weight + mean_force @ nonlinear.forces.directions(values)
        displaced = -model.matrices(values).deflection(forces)
        return np.asarray(nonlinear.forces.rows.at(values) @ displaced + nonlinear.travel_offsets(values)[0])

    def following(self, travel: RandomTravel) -> RandomTravel:
        """Return the statistics of the travels of the vehicle that is linearised at others."""
        one = self.response
        equivalents = linearise_random(one.model.forces, one.values, travel)
        displacements = one.model.displacements(one.values, one.omega, equivalents.dynamic_stiffness(one.omega))
        rows = one.model.forces.rows.at(one.values)
        spectra = mean_squares(rows @ displacements, one.spectra)
        rates = spectra * one.omega[:, None] ** 2
        rate_std = np.sqrt(rates.sum(axis=0))
        memory = equivalents.memory_correlation(one.omega, rates) / rate_std[equivalents.memory_rows]
        return RandomTravel(self._rest(equivalents.mean), np.sqrt(spectra.sum(axis=0)), rate_std, memory)

    def solve(self, near: TravelGuess | None) -> RandomTravel:
        """Return the statistics at which the vehicle moves as it was linearised."""
        rows = self.response.model.forces.number
        point, slopes = _packed(self.start() if near is None else near.travel), None if near is None else near.slopes
        before = np.inf
        for _ in range(_ITERATIONS):
            change = _packed(self.following(_unpacked(point, rows))) - point
            size = float(np.abs(change).max())
            if not np.isfinite(size):
                break
            if size < _CLOSED:
                return _unpacked(point, rows)
            # As long as plain steps bring much they are taken; then Newton's, with derivatives that are kept while they serve.
            if size > 0.3 * before and (slopes is None or size > 0.5 * before):
                slopes = self.slopes(point, rows)
            before = size
            step = change if slopes is None else np.linalg.solve(np.eye(len(point)) - slopes, change)
            point = point + step * min(1.0, 1.0 / float(np.abs(step).max()))
        raise NotConvergedError(
            f"no equivalent linear vehicle on road {self.response.drive.road.name} at {self.response.drive.speed:g} m/s"
        )

    def slopes(self, point: Real, rows: int) -> Real:
        """Return the derivatives of the statistics that follow, by those at which the vehicle is linearised."""
        columns = [
            _packed(self.following(_unpacked(point + step, rows)))
            - _packed(self.following(_unpacked(point - step, rows)))
            for step in _NUDGE * np.eye(len(point))
        ]
        return np.stack(columns, axis=1) / (2 * _NUDGE)


_METRE = 100.0
"""Mean travels are counted in cm beside the logarithms of the other statistics."""


def _packed(travel: RandomTravel) -> Real:
    return np.concatenate([_METRE * travel.mean, np.log(travel.std), np.log(travel.rate_std), travel.memory])


def _unpacked(point: Real, rows: int) -> RandomTravel:
    mean, std, rate, memory = np.split(point, [rows, 2 * rows, 3 * rows])
    return RandomTravel(mean / _METRE, np.exp(std), np.exp(rate), memory)
