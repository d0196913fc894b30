"""Excitation that displacements show: dropped from blocks, pushed, held and let go, or driven over a bump.

Off blocks a wheel falls as far as the body above it. Where the body alone is held, the wheel below rises by no more than its
tyre is relieved, and the suspension is longer, or shorter, before the release than after it. By hand a body is pushed slowly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sprung.drafting.detected_release import DetectedRelease
from sprung.drafting.excitation_names import UnpaddedExcitation, excitation_named
from sprung.drafting.layout_names import wheels_in_part
from sprung.drafting.records import DraftSensor
from sprung.vehicle import WHEELS, VehicleModel, Wheel

_SHARE = 0.5
"""Part of the largest fall from which a channel falls too, and part of the body's fall from which a wheel falls off a block."""

_HELD = 0.15
"""Part of the largest swing by which the rest before a release differs from that after it, where something was held."""

_BLOCK = 0.01
"""m that a wheel falls at least off a block, where no sensor is on the body."""

_FAST = 0.3
"""m/s at which a suspension begins to move if a wheel falls off a block, 1 m/s, or meets a bump, and not by hand, 0.1 m/s."""


@dataclass(frozen=True)
class ClassifiedExcitation:
    """What excited a vehicle in a release.

    Attributes
    ----------
    excitation
        None where it is not known.
    moved
        The sensors over, or on, the wheels that fell or between which the body was held or pushed.
    why
        In words.
    is_rough
        Whether the wheels follow only from how far the vehicle swings, so that the name of a recording knows them better.
    """

    excitation: UnpaddedExcitation | None
    moved: tuple[DraftSensor, ...]
    why: str
    is_rough: bool = False


def classify_excitation(release: DetectedRelease, sensors: Sequence[DraftSensor], path: str) -> ClassifiedExcitation:
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
    ClassifiedExcitation
    """
    own = [sensor for sensor in sensors if sensor.quantity == "displacement" and sensor.channel in release.channels]
    own = [
        sensor for sensor in own if sensor.unit is not None
    ] or own  # of unknown units only those of the same compare
    body, wheel, travel = (
        _motion_of(release, [sensor for sensor in own if is_one(sensor)])
        for is_one in (_is_on_body, _is_on_wheel, _is_travel)
    )
    found = _classify_held(body, wheel, travel)
    if found is None and not any(motion.is_held for motion in (body, wheel, travel)):
        found = _classify_at_rest(body, wheel) if body.sensors else _classify_by_onset(travel)
    if found is not None:
        return found
    named = excitation_named(path)
    moved = next((motion.moved for motion in (body, wheel) if motion.is_held), ())
    if named is not None:
        return ClassifiedExcitation(named, moved, f"{named} by the name of the recording")
    return ClassifiedExcitation(None, moved, "what excited the vehicle does not show")


def _classify_held(body: _Motion, wheel: _Motion, travel: _Motion) -> ClassifiedExcitation | None:
    """Classify the excitation of a vehicle that rests at another level before the release than after it."""
    if body.is_held and 0 < _SHARE * body.size <= wheel.size:
        why = f"wheels fall by {1e3 * wheel.size:.3g} mm, the body by {1e3 * body.size:.3g} mm"
        return ClassifiedExcitation("drop", wheel.moved, why)
    if body.is_held and (wheel.sensors or travel.is_held):
        below = f", the wheels by no more than {1e3 * abs(wheel.size):.2g} mm" if wheel.sensors else ""
        how = "held" if body.size > 0 else "pressed down"
        said = f"{how} {1e3 * abs(body.size):.3g} mm off its rest and let go{below}: no wheel falls off a block"
        return ClassifiedExcitation("push", body.moved, f"the body is {said}")
    if travel.is_held:
        said = f"a suspension is {1e3 * abs(travel.size):.3g} mm {'longer' if travel.size > 0 else 'shorter'}"
        why = f"{said} before the release than after it: the body was held and let go"
        return ClassifiedExcitation("push", travel.moved, why)
    in_metres = bool(wheel.sensors) and wheel.sensors[0].unit is not None
    if in_metres and wheel.is_held and wheel.size >= _BLOCK and not body.sensors:
        return ClassifiedExcitation("drop", wheel.moved, f"wheels fall by {1e3 * wheel.size:.3g} mm")
    return None


def _classify_at_rest(body: _Motion, wheel: _Motion) -> ClassifiedExcitation:
    """Classify the excitation of a vehicle whose body rests at the same level before and after it."""
    level = "the body rests at the same level before and after"
    if wheel.swing < _SHARE * body.swing:
        why = f"{level}{', and the wheels swing less' if wheel.sensors else ''}: pushed by hand"
        return ClassifiedExcitation("push", body.swinging, why, is_rough=True)
    return ClassifiedExcitation(
        "pass", wheel.swinging, f"{level}, and the wheels swing as far: over a bump", is_rough=True
    )


def _classify_by_onset(travel: _Motion) -> ClassifiedExcitation | None:
    """Classify the excitation of a vehicle whose suspensions rest at the same length before and after it."""
    fastest = max(map(abs, travel.onsets), default=0.0)
    if not fastest or travel.sensors[0].unit is None:
        return None
    begins = f"the suspensions rest at the same length before and after, and begin to move at {fastest:.2g} m/s"
    if fastest < _FAST:
        return ClassifiedExcitation("push", travel.swinging, f"{begins}: pushed by hand", is_rough=True)
    onsets = dict(zip(travel.sensors, travel.onsets, strict=True))
    fast = tuple(sensor for sensor, onset in onsets.items() if abs(onset) >= _SHARE * fastest)
    if min(onsets[sensor] for sensor in fast) > 0:
        return ClassifiedExcitation("drop", fast, f"{begins} in rebound: wheels fall off blocks")
    why = f"{begins} in compression, if they read positive in rebound: over a bump"
    return ClassifiedExcitation("pass", travel.swinging, why, is_rough=True)


@dataclass(frozen=True)
class _Motion:
    """How the sensors of one kind move in a release."""

    sensors: tuple[DraftSensor, ...]
    """All of them."""
    size: float
    """The largest fall, m; negative where they rise."""
    is_held: bool
    """Whether the rest before the release is another than that after it."""
    moved: tuple[DraftSensor, ...]
    """The sensors that fall about as far."""
    swing: float
    """The largest, m."""
    swinging: tuple[DraftSensor, ...]
    """The sensors that swing about as far."""
    onsets: tuple[float, ...]
    """Largest speed directly after the release, with the sign of the first motion, m/s; of each."""


def _motion_of(release: DetectedRelease, sensors: Sequence[DraftSensor]) -> _Motion:
    falls, swings, onsets = release.of([sensor.channel for sensor in sensors])
    signs = np.array([-1.0 if sensor.direction == "down" else 1.0 for sensor in sensors])
    falls, onsets = falls * signs, onsets * signs
    size = float(falls[np.argmax(np.abs(falls))]) if falls.size else 0.0
    is_held = bool(falls.size) and abs(size) > _HELD * float(swings.max(initial=0.0))
    alike = falls * np.sign(size) >= _SHARE * abs(size)
    moved = tuple(sensor for sensor, like in zip(sensors, alike, strict=True) if like)
    swing = float(swings.max(initial=0.0))
    swinging = tuple(sensor for sensor, own in zip(sensors, swings, strict=True) if own >= _SHARE * swing)
    return _Motion(tuple(sensors), size, is_held, moved, swing, swinging, tuple(onsets.tolist()))


def _is_on_body(sensor: DraftSensor) -> bool:
    return sensor.on == "body" and not sensor.is_travel


def _is_on_wheel(sensor: DraftSensor) -> bool:
    return sensor.on not in ("body", None) and "pad" not in str(sensor.on)


def _is_travel(sensor: DraftSensor) -> bool:
    return sensor.is_travel


def wheels_of_excitation(
    found: ClassifiedExcitation, stations: Mapping[str, Wheel | None], hint: Sequence[Wheel], model: VehicleModel
) -> tuple[tuple[Wheel, ...], str]:
    """Return the wheels that fell, or between which the body was held, and how they are known.

    Parameters
    ----------
    found
        What excited the vehicle, with the sensors that moved most.
    stations
        Wheel station by channel.
    hint
        Wheels of a whole vehicle that the name of the recording states.
    model
        Which part of a vehicle it is.
    """
    seen = {stations[sensor.channel] for sensor in found.moved}
    named = wheels_in_part(hint, model)
    if not seen or None in seen or (found.is_rough and named):
        return named, "wheels by the name of the recording" if named else ""
    wheels = tuple(wheel for wheel in wheels_in_part(WHEELS, model) if wheel in seen)
    if found.is_rough:
        return wheels, "wheels by how far the vehicle swings"
    return wheels, f"though the name of the recording states {', '.join(named)}" if named and set(named) != seen else ""
