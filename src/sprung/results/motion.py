"""Motion of the vehicle in a drop, as displacements and velocities, from the fitted readings of its sensors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sprung.display import shown
from sprung.errors import InputError, Problem
from sprung.vehicle import (
    EMPTY,
    LinearModel,
    Load,
    Motion,
    Readout,
    Vehicle,
    coordinates,
    sensor_unknown,
    state_matrix,
    with_tyre_rates_at_rest,
)

if TYPE_CHECKING:
    from sprung.results.result import Result

Real = NDArray[np.float64]

EXACT = 0.005
"""Deviation from the linear vehicle, as a part of the fitted readings, below which the drop moves as that does."""

_LARGEST = 0.05
"""Such a deviation above which a motion is not shown where the accelerometers do not determine it."""

_DETERMINED = 1e-6
"""Part of a coordinate that the accelerometers may leave undetermined."""

_QUIET = 0.05
"""Part of the largest displacement below which a motion counts as having ended."""


@shown
@dataclass(frozen=True, eq=False)
class FittedMotion:
    """Motion of the vehicle in one drop.

    Attributes
    ----------
    drop, load
        Names.
    time
        On the file's own clock, s, shape (time,).
    coordinates
        Names of the vehicle's coordinates.
    motion
        Displacements from where the vehicle rests, m and rad, velocities and accelerations; shape (coordinate, time) each.
    deviation
        Root-mean-square of what the fitted readings differ from those of the linear vehicle, as a part of them, dimensionless.
    """

    drop: str
    load: str
    time: Real
    coordinates: tuple[str, ...]
    motion: Motion
    deviation: float

    @property
    def is_linear(self) -> bool:
        """Whether it is a free decay of the linear vehicle."""
        return self.deviation <= EXACT


@dataclass(frozen=True, eq=False)
class ReadDrop:
    """A drop of a result with the vehicle that moves in it.

    Attributes
    ----------
    name
        Of the drop.
    vehicle
        The identified vehicle.
    load
        What is on it.
    model, values
        Its linear equations of motion, and its parameters at rest, SI.
    readout, readings
        Of the sensors, and the values of its parameters, SI.
    usable
        Which channels were fitted, shape (channel,).
    noise
        Of each channel, SI root-mean-square, shape (channel,).
    """

    name: str
    vehicle: Vehicle
    load: Load
    model: LinearModel
    values: Real
    readout: Readout
    readings: Real
    usable: NDArray[np.bool_]
    noise: Real


def read_drop(result: Result, drop: str) -> ReadDrop:
    """Return a drop of a result with the vehicle that moves in it.

    Parameters
    ----------
    result
        With its series.
    drop
        Name of a drop that was fitted.

    Raises
    ------
    InputError
        If a parameter of the vehicle is not determined, or the drop was not fitted as a free decay.
    """
    vehicle = result.vehicle
    if drop not in result.series:
        do = f"Choose one of {', '.join(result.series)}." if result.series else "Load the result with its series."
        raise InputError([Problem(f"drop {drop}", "no fitted readings", "a drop that was fitted", do)])
    loads = {load.name: load for load in result.setup.loads}
    name = next((one.load for one in result.drops if one.name == drop), EMPTY.name)
    load = loads.get(name or EMPTY.name, EMPTY)
    series = result.series[drop]
    sensors = {sensor.channel: sensor for sensor in result.setup.sensors}
    own = tuple(sensors[channel] for channel in series.channels)
    model = vehicle.linear_model(load)
    names = tuple(vehicle.parameters)
    # Readings depend on the parameters at first touch, and on what was found of the sensors.
    unknowns = {sensor_unknown(one.quantity, one.channel): one.value for one in result.sensors}
    return ReadDrop(
        name=drop,
        vehicle=vehicle,
        load=load,
        model=model,
        values=with_tyre_rates_at_rest(model, list(vehicle.parameters.values())),
        readout=Readout.of(own, (*names, *unknowns), vehicle.wheelbase),
        readings=np.array([*vehicle.parameters.values(), *unknowns.values()]),
        usable=np.asarray(np.isfinite(series.fitted).all(axis=1)),
        noise=np.array([result.fit.noise.get(channel, np.nan) for channel in series.channels]),
    )


def fitted_motion(result: Result, drop: str) -> FittedMotion:
    """Return the motion of the vehicle in a drop, as it was fitted.

    Parameters
    ----------
    result
        With its series.
    drop
        Name of a drop that was fitted.

    Returns
    -------
    FittedMotion

    Raises
    ------
    InputError
        If a parameter of the vehicle is not determined, the drop was not fitted, or the vehicle is nonlinear and its
        accelerometers do not determine the motion.

    Notes
    -----
    A result contains the fitted readings, not the states. The free decay of the linear vehicle is sought whose readings come
    nearest to them; for a linear vehicle it is the fitted motion. Otherwise its accelerations are replaced by those that the
    fitted readings of the accelerometers determine, and the difference is integrated twice. Its two constants of integration,
    and the offsets of the accelerometers, are a parabola in time, which is removed with weights that are largest where the
    motion has died away: there the vehicle rests.
    """
    return motion_of(result, read_drop(result, drop))


def motion_of(result: Result, read: ReadDrop) -> FittedMotion:
    """Return the motion of the vehicle in a drop that was read; see `fitted_motion`."""
    drop, series = read.name, result.series[read.name]
    time = np.asarray(series.time, dtype=float)
    nearest, fitted = _nearest_decay(read, time, np.asarray(series.fitted, dtype=float))
    usable = read.usable
    readings = series.fitted[usable] - series.fitted[usable].mean(axis=1, keepdims=True)
    weights = 1 / read.noise[usable, None]
    size = np.sqrt(np.mean((weights * readings) ** 2))
    difference = series.fitted[usable] - fitted[usable]
    deviation = float(np.sqrt(np.mean((weights * difference) ** 2)) / size) if size else 0.0
    motion = nearest
    if deviation > EXACT:
        begins = next((one.start for one in result.drops if one.name == drop and one.start is not None), time[0])
        motion = _corrected(read, time, nearest, difference, deviation, time >= begins)
    names = coordinates(tuple(read.vehicle.parameters))
    return FittedMotion(drop, read.load.name, time, names, motion, deviation)


def _nearest_decay(read: ReadDrop, time: Real, fitted: Real) -> tuple[Motion, Real]:
    """Return the free decay whose readings, with an offset of each, are the nearest; and these readings."""
    highest, _ = read.model.accelerations(read.values)
    massive = read.model.massive
    A = state_matrix(highest, massive)
    step = float(np.mean(np.diff(time)))
    flow = _propagators(A, step, len(time))
    rows = read.readout.at(read.readings) @ read.readout.observed_of_states(highest, massive)
    delays = read.readout.delays(read.readings)
    rows = np.stack([row @ expm(-delay * A) for row, delay in zip(rows, delays, strict=True)])
    usable, states = read.usable, len(A)
    basis = np.einsum("cs,tsk->ctk", rows, flow)
    offsets = np.eye(int(usable.sum()))[:, None, :] * np.ones((1, len(time), 1))
    weights = 1 / read.noise[usable, None]
    columns = np.concatenate([basis[usable], offsets], axis=2) * weights[..., None]
    wanted = (weights * fitted[usable]).ravel()
    columns = columns.reshape(wanted.size, -1)
    scale = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    solution = np.linalg.lstsq(columns / scale, wanted, rcond=1e-10)[0] / scale
    found = np.full_like(fitted, np.nan)
    found[usable] = (columns @ solution).reshape(len(weights), -1) / weights
    over_time = (flow @ solution[:states]).T
    return Motion.of_states(A, over_time, len(highest)), found


def _propagators(A: Real, step: float, samples: int) -> Real:
    """Return the matrices that lead from the state at the first sample to that at each, shape (sample, state, state)."""
    flow, power = np.eye(len(A))[None], expm(A * step)
    while len(flow) < samples:
        flow = np.concatenate([flow, power @ flow])
        power = power @ power
    return flow[:samples]


def _corrected(
    read: ReadDrop,
    time: Real,
    nearest: Motion,
    difference: Real,
    deviation: float,
    counts: NDArray[np.bool_],
) -> Motion:
    """Return a motion with the accelerations that the accelerometers determine."""
    which = read.readout.reads_accelerations & read.usable
    rows = read.readout.of_accelerations(read.readout.at(read.readings))[which] / read.noise[which, None]
    inverse = np.linalg.pinv(rows)
    determined = np.abs(inverse @ rows - np.eye(rows.shape[1])).max(axis=1) < _DETERMINED
    layout = read.vehicle.layout
    if not determined[: len(layout.coordinates)].all():
        if deviation <= _LARGEST:
            return nearest
        found = f"a vehicle whose fitted motion differs by {100 * deviation:.0f} % from that of a linear one"
        do = "Accelerometers on every wheel and at three places of the body would show it."
        raise InputError([Problem(f"drop {read.name}", found, "accelerometers that determine its motion", do)])
    of_usable = which[read.usable]
    missing = inverse @ (difference[of_usable] / read.noise[which, None])
    missing = np.where(determined[:, None], missing, 0.0)
    envelope = np.maximum.accumulate(np.abs(nearest.displacement).max(axis=0)[::-1])[::-1]
    weights = np.where(counts, 1 / (envelope + _QUIET * envelope[0]), 0.0)
    step = float(np.mean(np.diff(time)))
    velocity = _integral(missing, step)
    displacement = _integral(velocity, step)
    t = (time - time[-1]) / (time[-1] - time[0])
    powers = np.stack([np.ones_like(t), t, t**2 / 2])
    parabola = np.linalg.lstsq((weights * powers).T, (weights * displacement).T, rcond=None)[0].T
    length = time[-1] - time[0]
    slopes = np.stack([np.zeros_like(t), np.ones_like(t), t]) / length
    return Motion(
        nearest.displacement + displacement - parabola @ powers,
        nearest.velocity + velocity - parabola @ slopes,
        nearest.acceleration + missing - parabola[:, 2:] / length**2,
    )


def _integral(values: Real, step: float) -> Real:
    """Return the integral from the first sample on, with an error of the fourth order; shape (coordinate, time)."""
    slopes = np.gradient(values, step, axis=1, edge_order=2)
    pieces = step / 2 * (values[:, 1:] + values[:, :-1]) + step**2 / 12 * (slopes[:, :-1] - slopes[:, 1:])
    return np.concatenate([np.zeros((len(values), 1)), np.cumsum(pieces, axis=1)], axis=1)
