"""A direct start: the equations of motion, integrated against modulating functions, are linear in what is sought.

M Ẍ + C Ẋ + K X = 0 holds for the accelerations A, too. Multiplied by the first derivative p₁ of a function that vanishes with
its derivatives at both ends of a record, and integrated by parts until none is left on A, it says M∫p₃A - C∫p₂A + K∫p₁A = 0
with the derivatives p₂ and p₃ of p₁ (Shinbrot, Trans. ASME 79 (1957) 1319). Offsets drop out, for p₁ has no mean. M, C
and K are linear in products of the parameters where the body's motion is taken above the front axle, so that no row
depends on where the centre of gravity is. One small linear least squares gives all of them: no guess, no eigenvalues, no
iteration. What noise adds to the squares on average is taken off beforehand; even so it is no estimate to report, but a
start that is nearly there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.monomials import expand, parameters_of
from sprung.estimation.records import RecordBatch
from sprung.estimation.starts import VehicleSize
from sprung.vehicle import LINEAR_LAWS, LinearModel, Row, Rows, Sensor, parameter_of
from sprung.vibration import exponentials

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Flags = NDArray[np.bool_]
Key = tuple[int, int, int]

_WINDOWS = ((2.0, np.arange(0.0, 6.1, 0.75)), (12.0, np.arange(0.0, 24.1, 2.5)), (50.0, np.arange(0.0, 33.0, 8.0)))
"""1/s by which each modulating function falls, and Hz at which it turns: long ones for the body, short ones for wheel hop."""

_SHAPE = np.polynomial.Polynomial([0, 1]) ** 5 * np.polynomial.Polynomial([1, -1]) ** 5
_BUMP = np.array([np.pad((_SHAPE.deriv(k) if k else _SHAPE).coef, (0, k)) for k in range(4)])
"""u⁵(1-u)⁵ and its first three derivatives, as coefficients of the powers of u."""

_RATE, _LONGEST, _MOST = 200.0, 6.0, 8  # samples per second, s, and records of one load that are enough

_BODY, _HOP = 2 * np.pi * 1.5, 2 * np.pi * 11.0
"""Usual own frequencies of the coordinates of body and wheels, 1/s: what their equations are weighed by."""

_WHEEL = 0.035  # mass of a wheel as a part of the body's, to make the equations comparable


def modulating_function_estimate(
    batches: Sequence[RecordBatch], models: Sequence[LinearModel], sensors: Sequence[Sensor], size: VehicleSize
) -> dict[str, float] | None:
    """Estimate the parameters from the records in one linear least squares.

    Parameters
    ----------
    batches
        The records.
    models
        Equations of motion by the position of the load.
    sensors
        The sensors.
    size
        Size of the vehicle; its mass is used where it was weighed, or where no load determines the scale.

    Returns
    -------
    dict or None
        Parameters, SI, by name; None where the sensors do not observe every coordinate, or no vehicle explains the records.
    """
    wheelbase, layout, names = size.wheelbase, size.layout, models[0].names
    own_rows = _rows_of_one_order(sensors, names, wheelbase)
    moved = models
    if layout.pitches:
        moved = [model.referred_to_front_axle(wheelbase) for model in models]
        own_rows = [row.referred_to_front_axle(wheelbase) for row in own_rows]
    affine = Rows.of(own_rows, names).affine
    # What depends on a parameter says nothing before that is known.
    settled = np.logical_not(affine[:, :, 1:].any(axis=(1, 2)))
    rows = settled[:, None] * affine[:, :, 0]
    sprung = 1 + names.index("m_s")
    keys = list(dict.fromkeys(_key(key) for model in moved for key in model.products.tolist()))
    if layout.pitches:
        # m_s a² stands where I_yy does: only their sum can be found.
        ahead = 1 + names.index("a")
        keys = [key for key in keys if key != _key(sorted((sprung, ahead, ahead)))]
    frequencies = np.array([_BODY] * len(layout.body) + [_HOP] * len(layout.wheels))
    normal = np.zeros((len(keys), len(keys)))
    for load, used, records, step in _thinned(batches, rows):
        terms = _terms(moved[load], keys, size)
        normal += _normal_equations(*_coordinates(records, rows[used]), step, terms, frequencies)
    products = _products(normal, keys, (0, 0, sprung))
    if products is None:
        return None
    laws = [{key: term for key, term in expand(moved[0], law).items() if key in products} for law in LINEAR_LAWS]
    per_mass = dict(zip(names, parameters_of(products, laws, names).tolist(), strict=True))
    if layout.pitches:
        per_mass |= {"I_yy": per_mass["I_yy"] - per_mass["a"] ** 2, "b": wheelbase - per_mass["a"]}
    # A known load stands beside the vehicle's own masses as a number.
    load_share = products.get((0, 0, 0), 0.0)
    mass = 1 / load_share if load_share > 0 and not size.weighed else size.sprung_mass
    values = {name: value * (mass if parameter_of(name).scales else 1.0) for name, value in per_mass.items()}
    usable = all(
        np.isfinite(value) and (value > 0 or not parameter_of(name).positive) for name, value in values.items()
    )
    return values if usable else None


def _rows_of_one_order(sensors: Sequence[Sensor], names: Sequence[str], wheelbase: float) -> list[Row]:
    """Return the rows of all sensors that read the same derivative of a displacement as most do, those of others empty.

    The equations of motion hold for displacements, velocities and accelerations alike.
    """
    read = [sensor.rows(names, wheelbase) for sensor in sensors]
    orders = Counter(order for rows in read for order in rows)
    most = max(orders, key=lambda order: orders[order])
    return [rows.get(most, Row({})) for rows in read]


def _key(key: Sequence[int]) -> Key:
    first, second, third = key
    return first, second, third


def _products(normal: Real, keys: Sequence[Key], unit: Key) -> dict[Key, float] | None:
    """Solve for the products in units of one of them."""
    size = np.sqrt(np.maximum(np.diag(normal), 0.0))
    others = [i for i, key in enumerate(keys) if key != unit and size[i] > 0]
    if not others or not np.isfinite(normal).all():
        return None
    system = normal[np.ix_(others, others)] / np.outer(size[others], size[others])
    right = -normal[others, keys.index(unit)] / size[others]
    found = np.linalg.lstsq(system, right, rcond=1e-10)[0] / size[others]
    return {unit: 1.0, **dict(zip([keys[i] for i in others], found.tolist(), strict=True))}


def _terms(model: LinearModel, keys: Sequence[Key], size: VehicleSize) -> Real:
    """Return what each product multiplies, equations of n coordinates divided by usual masses; shape (product, n, 3 n)."""
    usual, n = {"z_s": 1.0, "theta": size.wheelbase**2 / 4, "phi": size.wheelbase**2 / 16}, len(size.layout.coordinates)
    masses = np.array([usual.get(coordinate, _WHEEL) for coordinate in size.layout.coordinates])
    terms = np.zeros((len(keys), n, 3 * n))
    for key, term in zip(model.products.tolist(), model.terms, strict=True):
        if _key(key) in keys:
            terms[keys.index(_key(key))] = np.concatenate(list(term[:, :n, :n]), axis=1)
    terms /= masses[:, None]
    return terms


def _thinned(batches: Sequence[RecordBatch], rows: Real) -> Iterator[tuple[int, Flags, Real, float]]:
    """Yield the records of every load thinned, and cut to one length as far as they are of a similar one.

    Yields
    ------
    load
        Its position.
    used
        Which channels are not left out, shape (channel,).
    records
        Centred, shape (record, used channel, time).
    step
        Sampling interval, s.
    """
    found = []
    for batch in batches:
        used = batch.channel_weights > 0
        if np.linalg.matrix_rank(rows[used]) == rows.shape[1]:
            for group, load in enumerate(batch.load.tolist()):
                found.append((load, used, *batch.thinned(group, _RATE, _LONGEST, _MOST)[1:]))
    durations = np.array([records.shape[2] * step for _, _, records, step in found])
    common = durations[2 * durations > durations.max(initial=0.0)].min(initial=_LONGEST)
    for (load, used, records, step), duration in zip(found, durations.tolist(), strict=True):
        cut = records[:, used] if duration <= common else records[:, used, : int(common / step)]
        yield load, used, cut - cut.mean(axis=2, keepdims=True), step


def _coordinates(records: Real, rows: Real) -> tuple[Real, Real]:
    """Return accelerations of the coordinates, shape (record, n, time), and the covariance of their noise, shape (n, n)."""
    to_coordinates = np.linalg.pinv(rows)
    # From differences of the last third, where hardly anything but noise is left.
    differences = np.diff(records[:, :, -max(records.shape[2] // 3, 3) :], 2, axis=2)
    noise = (to_coordinates * (np.mean(differences**2, axis=(0, 2)) / 6)) @ to_coordinates.T
    return to_coordinates @ records, noise


@lru_cache(maxsize=6)  # a campaign has records of one or two kinds, and is fitted more than once
def _modulating_functions(samples: int, step: float, window: int) -> tuple[Real, Real, Real]:
    """Return p₃, -p₂ and p₁ of ψ = u⁵(1-u)⁵ e^{-st}, u running from 0 to 1.

    Returns
    -------
    real, imaginary
        Shape (function, 3, time).
    overlap
        Real part of their inner products, shape (function, 3, 3).
    """
    decay_rate, frequencies = _WINDOWS[window]
    s = np.asarray(decay_rate + 2j * np.pi * frequencies, dtype=np.complex128)
    duration = (samples - 1) * step
    powers = np.linspace(0.0, 1.0, samples) ** np.arange(_BUMP.shape[1])[:, None]
    derivatives = _BUMP @ powers / duration ** np.arange(4)[:, None]
    # Leibniz: the derivatives of a product with an exponential.
    unit, zero = np.ones_like(s), np.zeros_like(s)
    leibniz = np.array([[-(s**3), 3 * s**2, -3 * s, unit], [-(s**2), 2 * s, -unit, zero], [-s, unit, zero, zero]])
    waves = exponentials(-s * step, samples).T
    size = np.linalg.norm(derivatives[0] * waves, axis=1)
    functions = np.moveaxis(leibniz, 2, 0) @ derivatives
    functions *= (waves / size[:, None])[:, None]
    real, imaginary = np.ascontiguousarray(functions.real), np.ascontiguousarray(functions.imag)
    return real, imaginary, real @ np.swapaxes(real, 1, 2) + imaginary @ np.swapaxes(imaginary, 1, 2)


def _normal_equations(accelerations: Real, noise: Real, step: float, terms: Real, frequencies: Real) -> Real:
    """Return the normal equations of the products, what noise adds on average subtracted; shape (product, product)."""
    records, n, samples = accelerations.shape
    flat = accelerations.reshape(-1, samples)
    kinds = np.unique(frequencies)
    squares = np.zeros((len(kinds), 3 * n, 3 * n))
    for window in range(len(_WINDOWS)):
        *parts, overlap = _modulating_functions(samples, step, window)
        integrals = np.array([flat @ part.reshape(-1, samples).T for part in parts])
        integrals = integrals.reshape(2, records, n, -1, 3).transpose(4, 2, 0, 1, 3).reshape(3 * n, 2 * records, -1)
        weights = 1 / (overlap[:, 0, 0] + kinds[:, None] ** 4 * overlap[:, 2, 2])
        weighted = (integrals * np.sqrt(weights)[:, None, None]).reshape(len(kinds), 3 * n, -1)
        # What noise adds is the Kronecker product of the functions' overlaps and of its covariance.
        overlaps = np.tensordot(weights, overlap, 1)[:, :, None, :, None]
        squares += weighted @ np.swapaxes(weighted, 1, 2)
        squares -= records * (overlaps * noise[:, None, :]).reshape(squares.shape)
    normal = np.zeros((len(terms), len(terms)))
    for own, total in zip(kinds.tolist(), squares, strict=True):
        design = terms[:, own == frequencies]
        normal += np.tensordot(design @ total, design, axes=([1, 2], [1, 2]))
    return normal
