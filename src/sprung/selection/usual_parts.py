"""Parts that move on the body or bend with it, at their usual sizes: engine, people on seats, twist and bending of the body."""

from __future__ import annotations

import numpy as np

from sprung.selection.description import Values
from sprung.selection.structure import ModelStructure
from sprung.vehicle import PARAMETERS

USUAL_OCCUPANTS, SEAT_FREQUENCY, _SEAT_DAMPING = 0.06, 4.5, 0.3
"""People on seats as a part of the sprung mass, the natural frequency of a seat, Hz, and its damping ratio (Griffin, Handbook
of Human Vibration, 1990)."""

SEAT_LOSS = 2 * _SEAT_DAMPING * 2 * np.pi * SEAT_FREQUENCY
"""Damping of a seat over the mass on it, 1/s."""

_MODAL_INERTIA, _BODY_DAMPING = 0.08, 0.03
"""Modal inertia of a usual twist over I_xx, and damping ratio of twist and bending."""

_MODAL_MASS, _MEAN_RISE = 4 / 45, 2 / 3
"""Modal mass of a usual bending over m_s, and how far the centre of gravity rises with the middle of the body: those of a
parabola over a body of uniform mass between its axles."""


def natural_frequency(rate: float, mass: float) -> float:
    """Return the undamped natural frequency of a mass on a spring, or of a modal mass, Hz; rate and mass in SI.

    Zero where one of both is negative, as a fit may leave them: nothing vibrates there.
    """
    return float(np.sqrt(max(rate / mass, 0.0)) / (2 * np.pi))


def usual_twist(own: Values, structure: ModelStructure, factor: float = 1.0) -> Values:
    """Return a usual twist of the body, its modal mass multiplied by a factor."""
    inertia, omega = factor * _MODAL_INERTIA * own["I_xx"], 2 * np.pi * structure.body_frequency
    rates = {"I_w": inertia, "k_w": inertia * omega**2, "c_w": 2 * _BODY_DAMPING * inertia * omega}
    return {**rates, "a_w": 0.0, "u_w": 0.0, "e_w": 0.0}


def usual_bending(own: Values, structure: ModelStructure, factor: float = 1.0) -> Values:
    """Return a usual bending of the body, its modal mass multiplied by a factor."""
    mass, omega = factor * _MODAL_MASS * own["m_s"], 2 * np.pi * structure.body_frequency
    rates = {"m_v": mass, "k_v": mass * omega**2, "c_v": 2 * _BODY_DAMPING * mass * omega}
    return {**rates, "b_v": _MEAN_RISE, "p_v": 0.0}


def usual_occupants(own: Values, structure: ModelStructure, share: float = USUAL_OCCUPANTS) -> Values:
    """Return people who are a part of the sprung mass, on usual seats."""
    mass, omega = share * own["m_s"], 2 * np.pi * SEAT_FREQUENCY
    place = -structure.seat_place * (own.get("a", 0.0) + own.get("b", 0.0))
    rates = {"m_o": mass, "k_o": mass * omega**2, "c_o": 2 * _SEAT_DAMPING * mass * omega}
    return {**rates, "x_o": place, "y_o": 0.0, "t_o": PARAMETERS["t_o"].usual}
