"""The methods of modal identification, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import Problems, did_you_mean
from sprung.modal.arma import autoregression
from sprung.modal.criteria import NEAR_NYQUIST
from sprung.modal.decays import Decays
from sprung.modal.emd import empirical_mode_decomposition
from sprung.modal.era import eigensystem_realisation
from sprung.modal.era_dc import realisation_by_correlations
from sprung.modal.frequency_likelihood import frequency_domain_likelihood
from sprung.modal.itd import ibrahim_time_domain, state_variables_in_rows
from sprung.modal.likelihood import ModalObjective, Poles
from sprung.modal.maximum_likelihood import maximum_likelihood
from sprung.modal.mode_set import ModeSet, RejectedPole
from sprung.modal.peak_picking import peak_picking
from sprung.modal.polynomials import complex_frequency, rational_fractions
from sprung.modal.record_checks import check_records
from sprung.modal.ssi import subspace_by_covariances, subspace_by_data
from sprung.modal.svm import state_variable_method
from sprung.vibration import Mode

Real = NDArray[np.float64]

Method = Callable[[Sequence[ArrayLike], float, int | None], ModeSet]
"""Function of records of shape (channel, time), the sampling rate and the order, None to choose it, to modes."""

_SVM_STEP = 0.015
"""s between the states of the State Variable Method, where it is not taken as printed."""


def _svm(records: Sequence[ArrayLike], rate: float, order: int | None) -> ModeSet:
    """Apply the State Variable Method, with a longer lag, to half as many combinations of channels as the order."""
    return _state_variables(records, rate, order, "svm", max(1, round(_SVM_STEP * rate)))


def _svm_as_printed(records: Sequence[ArrayLike], rate: float, order: int | None) -> ModeSet:
    """Apply the State Variable Method as printed, from sample to sample."""
    return _state_variables(records, rate, order, "svm-printed", 1)


def _state_variables(records: Sequence[ArrayLike], rate: float, order: int | None, method: str, lag: int) -> ModeSet:
    arrays = check_records(records, rate, method)
    channels = len(arrays[0]) if arrays else 0
    degrees = min(channels, 7) if order is None else (order + 1) // 2
    if order is not None and not 0 < degrees <= channels:
        problems = Problems()
        expected = f"an even number from 2 to {2 * channels}, twice the channels"
        problems.add(f"{method}: order", f"{order}", expected, "Choose it in that range, or leave it out.")
        problems.raise_if_any()
    # Eight channels see seven degrees of freedom: the method needs as many outputs as there are degrees of freedom.
    patterns = np.eye(channels)
    if degrees < channels:
        patterns = np.linalg.svd(np.hstack(arrays), full_matrices=False)[0][:, :degrees]
    found = state_variable_method([patterns.T @ record for record in arrays], rate, lag).modes
    fastest = 0.999 * np.pi * rate / lag
    decaying, rejected = [], []
    for mode in found:
        if mode.pole.real >= 0:
            rejected.append(RejectedPole(mode.pole, "it grows"))
        elif mode.pole.imag > fastest:
            rejected.append(RejectedPole(mode.pole, "it changes its sign from sample to sample"))
        else:
            decaying.append(Mode(mode.pole, patterns @ mode.shape))
    return ModeSet(tuple(decaying), tuple(rejected), method)


METHODS: Mapping[str, Method] = MappingProxyType(
    {
        "ml": maximum_likelihood,
        "era": eigensystem_realisation,
        "era-dc": realisation_by_correlations,
        "ssi-cov": subspace_by_covariances,
        "ssi-data": subspace_by_data,
        "itd": ibrahim_time_domain,
        "svm": _svm,
        "svm-printed": _svm_as_printed,
        "svm-rows": state_variables_in_rows,
        "arma": autoregression,
        "lscf": complex_frequency,
        "rfp": rational_fractions,
        "peaks": peak_picking,
        "ml-frequency": frequency_domain_likelihood,
        "emd": empirical_mode_decomposition,
    }
)
"""The methods, by the name that `identify_modes` takes; the first is the one it takes by default."""

DEFAULT_METHOD = next(iter(METHODS))
"""Name of the default method."""

APPROXIMATE = frozenset({"peaks", "emd"})
"""Methods that are not exact even without noise."""

_TOLERANT = APPROXIMATE | {"svm", "svm-printed"}
"""Methods that find slow motions in noise: these are rejected, without consequence for the records."""

_LEAST_PERIODS, _LEAST_DECAY = 2.0, 3.0
"""Periods of a vibration, and time constants of an overdamped motion, that a record must hold to determine it."""

_OVERDAMPED_FROM = 0.7
"""Damping ratio above which a motion is judged by its decay instead of its periods."""

_LEAST_SAMPLES = 16
"""Least number of samples."""

_SMALL = 0.05
"""Part of a channel's energy up to which a motion that is too slow for the records is rejected without an error."""


def identify_modes(
    records: Sequence[ArrayLike], rate: float, method: str = DEFAULT_METHOD, order: int | None = None
) -> ModeSet:
    """Identify the modes common to several free decays of one load; no vehicle model is needed.

    Parameters
    ----------
    records
        One array of shape (channel, time) for each drop, the same two or more channels in each.
    rate
        Samples per second.
    method
        One of `METHODS`. The default ``ml``, maximum likelihood, reaches the Cramér-Rao bound and gives uncertainties; so does
        ``ml-frequency``, for the lines of a band. Realisations: ``era``, ``era-dc``, ``ssi-cov``, ``ssi-data``.
        Recursions: ``itd``, ``arma``, and the paper's State Variable Method, ``svm-printed`` as it stands there, ``svm`` with a
        longer lag, ``svm-rows`` with more block rows too. In the frequency domain: ``lscf`` (PolyMAX), ``rfp``. Not exact:
        ``peaks``, ``emd``.
    order
        How many poles to look for, two for each mode; unless given the method chooses.

    Returns
    -------
    ModeSet
        Shapes at the channels, without names, in the order of undamped natural frequency.

    Raises
    ------
    InputError
        If there is no such method, the records cannot be used, or they are shorter than two periods of their main motion.
    """
    problems = Problems()
    if method not in METHODS:
        expected = " or ".join(f"'{name}'" for name in METHODS)
        problems.add("method", f"'{method}'", expected, did_you_mean(method, METHODS, listed=True))
        problems.raise_if_any()
    arrays = check_records(records, rate, method)
    if len(arrays[0]) < 2:
        expected = "two or more: shapes are ratios of channels"
        problems.add(f"{method}: records", f"{len(arrays[0])} channel", expected, "Give all channels together.")
    shortest = min(record.shape[1] for record in arrays)
    if shortest < _LEAST_SAMPLES:
        reason = f"{shortest} samples in the shortest", f"at least {_LEAST_SAMPLES}"
        problems.add(f"{method}: records", *reason, "Give longer decays.")
    elif not any(np.ptp(record, axis=1).any() for record in arrays if record.size):
        problems.add(f"{method}: records", "no motion in any channel", "a free decay", "Check the recordings.")
    problems.raise_if_any()
    found = METHODS[method](arrays, rate, order)
    below, fast = _below_nyquist(found.modes, rate)
    kept, slow = _split(below, arrays, rate, refusing=method not in _TOLERANT)
    return ModeSet(kept, (*found.rejected, *fast, *slow), method)


def _below_nyquist(modes: tuple[Mode, ...], rate: float) -> tuple[tuple[Mode, ...], tuple[RejectedPole, ...]]:
    """Reject modes near the Nyquist frequency: noise, aliases and the edge of a filter lie there."""
    limit = NEAR_NYQUIST * rate / 2
    fast = [mode for mode in modes if mode.damped_frequency > limit]
    reason = f"its frequency is above {limit:.4g} Hz, {NEAR_NYQUIST:.0%} of half the sampling rate"
    return tuple(mode for mode in modes if mode not in fast), tuple(RejectedPole(mode.pole, reason) for mode in fast)


def _split(
    modes: tuple[Mode, ...], records: Sequence[Real], rate: float, refusing: bool
) -> tuple[tuple[Mode, ...], tuple[RejectedPole, ...]]:
    """Reject modes that are too slow for the records; raise an error if they are the main motion."""
    seconds = max(record.shape[1] for record in records) / rate
    slow = [mode for mode in modes if not _is_long_enough(mode, seconds)]
    if not slow:
        return modes, ()
    decays = Decays.of(records, rate)
    poles = Poles.of(
        np.array([mode.pole / rate for mode in modes], dtype=complex),
        np.stack([mode.shape for mode in modes], axis=1),
    )
    shares = ModalObjective.at(decays, poles, 1 / np.maximum(decays.energy.sum(axis=0), 1e-300)).shares
    problems = Problems()
    for mode in slow:
        share = float(shares[:, modes.index(mode)].max())
        if refusing and (share > _SMALL or len(slow) == len(modes)):
            problems.add("records", *_too_short(mode, seconds), "Record longer, or leave that motion out.")
    problems.raise_if_any()
    rejected = tuple(RejectedPole(mode.pole, " for ".join(_too_short(mode, seconds)[::-1])) for mode in slow)
    return tuple(mode for mode in modes if mode not in slow), rejected


def _is_long_enough(mode: Mode, seconds: float) -> bool:
    if mode.damping_ratio > _OVERDAMPED_FROM:
        return -mode.pole.real * seconds >= _LEAST_DECAY
    return mode.frequency * seconds >= _LEAST_PERIODS


def _too_short(mode: Mode, seconds: float) -> tuple[str, str]:
    if mode.damping_ratio > _OVERDAMPED_FROM:
        decay = -1 / mode.pole.real
        return (
            f"{seconds:.3g} s of a motion that decays in {decay:.3g} s",
            f"at least {_LEAST_DECAY * decay:.3g} s, {_LEAST_DECAY:g} times as long",
        )
    return (
        f"{seconds:.3g} s, {mode.frequency * seconds:.2g} periods of the lowest mode at {mode.frequency:.3g} Hz",
        f"at least {_LEAST_PERIODS / mode.frequency:.3g} s, two periods",
    )
