"""Contact: for which samples the tyres of the fitted vehicle are on the ground.

Before a fit, the accelerometers say roughly when the last tyre has come down for good. A fitted vehicle says it exactly:
carried backward and forward from its state at the start of a decay, it shows how far each tyre is compressed, and free
vibration begins where the last one last touched. The samples between have the largest wheel hop, and most information. After a
push or a bump it begins where the fitted vehicle moves freely.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.fit_result import FitResult
from sprung.preprocess import FreeDecay
from sprung.units import STANDARD_GRAVITY
from sprung.vehicle import LinearModel, layout_of

Real = NDArray[np.float64]

_COMPRESSED = 0.01
"""Part of its static compression below which a tyre may have left the ground, the fit being what it is."""

_PASSES = 4

_NO_WORSE = 1.1
"""Noise after moving the starts over noise before, above which they are left where they were."""

_SHOCK, _FAR = 0.03, 5.0
"""s for which a landing may last at most, and times the noise from which a residual is not noise."""

_LONGEST = 2.0
"""s after the start of a decay for which wheels may still hop."""

_NEIGHBOURS = 4
"""Samples on each side of which a spline makes a new one."""

_MOST = 0.5
"""Part of a decay that may be given up: a model to which tyres seem to hop for longer is not to be trusted in this."""


Refit = Callable[[Sequence[FreeDecay], FitResult, Real], FitResult]
"""Fits decays that begin elsewhere: from a fit and the {X, Ẋ} that it has where they begin, (drop, state)."""


def fit_from_contact(
    decays: Sequence[FreeDecay],
    models: Mapping[str, LinearModel],
    first: FitResult,
    again: Refit,
) -> tuple[tuple[FreeDecay, ...], FitResult]:
    """Move the start of each decay to the last contact of its tyres in the fitted vehicle, and fit again until it stays.

    Nothing is fitted where none moves.

    Parameters
    ----------
    decays
        With starts that are certain rather than early.
    models
        Equations of motion by load name.
    first
        The fit of these decays.
    again
        Fits decays that begin elsewhere: from a fit and the {X, Ẋ} that it has where they begin, (drop, state). Counts the
        steps of that fit.

    Returns
    -------
    decays
        With starts where the last tyre last touched.
    fit
        Of these decays; the first one where none has moved.
    """
    best, fit = tuple(decays), first
    earliest = [decay.start - decay.earlier.shape[1] / decay.rate for decay in best]
    for _ in range(_PASSES if first.is_reversible else 1):
        ringing = [_ringing(decay, fit, drop) for drop, decay in enumerate(best)]
        # Once a start is behind what rings, nothing shows that it did.
        earliest = [
            decay.start + samples / decay.rate if samples else before
            for decay, samples, before in zip(best, ringing, earliest, strict=True)
        ]
        shifts = [
            max(shift, round((start - decay.start) * decay.rate))
            for decay, shift, start in zip(best, _shifts(best, models, fit), earliest, strict=True)
        ]
        if not any(shifts):
            break
        moved, refitted = fit_from_start(best, shifts, fit, again)
        if not _is_as_good(refitted, fit):
            # Where no sensor shows the landing, little is left of wheel hop in the first decays: their fit may see the last
            # contact too early, and what it does not explain then is none.
            if any(decay.events.landing is not None for decay in best):
                break
            shifts = _explained(best, shifts, fit)
            if not any(shifts):
                break
            moved, refitted = fit_from_start(best, shifts, fit, again)
            if not _is_as_good(refitted, fit):
                break
        best, fit = moved, refitted
    return best, fit


def fit_from_start(
    decays: Sequence[FreeDecay], shifts: Sequence[int], fit: FitResult, again: Refit
) -> tuple[tuple[FreeDecay, ...], FitResult]:
    """Let decays begin at other samples, and fit them.

    Parameters
    ----------
    decays
        As fitted.
    shifts
        Samples by which each begins later, shape (drop,).
    fit
        Their fit.
    again
        As for `fit_from_contact`.

    Returns
    -------
    decays, fit
        With the other starts.
    """
    states = fit.states.copy()
    for drop, (decay, shift) in enumerate(zip(decays, shifts, strict=True)):
        before = max(-shift, 0)
        states[drop] = fit.motion(drop, before, max(min(shift + 1, decay.samples), 1))[:, 0 if before else -1]
    moved = _shifted(decays, shifts)
    return moved, again(moved, fit, states)


def _shifted(decays: Sequence[FreeDecay], shifts: Sequence[int]) -> tuple[FreeDecay, ...]:
    return tuple(decay.shifted(shift) for decay, shift in zip(decays, shifts, strict=True))


def _is_as_good(refitted: FitResult, fit: FitResult) -> bool:
    # Without noise rounding grows with the records.
    rounding = np.sqrt(refitted.problem.least_variance)
    return bool(np.all(refitted.noise <= _NO_WORSE * np.maximum(fit.noise, rounding)))


def _explained(decays: Sequence[FreeDecay], shifts: Sequence[int], fit: FitResult) -> list[int]:
    """Return the shifts, halved until the fitted vehicle explains the longer decays as it explains the present ones."""
    shifts = list(shifts)
    allowed = _NO_WORSE**2 * (fit.residual_sums @ fit.weights) / [decay.samples for decay in decays]
    while any(shift < 0 for shift in shifts):
        moved = _shifted(decays, shifts)
        found = (fit.residual_sums_of(moved) @ fit.weights) / [decay.samples for decay in moved]
        if not np.any(worse := found > allowed):
            break
        shifts = [int(shift / 2) if bad else shift for shift, bad in zip(shifts, worse.tolist(), strict=True)]
    return shifts


def _shifts(decays: Sequence[FreeDecay], models: Mapping[str, LinearModel], fit: FitResult) -> list[int]:
    """Return the samples by which the start of each decay is to be moved."""
    shifts = []
    compressions = {load: _static_compression(models[load], fit.values) for load in {decay.load for decay in decays}}
    wheels = layout_of(fit.names).wheels_at
    for drop, decay in enumerate(decays):
        if decay.pads:
            shifts.append(0)
            continue
        if decay.is_driven:
            from sprung.estimation.free_start import find_free_start  # noqa: PLC0415 (only a push or a bump needs it)

            shifts.append(find_free_start(fit, drop) if fit.is_reversible else _landing(decay, fit, drop))
            continue
        static = compressions[decay.load][:, None]
        earlier, samples = decay.earlier.shape[1] if fit.is_reversible else 0, decay.samples
        motion = fit.motion(drop, earlier, min(samples, int(_LONGEST * decay.rate)))
        loose = np.flatnonzero((static - motion[wheels] < _COMPRESSED * static).any(axis=0))
        first = int(loose[-1]) + 1 + _interpolated(decay) if loose.size else 0
        landing = 0 if fit.is_reversible else _landing(decay, fit, drop)
        first = max(first, earlier + landing) if landing else first
        shifts.append(first - earlier if first - earlier < _MOST * samples else 0)
    return shifts


def _static_compression(model: LinearModel, values: Real) -> Real:
    """Return how far the standing vehicle compresses its tyres, m, shape (wheel,)."""
    matrices = model.matrices(values)
    return matrices.deflection(matrices.M @ model.heave * STANDARD_GRAVITY)[layout_of(model.names).wheels_at]


def _landing(decay: FreeDecay, fit: FitResult, drop: int) -> int:
    """Return the samples at the start in which the landing is not over: friction reverses too fast for any sampling."""
    residual = np.nan_to_num(fit.residuals[drop][:, : int(_SHOCK * decay.rate)])
    return int(np.max(np.flatnonzero((np.abs(residual) > _FAR * fit.noise[:, None]).any(axis=0)) + 1, initial=0))


def _ringing(decay: FreeDecay, fit: FitResult, drop: int) -> int:
    """Return the samples at the start in which the filter of a logger still rings from what was before; 0 where none does.

    It rings for a few samples, and the fitted vehicle explains all others. Where these are no noise, it differs from the model.
    """
    if decay.pads or decay.is_driven or not fit.is_reversible or fit.autocorrelation_inflation.max() > 1:
        return 0
    return _landing(decay, fit, drop)


def _interpolated(decay: FreeDecay) -> int:
    """Return the samples after the last contact that a slower logger interpolated with samples from before it."""
    slowest = min(decay.rate_ratios, default=1.0)
    return round(_NEIGHBOURS / slowest) if slowest < 1 else 0


def clear_of_splines(decay: FreeDecay) -> FreeDecay:
    """Return a decay in which the channels of slower loggers begin later: their first samples are interpolated.

    Parameters
    ----------
    decay
        Of several loggers.

    Returns
    -------
    FreeDecay
        In which these loggers are delayed by that.
    """
    skips = [round(_NEIGHBOURS / clock.rate_ratio) if clock.rate_ratio < 1 else 0 for clock in decay.clocks]
    whole = np.concatenate([decay.earlier, decay.values], axis=1)
    length, before = whole.shape[1] - max(skips, default=0), decay.earlier.shape[1]
    values = whole[:, :length].copy()
    for clock, skip in zip(decay.clocks, skips, strict=True):
        values[list(clock.channels)] = whole[list(clock.channels), skip : skip + length]
    clocks = tuple(
        replace(clock, offset=clock.offset + skip / decay.rate, delay=clock.delay + skip / decay.rate)
        for clock, skip in zip(decay.clocks, skips, strict=True)
    )
    return replace(decay, earlier=values[:, :before], values=values[:, before:], clocks=clocks)
