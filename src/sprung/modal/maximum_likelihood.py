"""The default method: a subspace start, and the poles and shapes that make all records likeliest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from sprung.errors import Problems
from sprung.modal.decays import Decays
from sprung.modal.identified import ModeSet, RejectedPole
from sprung.modal.likelihood import Poles, Stand
from sprung.modal.modelling import agreement, model_by_data, model_of_order
from sprung.modal.records import as_records
from sprung.modal.selection import refuse_without_decay
from sprung.modal.subspace import Span
from sprung.modal.uncertainty import bounds, spreads
from sprung.vibration import Mode, sort_modes

_GROWS = 2.0
"""Standard uncertainties by which a motion must grow for it to be none of a free decay."""


def maximum_likelihood(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify the modes common to several free decays, with their uncertainty.

    Every record is a sum of the same modes, y_d = Re Σ_k φ_k q_dk e^{λ_k t} + offset_d, with white noise of its own variance
    in every channel. Poles λ and shapes φ are those of all records; how much of each mode a record holds is its own, so
    that several different drops tell close modes apart which one alone cannot. A block Hankel matrix of all records gives
    the start, Gauss-Newton steps on the likelihood the rest, with amplitudes, offsets and noise eliminated.

    Parameters
    ----------
    records
        One array of shape (channel, time) for each drop, in free decay; offsets and noise may differ.
    rate
        Samples per second, the same in all records.
    order
        How many poles to look for at the most, two for each mode; unless given, as many as the records hold. Either way those
        that an information criterion does not find worth their parameters are rejected.

    Returns
    -------
    Modes
        With spreads: covariances at the Cramér-Rao bound for white noise, enlarged for residuals that are coloured around a
        mode or contradict each other.

    Raises
    ------
    InputError
        If the records cannot be used, or the order cannot be reached.

    References
    ----------
    Variable projection after G. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; the bound after Y. Hua and T. K.
    Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38 (1990) 814.
    """
    arrays = as_records(records, rate, "ml")
    decays = Decays.of(arrays, rate)
    span = Span.of(arrays, decays.spectrum)
    problems = Problems()
    if not span.standing_out:
        problems.add("ml: records", "nothing that stands out from noise", "a free decay", "Look at the recordings.")
    elif order is not None and not 1 <= order <= span.most:
        expected = f"1 to {span.most} for {decays.channels} channels and {decays.seconds.min():.3g} s"
        problems.add("ml: order", f"{order}", expected, "Choose it in that range, or leave it out.")
    problems.raise_if_any()
    refuse_without_decay(span.poles(min(max(span.standing_out, 2), span.most)), "ml")
    model = model_by_data(decays, span) if order is None else model_of_order(decays, span, order)
    stand = model.stand
    found, rejected = [], list(model.rejected)
    shapes = stand.poles.shapes.T
    spread = spreads(stand, agreement(stand))
    for pole, shape, own in zip(stand.poles.exponent * rate, shapes, spread, strict=True):
        growth, unsure = float(pole.real), float(np.sqrt(own.pole[0, 0]))
        if growth > _GROWS * unsure:
            rejected.append(RejectedPole(complex(pole), f"it grows, by {growth:.3g} ± {unsure:.2g} 1/s"))
        else:
            found.append(Mode(complex(pole), shape, uncertainty=own))
    return ModeSet(sort_modes(found), tuple(rejected), "ml")


def cramer_rao_bound(
    records: Sequence[ArrayLike], rate: float, modes: Sequence[Mode], noise: ArrayLike
) -> tuple[Mode, ...]:
    """Give known modes the uncertainty that no unbiased estimate from such records can better.

    Parameters
    ----------
    records
        Without noise, shape (channel, time) each.
    rate
        Samples per second.
    modes
        All modes that the records hold, with shapes at the channels.
    noise
        Standard deviation of white noise in each channel, shape (channel,).

    Returns
    -------
    tuple of Mode
        The same, with the bound as their uncertainty; amplitudes and offsets of every record are unknown.
    """
    arrays = as_records(records, rate, "bound")
    exponent = np.array([mode.pole / rate for mode in modes], dtype=complex)
    poles = Poles.of(exponent, np.stack([mode.shape for mode in modes], axis=1))
    stand = Stand.at(Decays.of(arrays, rate), poles, 1 / np.asarray(noise, dtype=float) ** 2)
    return tuple(replace(mode, uncertainty=spread) for mode, spread in zip(modes, bounds(stand), strict=True))
