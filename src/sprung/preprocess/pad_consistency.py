"""Statements about the sensors of pads that the recordings contradict: units, signs, exchanged pads, pads that move.

Only what holds for every vehicle is used (`sprung.preprocess.pad_response`): between the modes of the body and wheel hop a
wheel follows its own pad, and the force of a pad leads its displacement.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import DropTest, Recording
from sprung.errors import Fault
from sprung.preprocess.gravity import scale_recording
from sprung.preprocess.pad_response import PadResponse, displacements_of_pads, estimate_pad_responses
from sprung.preprocess.pads import find_moving_pads, is_on_pads
from sprung.units import STANDARD_GRAVITY, UNITS, si_factor
from sprung.vehicle import STATIONS, Sensor, Wheel

Real = NDArray[np.float64]

_OFF = 5.0
"""Ratio from which it is another unit. In the band a wheel moves by 0.4 to 1.6 times its pad, in sixty vehicles from microcar
to lorry, and the two pads of an axle, whose tyres are alike, differ in dynamic stiffness as its wheel loads do."""

_NEAR = 2.0
"""Ratio within which a unit explains what was found, for the same reason."""

_UPRIGHT = 0.5
"""Part of gravity from which the mean reading of an accelerometer shows which way up it is."""

_LAGS = 0.5
"""Imaginary part over absolute value of a dynamic stiffness by which it is negative beyond doubt: the two channels would
have to be late against each other by more than a twelfth of a period, 20 ms, for a sound sensor to show it."""


def add_moving_pads(drop: DropTest, sensors: Sequence[Sensor]) -> DropTest:
    """Add the pads that move to the wheels of a test on pads.

    Parameters
    ----------
    drop
        With its recording.
    sensors
        One for each channel.

    Returns
    -------
    DropTest
        With a fault in its recording where pads move that are not among its wheels.
    """
    measured = [pad for pad in displacements_of_pads(sensors) if drop.recording.usable[pad.channel]]
    if not is_on_pads(drop) or not measured or not drop.wheels:
        return drop
    values = drop.recording.values[[pad.channel for pad in measured]]
    moving = [pad for pad, moves in zip(measured, find_moving_pads(values).tolist(), strict=True) if moves]
    more = [pad for pad in moving if pad.wheel not in drop.wheels]
    if not more:
        return drop
    wheels = tuple(wheel for wheel in STATIONS if wheel in drop.wheels or any(wheel == pad.wheel for pad in more))
    sizes = [
        f"{drop.recording.channels[pad.channel]} by {1e3 * float(np.ptp(drop.recording.values[pad.channel])):.2g} mm"
        for pad in more
    ]
    what = (
        f"the pads under {', '.join(pad.wheel for pad in more)} move too (peak to peak: {', '.join(sizes)}), the campaign "
        f"states {', '.join(drop.wheels)}; all of these are used"
    )
    do = f"Write wheels = {list(wheels)} for this drop, unless channels of pads are exchanged.".replace("'", '"')
    fault = Fault("wheels", drop.recording.name, what, do)
    recording = replace(drop.recording, faults=(*drop.recording.faults, fault))
    return replace(drop, recording=recording, wheels=wheels)


def check_pad_sensors(drops: Sequence[DropTest], sensors: Sequence[Sensor]) -> list[Recording]:
    """Correct units and signs of pads' sensors that the motion of the wheels contradicts, and report what cannot be corrected.

    Parameters
    ----------
    drops
        With their recordings; those on pads are examined.
    sensors
        One for each channel.

    Returns
    -------
    list of Recording
        The first one on pads with a fault for each channel that was changed, and for pads or wheels that are exchanged.
    """
    on_pads = [drop for drop in drops if is_on_pads(drop)]
    responses = estimate_pad_responses(on_pads, sensors)
    if not responses:
        return [drop.recording for drop in drops]
    wheels = {sensors[own.channel].wheel: own for own in responses if sensors[own.channel].reads_gravity}
    followed = {wheel: own for wheel, own in wheels.items() if wheel is not None}
    faults = list(_exchanged(followed, sensors))
    if not faults:
        channels = {pad.wheel: pad.channel for pad in displacements_of_pads(sensors)}
        level = np.nanmean([drop.recording.values.mean(axis=1) for drop in on_pads], axis=0)
        factors = np.ones(len(sensors))
        upright = {wheel: own for wheel, own in followed.items() if level[own.channel] > _UPRIGHT * STANDARD_GRAVITY}
        for wheel, own in upright.items():
            gain, sensor = _own_gain(own, wheel), sensors[channels[wheel]]
            factors[channels[wheel]], found = _judge_displacement(gain, sensor, sensors[own.channel])
            faults += found
        forces = {pad: own for own in responses if (pad := sensors[own.channel].pad) is not None}
        stiffness = {
            wheel: _own_gain(own, wheel) / factors[channels[wheel]]
            for wheel, own in forces.items()
            if wheel in upright and own.strongest == wheel and np.isfinite(factors[channels[wheel]])
        }
        for wheel, own in stiffness.items():
            others = {each: abs(other) for each, other in stiffness.items() if each != wheel}
            channel = forces[wheel].channel
            factors[channel], found = _judge_force(wheel, own, others, sensors[channel])
            faults += found
        drops = [replace(drop, recording=scale_recording(drop.recording, factors)) for drop in drops]
    first = next(n for n, drop in enumerate(drops) if is_on_pads(drop))
    recordings = [drop.recording for drop in drops]
    recordings[first] = replace(recordings[first], faults=(*recordings[first].faults, *faults))
    return recordings


def _own_gain(response: PadResponse, wheel: Wheel) -> complex:
    """Return the gain of a channel for the pad under its own wheel."""
    return complex(response.gain[response.to.index(wheel)])


def _exchanged(followed: Mapping[Wheel, PadResponse], sensors: Sequence[Sensor]) -> Iterator[Fault]:
    """Yield the fault that wheels follow other pads than their own."""
    wrong = {wheel: own for wheel, own in followed.items() if own.strongest != wheel}
    if not wrong:
        return
    channels = {pad.wheel: sensors[pad.channel].channel for pad in displacements_of_pads(sensors)}
    found = "; ".join(
        f"{sensors[own.channel].channel}, stated on {wheel}, follows {channels[own.strongest]}, stated on pad {own.strongest}"
        for wheel, own in wrong.items()
    )
    what = f"{found}: every wheel follows the pad under it. Nothing was changed"
    names = ", ".join(sensors[own.channel].channel for own in wrong.values())
    do = "Exchange the places of these pads' sensors, or of these wheels' sensors, in the campaign file, whichever is wrong."
    yield Fault("exchanged", names, what, do)


def _judge_displacement(gain: complex, sensor: Sensor, wheel: Sensor) -> tuple[float, list[Fault]]:
    """Return the factor that corrects a pad's displacement, NaN where it cannot be used, and the faults that say so."""
    faults, sign = [], 1.0
    if gain.real < -_LAGS * abs(gain):
        sign = -1.0
        what = f"{wheel.channel}, the wheel on this pad, moves down when it reads up; its sign was reversed"
        faults.append(_sign_fault(sensor, what))
    if 1 / _OFF < abs(gain) < _OFF:
        return sign, faults
    factor, remedy = _unit_factor(sensor, abs(gain))
    what = (
        f"{wheel.channel}, the wheel on this pad, moves {abs(gain):.3g} times as far as it reads, expected about once"
    )
    return sign * factor, [*faults, _unit_fault(sensor, what, factor, remedy)]


def _judge_force(
    wheel: Wheel, stiffness: complex, others: Mapping[Wheel, float], sensor: Sensor
) -> tuple[float, list[Fault]]:
    """Return the factor that corrects the force of a pad, NaN where it cannot be used, and the faults that say so."""
    faults, sign = [], 1.0
    if stiffness.imag < -_LAGS * abs(stiffness):
        sign = -1.0
        what = "the force lags its pad's displacement, as if the vehicle gave out energy; its sign was reversed"
        faults.append(_sign_fault(sensor, what))
    sizes = list(others.values())
    opposite = next((size for each, size in others.items() if STATIONS[each].axle == STATIONS[wheel].axle), None)
    # Two pads that differ do not tell which of them is wrong: a third one does.
    if opposite is None or len(sizes) < 2 or max(sizes) > _OFF * min(sizes):
        return sign, faults
    if min(sizes) / _OFF < abs(stiffness) < _OFF * max(sizes):
        return sign, faults
    factor, remedy = _unit_factor(sensor, opposite / abs(stiffness))
    what = f"{abs(stiffness):.3g} N/m between force and displacement of its pad, {opposite:.3g} N/m at the opposite pad"
    return sign * factor, [*faults, _unit_fault(sensor, what, factor, remedy)]


def _sign_fault(sensor: Sensor, what: str) -> Fault:
    direction = "down" if sensor.direction == "up" else "up"
    return Fault("sign", sensor.channel, what, f'Set direction = "{direction}" for it in the campaign file.')


def _unit_fault(sensor: Sensor, what: str, factor: float, remedy: str) -> Fault:
    done = f"multiplied by {factor:g}" if np.isfinite(factor) else "the channel is left out"
    return Fault("unit", sensor.channel, f"{what}: another unit; {done}", remedy)


def _unit_factor(sensor: Sensor, ratio: float) -> tuple[float, str]:
    """Return the factor of the one unit that explains a ratio of right to read numbers, NaN without one, and the remedy."""
    stated = si_factor(sensor.unit, sensor.quantity) if sensor.unit else None
    if stated is None:  # the file's own unit is not known here
        factor = float(10.0 ** np.round(np.log10(ratio)))
        alike = [(factor, "")] if 1 / _NEAR < ratio / factor < _NEAR else []
    else:
        possible = [(own / stated, name) for name, own in UNITS[sensor.quantity].items()]
        alike = [(factor, name) for factor, name in possible if 1 / _NEAR < ratio / factor < _NEAR]
    if len(alike) != 1 or alike[0][0] == 1:
        return np.nan, "Give the sensor its unit in the campaign file."
    factor, name = alike[0]
    names = {"n": "N", "kn": "kN"}
    return (
        factor,
        f'Set unit = "{names.get(name, name)}" for it.'
        if name
        else "Give the sensor its unit; that of its file is wrong.",
    )
