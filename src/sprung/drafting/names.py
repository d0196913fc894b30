"""Names of channels and files: wheels, parts, axes and loads in English, in German and in the codes of ISO-MME."""

from __future__ import annotations

import itertools
import re
from pathlib import PurePath
from typing import Literal

from sprung.vehicle import WHEELS, Wheel

_CODES: dict[str, Wheel] = {
    "fl": "fl", "fr": "fr", "rl": "rl", "rr": "rr", "lf": "fl", "rf": "fr", "lr": "rl",
    "vl": "fl", "vr": "fr", "hl": "rl", "hr": "rr", "lv": "fl", "rv": "fr",
}  # fmt: skip
_ENDS = {"f": ("front", "vorn", "vorne", "vorder", "vorderachse", "va"),
         "r": ("rear", "back", "hinten", "hinter", "hinterachse", "ha", "heck")}  # fmt: skip
_SIDES = {"l": ("left", "links", "li", "lh", "lhs"), "r": ("right", "rechts", "rh", "rhs")}
_WHEEL = ("wheel", "whl", "whel", "rad", "radtraeger", "radträger", "hub", "nabe", "knuckle", "upright", "axle", "achse", "axl",
          "achs", "unsprung", "spindle", "carrier", "susp")  # fmt: skip
_BODY = ("body", "aufbau", "karosserie", "chassis", "frame", "rahmen", "sprung", "dom", "dome", "tower", "strut", "cabin",
         "vehc", "kar", "floor", "boden", "sill", "schweller", "seat", "sitz", "roof", "dach")  # fmt: skip
_ALL = ("bounce", "heave", "all", "alle", "four", "vier", "hub", "hubschwingung")
_EMPTY = (
    "empty",
    "leer",
    "unladen",
    "unloaded",
    "unbeladen",
    "ohne",
    "without",
    "kerb",
    "curb",
    "bare",
    "tare",
    "noload",
)
_LOADED = ("loaded", "laden", "beladen", "load", "ladung", "mit", "with", "zuladung", "voll", "full", "gvw", "gewicht",
           "heavy")  # fmt: skip
_PIECES = ("ballast", "sand", "sandbag", "sandbags", "sandsack", "sandsäcke", "sandsaecke", "weights", "bags", "gewichte",
           "plates", "water", "wasser", "dummies", "dummy", "driver", "fahrer", "passengers")  # fmt: skip

_ISO_MME = re.compile(
    r"[0-9A-Z?](?P<position>[0-9A-Z?])(?P<main>[A-Z?]{4})(?P<fine>[0-9A-Z?]{6})(?P<what>[A-Z?]{2})(?P<axis>[XYZRS0?])[A-Z0-9?]"
)
_QUARTERS: dict[str, Wheel] = {"1": "fl", "3": "fr", "4": "rl", "6": "rr"}
"""The positions of ISO/TS 13499 on a vehicle, counted like its seats."""

_FINE = {"LE": "left", "RI": "right", "FR": "front", "RE": "rear", "FL": "fl", "RL": "rl", "RR": "rr"}
"""Its fine locations."""


def tokens(text: str) -> list[str]:
    """Split a name into its words, in small letters: at signs, at capital letters and at numbers.

    Parameters
    ----------
    text
        The name.

    Examples
    --------
    >>> tokens("AxleBodyFL"), tokens("rad_vl [g]"), tokens("Fz12")
    (['axle', 'body', 'fl'], ['rad', 'vl', 'g'], ['fz', '12'])
    """
    text = re.sub(r"([A-Z]{2})([xyz])(?![a-zA-Z])", r"\1 \2", text)  # AccFLz ends in its axis
    return [word.lower() for word in re.findall(r"[A-ZÄÖÜ]+(?![a-zäöü])|[A-ZÄÖÜ]?[a-zäöüß]+|\d+", text)]


def _words(text: str) -> list[str]:
    """Return the tokens, compound ones split: ``wheelfl`` is wheel and fl."""
    words: list[str] = []
    for token in tokens(text):
        glued = re.fullmatch(rf"({'|'.join((*_WHEEL, *_BODY, 'acc', 'a'))})?({'|'.join(_CODES)})([xyz])?", token)
        words += [part for part in glued.groups() if part] if glued else [token]
    pairs = [f"{first}{second}" for first, second in itertools.pairwise(words) if len(first) == len(second) == 1]
    return words + [pair for pair in pairs if pair in _CODES]


def station_named(channel: str) -> Wheel | None:
    """Return the wheel, or the corner of the body, that a channel's name states.

    Parameters
    ----------
    channel
        Its name.

    Returns
    -------
    Wheel or None
        None where it names none, or more than one.

    Examples
    --------
    >>> station_named("Rad_VL"), station_named("body front left"), station_named("ch1"), station_named("AccHRz")
    ('fl', 'fl', None, 'rr')
    """
    code = _ISO_MME.fullmatch(channel.strip().upper())
    if code is not None:
        wheels = _stations([_FINE[part] for part in re.findall(r"..", code["fine"]) if part in _FINE])
        return wheels[0] if len(wheels) == 1 else _QUARTERS.get(code["position"])
    wheels = _stations(_words(channel))
    return wheels[0] if len(wheels) == 1 else None


def _stations(words: list[str]) -> tuple[Wheel, ...]:
    coded = {_CODES[word] for word in words if word in _CODES}
    if not coded:
        ends, sides = _ends(words), _sides(words)
        coded = {wheel for wheel in WHEELS if len(ends) == len(sides) == 1 and wheel[0] in ends and wheel[1] in sides}
    return tuple(wheel for wheel in WHEELS if wheel in coded)


def ends_named(channel: str) -> set[str]:
    """Return the ends of the vehicle, ``f`` and ``r``, that a channel's name states by words."""
    return _ends(_words(channel))


def sides_named(channel: str) -> set[str]:
    """Return the sides of the vehicle, ``l`` and ``r``, that a channel's name states by words."""
    return _sides(_words(channel))


def _ends(words: list[str]) -> set[str]:
    return {end for end, names in _ENDS.items() if any(word in names for word in words)}


def _sides(words: list[str]) -> set[str]:
    alone = {"l": "l", "r": "r"} if _ends(words) else {}
    return {side for side, names in _SIDES.items() if any(word in names or alone.get(word) == side for word in words)}


def part_named(channel: str) -> Literal["body", "wheel"] | None:
    """Return whether a channel's name states the body or a wheel; None where it states neither, or both.

    Parameters
    ----------
    channel
        Its name.
    """
    parts = parts_named(channel)
    return None if len(parts) != 1 else "wheel" if "wheel" in parts else "body"


def parts_named(channel: str) -> set[str]:
    """Return which of body and wheel a channel's name states.

    Parameters
    ----------
    channel
        Its name.
    """
    code = _ISO_MME.fullmatch(channel.strip().upper())
    words = [code["main"].lower()] if code is not None else _words(channel)
    return {part for part, names in (("wheel", _WHEEL), ("body", _BODY)) if any(word in names for word in words)}


def axis_named(channel: str, others: tuple[str, ...]) -> Literal["x", "y", "z"] | None:
    """Return the axis along which a sensor measures, where its name states one and those of its neighbours agree.

    Parameters
    ----------
    channel
        Its name.
    others
        All names of the recording: without a sister called z, x and y may mean anything.
    """
    code = _ISO_MME.fullmatch(channel.strip().upper())
    if code is not None:
        axis = code["axis"].lower()
    else:
        match = re.fullmatch(r"(?P<before>.*?)(?P<axis>[xyzXYZ])(?P<after>[\s\d]*)", channel.strip())
        if match is None or (match["before"] and not re.search(r"[\W_a-zA-Z]$", match["before"])):
            return None
        axis = match["axis"].lower()
        vertical = f"{match['before']}{'z' if match['axis'].islower() else 'Z'}{match['after']}"
        if vertical not in {other.strip() for other in others}:
            return None
    return "x" if axis == "x" else "y" if axis == "y" else "z" if axis == "z" else None


def parts_of(path: str) -> tuple[str, ...]:
    """Return a recording's name without its ending, then the folders that it is in, the innermost first.

    Parameters
    ----------
    path
        Relative to the campaign's folder.
    """
    return (PurePath(path).stem, *reversed(PurePath(path).parts[:-1]))


def load_named(path: str) -> str | None:
    """Return the load that a recording's name states, or else its folders': ``empty``, or its name.

    Parameters
    ----------
    path
        Relative to the campaign's folder.

    Examples
    --------
    >>> load_named("Messung_leer_01.csv"), load_named("ballast/front.csv"), load_named("with_200kg.mf4"), load_named("a.csv")
    ('empty', 'ballast', '200kg', None)
    """
    for part in parts_of(path):
        words = tokens(part)
        mass = re.search(r"(?<!\d)(\d+)\s?_?kg", part.lower())
        if any(word in _EMPTY for word in words) or (mass is not None and int(mass[1]) == 0):
            return "empty"
        if mass is not None:
            return f"{mass[1]}kg"
        named = next((word for word in words if word in _PIECES), None)
        if named is not None:
            return named
        if any(word in _LOADED for word in words):
            return "loaded"
    return None


def wheels_named(path: str) -> tuple[Wheel, ...]:
    """Return the dropped wheels that a recording's name states; none where it states none.

    Parameters
    ----------
    path
        Relative to the campaign's folder.

    Examples
    --------
    >>> wheels_named("empty_pitch_front.csv"), wheels_named("leer/links 2.csv"), wheels_named("test.csv")
    (('fl', 'fr'), ('fl', 'rl'), ())
    """
    words = _words(PurePath(path).stem)
    stations = _stations(words)
    if stations:
        return stations
    ends, sides = _ends(words), _sides(words)
    if len(ends) + len(sides) == 1:
        return tuple(wheel for wheel in WHEELS if wheel[0] in ends or wheel[1] in sides)
    return WHEELS if any(word in _ALL for word in words) else ()
