"""Text of a drafted campaign file: keys in their usual order, findings as comments, placeholders for what is missing."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Sequence
from textwrap import wrap

from sprung.campaign import SCHEMA_LINE, find_placeholders, placeholder
from sprung.drafting.records import DraftCampaign, DraftDrop, DraftSensor

_HEAD = """\
# Drafted by `sprung new` from the recordings in this folder. Go through it from top to bottom: in place of every text that
# begins with TODO write what it asks for; `sprung check` lists those that are left.
# Lengths m, masses kg, times s, angles rad. x forward from the front axle, y left from the centreline, z up from the ground.
schema = 1
"""

_WHEELBASE = placeholder("m, front axle to rear axle, by tape: a number or { value = ..., std = ... }")
_MASS = placeholder(
    "kg, whole vehicle, empty, on the scales: a number or { value = ..., std = ... }; or remove this line"
)
_POSITION = placeholder("[x, y, z], m: forward of the front axle, left of the centreline, above the ground")
_STATION = placeholder("fl, fr, rl or rr: the wheel it sits on")
_UNIT = placeholder("g or m/s^2: its unit, which neither the file nor gravity at rest shows")
_HIGH_PASS = placeholder(
    "Hz, lower limit of the sensor or its amplifier; remove the line if it has none, or it is not known"
)
_ITEMS = placeholder("[ { mass = ..., position = [x, y, z] }, ... ], kg and m, one for each piece of this load")
_WHICH = placeholder(
    "which load? [ { mass = ..., position = [x, y, z] }, ... ], kg and m, one for each piece on the vehicle"
)
_LOAD = placeholder("empty, or the name of the [[load]] that was on the vehicle")
_WHEELS = placeholder("[fl, fr, rl, rr] each in quotes: those that were dropped")

_LOADS = """\
# One [[load]] for each load that was on the vehicle in some of the drops; the load "empty" always exists, and a vehicle that
# was dropped only empty needs none. Weigh each piece, measure where its centre lies, and write:
#
# [[load]]
# name     = "sandbags"                # what the drops call it: load = "sandbags"
# items    = [ { mass = 235, position = [-1.2, 0.4, 1.1] },     # kg; m: forward of the front axle, left, above the ground
#              { mass = 20, on = "fl" } ]                       # a piece on a wheel: fl, fr, rl or rr
# or, when only totals are known, centred on the body, in place of items:
# added    = { mass = 470, I_yy = 1057.5, I_xx = 339.6 }        # kg and kg m²
"""

_KEYS = 9
"""Length of the longest usual key of a section, so that the equals signs stand below each other."""


def campaign_text(draft: DraftCampaign) -> str:
    """Write a campaign file.

    Parameters
    ----------
    draft
        The draft.

    Returns
    -------
    str
        TOML, with a placeholder for everything that the recordings do not show.
    """
    sections = [
        SCHEMA_LINE + _HEAD,
        _vehicle(draft.name),
        *map(_sensor, draft.sensors),
        _LOADS,
        *(_load(name, draft) for name in draft.loads),
        *(_drop(drop) for drop in draft.drops),
    ]
    others = [*_without_drop(draft), *_unread(draft), *_left_out(draft)]
    if others:
        sections.append("\n".join(others) + "\n")
    return "\n".join(sections)


def missing_in(text: str) -> tuple[tuple[str, str], ...]:
    """Return the placeholders of a campaign file: the place, and what to write there.

    Parameters
    ----------
    text
        TOML.
    """
    document = tomllib.loads(text)
    found = []
    for place, what in find_placeholders(document):
        where = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in place).lstrip(".")
        label = ""
        if len(place) > 2 and isinstance(place[1], int):
            entry = document[str(place[0])][place[1]]
            label = next((str(entry[key]) for key in ("channel", "name", "file") if key in entry), "")
        found.append((f"{where} ({label})" if label else where, what))
    return tuple(found)


def _vehicle(name: str) -> str:
    return f"""\
[vehicle]
name      = {_quoted(name)}
wheelbase = {_quoted(_WHEELBASE)}
# cg_height = 0.9                    # optional, of the sprung mass, from the ground; left out, loads count as level with it
# wheel_height, roll_axis_height     # optional, for the geometry of roll
# motion_ratio = {{ spring_front = 0.7, damper_front = 0.68 }}   # optional, spring travel per wheel travel; rear likewise
# identification = "..."             # optional, which specimen it is: registration, chassis number

# [test]                             # optional, for the record: the report shows it, nothing is computed from it
# date     = 2026-11-22              # without quotes
# operator = "..."                   # who did the test
# place    = "..."                   # where it was done
# remarks  = "..."                   # tyre pressures, fuel, weather

[known]                              # measured beforehand: a number (exact) or {{ value, std }}. Any parameter, or:
total_mass = {_quoted(_MASS)}
# front_axle_mass, rear_axle_mass    # kg on the scales, empty: worth more than anything else that can be measured

# [model]                            # optional; left out, sprung decides and says why
# extras = ["friction"]              # exactly these; [] is the plain linear 7-DOF model
"""


def _sensor(sensor: DraftSensor) -> str:
    channel = sensor.channel.removeprefix(f"{sensor.logger} ") if sensor.logger else sensor.channel
    lines = ["[[sensor]]", *map(_comment, sensor.notes), _key("channel", channel)]
    if sensor.logger:
        lines.append(_key("logger", sensor.logger))
    if sensor.on == "body":
        lines.append(_key("on", "body"))
        lines.append(_key("position", _POSITION))
    else:
        lines.append(_key("on", _STATION if sensor.on == "wheel" else sensor.on))
    if sensor.unit is None:
        lines.append(_key("unit", _UNIT))
    elif sensor.unit != sensor.stated_unit:
        lines.append(_key("unit", sensor.unit))
    if sensor.direction == "down":
        lines.append(_key("direction", "down"))
    if sensor.full_scale is not None:
        lines.append(f"# range = {sensor.full_scale:.4g}  # it stays at this reading for some samples: its full scale?")
    if sensor.coupling == "AC":
        lines.append(_key("high_pass", _HIGH_PASS))
    return "\n".join(lines) + "\n"


def _load(name: str, draft: DraftCampaign) -> str:
    own = [drop for drop in draft.drops if drop.load == name]
    why = [_comment("by the names of the recordings")]
    if any(drop.proposed for drop in own):
        said = (
            f"{len(own)} drops swing more slowly than others of the same wheels, as with something on the vehicle: which load "
            'was it? If there was none, remove this section and write load = "empty" in these drops.'
        )
        why = wrap(said, 118, initial_indent="# ", subsequent_indent="# ")
    lines = ["[[load]]", *why]
    lines += [_key("name", name), _key("items", _WHICH if any(drop.proposed for drop in own) else _ITEMS)]
    lines.append(
        "# or, when only totals are known, centred on the body:  added = { mass = ..., I_yy = ..., I_xx = ... }"
    )
    return "\n".join(lines) + "\n"


def _drop(drop: DraftDrop) -> str:
    lines = ["[[drop]]", *wrap("; ".join(drop.notes), 118, initial_indent="# ", subsequent_indent="# ")]
    lines.append(_list("files", drop.files) if len(drop.files) > 1 else _key("file", drop.files[0]))
    if drop.window is not None:
        lines.append(f"{'window':<{_KEYS}}= [{drop.window[0]:.3f}, {drop.window[1]:.3f}]")
    lines.append(_key("load", drop.load or _LOAD))
    lines.append(_list("wheels", drop.wheels) if drop.wheels else _key("wheels", _WHEELS))
    lines.append("# height = 0.05                      # of the blocks, m; optional")
    return "\n".join(lines) + "\n"


def _without_drop(draft: DraftCampaign) -> Iterator[str]:
    for file in draft.files:
        if not file.drops:
            why = file.rejected[0].why if file.rejected else "it shows no motion"
            yield _comment(f"No drop was found in {file.name}: {why}.")


def _unread(draft: DraftCampaign) -> Iterator[str]:
    for name, problems in draft.unreadable.items():
        yield _comment(f"Not read: {name}: {problems[0].found}.")


def _left_out(draft: DraftCampaign) -> Iterator[str]:
    said: dict[tuple[str, str], None] = {}
    for file in draft.files:
        said |= dict.fromkeys(file.left_out.items())
    for channel, why in said:
        yield _comment(f"No sensor: '{channel}': {why}.")


def _key(name: str, value: str) -> str:
    return f"{name:<{_KEYS}}= {_quoted(value)}"


def _list(name: str, values: Sequence[str]) -> str:
    return f"{name:<{_KEYS}}= [{', '.join(map(_quoted, values))}]"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _comment(text: str) -> str:
    return "# " + re.sub(r"[\x00-\x1f\x7f]", " ", text)
