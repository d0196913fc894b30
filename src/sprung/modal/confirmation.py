"""Whether a mode is one of the structure: it is there at many orders of a model, or again in a later part of the records."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import InputError
from sprung.modal.identified import ModeSet, RejectedPole
from sprung.modal.methods import identify_modes
from sprung.modal.stabilisation import StabilisationDiagram, stabilisation_diagram
from sprung.vibration import Mode

Real = NDArray[np.float64]

_NEAR, _SURE = 0.02, 3.0
"""Part of its frequency, and damping ratio, within which another pole is the same; and standard uncertainties besides."""

_LATER = 0.5
"""Time constants of its decay by which the records begin later for a mode to be found again."""


def confirm_modes(
    found: ModeSet, records: Sequence[ArrayLike], rate: float, diagram: StabilisationDiagram | None = None
) -> ModeSet:
    """Keep the modes that the records confirm.

    A free decay holds the same modes wherever it begins, and a model of any order that is high enough shows them. What a
    landing, a tyre off the ground or dry friction adds does neither.

    Parameters
    ----------
    found
        Identified from the records.
    records
        Shape (channel, time) each.
    rate
        Samples per second.
    diagram
        Of the same records, if it was drawn already.

    Returns
    -------
    Modes
        Those that stay in the stabilisation diagram, or that the same method finds again, within the uncertainties, once the
        records begin later by half a time constant of the mode's decay. The others are rejected, with the reason.
    """
    arrays = [np.asarray(record, dtype=float) for record in records]
    staying: list[complex] = []
    with suppress(InputError):  # of records too short for a diagram the later beginning decides
        staying = [one.pole for one in (diagram or stabilisation_diagram(arrays, rate)).chosen]
    kept, rejected = [], []
    later: dict[int, tuple[Mode, ...]] = {}
    for mode in found:
        if any(_is_same(mode, Mode(pole, mode.shape)) for pole in staying):
            kept.append(mode)
            continue
        skip = max(int(np.ceil(_LATER * rate / max(-mode.pole.real, 1e-9))), 1)
        if skip not in later:
            later[skip] = _found_again([record[:, skip:] for record in arrays], rate, found.method)
        if any(_is_same(mode, other) for other in later[skip]):
            kept.append(mode)
        else:
            said = (
                f"it is neither at most orders of the stabilisation diagram nor found again {skip / rate:.3g} s later"
            )
            rejected.append(RejectedPole(mode.pole, said))
    return ModeSet(tuple(kept), (*found.rejected, *rejected), found.method)


def _found_again(records: Sequence[Real], rate: float, method: str) -> tuple[Mode, ...]:
    try:
        return tuple(identify_modes(records, rate, method))
    except InputError:
        return ()


def _is_same(mode: Mode, other: Mode) -> bool:
    frequency = _NEAR * mode.frequency + _SURE * _both(mode.frequency_std, other.frequency_std)
    ratio = _NEAR + _SURE * _both(mode.damping_ratio_std, other.damping_ratio_std)
    apart = abs(mode.frequency - other.frequency), abs(mode.damping_ratio - other.damping_ratio)
    return apart[0] <= frequency and apart[1] <= ratio and other.resolved


def _both(*stds: float | None) -> float:
    known: Iterable[float] = (std for std in stds if std is not None)
    return float(np.hypot.reduce([0.0, *known]))
