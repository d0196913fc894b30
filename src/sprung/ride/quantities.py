"""Units, limits and meaning of every ride number."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class Quantity(NamedTuple):
    """A ride number.

    Attributes
    ----------
    unit
        SI.
    meaning
        In words.
    limits
        Smallest and largest possible value; None of a number that is positive and estimated by its logarithm.
    """

    unit: str
    meaning: str
    limits: tuple[float, float] | None = None


QUANTITIES: Mapping[tuple[str, str], Quantity] = MappingProxyType(
    {
        ("axles", "m_s"): Quantity("kg", "sprung mass of the quarter car"),
        ("axles", "m_u"): Quantity("kg", "unsprung mass of the quarter car"),
        ("axles", "k_s"): Quantity("N/m", "spring rate of the quarter car"),
        ("axles", "k_t"): Quantity("N/m", "tyre rate of the quarter car"),
        ("axles", "c_s"): Quantity("N s/m", "damper rate of the quarter car"),
        ("axles", "c_t"): Quantity("N s/m", "tyre damping of the quarter car", (-math.inf, math.inf)),
        ("axles", "body_frequency"): Quantity(
            "Hz", "natural frequency of the body on the axle, of the quarter car's pole"
        ),
        ("axles", "body_damping"): Quantity("1", "damping ratio of the body on the axle"),
        ("axles", "hop_frequency"): Quantity("Hz", "natural frequency of the wheel, of the quarter car's pole"),
        ("axles", "hop_damping"): Quantity("1", "damping ratio of the wheel"),
        ("half_cars", "m_s"): Quantity("kg", "sprung mass"),
        ("half_cars", "I_yy"): Quantity("kg m^2", "pitch inertia"),
        ("half_cars", "I_xx"): Quantity("kg m^2", "roll inertia"),
        ("half_cars", "a"): Quantity("m", "centre of gravity of the sprung mass to front axle", (-math.inf, math.inf)),
        ("half_cars", "b"): Quantity("m", "centre of gravity of the sprung mass to rear axle", (-math.inf, math.inf)),
        ("half_cars", "dynamic_index"): Quantity("1", "dynamic index I_yy/(m_s a b)", (-math.inf, math.inf)),
        ("half_cars", "m_u"): Quantity("kg", "unsprung mass of a side"),
        ("half_cars", "k_s"): Quantity("N/m", "spring rate of a side"),
        ("half_cars", "k_t"): Quantity("N/m", "tyre rate of a side"),
        ("half_cars", "c_s"): Quantity("N s/m", "damper rate of a side"),
        ("half_cars", "t"): Quantity("m", "half-distance of the springs"),
        ("half_cars", "k_a"): Quantity("N/m", "anti-roll bars", (-math.inf, math.inf)),
        ("peaks", "frequency"): Quantity("Hz", "frequency of the largest transmissibility"),
        ("peaks", "gain"): Quantity("1", "largest transmissibility"),
        ("plates", "static_load"): Quantity("N", "static wheel load"),
        ("plates", "least_load"): Quantity("1", "minimum force on the plate over the static load (EUSAMA)", (0.0, 1.0)),
        ("plates", "resonance"): Quantity("Hz", "frequency of the largest force on the plate"),
        ("plates", "least_phase"): Quantity("rad", "minimum phase shift from 18 to 6 Hz (EGEA)", (0.0, math.pi)),
        ("places", "acceleration"): Quantity("m/s^2", "vertical acceleration, rms"),
        ("places", "weighted"): Quantity("m/s^2", "vertical acceleration, weighted by W_k, rms"),
        ("places", "vibration_dose"): Quantity("m/s^1.75", "vibration dose value of the vertical acceleration"),
        ("places", "forward_weighted"): Quantity("m/s^2", "acceleration forward by pitch, weighted by W_d, rms"),
        ("places", "left_weighted"): Quantity("m/s^2", "acceleration to the left by roll, weighted by W_d, rms"),
        ("places", "total"): Quantity("m/s^2", "vibration total value of the translations, rms"),
        ("body", "acceleration"): Quantity("rad/s^2", "angular acceleration, rms"),
        ("body", "weighted"): Quantity("rad/s^2", "angular acceleration, weighted by W_e, rms"),
        ("wheels", "acceleration"): Quantity("m/s^2", "vertical acceleration of the wheel, rms"),
        ("wheels", "travel"): Quantity("m", "suspension travel, rms"),
        ("wheels", "load"): Quantity("N", "dynamic wheel load, rms"),
        ("wheels", "load_coefficient"): Quantity("1", "dynamic wheel load coefficient: rms over static load"),
    }
)
"""By group and name."""


def quantity_of(key: tuple[str, ...]) -> Quantity:
    """Return what a number is, from its key.

    Parameters
    ----------
    key
        Group, place in it, and quantity; numbers of a drive have ``roads`` and its number before them.
    """
    group = key[2] if key[0] == "roads" else key[0]
    return QUANTITIES[group, key[-1]]
