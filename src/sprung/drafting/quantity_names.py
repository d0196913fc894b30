"""Names of quantities: what a channel measures, along or about what, and between what, by the words of its name.

Words are English, German, French, Italian and Spanish ones; ``(Filtered)`` and the like say nothing of it.
"""

from __future__ import annotations

from typing import Literal

from sprung.drafting.names import tokens
from sprung.units import Quantity

_ACCELERATION = frozenset(
    ("acc", "accel", "acceleration", "beschl", "beschleunigung", "accelerometer", "accelerazione")
)
_WORDS: dict[Quantity, frozenset[str]] = {
    "angular-rate": frozenset(
        ("gyro", "gyr", "gyroscope", "rate", "drehrate", "nickrate", "wankrate", "rollrate", "pitchrate", "omega", "kreisel",
         "gyromètre", "giroscopio")
    ),
    "force": frozenset(
        ("force", "kraft", "radlast", "loadcell", "wheelload", "forza", "fuerza", "kmd", "kraftmessdose", "fz")
    ),
    "velocity": frozenset(
        ("vel", "velo", "velocity", "geschw", "geschwindigkeit", "vitesse", "velocità", "velocidad")
    ),
    "displacement": frozenset(
        ("disp", "displ", "displacement", "lvdt", "pot", "poti", "potentiometer", "string", "stringpot", "wire", "travel",
         "stroke", "deflection", "weg", "wegaufnehmer", "wegsensor", "seilzug", "federweg", "einfederung", "hubweg", "laser",
         "déplacement", "deplacement", "course", "débattement", "debattement", "spostamento", "corsa", "desplazamiento",
         "recorrido")
    ),
}  # fmt: skip
"""Words by the quantity that they name, in the order in which they decide: a force may be named beside a travel."""

_TRAVEL = frozenset(
    ("travel", "stroke", "susp", "suspension", "federweg", "einfederung", "ausfederung", "rebound", "federbein", "shock",
     "damper", "dämpfer", "daempfer", "stossdämpfer", "débattement", "debattement", "corsa", "relative")
)  # fmt: skip
_PAD = frozenset(
    ("pad", "pads", "plate", "platform", "platte", "plattform", "stempel", "shaker", "actuator", "post", "exciter",
     "wheelload", "radlast", "ground", "prüfstand")
)  # fmt: skip
_PITCH = frozenset(("pitch", "nick", "nicken", "nickrate", "pitchrate", "tangage", "beccheggio", "cabeceo"))
_ROLL = frozenset(("roll", "wank", "wanken", "wankrate", "rollrate", "roulis", "rollio", "balanceo"))
_YAW = frozenset(("yaw", "gier", "gieren", "gierrate", "yawrate", "lacet", "imbardata"))

_NOT_VERTICAL = frozenset(
    ("steer", "steering", "lenk", "lenkung", "lenkwinkel", "gps", "gnss", "distance", "strecke", "altitude", "odometer",
     "longitudinal", "längs", "lateral", "quer", "horizontal", "throttle", "brake", "bremse", "clutch", "engine", "motor",
     "wheelspeed", "raddrehzahl", "drehzahl")
)  # fmt: skip
"""Words of what is driven or steered, not of a motion up and down."""

_INSIDE = frozenset(("damper", "dämpfer", "daempfer", "spring", "feder", "hammer", "strut", "tie", "link"))
"""Words of a force between two parts of the vehicle, or of a hammer."""

_OF_THE_ROAD = frozenset(("km/h", "kph", "rpm"))
"""Units in which speeds on the road and of shafts are stated."""

_AXES: dict[str, Literal["roll", "pitch", "yaw"]] = {"x": "roll", "y": "pitch", "z": "yaw"}


def quantity_named(channel: str) -> Quantity | None:
    """Return the quantity that a channel's name states; None where it states none.

    Parameters
    ----------
    channel
        Its name.

    Examples
    --------
    >>> quantity_named("LVDT 3"), quantity_named("Kraft VL"), quantity_named("gyro_y"), quantity_named("Acc_FL pot")
    ('displacement', 'force', 'angular-rate', 'acceleration')
    """
    words = tokens(channel)
    if any(word in _ACCELERATION for word in words):
        return "acceleration"
    if {"load", "cell"} <= set(words):
        return "force"
    return next((quantity for quantity, names in _WORDS.items() if any(word in names for word in words)), None)


def is_travel_named(channel: str) -> bool:
    """Return whether a channel's name states the travel of a suspension, body relative to wheel.

    Parameters
    ----------
    channel
        Its name.

    Examples
    --------
    >>> is_travel_named("susp travel FL"), is_travel_named("Disp Unsprung LH"), is_travel_named("Federweg VL")
    (True, False, True)
    """
    return any(word in _TRAVEL for word in tokens(channel))


def is_pad_named(channel: str) -> bool:
    """Return whether a channel's name states a pad under a tyre.

    Parameters
    ----------
    channel
        Its name.
    """
    return any(word in _PAD for word in tokens(channel))


def rotation_named(channel: str) -> Literal["roll", "pitch", "yaw"] | None:
    """Return the axis of rotation that the name of a gyroscope states, by a word or by x, y or z; None where it states none.

    Parameters
    ----------
    channel
        Its name.

    Examples
    --------
    >>> rotation_named("pitch rate"), rotation_named("GyroX"), rotation_named("Gierrate"), rotation_named("gyro 2")
    ('pitch', 'roll', 'yaw', None)
    """
    words = tokens(channel)
    by_word: tuple[tuple[Literal["roll", "pitch", "yaw"], frozenset[str]], ...] = (
        ("pitch", _PITCH), ("roll", _ROLL), ("yaw", _YAW),
    )  # fmt: skip
    named = [axis for axis, names in by_word if any(word in names for word in words)]
    named = named or [_AXES[word] for word in words if word in _AXES]
    return named[0] if len(named) == 1 else None


def reason_against_name(channel: str, quantity: Quantity, unit: str | None) -> str | None:
    """Return why a channel measures no motion up and down, no pitch or roll and no force under a tyre, by its name and unit.

    Parameters
    ----------
    channel
        Its name.
    quantity
        What it measures.
    unit
        That its file states; None where it states none.

    Returns
    -------
    str or None
        None where nothing is against it.
    """
    words = tokens(channel)
    strange = next((word for word in words if word in _NOT_VERTICAL), None)
    if strange is not None:
        return f"its name states {strange}"
    if unit is not None and unit.strip().lower() in _OF_THE_ROAD:
        return f"its unit {unit} is that of a speed on the road or of a shaft"
    if quantity == "angular-rate" and rotation_named(channel) == "yaw":
        return "it measures yaw, and a vehicle that is dropped pitches and rolls"
    inside = next((word for word in words if word in _INSIDE), None)
    if quantity == "force" and inside is not None:
        return f"a force of its {inside}; only forces under the tyres are used"
    return None
