"""Quantities that follow from the parameters: masses, centre of gravity, ride and wheel-hop frequencies, damping ratios.

All are of the empty vehicle. Those of an axle are of the quarter car of that axle: one wheel, its spring and damper at their
mean of left and right, and half the sprung mass that the axle carries (Gillespie, Fundamentals of Vehicle Dynamics,
chapter 5). They are of the linear vehicle: sliding friction, a damper at the mean of its rates in compression and rebound.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.units import STANDARD_GRAVITY
from sprung.vehicle.layout import layout_of, parameter_name
from sprung.vehicle.model import LinearModel

Real = NDArray[np.float64]
Values = Mapping[str, Any]
"""Parameters by name, SI: numbers, or complex arrays for differentiation by complex steps."""

_STEP = 1e-30
"""Imaginary step: no difference is taken, so that it may be as small as the numbers allow."""


class Characteristic(NamedTuple):
    """A quantity that follows from the parameters of the empty vehicle.

    Attributes
    ----------
    unit
        SI.
    meaning
        In words.
    value
        Analytic function of the parameters by name, those that a model lacks left out.
    needs
        Parameters without which it is of no interest.
    signed
        Whether it may be negative.
    """

    unit: str
    meaning: str
    value: Callable[[Values], Any]
    needs: frozenset[str] = frozenset()
    signed: bool = False


def _wheels(p: Values, axle: str) -> int:
    return len(layout_of(p).wheels_of(axle))


def _corner_mass(p: Values, axle: str) -> Any:
    """Sprung mass on one wheel, kg: its part of what the axle carries."""
    share = p[{"f": "b", "r": "a"}[axle]] / (p["a"] + p["b"]) if axle else 1.0
    return p["m_s"] * share / _wheels(p, axle)


def _damper_rate(p: Values, axle: str) -> Any:
    """Damper rate, N s/m: the mean of compression and rebound, where these differ."""
    return p[f"c_s{axle}"] * (1 + p.get(parameter_name("r", axle), 1.0)) / 2


def _ride_frequency(p: Values, axle: str) -> Any:
    spring, tyre = p[f"k_s{axle}"], p[f"k_t{axle}"]
    return (spring * tyre / (spring + tyre) / _corner_mass(p, axle)) ** 0.5 / (2 * np.pi)


def _ride_damping(p: Values, axle: str) -> Any:
    return _damper_rate(p, axle) / (2 * (p[f"k_s{axle}"] * _corner_mass(p, axle)) ** 0.5)


def _hop_frequency(p: Values, axle: str) -> Any:
    return ((p[f"k_s{axle}"] + p[f"k_t{axle}"]) / p[f"m_u{axle}"]) ** 0.5 / (2 * np.pi)


def _hop_damping(p: Values, axle: str) -> Any:
    stiffness = p[f"k_s{axle}"] + p[f"k_t{axle}"]
    return (_damper_rate(p, axle) + p.get(f"c_t{axle}", 0.0)) / (2 * (stiffness * p[f"m_u{axle}"]) ** 0.5)


def _total_mass(p: Values) -> Any:
    return p["m_s"] + sum(_wheels(p, axle) * p[f"m_u{axle}"] for axle in layout_of(p).axles)


def _axle_mass(p: Values, axle: str) -> Any:
    return _wheels(p, axle) * (_corner_mass(p, axle) + p[f"m_u{axle}"])


def _cg_from_front_axle(p: Values) -> Any:
    return _axle_mass(p, "r") / _total_mass(p) * (p["a"] + p["b"])


def _cg_left(p: Values) -> Any:
    return p["m_s"] * p["y_s"] / _total_mass(p)


def _attached_frequency(index: str, mass: str) -> Callable[[Values], Any]:
    return lambda p: (p[f"k_{index}"] / p[mass]) ** 0.5 / (2 * np.pi)


def _attached_damping(index: str, mass: str) -> Callable[[Values], Any]:
    return lambda p: p[f"c_{index}"] / (2 * (p[f"k_{index}"] * p[mass]) ** 0.5)


def _of_axle(function: Callable[[Values, str], Any], axle: str) -> Callable[[Values], Any]:
    return lambda p: function(p, axle)


_AXLES = {"front": "f", "rear": "r"}
_EITHER = {**_AXLES, "": ""}
_OF_TWO = frozenset({"a"})
"""Parameters of a vehicle with two axles."""

_AXLE_QUANTITIES: Mapping[str, tuple[str, str, Callable[[Values, str], Any]]] = {
    "ride_frequency": ("Hz", "natural frequency of the body on spring and tyre, {} quarter car", _ride_frequency),
    "ride_damping": ("1", "damping ratio of the body on its springs, {} quarter car", _ride_damping),
    "hop_frequency": ("Hz", "natural frequency of the wheel between spring and tyre, {} quarter car", _hop_frequency),
    "hop_damping": ("1", "damping ratio of the wheel, {} quarter car", _hop_damping),
}

CHARACTERISTICS: Mapping[str, Characteristic] = {
    "total_mass": Characteristic("kg", "mass of the empty vehicle", _total_mass),
    "front_axle_mass": Characteristic(
        "kg", "on the front wheels of the empty vehicle", _of_axle(_axle_mass, "f"), _OF_TWO
    ),
    "rear_axle_mass": Characteristic(
        "kg", "on the rear wheels of the empty vehicle", _of_axle(_axle_mass, "r"), _OF_TWO
    ),
    "front_axle_share": Characteristic(
        "1",
        "part of the empty vehicle's mass on its front wheels",
        lambda p: _axle_mass(p, "f") / _total_mass(p),
        _OF_TWO,
    ),
    "cg_from_front_axle": Characteristic(
        "m", "centre of gravity of the empty vehicle, behind the front axle", _cg_from_front_axle, _OF_TWO
    ),
    "cg_left": Characteristic(
        "m",
        "centre of gravity of the empty vehicle, left of the centreline",
        _cg_left,
        frozenset({"y_s"}),
        signed=True,
    ),
    **{
        f"{name}_{quantity}".lstrip("_"): Characteristic(
            unit, " ".join(meaning.format(name).split()), _of_axle(function, axle), frozenset({f"m_u{axle}"})
        )
        for quantity, (unit, meaning, function) in _AXLE_QUANTITIES.items()
        for name, axle in _EITHER.items()
    },
    **{
        f"{name}_{quantity}": Characteristic(unit, meaning.format(what), function(index, mass), frozenset({mass}))
        for quantity, unit, meaning, function in (
            ("frequency", "Hz", "natural frequency of {}", _attached_frequency),
            ("damping", "1", "damping ratio of {}", _attached_damping),
        )
        for name, index, mass, what in (
            ("twist", "w", "I_w", "the twist of the body as it floats"),
            ("bending", "v", "m_v", "the bending of the body as it floats"),
            ("seat", "o", "m_o", "people on their seats, the body held"),
        )
    },
}
"""By name, in the order in which tables show them. Static wheel loads, which follow from the matrices, are `wheel_loads`."""

DERIVED: Mapping[str, Characteristic] = {
    **{name: CHARACTERISTICS[name] for name in ("total_mass", "front_axle_mass", "rear_axle_mass")},
    "wheelbase": Characteristic("m", "front axle to rear axle", lambda p: p["a"] + p["b"], _OF_TWO),
}
"""Those that a campaign may state as known beforehand, by the names it gives them."""


MOTION_RATIOS: Mapping[str, tuple[str, str, str]] = {
    f"{part}_{name}".rstrip("_"): (
        f"{letter}_s{axle}",
        f"{letter}_s{axle}_at_{part}",
        " ".join(f"{part} rate at each {name} {part}: {letter}_s{axle} over the squared motion ratio".split()),
    )
    for part, letter in (("spring", "k"), ("damper", "c"))
    for name, axle in _EITHER.items()
}
"""Motion ratios, travel of a spring or damper per travel of its wheel, by the names that a campaign gives them.

Each with the rate at the wheel, and with name and meaning of that at the spring or damper.
"""

WHEEL_LOADS: Mapping[str, str] = {
    "front_wheel_load": "static load of each front wheel of the empty vehicle",
    "rear_wheel_load": "static load of each rear wheel of the empty vehicle",
    "front_left_wheel_load": "static load of the left front wheel of the empty vehicle",
    "front_right_wheel_load": "static load of the right front wheel of the empty vehicle",
    "rear_left_wheel_load": "static load of the left rear wheel of the empty vehicle",
    "rear_right_wheel_load": "static load of the right rear wheel of the empty vehicle",
    "wheel_load": "static load of each wheel of the empty vehicle",
    "left_wheel_load": "static load of the left wheel of the empty vehicle",
    "right_wheel_load": "static load of the right wheel of the empty vehicle",
}
"""Meaning of the static wheel loads, N, by name: one for each axle where left and right are alike."""


def evaluate_quantity(name: str, names: Sequence[str], values: Real) -> tuple[float, Real]:
    """Return a parameter or a quantity that follows from the parameters, and its gradient.

    Parameters
    ----------
    name
        One of `names`, of `DERIVED` or of `CHARACTERISTICS`.
    names, values
        Parameters of a vehicle, SI; values of shape (parameter,).

    Returns
    -------
    value
        SI.
    gradient
        By each parameter, SI, shape (parameter,); exact to rounding.
    """
    values, gradients = evaluate_quantities((name,), tuple(names), values)
    return float(values[0]), gradients[0]


def evaluate_quantities(quantities: tuple[str, ...], names: tuple[str, ...], values: Real) -> tuple[Real, Real]:
    """Return several such quantities at once, and their gradients.

    Parameters
    ----------
    quantities
        Each one of `names`, of `DERIVED` or of `CHARACTERISTICS`.
    names, values
        As for `evaluate_quantity`.

    Returns
    -------
    values
        SI, shape (quantity,).
    gradients
        By each parameter, SI, shape (quantity, parameter); exact to rounding.
    """
    selection, derived = _selection(quantities, names)
    found, gradients = selection @ values, selection.copy()
    if derived:
        # f(p + ih) = f(p) + ih f'(p) + O(h²): the imaginary part holds the derivative, without any cancellation (Squire and
        # Trapp, SIAM Rev. 40 (1998) 110). One evaluation takes a step in every parameter.
        steps = dict(zip(names, values[:, None] + 1j * _STEP * np.eye(len(names)), strict=True))
        for row in derived:
            characteristic = DERIVED.get(quantities[row]) or CHARACTERISTICS[quantities[row]]
            stepped = np.broadcast_to(characteristic.value(steps), len(names))
            found[row], gradients[row] = stepped[0].real, stepped.imag / _STEP
    return found, gradients


@lru_cache
def _selection(quantities: tuple[str, ...], names: tuple[str, ...]) -> tuple[Real, tuple[int, ...]]:
    """Return the gradients of those quantities that are parameters, and the rows of the others."""
    selection = np.array([[float(name == quantity) for name in names] for quantity in quantities])
    selection = selection.reshape(len(quantities), len(names))
    return selection, tuple(row for row, quantity in enumerate(quantities) if quantity not in names)


def wheel_loads(model: LinearModel, values: Real) -> tuple[Real, Real]:
    """Return the static force of level ground on each wheel, and its gradient.

    The four forces of a vehicle whose left and right differ depend on how the springs were seated, which no recording shows:
    these are those of springs that would all be unloaded at one height.

    Parameters
    ----------
    model
        Equations of motion of the vehicle with its load.
    values
        Parameters, SI, shape (parameter,).

    Returns
    -------
    loads
        N, shape (wheel,), in the order of the wheel stations.
    gradient
        By each parameter, SI, shape (wheel, parameter).
    """
    matrices, heave = model.matrices(values), model.heave
    M, _, K = matrices
    dM, _, dK = model.slopes(values)
    wheels = layout_of(model.names).wheels_at
    # Heave strains nothing but the tyres: K times it is their rates.
    tyres, tyre_slopes = (K @ heave)[wheels], (dK @ heave)[:, wheels]
    sag = matrices.deflection(STANDARD_GRAVITY * M @ heave)
    sag_slopes = matrices.deflection((STANDARD_GRAVITY * dM @ heave - dK @ sag).T).T
    loads = tyres * sag[wheels]
    gradient = tyre_slopes * sag[wheels] + tyres * sag_slopes[:, wheels]
    return loads, gradient.T
