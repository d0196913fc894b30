"""The example campaign of `sprung demo`: the paper's school bus."""

from __future__ import annotations

from typing import Literal

from sprung.campaign import Campaign
from sprung.simulation import simulate
from sprung.uncertainty import KnownValue
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import SCHOOL_BUS, WHEELS, Sensor, Wheel

DEMO_VEHICLE = SCHOOL_BUS
"""The vehicle of the example; its parameters are the true values."""

_BODY_RANGE, _WHEEL_RANGE = 4.0, 50.0  # g: wheel accelerations are about ten times those of the body
_STEPS = 2**16  # of a 16-bit recorder

_LOAD = {
    "name": "sandbags",
    "items": [
        {"mass": 235.0, "position": (-1.2, 0.4, 1.1), "inertia": (12.0, 20.0)},
        {"mass": 235.0, "position": (-2.4, -0.4, 1.1), "inertia": (12.0, 20.0)},
    ],
}
"""The paper's 470 kg, as two items at measured positions."""


def demo_campaign(seed: int = 1) -> Campaign:
    """Return the example: bounce, front, rear, left and right drops, empty and with 470 kg.

    Eight sensors in g, 500 Hz, noise of 0.02 m/s², 16 bit; known beforehand as in the paper (Table 4): total mass, a, b,
    t_f2 and t_r2.

    Parameters
    ----------
    seed
        Of the noise.

    Returns
    -------
    Campaign
    """
    wheelbase = DEMO_VEHICLE.wheelbase
    places = {
        "body_fl": (0.12, 0.69, 0.55),
        "body_fr": (0.12, -0.69, 0.55),
        "body_rl": (-wheelbase - 0.2, 0.7, 0.55),
        "body_rr": (-wheelbase - 0.2, -0.7, 0.55),
    }
    body = [_sensor(name, "body", _BODY_RANGE, position) for name, position in places.items()]
    wheels = [_sensor(f"wheel_{station}", station, _WHEEL_RANGE) for station in WHEELS]
    return simulate(
        DEMO_VEHICLE,
        sensors=body + wheels,
        loads=[_LOAD],
        rate=500,
        noise=0.02,
        offset=0.02 * STANDARD_GRAVITY,
        seed=seed,
        known={
            "total_mass": KnownValue(DEMO_VEHICLE.total_mass, 5.0),
            "a": KnownValue(DEMO_VEHICLE.a),
            "b": KnownValue(DEMO_VEHICLE.b),
            "t_f2": KnownValue(0.4),
            "t_r2": KnownValue(0.5),
        },
    )


def _sensor(
    channel: str,
    station: Literal["body"] | Wheel,
    full_scale: float,
    position: tuple[float, float, float] | None = None,
) -> Sensor:
    return Sensor(
        channel=channel,
        on=station,
        position=position,
        unit="g",
        range=full_scale,
        resolution=2 * full_scale / _STEPS,
    )
