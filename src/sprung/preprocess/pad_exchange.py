"""Exchange of the two pads, or of the two wheels' sensors, of an axle: the body shows which of the two it is.

That wheels follow the opposite pads shows that one or the other is exchanged. Over an axle the body moves more above the
pad that moves than on the other side, as bounce, pitch and roll add up there: by a factor of 1.4 at least in fifty vehicles
from microcar to lorry.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sprung.campaign import DropTest
from sprung.errors import Fault
from sprung.preprocess.pad_consistency import add_moving_pads
from sprung.preprocess.pad_response import PadResponse, estimate_pad_responses
from sprung.preprocess.pads import is_on_pads
from sprung.vehicle import STATIONS, Sensor, Wheel

_CLEAR = 1.2
"""Ratio of its responses to the two pads from which a sensor of the body shows on which side it is: half of the least, in
decibels, of all vehicles tried."""

_APART = 0.5
"""m between front and rear sensors of the body, and between left and right ones, from which they show it."""


def exchange_opposite_channels(drops: Sequence[DropTest], sensors: Sequence[Sensor]) -> list[DropTest]:
    """Exchange the channels of two opposite pads, or wheels, where the recordings show beyond doubt that they are exchanged.

    Parameters
    ----------
    drops
        With their recordings; those on pads are examined.
    sensors
        One for each channel.

    Returns
    -------
    list of DropTest
        With the channels exchanged in all drops, and a fault in the first one on pads.
    """
    on_pads = [add_moving_pads(drop, sensors) for drop in drops if is_on_pads(drop)]
    responses = [own for own in estimate_pad_responses(on_pads, sensors) if sensors[own.channel].wheel is not None]
    crossed = list(_crossed(responses, sensors))
    if not crossed:
        return list(drops)
    of_body = estimate_pad_responses(on_pads, sensors, of_body=True)
    order, faults = np.arange(len(sensors)), []
    for first, second in crossed:
        side = _side_shown_by_body(of_body, sensors, first, second)
        if not side:
            continue
        pairs = list(_channels_at(sensors, first, second, of_pads=side < 0))
        for own, other in pairs:
            order[[own, other]] = other, own
        faults.append(
            _fault([sensors[channel].channel for channels in pairs for channel in channels], of_pads=side < 0)
        )
    if not faults:
        return list(drops)
    noted = next(n for n, drop in enumerate(drops) if is_on_pads(drop))
    exchanged = [
        replace(
            drop.recording,
            values=drop.recording.values[order],
            full_scale=tuple(drop.recording.full_scale[n] for n in order) if drop.recording.full_scale else (),
            faults=(*drop.recording.faults, *(faults if n == noted else ())),
        )
        for n, drop in enumerate(drops)
    ]
    return [replace(drop, recording=recording) for drop, recording in zip(drops, exchanged, strict=True)]


def _crossed(responses: Sequence[PadResponse], sensors: Sequence[Sensor]) -> Iterator[tuple[Wheel, Wheel]]:
    """Yield the wheels of an axle, left and right, of which each follows the pad under the other one."""
    follows = {sensors[own.channel].wheel: own.strongest for own in responses}
    for wheel, pad in follows.items():
        is_left = wheel is not None and wheel != pad and STATIONS[wheel].side > 0
        if wheel and is_left and follows.get(pad) == wheel and STATIONS[pad].axle == STATIONS[wheel].axle:
            yield wheel, pad


def _side_shown_by_body(responses: Sequence[PadResponse], sensors: Sequence[Sensor], left: Wheel, right: Wheel) -> int:
    """Return 1 where the body over an axle moves more on the side of the pad that moves, -1 on the other side, 0 if unclear."""
    placed = [(own, position) for own in responses if (position := sensors[own.channel].position) is not None]
    x = np.array([position[0] for _, position in placed])
    if not x.size or np.ptp(x) < _APART:
        return 0
    middle = (x.min() + x.max()) / 2
    votes = [
        np.sign(y) * np.log(abs(own.gain[own.to.index(left)]) / abs(own.gain[own.to.index(right)]))
        for own, (place, y, _) in placed
        if (place - middle) * STATIONS[left].end > 0 and abs(y) > _APART / 2 and {left, right} <= {*own.to}
    ]
    if not votes or min(np.abs(votes)) < np.log(_CLEAR):
        return 0
    return 1 if min(votes) > 0 else -1 if max(votes) < 0 else 0


def _channels_at(sensors: Sequence[Sensor], first: Wheel, second: Wheel, *, of_pads: bool) -> Iterator[tuple[int, int]]:
    """Yield the channels of the same quantity at two pads, or at two wheels."""
    places = [one.pad if of_pads else one.wheel for one in sensors]
    for own, sensor in enumerate(sensors):
        for other, opposite in enumerate(sensors):
            if places[own] == first and places[other] == second and sensor.quantity == opposite.quantity:
                yield own, other


def _fault(names: Sequence[str], *, of_pads: bool) -> Fault:
    what, which = ("pads", "the wheels over them") if of_pads else ("wheels", "the pads under them")
    found = f"the channels of the two {what} are exchanged, as {which} and the body show; corrected"
    return Fault("exchanged", ", ".join(names), found, "Exchange their places in the campaign file, or their cables.")
