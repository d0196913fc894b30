"""One door to all methods of modal identification."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from sprung.errors import Problems, did_you_mean
from sprung.modal.era import eigensystem_realisation
from sprung.modal.modes import Mode
from sprung.modal.svm import state_variable_method

Method = Callable[[Sequence[ArrayLike], float, int | None], tuple[Mode, ...]]
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


METHODS: Mapping[str, Method] = MappingProxyType({"era": eigensystem_realisation, "svm": _svm})
"""The methods, by the name that `identify_modes` takes."""


def identify_modes(
    records: Sequence[ArrayLike], rate: float, method: str = "era", order: int | None = None
) -> tuple[Mode, ...]:
    """Identify the modes common to several free decays of one load; no vehicle model is needed.

    Parameters
    ----------
    records
        One array of shape (channel, time) for each drop, the same channels in each.
    rate
        Samples per second.
    method
        One of `METHODS`: ``era``, eigensystem realisation, good with noise and offsets; ``svm``, the paper's State
        Variable Method, exact without noise.
    order
        How many poles to look for, two for each mode; unless given the method chooses, at most 14.

    Returns
    -------
    tuple of Mode
        Shapes at the channels, without names, in the order of undamped natural frequency.

    Raises
    ------
    InputError
        If there is no such method, or the records cannot be used.
    """
    if method not in METHODS:
        problems = Problems()
        expected = " or ".join(f"'{name}'" for name in METHODS)
        problems.add("identify_modes: method", f"'{method}'", expected, did_you_mean(method, METHODS))
        problems.raise_if_any()
    return METHODS[method](records, rate, order)
