"""What a channel may measure: what its records beside a vehicle's motion say of its sign, unit, gain, delay and place."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.faults.changes import Change, advanced, described, scaled
from sprung.faults.coupled import of_corners, with_corner
from sprung.faults.heard import ChannelPrediction
from sprung.faults.suspicion import SURE
from sprung.preprocess import is_ac_coupled
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import WHEELS

Real = NDArray[np.float64]

Numbers = tuple[float, ...]

_UNITS = {"g": STANDARD_GRAVITY, "mm/s²": 1e-3, "cm/s²": 1e-2, "mg": STANDARD_GRAVITY / 1000, "ft/s²": 0.3048}
"""m/s² in each unit that may have been taken for m/s², or the other way round."""

_NEAR_UNIT = 0.5
"""Logarithm by which a channel may seem to miss a unit before the vehicle is fitted with it."""

_OF_ONE_KIND = 1.0
"""Logarithm of a gain up to which it is one of calibration or tilt."""

_SILENT = 3.0
"""Times the noise at rest up to which a channel shows nothing."""

_NONE_OF_IT = 0.25
"""Part of the energy that a channel should show, below which it shows none."""

_MIRRORED = 0.1
"""Part of its distance from the centreline by which a sensor may miss its mirrored place."""


@dataclass(frozen=True, eq=False)
class ChannelFaultHypothesis:
    """One reading of what a channel measures.

    Attributes
    ----------
    code
        Of the fault.
    say
        Names the fault, given the numbers and their standard uncertainties, without saying what is done about it.
    residual
        What it leaves of the channel, sum of squares of each decay, shape (decay,).
    put_right
        Makes the channel what it is taken for, given the numbers; None where nothing would.
    done
        What that is called.
    numbers
        What it takes from the records: a part, s, m or Hz.
    stated
        What the campaign file says of the numbers, where it says anything.
    size
        What the channel reads over what it should, given the numbers.
    free
        How many numbers it takes from the records, where these do not say it.
    """

    code: str
    say: Callable[[Numbers, Numbers], Fault]
    residual: Real
    put_right: Callable[[Numbers], Change] | None = None
    done: str = "it is left out"
    numbers: Numbers = ()
    stated: Numbers = ()
    size: Callable[[Numbers], float] = lambda _: 1.0
    free: int = 0


def meanings(heard: ChannelPrediction, noise: float, walks: Real | None = None) -> Iterator[ChannelFaultHypothesis]:
    """List what a channel may measure, the same in all decays.

    Parameters
    ----------
    heard
        The channel beside the motion of a vehicle that was fitted without it.
    noise
        Of it at rest, m/s².
    walks
        Where what the fit with the channel leaves of it walks slowly, the sum of squares of that in each decay, shape
        (decay,); None where it does not.
    """
    stated = heard.row(heard.sensor) @ heard.motion
    shown = float(heard.record @ stated) ** 2 / max(float(stated @ stated), np.finfo(float).tiny)
    quiet = (heard.energy / heard.record.size) ** 0.5 < _SILENT * noise and shown < SURE * noise**2
    if quiet and heard.energy < _NONE_OF_IT * float(stated @ stated):
        yield _unknown(heard, "flat", "it shows nothing where the other channels show motion", 0.0 * heard.record)
        return
    yield from _turned_or_scaled(heard)
    yield _late(heard)
    if all(is_ac_coupled(decay)[heard.channel] for decay in heard.decays):
        yield _coupled_otherwise(heard)
    yield from _other_wheels(heard)
    yield _other_place(heard)
    yield from _left_over(heard, walks)


def _turned_or_scaled(heard: ChannelPrediction) -> Iterator[ChannelFaultHypothesis]:
    channel, name = heard.channel, heard.sensor.channel
    stated = heard.row(heard.sensor) @ heard.motion
    gain = float(heard.record @ stated) / max(float(stated @ stated), np.finfo(float).tiny)
    do = "Describe the sensor the other way up in the campaign file, or turn it over."
    over = Fault("sign", name, "it reads upside down, as the other channels show", do)
    yield ChannelFaultHypothesis(
        "sign", lambda *_: over, heard.left(-stated), lambda _: scaled(channel, -1.0), "it was turned over"
    )
    if not gain > 0:
        return
    for factor, told in _factors():
        if abs(np.log(gain / factor)) < _NEAR_UNIT:
            what = f"it reads {told}, as the other channels show"
            yield _of_unit(Fault("unit", name, what, "Correct its unit in the campaign file."), heard, stated, factor)

    def too_much(numbers: Numbers, _: Numbers) -> Fault:
        size, way = _figures(100 * abs(numbers[0] - 1)), "much" if numbers[0] > 1 else "little"
        what = f"it reads {size} % too {way}, as the other channels show"
        return Fault("gain", name, what, "Check its calibration, that it stands upright, and its unit.")

    if abs(np.log(gain)) < _OF_ONE_KIND:
        yield ChannelFaultHypothesis(
            "gain",
            too_much,
            heard.left(gain * stated),
            lambda numbers: scaled(channel, 1 / numbers[0]),
            "that was put right",
            (gain,),
            (1.0,),
            lambda numbers: numbers[0],
        )


def _of_unit(fault: Fault, heard: ChannelPrediction, stated: Real, factor: float) -> ChannelFaultHypothesis:
    return ChannelFaultHypothesis(
        "unit",
        lambda *_: fault,
        heard.left(factor * stated),
        lambda _: scaled(heard.channel, 1 / factor),
        "that was put right",
        size=lambda _: factor,
    )


def _late(heard: ChannelPrediction) -> ChannelFaultHypothesis:
    row = heard.row(heard.sensor)

    def is_late(numbers: Numbers, _: Numbers) -> Fault:
        size, way = _figures(1000 * abs(numbers[0])), "late" if numbers[0] > 0 else "early"
        what = f"it is {size} ms {way}, as the other channels show"
        do = "Check the delays of the logger and its filters, channel by channel."
        return Fault("late", heard.sensor.channel, what, do)

    late = heard.delay(row)
    left = heard.left(row @ heard.moved(late)[0])
    return ChannelFaultHypothesis(
        "late", is_late, left, lambda numbers: advanced(heard.channel, numbers[0]), "it was moved", (late,), (0.0,)
    )


def _coupled_otherwise(heard: ChannelPrediction) -> ChannelFaultHypothesis:
    """Find the corner of the high-pass through which a channel feels what is stated."""
    corner, stated = heard.corner(), heard.sensor.high_pass or 0.0

    def goes_through(numbers: Numbers, stds: Numbers) -> Fault:
        return of_corners([heard.sensor], numbers, stds)

    def put(numbers: Numbers) -> Change:
        return described(heard.channel, with_corner(heard.sensor, numbers[0]))

    left = heard.left(heard.through(corner))
    return ChannelFaultHypothesis("corner", goes_through, left, put, "that was undone", (corner,), (stated,))


def _other_wheels(heard: ChannelPrediction) -> Iterator[ChannelFaultHypothesis]:
    for wheel in WHEELS:
        if wheel != heard.sensor.on:
            there = replace(heard.sensor, on=wheel, position=None)
            what = f"it shows what the wheel {wheel} does, not {_stated(heard)}"
            fault = Fault(
                "wrong-wheel", heard.sensor.channel, what, "Correct on = ... in the campaign file, or move the sensor."
            )
            put = described(heard.channel, there)
            yield _of_wheel(fault, heard.left(heard.row(there) @ heard.motion), put)


def _of_wheel(fault: Fault, residual: Real, put: Change) -> ChannelFaultHypothesis:
    return ChannelFaultHypothesis("wrong-wheel", lambda *_: fault, residual, lambda _: put, "it was taken to be there")


def _other_place(heard: ChannelPrediction) -> ChannelFaultHypothesis:
    """Find where on the body a channel sits: what it feels is linear in that."""
    sensor = heard.sensor
    here = sensor.position or (0.0, 0.0, 0.0)
    code = "wrong-wheel" if sensor.position is None else "position"
    origin = replace(sensor, on="body", position=(0.0, 0.0, here[2]))
    level = heard.row(origin) @ heard.motion
    tilt = np.stack([-heard.motion[1], heard.motion[2]])
    place = np.linalg.lstsq(tilt.T, heard.record - level, rcond=None)[0]

    def sits(numbers: Numbers, _: Numbers) -> Fault:
        x, y = numbers
        what = f"it shows what the body does at x = {x:.2f} m, y = {y:.2f} m, not {_stated(heard)}"
        if sensor.position is not None and np.hypot(x - here[0], y + here[1]) < _MIRRORED * abs(here[1]):
            what += ": left and right are confused"
        do = "Measure the sensor's place again, and correct it in the campaign file."
        return Fault(code, sensor.channel, what, do)

    def put(numbers: Numbers) -> Change:
        x, y = numbers
        return described(heard.channel, replace(origin, position=(x, y, here[2])))

    residual = heard.left(level + place @ tilt)
    return ChannelFaultHypothesis(
        code,
        sits,
        residual,
        put,
        "it was taken to be there",
        tuple(place.tolist()),
        here[:2] if sensor.position else (),
    )


def _left_over(heard: ChannelPrediction, walks: Real | None) -> Iterator[ChannelFaultHypothesis]:
    """Give what a channel is if it is nothing in particular."""
    if walks is not None:
        fault = Fault(
            "drift",
            heard.sensor.channel,
            "baseline drift, as the other channels show",
            "Let the sensor and the logger warm up before the test, and see that nothing strains the sensor's base.",
        )
        yield ChannelFaultHypothesis("drift", lambda *_: fault, walks)
        return
    what = "it shows something else where the other channels show motion"
    yield _unknown(heard, "unlike-others", what, 0.0 * heard.record)
    row = np.linalg.lstsq(heard.motion.T, heard.record, rcond=1e-9)[0]
    what = "it contradicts the other channels wherever it may sit"
    yield _unknown(heard, "unlike-others", what, row @ heard.motion, len(row))


def _unknown(heard: ChannelPrediction, code: str, what: str, fitted: Real, free: int = 0) -> ChannelFaultHypothesis:
    fault = Fault(code, heard.sensor.channel, what, "Check the sensor, its cable and how it is fastened.")
    return ChannelFaultHypothesis(code, lambda *_: fault, heard.left(fitted), free=free)


def _stated(heard: ChannelPrediction) -> str:
    if heard.sensor.position is None:
        return heard.sensor.on or "a wheel"
    x, y, _ = heard.sensor.position
    return f"x = {x:.2f} m, y = {y:.2f} m"


def _factors() -> Iterator[tuple[float, str]]:
    """Give by how much a channel reads too much where one unit was taken for another, and in words."""
    for unit, si in _UNITS.items():
        yield 1 / si, f"{unit} as if they were m/s²"
        yield si, f"m/s² as if they were {unit}"


def _figures(number: float) -> str:
    return f"{float(f'{number:.2g}'):g}"
