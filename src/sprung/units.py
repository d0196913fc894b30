"""Units of recordings, converted to SI when they are read. Every other number of sprung is SI and carries no unit."""

from __future__ import annotations

import re

from sprung.errors import did_you_mean

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall, m/s² (CGPM 1901): the unit g, and gravity in the model."""

_ACCELERATION = {
    "m/s^2": 1.0,
    "g": STANDARD_GRAVITY,
    "mg": 1e-3 * STANDARD_GRAVITY,
    "mm/s^2": 1e-3,
    "cm/s^2": 1e-2,
    "gal": 1e-2,
    "ft/s^2": 0.3048,
    "in/s^2": 0.0254,
}
_BRACKETS = re.compile(r"^(?P<name>.*\S)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))$", re.DOTALL)
_SPELLINGS = {
    "m/s/s": "m/s^2",
    "ms-2": "m/s^2",
    "m*s-2": "m/s^2",
    "ms^-2": "m/s^2",
    "m*s^-2": "m/s^2",
    "g_n": "g",
    "g0": "g",
    "g_0": "g",
    "gn": "g",
}


def acceleration_factor(text: str) -> float:
    """Return the factor that converts a reading to m/s².

    Parameters
    ----------
    text
        Unit of acceleration as loggers write it: ``m/s²``, ``m/s^2``, ``g``, ``mg``, ``mm/s2``, ``ft/s^2``...

    Returns
    -------
    float
        m/s² per unit.

    Raises
    ------
    ValueError
        If it is no unit of acceleration; the message states the nearest one.

    Examples
    --------
    >>> acceleration_factor("m/s²"), acceleration_factor("[g]")
    (1.0, 9.80665)
    """
    plain = text.strip().strip("[]()").replace(" ", "").replace("²", "^2").replace("**", "^").replace("·", "*")
    plain = plain.replace("⁻", "-").lower()
    if plain.endswith("s2"):
        plain = plain[:-1] + "^2"
    plain = _SPELLINGS.get(plain, plain)
    if plain not in _ACCELERATION:
        raise ValueError(f"'{text}' is not a unit of acceleration. {did_you_mean(text, _ACCELERATION)}")
    return _ACCELERATION[plain]


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
        acceleration: ``body (left)`` is a name.

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
    try:
        acceleration_factor(match["round"])
    except ValueError:
        return text.strip(), None
    return match["name"], match["round"].strip()
