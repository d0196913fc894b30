"""Start values: a grid of usual vehicles of the size that is known or that the sensors span."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.uncertainty import KnownValue
from sprung.vehicle import FULL, NEUTRAL, Layout, Sensor, layout_of, parameter_name

BODY_FREQUENCIES = (1.0, 1.6, 2.6)
"""Hz: from a limousine to an empty lorry."""

USUAL_ENGINE = 0.1
"""Part of the sprung mass that an engine on mounts usually is."""

USUAL_ENGINE_FREQUENCY = 10.0
"""Natural frequency of a usual engine on its mounts, Hz."""

USUAL_MOUNT = 12.0
"""Rate of a usual damper mount over that of the spring."""

USUAL_RELAXATION = 0.15
"""Part of a spring rate that usual rubber adds in fast motion."""

_RELAXATION_TIMES = {
    "f": 0.05,
    "r": 0.07,
    "": 0.05,
}  # s; unlike, as branches that do next to nothing would have equal poles

_MOUNTED = (7.0, 10.0, 14.0)  # Hz of an engine on its mounts

HOP_FREQUENCIES = (8.5, 12.0, 18.0)
"""Hz."""

DAMPING_RATIOS = (0.12, 0.35, 0.8)

_LOSS = 0.1  # loss factor of rubber mounts
_USUAL_BODY, _USUAL_HOP, _USUAL_DAMPING = 1.4, 12.0, 0.3  # Hz, Hz, and the damping ratio of the body
_GRAVITY_FREE_MASS = 1500.0  # kg at a wheelbase of 2.7 m; any scale will do where nothing fixes it
_MOUNT_DAMPING = 0.08  # damping ratio of usual engine mounts
_WHEEL_SHARE = 0.035  # of the total mass in each wheel: between a car's 0.027 and a bus's 0.06


def usual_engine(mass: float, frequency: float = USUAL_ENGINE_FREQUENCY, place: float = 0.0) -> dict[str, float]:
    """Return the parameters of an engine on usual mounts, before the fit.

    Parameters
    ----------
    mass
        kg.
    frequency
        On its mounts, the body held, Hz.
    place
        Forward of the front axle, m.

    Returns
    -------
    dict
        SI, by name.
    """
    omega = 2 * np.pi * frequency
    return {"m_e": mass, "k_e": mass * omega**2, "c_e": 2 * _MOUNT_DAMPING * mass * omega, "x_e": place}


def engine_mountings(wheelbase: float) -> list[tuple[float, float]]:
    """Return the usual mountings of engines, above either axle.

    Parameters
    ----------
    wheelbase
        m.

    Returns
    -------
    list of tuple
        Frequency, Hz, and place, m, as `usual_engine` takes them.
    """
    return [(frequency, place) for frequency in _MOUNTED for place in (0.0, -wheelbase)]


def usual_rubber(values: Mapping[str, float]) -> dict[str, float]:
    """Return the usual rubber of the suspension of a vehicle: damper mounts, and Zener branches beside its springs.

    Parameters
    ----------
    values
        Its parameters, SI, by name.

    Returns
    -------
    dict
        Parameters, SI, by name.
    """
    rates = {axle: values[f"k_s{axle}"] for axle in layout_of(values).axles}
    return {
        **{f"k_d{axle}": USUAL_MOUNT * rate for axle, rate in rates.items()},
        **{f"c_d{axle}": _LOSS * USUAL_MOUNT * rate / (2 * np.pi * _USUAL_HOP) for axle, rate in rates.items()},
        **{f"k_z{axle}": USUAL_RELAXATION * rate for axle, rate in rates.items()},
        **{f"c_z{axle}": _RELAXATION_TIMES[axle] * USUAL_RELAXATION * rate for axle, rate in rates.items()},
    }


class VehicleSize(NamedTuple):
    """Size of a vehicle, as far as it is known or follows from the sensors' positions.

    Attributes
    ----------
    wheelbase
        m.
    front_share
        The front axle's share of the weight, dimensionless.
    mass
        Of the whole vehicle, kg.
    weighed
        Whether the mass is known; a usual one for the wheelbase otherwise.
    half_track
        m.
    layout
        Of the vehicle.
    """

    wheelbase: float
    front_share: float
    mass: float
    weighed: bool
    half_track: float
    layout: Layout = FULL

    @classmethod
    def of(cls, known: Mapping[str, KnownValue], sensors: Sequence[Sensor], layout: Layout = FULL) -> VehicleSize:
        """Return the size from what is known beforehand, the rest from the sensors' positions.

        Parameters
        ----------
        known
            Quantities measured beforehand, by name.
        sensors
            The sensors.
        layout
            Of the vehicle.

        Returns
        -------
        VehicleSize
        """
        value = {name: one.value for name, one in known.items()}
        places = np.array([sensor.position for sensor in sensors if sensor.position is not None]).reshape(-1, 3)
        wheelbase, front_share = _length(value, places if layout.pitches else places[:0])
        mass = _mass(value)
        half_track = float(np.abs(places[:, 1]).sum()) / max(len(places), 1) or 0.27 * wheelbase
        usual = _GRAVITY_FREE_MASS * (wheelbase / 2.7) ** 3 * len(layout.wheels) / 4
        return cls(wheelbase, front_share, usual if mass is None else mass, mass is not None, half_track, layout)

    @property
    def sprung_mass(self) -> float:
        """Mass of a usual body in it, kg."""
        return self.mass * (1 - 4 * _WHEEL_SHARE)


def start_grid(size: VehicleSize, known: Mapping[str, KnownValue], engine: bool = False) -> Iterator[dict[str, float]]:
    """Yield usual vehicles of one size.

    Parameters
    ----------
    size
        The size.
    known
        What was measured beforehand.
    engine
        Whether each has an engine on mounts, wherever that usually is.

    Yields
    ------
    dict
        Values, SI, of every parameter of every linear model; the known ones hold.
    """
    for body, hop, damping in product(BODY_FREQUENCIES, HOP_FREQUENCIES, DAMPING_RATIOS):
        values = {**usual_vehicle(size, body, hop, damping), **NEUTRAL}
        values |= usual_rubber(values)
        for mounting in engine_mountings(size.wheelbase) if engine else [(USUAL_ENGINE_FREQUENCY, 0.0)]:
            values |= usual_engine(USUAL_ENGINE * size.sprung_mass, *mounting)
            yield values | {name: one.value for name, one in known.items() if name in values}


def usual_vehicle(
    size: VehicleSize, body: float = _USUAL_BODY, hop: float = _USUAL_HOP, damping: float = _USUAL_DAMPING
) -> dict[str, float]:
    """Return a usual vehicle of a size, without further model terms.

    Parameters
    ----------
    size
        The size.
    body, hop
        Frequencies of body and wheels, Hz.
    damping
        Damping ratio of the body.

    Returns
    -------
    dict
        Parameters by name, SI; half-distances both shared and separate.
    """
    wheelbase, front_share, half_track = size.wheelbase, size.front_share, size.half_track
    a, b = (1 - front_share) * wheelbase, front_share * wheelbase
    layout, sprung_mass = size.layout, size.sprung_mass
    wheel = 4 * _WHEEL_SHARE * size.mass / len(layout.wheels)
    values = {"m_s": sprung_mass, "I_yy": sprung_mass * a * b, "I_xx": sprung_mass * (0.8 * half_track) ** 2}
    shares = {"f": front_share, "r": 1 - front_share, "": 1.0}
    for axle in layout.axles:
        corner = sprung_mass * shares[axle] / len(layout.wheels_of(axle))
        spring = corner * (2 * np.pi * body) ** 2
        values |= {
            f"m_u{axle}": wheel,
            f"k_s{axle}": spring,
            f"k_t{axle}": max(wheel * (2 * np.pi * hop) ** 2 - spring, 2 * spring),
            f"c_s{axle}": 2 * damping * np.sqrt(corner * spring),
        }
        values |= dict.fromkeys((parameter_name("t", axle, number) for number in ("", "1", "2")), half_track)
    values |= {"a": a, "b": b}
    absent = {*(("I_yy", "a", "b") if not layout.pitches else ()), *(("I_xx",) if not layout.rolls else ())}
    return {name: value for name, value in values.items() if name not in absent}


def _length(value: Mapping[str, float], places: NDArray[np.float64]) -> tuple[float, float]:
    """Return wheelbase and the front axle's share of the weight."""
    wheelbase = value.get("wheelbase")
    if wheelbase is None and "a" in value and "b" in value:
        wheelbase = value["a"] + value["b"]
    if wheelbase is None:
        wheelbase = float(np.ptp(places[:, 0])) if len(places) else 2.7
    if "b" in value:
        share = value["b"] / wheelbase
    elif "a" in value:
        share = 1 - value["a"] / wheelbase
    elif "front_axle_mass" in value and "rear_axle_mass" in value:
        share = value["front_axle_mass"] / (value["front_axle_mass"] + value["rear_axle_mass"])
    else:
        share = 0.5
    return wheelbase, float(np.clip(share, 0.1, 0.9))


def _mass(value: Mapping[str, float]) -> float | None:
    if "total_mass" in value:
        return value["total_mass"]
    axles = [value[name] for name in ("front_axle_mass", "rear_axle_mass") if name in value]
    if axles:
        return sum(axles) * 2 / len(axles)
    if "m_s" in value:
        return value["m_s"] / (1 - 4 * _WHEEL_SHARE)
    return None
