"""One door to all methods of modal identification."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from sprung.errors import Problems, did_you_mean
from sprung.modal.decays import Decays
from sprung.modal.era import eigensystem_realisation
from sprung.modal.identified import Modes, Rejected
from sprung.modal.likelihood import Poles, Stand
from sprung.modal.maximum_likelihood import maximum_likelihood
from sprung.modal.modes import Mode
from sprung.modal.records import as_records
from sprung.modal.svm import state_variable_method

Method = Callable[[Sequence[ArrayLike], float, int | None], tuple[Mode, ...] | Modes]
"""Takes records of shape (channel, time), the sampling rate and the order, None to choose it; gives modes."""

_SVM_STEP = 0.015
"""s between the states of the State Variable Method."""


def _svm(records: Sequence[ArrayLike], rate: float, order: int | None) -> tuple[Mode, ...]:
    """Apply the State Variable Method to as many combinations of channels as half the order."""
    arrays = [np.asarray(record, dtype=float) for record in records]
    channels = arrays[0].shape[0] if arrays and arrays[0].ndim == 2 else 0
    degrees = min(channels, 7) if order is None else (order + 1) // 2
    if order is not None and not 0 < degrees <= channels:
        problems = Problems()
        expected = f"an even number from 2 to {2 * channels}, twice the channels"
        problems.add("svm: order", f"{order}", expected, "Choose it in that range, or leave it out.")
        problems.raise_if_any()
    lag = max(1, round(_SVM_STEP * rate))
    if degrees in (0, channels):
        return tuple(mode for mode in state_variable_method(arrays, rate, lag).modes if mode.pole.real < 0)
    # Eight channels see seven degrees of freedom: the method needs as many outputs as there are degrees of freedom.
    patterns = np.linalg.svd(np.hstack(arrays), full_matrices=False)[0][:, :degrees]
    found = state_variable_method([patterns.T @ record for record in arrays], rate, lag)
    return tuple(Mode(mode.pole, patterns @ mode.shape) for mode in found.modes if mode.pole.real < 0)


METHODS: Mapping[str, Method] = MappingProxyType(
    {"ml": maximum_likelihood, "era": eigensystem_realisation, "svm": _svm}
)
"""The methods, by the name that `identify_modes` takes; the first is the one it takes unless told otherwise."""

DEFAULT = next(iter(METHODS))

_LEAST_PERIODS, _LEAST_DECAY = 2.0, 3.0
"""Periods of a vibration, and powers of e of an overdamped motion, that a record must hold for it to be told."""

_SMALL = 0.05
"""Part of a channel's energy up to which a motion that is too slow for the records is left out instead of refused."""


def identify_modes(records: Sequence[ArrayLike], rate: float, method: str = DEFAULT, order: int | None = None) -> Modes:
    """Identify the modes common to several free decays of one load; no vehicle model is needed.

    Parameters
    ----------
    records
        One array of shape (channel, time) for each drop, the same two or more channels in each.
    rate
        Samples per second.
    method
        One of `METHODS`: ``ml``, the likeliest poles and shapes, with their uncertainty; ``era``, eigensystem realisation;
        ``svm``, the paper's State Variable Method, exact without noise.
    order
        How many poles to look for, two for each mode; unless given the method chooses.

    Returns
    -------
    Modes
        Shapes at the channels, without names, in the order of undamped natural frequency.

    Raises
    ------
    InputError
        If there is no such method, the records cannot be used, or they are shorter than two periods of what they mostly
        show.
    """
    problems = Problems()
    if method not in METHODS:
        expected = " or ".join(f"'{name}'" for name in METHODS)
        problems.add("identify_modes: method", f"'{method}'", expected, did_you_mean(method, METHODS))
        problems.raise_if_any()
    arrays = as_records(records, rate, method)
    if len(arrays[0]) < 2:
        expected = "two or more: shapes are ratios of channels"
        problems.add(f"{method}: records", f"{len(arrays[0])} channel", expected, "Give all channels together.")
    if not any(np.ptp(record, axis=1).any() for record in arrays if record.size):
        problems.add(f"{method}: records", "no motion in any channel", "a free decay", "Look at the recordings.")
    problems.raise_if_any()
    found = METHODS[method](arrays, rate, order)
    modes, rejected = (found.modes, found.rejected) if isinstance(found, Modes) else (found, ())
    kept, slow = _split(modes, Decays.of(arrays, rate))
    return Modes(kept, (*rejected, *slow), method)


def _split(modes: tuple[Mode, ...], decays: Decays) -> tuple[tuple[Mode, ...], tuple[Rejected, ...]]:
    """Leave out modes that are too slow for the records; refuse the records where these are most of them."""
    seconds = float(decays.seconds.max())
    slow = [mode for mode in modes if not _is_told(mode, seconds)]
    if not slow:
        return modes, ()
    poles = Poles.of(
        np.array([mode.pole / decays.rate for mode in modes], dtype=complex),
        np.stack([mode.shape for mode in modes], axis=1),
    )
    shares = Stand.at(decays, poles, 1 / np.maximum(decays.energy.sum(axis=0), 1e-300)).shares
    problems = Problems()
    for mode in slow:
        share = float(shares[:, modes.index(mode)].max())
        if share > _SMALL or len(slow) == len(modes):
            problems.add("records", *_too_short(mode, seconds), "Record longer, or leave that motion out.")
    problems.raise_if_any()
    rejected = tuple(Rejected(mode.pole, " for ".join(_too_short(mode, seconds)[::-1])) for mode in slow)
    return tuple(mode for mode in modes if mode not in slow), rejected


def _is_told(mode: Mode, seconds: float) -> bool:
    if mode.pole.imag == 0:
        return abs(mode.pole) * seconds >= _LEAST_DECAY
    return mode.frequency * seconds >= _LEAST_PERIODS


def _too_short(mode: Mode, seconds: float) -> tuple[str, str]:
    if mode.pole.imag == 0:
        return (
            f"{seconds:.3g} s of a motion that decays in {1 / abs(mode.pole):.3g} s",
            f"at least {_LEAST_DECAY / abs(mode.pole):.3g} s, {_LEAST_DECAY:g} times as long",
        )
    return (
        f"{seconds:.3g} s, {mode.frequency * seconds:.2g} periods of the lowest mode at {mode.frequency:.3g} Hz",
        f"at least {_LEAST_PERIODS / mode.frequency:.3g} s, two periods",
    )
