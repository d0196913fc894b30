"""Response of wheels and pad forces to the pads' displacements, between the modes of the body and wheel hop.

There a wheel follows its own pad, whatever the vehicle: its tyre is many times as stiff as what else holds the wheel, and
the wheel is not yet at resonance. And no vehicle gives out energy, so that the force with which a pad presses on the tyre
leads the pad's displacement: the imaginary part of the dynamic stiffness at a pad is positive at every frequency
(passivity; Anderson and Vongpanitlerd, Network Analysis and Synthesis, 1973).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sprung.campaign import DropTest
from sprung.vehicle import Sensor, Wheel

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_BAND = (2.0, 6.0)
"""Hz above the body's modes and below wheel hop, of cars and of lorries."""

_SEPARATE = 0.05
"""Least over largest singular value of the pads' normalised displacements from which the response to each can be told: pads
that all move alike cannot."""

_EXPLAINED = 0.8
"""Part of the power of a channel that the pads' displacements explain at least where their response is clear."""


@dataclass(frozen=True, eq=False)
class PadResponse:
    """Mean frequency response of one channel to the displacements of all pads.

    Attributes
    ----------
    channel
        Position of the channel.
    to
        Wheel stations over the pads.
    gain
        Complex gain for each pad: of an acceleration by the pad's acceleration, dimensionless; of a force by its displacement,
        N/m; shape (pad,).
    share
        Part of the channel's power that each pad explains alone, dimensionless, shape (pad,).
    """

    channel: int
    to: tuple[Wheel, ...]
    gain: Complex
    share: Real

    @property
    def strongest(self) -> Wheel:
        """Wheel station over the pad that explains most."""
        return self.to[int(np.argmax(self.share))]


class PadDisplacement(NamedTuple):
    """A channel that measures a pad's displacement.

    Attributes
    ----------
    channel
        Position of the channel.
    wheel
        Wheel station over the pad.
    """

    channel: int
    wheel: Wheel


def displacements_of_pads(sensors: Sequence[Sensor]) -> tuple[PadDisplacement, ...]:
    """Return the first channel that measures the displacement of each pad.

    Parameters
    ----------
    sensors
        One for each channel.

    Returns
    -------
    tuple of PadDisplacement
    """
    found: dict[Wheel, int] = {}
    for channel, sensor in enumerate(sensors):
        if sensor.pad is not None and sensor.quantity == "displacement":
            found.setdefault(sensor.pad, channel)
    return tuple(PadDisplacement(channel, wheel) for wheel, channel in found.items())


def estimate_pad_responses(
    drops: Sequence[DropTest], sensors: Sequence[Sensor], *, of_body: bool = False
) -> tuple[PadResponse, ...]:
    """Estimate the response of wheels and pad forces to the pads, by least squares over the lines of all tests on pads.

    Parameters
    ----------
    drops
        Tests on pads, with their recordings.
    sensors
        One for each channel.
    of_body
        Whether to estimate the response of the body's accelerometers instead, to which several pads contribute.

    Returns
    -------
    tuple of PadResponse
        Of the accelerometers on wheels and the forces of pads, of which one pad explains most; none where the displacements
        of all pads that move are not measured, or do not differ enough.
    """
    pads = displacements_of_pads(sensors)
    drops = [drop for drop in drops if _measures_all(drop, pads)]
    pads = tuple(pad for pad in pads if any(pad.wheel in drop.wheels for drop in drops))
    if not pads:
        return ()
    lines = [_displacements(drop, pads) for drop in drops]
    inputs = np.concatenate(lines)
    size = np.sqrt((np.abs(inputs) ** 2).sum(axis=0))
    if not size.all() or _is_singular(inputs / size):
        return ()
    responses = (
        _response(drops, lines, pads, channel, sensor)
        for channel, sensor in enumerate(sensors)
        if ((sensor.on == "body" and sensor.reads_gravity) if of_body else _is_over_one_pad(sensor))
    )
    return tuple(own for own in responses if own is not None and (of_body or own.share.max() > _EXPLAINED / 2))


def _is_over_one_pad(sensor: Sensor) -> bool:
    """Return whether a sensor reads what one pad moves or feels."""
    return (sensor.wheel is not None and sensor.reads_gravity) or (
        sensor.pad is not None and sensor.quantity == "force"
    )


def _measures_all(drop: DropTest, pads: Iterable[PadDisplacement]) -> bool:
    """Return whether the displacements of all pads that move are measured."""
    return set(drop.wheels) <= {pad.wheel for pad in pads if drop.recording.usable[pad.channel]}


def _is_singular(inputs: Complex) -> bool:
    singular = np.linalg.svd(inputs, compute_uv=False)
    return bool(len(inputs) < 2 * inputs.shape[1] or singular[-1] < _SEPARATE * singular[0])


def _lines(drop: DropTest, channel: int) -> tuple[Complex, Real]:
    """Return the lines of a channel in the band, and their angular frequencies, shape (line,) each."""
    values, rate = drop.recording.values[channel], drop.recording.rate
    frequencies = np.fft.rfftfreq(values.size, 1 / rate)
    band = (frequencies > _BAND[0]) & (frequencies < _BAND[1])
    lines = np.fft.rfft((values - values.mean()) * np.hanning(values.size))[band] / rate
    return np.asarray(lines), np.asarray(2 * np.pi * frequencies[band], dtype=float)


def _displacements(drop: DropTest, pads: Iterable[PadDisplacement]) -> Complex:
    """Return the lines of the pads' displacements, shape (line, pad); 0 of pads that do not move."""
    moving = (_lines(drop, pad.channel)[0] * (pad.wheel in drop.wheels) for pad in pads)
    return np.asarray(np.nan_to_num(np.array(list(moving))).T)


def _response(
    drops: Sequence[DropTest],
    displacements: Sequence[Complex],
    pads: Sequence[PadDisplacement],
    channel: int,
    sensor: Sensor,
) -> PadResponse | None:
    """Return the response of one channel in the drops in which it can be used; None where the pads do not explain it."""
    used = [(drop, own) for drop, own in zip(drops, displacements, strict=True) if drop.recording.usable[channel]]
    moving = [n for n, pad in enumerate(pads) if any(pad.wheel in drop.wheels for drop, _ in used)]
    if not used or not moving:
        return None
    outputs, inputs = (np.concatenate(parts) for parts in zip(*_pairs(used, channel, sensor), strict=True))
    inputs = inputs[:, moving]
    gain = np.linalg.lstsq(inputs, outputs, rcond=None)[0]
    power = float(np.sum(np.abs(outputs) ** 2))
    rest = float(np.sum(np.abs(outputs - inputs @ gain) ** 2))
    if rest > (1 - _EXPLAINED) * power or not power:
        return None
    share = np.sum(np.abs(inputs * gain) ** 2, axis=0) / power
    return PadResponse(channel, tuple(pads[n].wheel for n in moving), gain, share)


def _pairs(
    drops: Iterable[tuple[DropTest, Complex]], channel: int, sensor: Sensor
) -> Iterator[tuple[Complex, Complex]]:
    """Yield a channel's lines and the pads' displacements, or accelerations, of each drop."""
    for drop, inputs in drops:
        lines, omega = _lines(drop, channel)
        yield lines, (-(omega[:, None] ** 2) * inputs if sensor.reads_gravity else inputs)
