"""Contact: which samples the tyres were on the ground for, told by the fitted vehicle.

Before a fit, the accelerometers say roughly when the last tyre has come down for good. A fitted vehicle says it exactly:
carried backward and forward from its state at the start of a decay, it shows how far each tyre is compressed, and free
vibration begins where the last one last touched. What lies between is where wheel hop is largest and tells most.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.identification.summit import Summit
from sprung.prepare import Decay
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import LinearModel

Real = NDArray[np.float64]

_COMPRESSED = 0.01
"""Part of its static compression below which a tyre may have left the ground, the fit being what it is."""

_PASSES = 4

_NO_WORSE = 1.1
"""Noise after moving the starts over noise before, above which the records say that they were not to be moved."""

_BACKWARD = 30.0
"""Powers of e by which a motion may grow on its way back in time: long before, it is no motion of a vehicle."""

_LONGEST = 2.0
"""s after the start of a decay for which wheels may still hop."""

_NEIGHBOURS = 4
"""Samples on each side of which a spline makes a new one."""

_MOST = 0.5
"""Part of a decay that may be given up: a model to which tyres seem to hop for longer is not to be trusted in this."""


def ascend_from_contact(
    decays: Sequence[Decay],
    models: Mapping[str, LinearModel],
    first: Summit,
    again: Callable[[Sequence[Decay], Mapping[str, float]], Summit],
) -> tuple[tuple[Decay, ...], Summit]:
    """Let the fitted vehicle say where each decay begins, and fit again, until it stays with what it said.

    Parameters
    ----------
    decays
        With starts that are certain rather than early.
    models
        Equations of motion by load name.
    first
        Where the fit of these decays ended.
    again
        Fits decays from parameter values, to an expected gain in log-likelihood that is enough.

    Returns
    -------
    decays
        With starts where the last tyre last touched.
    summit
        Where the fit of these decays ends.
    """
    best, found = tuple(decays), first
    settled = False
    for _ in range(_PASSES):
        shifts = _shifts(best, models, found)
        if not any(shifts):
            break
        moved = tuple(decay.moved(shift) for decay, shift in zip(best, shifts, strict=True))
        next_one = again(moved, found.parameters).after(found)
        if np.any(next_one.noise > _NO_WORSE * found.noise):
            break
        best, found, settled = moved, next_one, True
    return best, found if settled else again(best, found.parameters).after(found)


def _shifts(decays: Sequence[Decay], models: Mapping[str, LinearModel], found: Summit) -> list[int]:
    """Give by how many samples the start of each decay has to be moved."""
    shifts = np.zeros(len(decays), dtype=np.int64)
    states = found.states
    for load, rate in {(decay.load, decay.rate) for decay in decays}:
        alike = [i for i, decay in enumerate(decays) if (decay.load, decay.rate) == (load, rate)]
        matrices = models[load].matrices(found.values)
        weight = matrices.M @ np.array([1.0, 0, 0, 1, 1, 1, 1]) * STANDARD_GRAVITY
        static = np.linalg.solve(matrices.K, weight)[3:, None]  # how far the standing vehicle compresses its tyres
        poles, shapes = np.linalg.eig(matrices.state)
        before = max(decays[i].earlier.shape[1] for i in alike)
        after = min(max(decays[i].samples for i in alike), int(_LONGEST * rate))
        exponent = poles[:, None] * np.arange(-before, after) / rate
        powers = np.exp(np.minimum(exponent.real, _BACKWARD) + 1j * exponent.imag)
        for i in alike:
            earlier, samples = decays[i].earlier.shape[1], decays[i].samples
            amplitudes = np.linalg.solve(shapes, states[i])
            motion = ((shapes[3:7] * amplitudes) @ powers[:, before - earlier : before + samples]).real
            loose = np.flatnonzero((static - motion < _COMPRESSED * static).any(axis=0))
            first = int(loose[-1]) + 1 + _wary(decays[i]) if loose.size else 0
            shifts[i] = first - earlier if first - earlier < _MOST * samples else 0
    return shifts.tolist()


def _wary(decay: Decay) -> int:
    """Give samples by which to stay away from the last contact with several loggers.

    One may have taken its sample half a step before the others, and what was interpolated has something of its neighbours.
    """
    return max((1 if clock.share == 1 else round(_NEIGHBOURS / clock.share) for clock in decay.clocks), default=0)
