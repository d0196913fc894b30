"""Units of recordings, converted to SI when they are read. Every other number of sprung is SI and carries no unit."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Literal

from sprung.errors import did_you_mean

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall, m/s² (CGPM 1901): the unit g, and gravity in the model."""

Quantity = Literal["acceleration", "velocity", "displacement", "angular-rate", "force"]
"""What a sensor measures."""

SI_UNITS: Mapping[Quantity, str] = {
    "acceleration": "m/s^2",
    "velocity": "m/s",
    "displacement": "m",
    "angular-rate": "rad/s",
    "force": "N",
}
"""Unit of each quantity inside sprung."""

UNITS: Mapping[Quantity, Mapping[str, float]] = {
    "acceleration": {
        "m/s^2": 1.0,
        "g": STANDARD_GRAVITY,
        "mg": 1e-3 * STANDARD_GRAVITY,
        "mm/s^2": 1e-3,
        "cm/s^2": 1e-2,
        "gal": 1e-2,
        "ft/s^2": 0.3048,
        "in/s^2": 0.0254,
    },
    "velocity": {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "km/h": 1 / 3.6, "ft/s": 0.3048, "in/s": 0.0254},
    "displacement": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254, "ft": 0.3048},
    "angular-rate": {
        "rad/s": 1.0,
        "deg/s": math.pi / 180,
        "mrad/s": 1e-3,
        "mdeg/s": 1e-3 * math.pi / 180,
        "rpm": math.pi / 30,
    },
    "force": {"n": 1.0, "kn": 1e3, "dan": 10.0, "kgf": STANDARD_GRAVITY, "lbf": 4.4482216152605},
}
"""SI units in one of each unit of a quantity, in lower case."""

_BRACKETS = re.compile(r"^(?P<name>.*\S)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))$", re.DOTALL)
_SPELLINGS = {
    "m/s/s": "m/s^2",
    "ms-2": "m/s^2",
    "m*s-2": "m/s^2",
    "ms^-2": "m/s^2",
    "m*s^-2": "m/s^2",
    "m*s-1": "m/s",
    "ms-1": "m/s",
    "kph": "km/h",
    "µm": "um",
    "μm": "um",
    "inch": "in",
    "°/s": "deg/s",
    "dps": "deg/s",
    "degree/s": "deg/s",
    "degrees/s": "deg/s",
    "newton": "n",
    "g_n": "g",
    "g0": "g",
    "g_0": "g",
    "gn": "g",
}


def si_factor(text: str, quantity: Quantity = "acceleration") -> float:
    """Return the factor that converts a reading to SI.

    Parameters
    ----------
    text
        Unit as loggers write it: ``m/s²``, ``m/s^2``, ``g``, ``mg``, ``mm/s2``, ``ft/s^2``...
    quantity
        What is measured.

    Returns
    -------
    float
        SI units per unit.

    Raises
    ------
    ValueError
        If it is no unit of that quantity; the message states the nearest one.

    Examples
    --------
    >>> si_factor("m/s²"), si_factor("[g]"), si_factor("mm", "displacement")
    (1.0, 9.80665, 0.001)
    """
    plain = text.strip().strip("[]()").replace(" ", "").replace("²", "^2").replace("**", "^").replace("·", "*")
    plain = plain.replace("⁻", "-").replace("¹", "1").lower()
    if plain.endswith("s2"):
        plain = plain[:-1] + "^2"
    plain = _SPELLINGS.get(plain, plain)
    if plain not in UNITS[quantity]:
        raise ValueError(f"'{text}' is not a unit of {quantity_name(quantity)}. {did_you_mean(text, UNITS[quantity])}")
    return UNITS[quantity][plain]


def quantity_name(quantity: Quantity) -> str:
    """Return the name of a quantity in a sentence: ``angular rate``.

    Parameters
    ----------
    quantity
        What is measured.

    Returns
    -------
    str
    """
    return quantity.replace("-", " ")


def si_symbol(quantity: Quantity) -> str:
    """Return the SI unit of a quantity as it is printed: ``m/s²``.

    Parameters
    ----------
    quantity
        What is measured.

    Returns
    -------
    str
    """
    return SI_UNITS[quantity].replace("^2", "²")


def quantity_of_unit(text: str) -> Quantity | None:
    """Return what is measured in a unit; None where it is none of what sensors measure.

    Parameters
    ----------
    text
        As loggers write it.

    Returns
    -------
    str or None

    Examples
    --------
    >>> quantity_of_unit("mm"), quantity_of_unit("deg/s"), quantity_of_unit("V")
    ('displacement', 'angular-rate', None)
    """
    for quantity in UNITS:
        try:
            si_factor(text, quantity)
        except ValueError:
            continue
        return quantity
    return None


def split_unit(text: str) -> tuple[str, str | None]:
    """Split the unit off a column's name.

    Parameters
    ----------
    text
        As the file has it: ``body_fl [g]``, ``body_fl (m/s^2)`` or plainly ``body_fl``.

    Returns
    -------
    name
        The text before the brackets.
    unit
        The text in them; None without brackets. Round brackets are taken as a unit only where they hold one of
        what sensors measure: ``body (left)`` is a name.

    Examples
    --------
    >>> split_unit("body_fl [g]"), split_unit("body (left)")
    (('body_fl', 'g'), ('body (left)', None))
    """
    match = _BRACKETS.match(text.strip())
    if match is None:
        return text.strip(), None
    if match["square"] is not None:
        return match["name"], match["square"].strip()
    return (match["name"], match["round"].strip()) if quantity_of_unit(match["round"]) else (text.strip(), None)
