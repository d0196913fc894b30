"""Quarter and half cars that a vehicle is made of, and natural frequencies and damping ratios of each axle.

The quarter car of an axle is one of its wheels with what the body weighs on it: the static wheel load less the unsprung mass.
Both wheels of the axle move alike, so that anti-roll bars do nothing. Whatever else moves, an engine or people on seats, is
carried by the body (Guyan's reduction), and heavier by the load.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sprung.ride.ride_model import RideModel
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import EquivalentElements, Matrices, parameter_name

Real = NDArray[np.float64]

_REAL = 1e-9
"""Imaginary part of a pole over its magnitude below which it does not oscillate."""


def axle_numbers(
    model: RideModel, values: Real, equivalents: EquivalentElements | None = None
) -> dict[str, dict[str, float]]:
    """Return the quarter car of each axle, with the natural frequencies and damping ratios of its two modes.

    Parameters
    ----------
    model, values
        The vehicle.
    equivalents
        Linear elements in place of its nonlinear ones.

    Returns
    -------
    dict
        By the index of the axle: ``m_s``, ``m_u``, ``k_s``, ``k_t``, ``c_s``, ``c_t``, SI; ``body_frequency`` and
        ``hop_frequency``, Hz, ``body_damping`` and ``hop_damping``, 1. A mode that does not oscillate has none.
    """
    found = {}
    for axle in model.vehicle.layout.axles:
        quarter = _quarter_matrices(model, values, axle, equivalents)
        own = _quarter_parameters(model, values, axle, quarter, equivalents)
        found[axle] = own | _modes(quarter)
    return found


def _with_equivalents(model: RideModel, values: Real, equivalents: EquivalentElements | None) -> Matrices:
    """Return M, C and K with equivalent elements, and one coordinate without mass behind each memory."""
    M, C, K = model.matrices(values)
    if equivalents is None:
        return Matrices(M, C, K)
    rows, directions = model.forces.rows.at(values), model.forces.directions(values)
    K = K + directions.T @ (equivalents.stiffness[:, None] * rows)
    C = C + directions.T @ (equivalents.damping[:, None] * rows)
    acting = [i for i in range(len(equivalents.memory_rows)) if equivalents.sliding[i] * equivalents.memory_gain[i]]
    n, memories = len(K), len(acting)
    # A spring s and a damper s/κ in series: behind the spring is a coordinate of its own.
    M, C, K = (np.pad(one, (0, memories)) for one in (M, C, K))
    for memory, one in enumerate(acting):
        row = int(equivalents.memory_rows[one])
        rate = equivalents.sliding[one] * equivalents.memory_gain[one]
        travel = np.zeros(n + memories)
        travel[:n] = rows[row]
        force = np.zeros(n + memories)
        force[:n] = directions[row]
        weight = directions[row] @ rows[row] / (rows[row] @ rows[row])
        travel[n + memory], force[n + memory] = -1.0, -weight
        K = K + rate * np.outer(force, travel)
        C[n + memory, n + memory] += weight * rate / equivalents.cutoff[one]
    return Matrices(M, C, K)


def _quarter_matrices(model: RideModel, values: Real, axle: str, equivalents: EquivalentElements | None) -> Matrices:
    """Return M, C and K of body, wheel, and whatever coordinates without mass belong to the wheels of an axle; per wheel."""
    layout = model.vehicle.layout
    matrices = _with_equivalents(model, values, equivalents)
    size, massive, first = len(matrices.K), model.linear.massive, layout.wheels_at.start
    wheels = [first + layout.wheels.index(wheel) for wheel in layout.wheels_of(axle)]
    # Coordinates without mass belong to the wheels with which they are connected.
    coupled = np.abs(matrices.K[:, wheels]).sum(axis=1) + np.abs(matrices.C[:, wheels]).sum(axis=1)
    hidden = [at for at in range(massive, size) if coupled[at] > 0]
    held = [at for at in hidden if not _is_even(matrices, at, wheels)]
    hidden = [at for at in hidden if at not in held]
    T = np.zeros((size, 2 + len(hidden)))
    T[0, 0] = 1.0
    T[wheels, 1] = 1.0
    T[hidden, 2 + np.arange(len(hidden))] = 1.0
    M, C, K = np.zeros((2 + len(hidden), 2 + len(hidden))), T.T @ matrices.C @ T, T.T @ matrices.K @ T
    for one in (C, K):
        # What acts between body and wheels does nothing if both move alike: the rest of the body's own entry is other axles'.
        one[0, 0] = -one[0, 1]
    sprung, unsprung = _corner_masses(model, values, axle)
    M[0, 0], M[1, 1] = sprung * len(wheels), unsprung * len(wheels)
    return Matrices(*(one / len(wheels) for one in (M, C, K)))


def _is_even(matrices: Matrices, at: int, wheels: list[int]) -> bool:
    """Return whether a coordinate without mass moves where the wheels of an axle move alike."""
    forces = [float(one[at, wheels].sum()) for one in (matrices.K, matrices.C)]
    sizes = [float(np.abs(one[at, wheels]).sum()) for one in (matrices.K, matrices.C)]
    return any(abs(force) > 1e-9 * size > 0 for force, size in zip(forces, sizes, strict=True))


def _corner_masses(model: RideModel, values: Real, axle: str) -> tuple[float, float]:
    """Return sprung and unsprung mass on one wheel of an axle, kg."""
    layout = model.vehicle.layout
    own = [layout.wheels.index(wheel) for wheel in layout.wheels_of(axle)]
    M = model.matrices(values).M
    unsprung = (M @ model.linear.heave)[layout.wheels_at][own].mean()
    load = model.static_loads(values)[own].mean() / STANDARD_GRAVITY
    return float(load - unsprung), float(unsprung)


def _quarter_parameters(
    model: RideModel, values: Real, axle: str, quarter: Matrices, equivalents: EquivalentElements | None
) -> dict[str, float]:
    at_rest = dict(zip(model.names, model.at_rest(values).tolist(), strict=True))
    sprung, unsprung = float(quarter.M[0, 0]), float(quarter.M[1, 1])
    tyre = at_rest[f"k_t{axle}"]
    damper = at_rest[f"c_s{axle}"]
    if equivalents is not None:
        damper += _of_dampers(model, axle, equivalents)
    found = {"m_s": sprung, "m_u": unsprung, "k_s": float(-quarter.K[0, 1]), "k_t": tyre, "c_s": damper}
    if len(quarter.K) > 2:
        found["k_s"] = _static_rate(quarter)
    damping = at_rest.get(f"c_t{axle}")
    return found if damping is None else found | {"c_t": damping}


def _static_rate(quarter: Matrices) -> float:
    """Return the rate between body and wheel at rest, N/m: coordinates without mass follow."""
    hidden = slice(2, None)
    own = quarter.K[hidden, hidden]
    free = np.diag(own) == 0
    coupling = quarter.K[0, hidden] * ~free
    return float(
        -(quarter.K[0, 1] - coupling @ np.linalg.solve(own + np.diag(free.astype(float)), quarter.K[hidden, 1]))
    )


def _of_dampers(model: RideModel, axle: str, equivalents: EquivalentElements) -> float:
    """Return what nonlinear elements add to the rate of each damper of an axle, N s/m."""
    layout = model.vehicle.layout
    rate = parameter_name("c_s", axle) if not axle else f"c_s{axle}"
    position = model.names.index(rate)
    added = np.zeros(model.forces.number)
    for law, at, _, positions in model.forces.laws:
        rows = np.arange(model.forces.number)[at]
        if not law.has_memory:
            uses = (positions == position).any(axis=0)
            added[rows[uses]] = equivalents.damping[rows[uses]]
    return float(added.sum() / len(layout.wheels_of(axle)))


def _modes(quarter: Matrices) -> dict[str, float]:
    """Return frequencies, Hz, and damping ratios of the body on the wheel and of the wheel under the body."""
    poles = np.linalg.eigvals(quarter.state)
    vibrating = sorted((pole for pole in poles if pole.imag > _REAL * abs(pole)), key=abs)
    # With one pair, the other mode does not oscillate: the pair is that which is nearer to its undamped frequency.
    undamped = np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(quarter.M[:2, :2], quarter.K[:2, :2]))))
    body, hop = np.sort(undamped)
    if len(vibrating) == 1:
        is_body = abs(np.log(abs(vibrating[0]) / body)) < abs(np.log(abs(vibrating[0]) / hop))
        named = {"body" if is_body else "hop": vibrating[0]}
    else:
        named = dict(zip(("body", "hop"), vibrating[:1] + vibrating[-1:], strict=False))
    return {
        f"{mode}_{quantity}": value
        for mode, pole in named.items()
        for quantity, value in (("frequency", abs(pole) / (2 * np.pi)), ("damping", -pole.real / abs(pole)))
    }


def half_car_numbers(model: RideModel, values: Real) -> dict[str, dict[str, float]]:
    """Return the half cars of a whole vehicle.

    Parameters
    ----------
    model, values
        The vehicle.

    Returns
    -------
    dict
        ``pitch``: one side of it, m_s, I_yy, a, b, and the ``dynamic_index`` I_yy/(m_s a b), at which 1 lets front and rear
        move independently. ``roll``: front and rear together, m_s, I_xx, the rates of both wheels of a side, and the half
        distance t at which these springs would have the same roll stiffness. None of a part of a vehicle.
    """
    layout = model.vehicle.layout
    if not layout.pitches:
        return {}
    body = _rigid_body(model, values)
    by_name = dict(zip(model.names, model.at_rest(values).tolist(), strict=True))
    mass = float(body[0, 0])
    ahead = -float(body[0, 1]) / mass
    a, b = by_name["a"] - ahead, by_name["b"] + ahead
    inertia = float(body[1, 1]) - mass * ahead**2
    share = 0.5 if layout.rolls else 1.0
    found = {
        "pitch": {
            "m_s": share * mass,
            "I_yy": share * inertia,
            "a": a,
            "b": b,
            "dynamic_index": inertia / (mass * a * b),
        }
    }
    if layout.rolls:
        left = float(body[0, 2]) / mass
        rates = {name: sum(by_name[f"{name}{axle}"] for axle in layout.axles) for name in ("m_u", "k_s", "k_t", "c_s")}
        arms = dict(zip(layout.wheels, model.wheel_places(values)[1].tolist(), strict=True))
        squares = sum(by_name[f"k_s{axle}"] * arms[layout.wheels_of(axle)[0]] ** 2 for axle in layout.axles)
        found["roll"] = {
            "m_s": mass,
            "I_xx": float(body[2, 2]) - mass * left**2,
            **rates,
            "t": float(np.sqrt(squares / rates["k_s"])),
        }
        bars = sum(by_name.get(f"k_a{axle}", 0.0) for axle in layout.axles)
        if bars:
            found["roll"]["k_a"] = bars
    return found


def _rigid_body(model: RideModel, values: Real) -> Real:
    """Return the mass matrix of the body by its rise, pitch and roll, with all that it carries."""
    matrices = model.matrices(values)
    body, massive = model.vehicle.layout.wheels_at.start, model.linear.massive
    attached = list(range(model.vehicle.layout.wheels_at.stop, massive))
    T = np.zeros((len(matrices.M), body))
    T[:body] = np.eye(body)
    if attached:
        own, coupling = matrices.K[np.ix_(attached, attached)], matrices.K[attached, :body]
        T[attached] = -np.linalg.solve(own, coupling)
    return np.asarray(T.T @ matrices.M @ T)
