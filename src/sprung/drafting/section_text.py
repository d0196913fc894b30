"""Text of the sections of a drafted campaign file: keys in their usual order, findings as comments, placeholders."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from textwrap import wrap

from sprung.campaign import placeholder
from sprung.display import enumerated
from sprung.drafting.draft_campaign import DraftCampaign
from sprung.drafting.records import DraftDrop, DraftSensor
from sprung.units import UNITS
from sprung.vehicle import LAYOUTS, PADS, VehicleModel

_WHEELBASE = placeholder("m, front axle to rear axle, by tape: a number or { value = ..., std = ... }")
_MASS = placeholder(
    "kg, whole vehicle, empty, on the scales: a number or { value = ..., std = ... }; or remove this line"
)
_POSITION = placeholder("[x, y, z], m: {axes}")
_STATION = placeholder("{wheels}: the wheel it sits on")
_UNIT = placeholder("g or m/s^2: its unit, which neither the file nor gravity at rest shows")
_HIGH_PASS = placeholder(
    "Hz, lower limit of the sensor or its amplifier; remove the line if it has none, or it is not known"
)
_ITEMS = placeholder("[ { mass = ..., position = [x, y, z] }, ... ], kg and m, one for each piece of this load")
_WHICH = placeholder(
    "which load? [ { mass = ..., position = [x, y, z] }, ... ], kg and m, one for each piece on the vehicle"
)
_NUMBER = placeholder(
    "[ { mass = ..., position = [x, y, z] }, ... ], kg and m, one for each piece; its name need not be its mass"
)
_LOAD = placeholder("empty, or the name of the [[load]] that was on the vehicle")
_WHEELS = placeholder("[{wheels}] each in quotes: those that were dropped")
_MOVED = {
    "push": placeholder("[{wheels}] each in quotes: those over which the body was held before it was let go"),
    "pass": placeholder("[{wheels}] each in quotes: those that ran over the bump"),
    "pads": placeholder("[{wheels}] each in quotes: those whose pads moved"),
}
_PLACE = placeholder(
    'body, or {wheels}: the wheel that it is on; or body with relative_to = "{wheel}" from body to wheel'
)
_RELATIVE = placeholder("{wheels}: the wheel to which it measures from the body")
_PAD = placeholder("{pads}: the pad under that tyre")
_OTHER_UNIT = placeholder("{units}: its unit, which the file does not state")
_AXIS = placeholder("pitch (positive nose down) or roll (positive left side up); where it is yaw, remove the sensor")
_EXCITATION = placeholder("drop (off blocks), push (pushed or pulled and let go), pass (over a bump) or pads")

_POSITIONS: Mapping[VehicleModel, str] = {
    "full": "forward of the front axle, left of the centreline, above the ground",
    "pitch-plane": "forward of the front axle; y = 0 in a pitch plane; above the ground",
    "roll-plane": "x = 0 in a roll plane; left of the centreline, right negative; above the ground",
    "quarter": "x = 0 and y = 0 in a quarter car; above the ground",
}

_DEGREES: Mapping[VehicleModel, int] = {model: len(layout.coordinates) for model, layout in LAYOUTS.items()}
"""Degrees of freedom of each part of a vehicle."""

_KEYS = 9
"""Length of the longest usual key of a section, so that the equals signs stand below each other."""


def vehicle_section(name: str, model: VehicleModel) -> str:
    """Return the sections of the vehicle, of the test and of what is known beforehand."""
    layout = LAYOUTS[model]
    own = (
        ""
        if model == "full"
        else f"model     = {_quoted(model)}             # by the places that the sensors' names state\n"
    )
    wheelbase = f"wheelbase = {_quoted(_WHEELBASE)}\n" if layout.pitches else ""
    mass = _MASS if model == "full" else _MASS.replace("whole vehicle, empty", "all on these wheels, empty")
    axles = "# front_axle_mass, rear_axle_mass    # kg on the scales, empty: worth more than anything else that can be measured"
    distance = "# t = 0.75                           # m, half the distance of the springs"
    further = axles + "\n" if layout.pitches else distance + "\n" if layout.rolls else ""
    ratio = (
        "# motion_ratio = { spring_front = 0.7, damper_front = 0.68 }"
        "   # optional, spring travel per wheel travel; rear likewise\n"
    )
    roll = "# wheel_height, roll_axis_height     # optional, for the geometry of roll\n"
    return f"""\
[vehicle]
name      = {_quoted(name)}
{own}{wheelbase}\
# cg_height = 0.9                    # optional, of the sprung mass, from the ground; left out, loads count as level with it
{roll if layout.rolls else ""}{ratio if layout.pitches else ""}\
# identification = "..."             # optional, which specimen it is: registration, chassis number

# [test]                             # optional, for the record: the report shows it, nothing is computed from it
# date     = 2026-11-22              # without quotes
# operator = "..."                   # who did the test
# place    = "..."                   # where it was done
# remarks  = "..."                   # tyre pressures, fuel, weather

[known]                              # measured beforehand: a number (exact) or {{ value, std }}. Any parameter, or:
total_mass = {_quoted(mass)}
{further}
# [model]                            # optional; left out, sprung decides and says why
# extras = ["friction"]              # exactly these; [] is the plain linear {_DEGREES[model]}-DOF model
"""


def sensor_section(sensor: DraftSensor, model: VehicleModel) -> str:
    """Return the section of a sensor."""
    channel = sensor.channel.removeprefix(f"{sensor.logger} ") if sensor.logger else sensor.channel
    lines = ["[[sensor]]", *map(comment, sensor.notes), _key("channel", channel)]
    if sensor.logger:
        lines.append(_key("logger", sensor.logger))
    if sensor.quantity != "acceleration":
        lines.append(_key("quantity", sensor.quantity))
    lines.append(_key("on", _place(sensor, model)))
    lines += _further_place(sensor, model)
    if sensor.unit is None:
        other = _OTHER_UNIT.format(units=enumerated(tuple(UNITS[sensor.quantity]), "or"))
        lines.append(_key("unit", _UNIT if sensor.quantity == "acceleration" else other))
    elif sensor.unit != sensor.stated_unit:
        lines.append(_key("unit", sensor.unit))
    if sensor.direction == "down":
        lines.append(_key("direction", "down"))
    if sensor.full_scale is not None:
        lines.append(f"# range = {sensor.full_scale:.4g}  # it stays at this reading for some samples: its full scale?")
    if sensor.coupling == "AC":
        lines.append(_key("high_pass", _HIGH_PASS))
    return "\n".join(lines) + "\n"


def _place(sensor: DraftSensor, model: VehicleModel) -> str:
    """Return where a sensor is, or what to write there."""
    if sensor.on is None:
        return _in(_PLACE, model)
    if sensor.on == "pad":
        return _in(_PAD, model)
    return _in(_STATION, model) if sensor.on == "wheel" and model != "quarter" else sensor.on


def _further_place(sensor: DraftSensor, model: VehicleModel) -> list[str]:
    """Return the line that states a place or an axis on the body."""
    if sensor.quantity == "angular-rate":
        return [_key("axis", sensor.axis or _AXIS)]
    if sensor.is_travel:
        return [_key("relative_to", sensor.relative_to or _in(_RELATIVE, model))]
    return [_key("position", _POSITION.format(axes=_POSITIONS[model]))] if sensor.on == "body" else []


def _in(text: str, model: VehicleModel) -> str:
    """Return a text with the wheel stations of a part of a vehicle."""
    wheels = LAYOUTS[model].wheels
    pads = [pad for pad, over in PADS.items() if over in wheels]
    return (
        text.replace("[{wheels}]", f"[{', '.join(wheels)}]")
        .replace("{wheels}", enumerated(wheels, "or"))
        .replace("{wheel}", wheels[0])
        .replace("{pads}", enumerated(pads, "or"))
    )


def load_section(name: str, draft: DraftCampaign) -> str:
    """Return the section of a load."""
    own = [drop for drop in draft.drops if drop.load == name]
    why = [comment("by the names of the recordings")]
    if any(drop.proposed for drop in own):
        said = (
            f"{len(own)} drops swing more slowly than others of the same wheels, as with something on the vehicle: which load "
            'was it? If there was none, remove this section and write load = "empty" in these drops.'
        )
        why = wrap(said, 118, initial_indent="# ", subsequent_indent="# ")
    lines = ["[[load]]", *why]
    items = _WHICH if any(drop.proposed for drop in own) else _NUMBER if name.isdecimal() else _ITEMS
    lines += [_key("name", name), _key("items", items)]
    totals = ", ".join(f"{total} = ..." for total in added_totals(draft.model))
    lines.append(f"# or, when only totals are known, centred on the body:  added = {{ {totals} }}")
    return "\n".join(lines) + "\n"


def added_totals(model: VehicleModel) -> tuple[str, ...]:
    """Return the totals by which a load of a part of a vehicle is stated."""
    layout = LAYOUTS[model]
    return ("mass", *["I_yy"] * layout.pitches, *["I_xx"] * layout.rolls)


def drop_section(drop: DraftDrop, draft: DraftCampaign) -> str:
    """Return the section of a drop."""
    lines = ["[[drop]]", *wrap("; ".join(drop.notes), 118, initial_indent="# ", subsequent_indent="# ")]
    files = [draft.path_to(name) for name in drop.files]
    lines.append(_list("files", files) if len(files) > 1 else _key("file", files[0]))
    if drop.window is not None:
        lines.append(f"{'window':<{_KEYS}}= [{drop.window[0]:.3f}, {drop.window[1]:.3f}]")
    lines.append(_key("load", drop.load or _LOAD))
    if drop.excitation != "drop":
        lines.append(_key("excitation", drop.excitation or _EXCITATION))
    which = _in(_MOVED.get(drop.excitation or "drop", _WHEELS), draft.model)
    lines.append(_list("wheels", drop.wheels) if drop.wheels else _key("wheels", which))
    if drop.excitation == "drop":
        lines.append("# height = 0.05                      # of the blocks, m; optional")
    if drop.excitation == "pass":
        lines.append("# speed = 5.0                        # m/s; optional")
    return "\n".join(lines) + "\n"


def _key(name: str, value: str) -> str:
    return f"{name:<{_KEYS}}{' ' * (len(name) > _KEYS)}= {_quoted(value)}"


def _list(name: str, values: Sequence[str]) -> str:
    return f"{name:<{_KEYS}}= [{', '.join(map(_quoted, values))}]"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def comment(text: str) -> str:
    """Return a text as one line of comment."""
    return "# " + re.sub(r"[\x00-\x1f\x7f]", " ", text)
