"""The default method: a subspace start, then maximum likelihood poles and shapes of all records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from sprung.errors import Problems
from sprung.modal.decays import Decays
from sprung.modal.identification_task import check_decay
from sprung.modal.likelihood import ModalObjective, Poles
from sprung.modal.mode_set import ModeSet, RejectedPole
from sprung.modal.model_selection import fit_by_criterion, fit_order, inconsistency_factor
from sprung.modal.record_checks import check_records
from sprung.modal.subspace import SignalSubspace
from sprung.modal.uncertainty import cramer_rao_bounds, mode_uncertainties
from sprung.vibration import Mode, sort_modes

_SIGNIFICANT_GROWTH = 2.0
"""Standard uncertainties by which a growth rate must exceed zero for the pole to be rejected."""


def maximum_likelihood(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify the modes common to several free decays, with their uncertainty.

    Every record is a sum of the same modes, y_d = Re Σ_k φ_k q_dk e^{λ_k t} + offset_d, with white noise of its own variance
    in every channel. Poles λ and shapes φ are those of all records; how much of each mode a record holds is its own, so
    that several different drops separate close modes, which one drop alone cannot. A block Hankel matrix of all records gives
    the start, Gauss-Newton steps on the likelihood the rest, with amplitudes, offsets and noise eliminated.

    Parameters
    ----------
    records
        One array of shape (channel, time) for each drop, in free decay; offsets and noise may differ.
    rate
        Samples per second, the same in all records.
    order
        Largest number of poles, two for each mode; unless given, as many as the records support. Either way those
        that an information criterion does not find worth their parameters are rejected.

    Returns
    -------
    ModeSet
        With uncertainties: covariances at the Cramér-Rao bound for white noise, enlarged for residuals that are coloured around
        a mode or inconsistent.

    Raises
    ------
    InputError
        If the records cannot be used, or the order cannot be reached.

    References
    ----------
    Variable projection after G. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; the bound after Y. Hua and T. K.
    Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38 (1990) 814.
    """
    arrays = check_records(records, rate, "ml")
    decays = Decays.of(arrays, rate)
    subspace = SignalSubspace.of(arrays, decays.spectrum)
    problems = Problems()
    if not subspace.significant:
        problems.add("ml: records", "nothing above the noise", "a free decay", "Check the recordings.")
    elif order is not None and not 1 <= order <= subspace.most:
        expected = f"1 to {subspace.most} for {decays.channels} channels and {decays.seconds.min():.3g} s"
        problems.add("ml: order", f"{order}", expected, "Choose it in that range, or leave it out.")
    problems.raise_if_any()
    check_decay(subspace.poles(min(max(subspace.significant, 2), subspace.most)), "ml")
    model = fit_by_criterion(decays, subspace) if order is None else fit_order(decays, subspace, order)
    objective = model.objective
    found, rejected = [], list(model.rejected)
    shapes = objective.poles.shapes.T
    uncertainties = mode_uncertainties(objective, inconsistency_factor(objective))
    for pole, shape, uncertainty in zip(objective.poles.exponent * rate, shapes, uncertainties, strict=True):
        growth, growth_std = float(pole.real), float(np.sqrt(uncertainty.pole[0, 0]))
        if growth > _SIGNIFICANT_GROWTH * growth_std:
            rejected.append(RejectedPole(complex(pole), f"it grows, by {growth:.3g} ± {growth_std:.2g} 1/s"))
        else:
            found.append(Mode(complex(pole), shape, uncertainty=uncertainty))
    return ModeSet(sort_modes(found), tuple(rejected), "ml")


def cramer_rao_bound(
    records: Sequence[ArrayLike], rate: float, modes: Sequence[Mode], noise: ArrayLike
) -> tuple[Mode, ...]:
    """Return known modes with their Cramér-Rao bound, the least uncertainty of any unbiased estimate from such records.

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
    arrays = check_records(records, rate, "bound")
    exponent = np.array([mode.pole / rate for mode in modes], dtype=complex)
    poles = Poles.of(exponent, np.stack([mode.shape for mode in modes], axis=1))
    objective = ModalObjective.at(Decays.of(arrays, rate), poles, 1 / np.asarray(noise, dtype=float) ** 2)
    return tuple(
        replace(mode, uncertainty=spread) for mode, spread in zip(modes, cramer_rao_bounds(objective), strict=True)
    )
