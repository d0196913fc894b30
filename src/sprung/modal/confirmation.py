"""Confirmation of modes: by many orders of a model, or by a later part of the records."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import InputError
from sprung.modal.methods import identify_modes
from sprung.modal.mode_set import ModeSet, RejectedPole
from sprung.modal.stabilisation import StabilisationDiagram, stabilisation_diagram
from sprung.vibration import Mode

Real = NDArray[np.float64]

_NEAR, _STDS = 0.02, 3.0
"""Part of its frequency, and damping ratio, within which another pole is the same, plus standard uncertainties."""

_LATER = 0.5
"""Time constants of its decay by which the records are shortened to identify a mode again."""


def confirm_modes(
    found: ModeSet, records: Sequence[ArrayLike], rate: float, diagram: StabilisationDiagram | None = None
) -> ModeSet:
    """Return the modes that the records confirm.

    A free decay holds the same modes wherever it begins, and a model of any order that is high enough shows them. What a
    landing, a tyre off the ground or dry friction adds meets neither condition.

    Parameters
    ----------
    found
        Identified from the records.
    records
        Shape (channel, time) each.
    rate
        Samples per second.
    diagram
        Of the same records, if it exists already.

    Returns
    -------
    ModeSet
        Those that are stable in the stabilisation diagram, or that the same method identifies again, within the uncertainties,
        from records that begin half a time constant of the mode's decay later. The others are rejected, with the reason.
    """
    arrays = [np.asarray(record, dtype=float) for record in records]
    stable: list[complex] = []
    with suppress(InputError):  # records too short for a diagram are shortened and identified again
        stable = [cluster.pole for cluster in (diagram or stabilisation_diagram(arrays, rate)).chosen]
    kept, rejected = [], []
    later: dict[int, tuple[Mode, ...]] = {}
    for mode in found:
        if any(_is_same(mode, Mode(pole, mode.shape)) for pole in stable):
            kept.append(mode)
            continue
        skip = max(int(np.ceil(_LATER * rate / max(-mode.pole.real, 1e-9))), 1)
        if skip not in later:
            later[skip] = _identify_again([record[:, skip:] for record in arrays], rate, found.method)
        if any(_is_same(mode, other) for other in later[skip]):
            kept.append(mode)
        else:
            reason = f"it is neither stable in the stabilisation diagram nor identified again {skip / rate:.3g} s later"
            rejected.append(RejectedPole(mode.pole, reason))
    return ModeSet(tuple(kept), (*found.rejected, *rejected), found.method)


def _identify_again(records: Sequence[Real], rate: float, method: str) -> tuple[Mode, ...]:
    try:
        return tuple(identify_modes(records, rate, method))
    except InputError:
        return ()


def _is_same(mode: Mode, other: Mode) -> bool:
    frequency = _NEAR * mode.frequency + _STDS * _combined(mode.frequency_std, other.frequency_std)
    ratio = _NEAR + _STDS * _combined(mode.damping_ratio_std, other.damping_ratio_std)
    difference = abs(mode.frequency - other.frequency), abs(mode.damping_ratio - other.damping_ratio)
    return difference[0] <= frequency and difference[1] <= ratio and other.is_resolved


def _combined(*stds: float | None) -> float:
    known: Iterable[float] = (std for std in stds if std is not None)
    return float(np.hypot.reduce([0.0, *known]))
