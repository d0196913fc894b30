"""Excitation that displacements show: dropped from blocks, or held and let go.

Off blocks a wheel falls as far as the body above it. Where the body alone is held, the wheel below rises by no more than its
tyre is relieved, and the suspension is longer, or shorter, before the release than after it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sprung.drafting.detected_release import DetectedRelease
from sprung.drafting.layout_names import wheels_in_part
from sprung.drafting.names import tokens
from sprung.drafting.records import DraftSensor
from sprung.vehicle import WHEELS, VehicleModel, Wheel

_SHARE = 0.5
"""Part of the largest fall from which a channel falls too, and part of the body's fall from which a wheel falls off a block."""

_HELD = 0.15
"""Part of the largest swing by which the rest before a release differs from that after it, where something was held."""

_BLOCK = 0.01
"""m that a wheel falls at least off a block, where no sensor is on the body."""

_NAMED: Mapping[str, frozenset[str]] = {
    "push": frozenset(
        ("push", "pushed", "pull", "pulled", "quick", "snap", "gedrückt", "gezogen", "anstossen", "wippen", "loslassen")
    ),
    "drop": frozenset(("drop", "dropped", "block", "blocks", "fall", "abwurf", "fallversuch", "klotz", "klötze")),
}  # fmt: skip

Excitation = Literal["drop", "push"]


def classify_excitation(
    release: DetectedRelease, sensors: Sequence[DraftSensor], path: str
) -> tuple[Excitation | None, tuple[DraftSensor, ...], str]:
    """Classify what excited a vehicle in a release.

    Parameters
    ----------
    release
        What the displacements show.
    sensors
        Of the campaign.
    path
        Name of the recording, with its folders; used only where the displacements leave it open.

    Returns
    -------
    excitation
        None where it is not known.
    moved
        The sensors over, or on, the wheels that fell or between which the body was held.
    why
        In words.
    """
    own = [sensor for sensor in sensors if sensor.quantity == "displacement" and sensor.channel in release.channels]
    own = [
        sensor for sensor in own if sensor.unit is not None
    ] or own  # of unknown units only those of the same compare
    body, wheel, travel = (
        _fall_of(release, [sensor for sensor in own if is_one(sensor)])
        for is_one in (_is_on_body, _is_on_wheel, _is_travel)
    )
    if body.is_held and 0 < _SHARE * body.size <= wheel.size:
        return "drop", wheel.moved, f"wheels fall by {1e3 * wheel.size:.3g} mm, the body by {1e3 * body.size:.3g} mm"
    if body.is_held and (wheel.sensors or travel.is_held):
        below = f", the wheels by no more than {1e3 * abs(wheel.size):.2g} mm" if wheel.sensors else ""
        how = "held" if body.size > 0 else "pressed down"
        said = f"{how} {1e3 * abs(body.size):.3g} mm off its rest and let go{below}: no wheel falls off a block"
        return "push", body.moved, f"the body is {said}"
    if travel.is_held:
        said = f"a suspension is {1e3 * abs(travel.size):.3g} mm {'longer' if travel.size > 0 else 'shorter'}"
        return "push", travel.moved, f"{said} before the release than after it: the body was held and let go"
    if wheel.is_held and wheel.size >= _BLOCK and wheel.sensors[0].unit is not None and not body.sensors:
        return "drop", wheel.moved, f"wheels fall by {1e3 * wheel.size:.3g} mm"
    words = tokens(path)
    named = [kind for kind, names in _NAMED.items() if any(word in names for word in words)]
    moved = next((group.moved for group in (body, wheel) if group.is_held), ())
    if len(named) == 1:
        return ("push" if named[0] == "push" else "drop"), moved, f"{named[0]} by the name of the recording"
    return None, moved, "what excited the vehicle does not show"


@dataclass(frozen=True)
class _Fall:
    """How far the sensors of one kind fall in a release."""

    sensors: tuple[DraftSensor, ...]
    """All of them."""
    size: float
    """The largest fall, m; negative where they rise."""
    is_held: bool
    """Whether the rest before the release is another than that after it."""
    moved: tuple[DraftSensor, ...]
    """The sensors that fall about as far."""


def _fall_of(release: DetectedRelease, sensors: Sequence[DraftSensor]) -> _Fall:
    falls, swings = release.of([sensor.channel for sensor in sensors])
    falls = falls * np.array([-1.0 if sensor.direction == "down" else 1.0 for sensor in sensors])
    size = float(falls[np.argmax(np.abs(falls))]) if falls.size else 0.0
    is_held = bool(falls.size) and abs(size) > _HELD * float(swings.max(initial=0.0))
    alike = falls * np.sign(size) >= _SHARE * abs(size)
    moved = tuple(sensor for sensor, like in zip(sensors, alike, strict=True) if like)
    return _Fall(tuple(sensors), size, is_held, moved)


def _is_on_body(sensor: DraftSensor) -> bool:
    return sensor.on == "body" and not sensor.is_travel


def _is_on_wheel(sensor: DraftSensor) -> bool:
    return sensor.on not in ("body", None) and "pad" not in str(sensor.on)


def _is_travel(sensor: DraftSensor) -> bool:
    return sensor.is_travel


def wheels_of_excitation(
    moved: Sequence[DraftSensor], stations: Mapping[str, Wheel | None], hint: Sequence[Wheel], model: VehicleModel
) -> tuple[tuple[Wheel, ...], str]:
    """Return the wheels that fell, or between which the body was held, and how they are known.

    Parameters
    ----------
    moved
        Sensors that moved most.
    stations
        Wheel station by channel.
    hint
        Wheels of a whole vehicle that the name of the recording states.
    model
        Which part of a vehicle it is.
    """
    seen = {stations[sensor.channel] for sensor in moved}
    named = wheels_in_part(hint, model)
    if not seen or None in seen:
        return named, "wheels by the name of the recording" if named else ""
    wheels = tuple(wheel for wheel in wheels_in_part(WHEELS, model) if wheel in seen)
    against = f"though the name of the recording states {', '.join(named)}" if named and set(named) != seen else ""
    return wheels, against
