"""Eigensystem realisation from the free decays of several drops at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import Problems
from sprung.modal.modes import Mode, modes_from
from sprung.modal.records import as_records

Real = NDArray[np.float64]

LARGEST_ORDER = 14
"""Poles of a vehicle with seven degrees of freedom."""

_LAG = 0.02
"""Seconds between block rows: half a period at 25 Hz, above the wheel hop of road vehicles."""

_WINDOW = 0.5
"""Seconds that the block rows span: half a period of the slowest body mode; longer gains nothing."""


def eigensystem_realisation(
    records: Sequence[ArrayLike],
    rate: float,
    order: int | None = None,
    *,
    lag: float = _LAG,
    window: float = _WINDOW,
) -> tuple[Mode, ...]:
    """Identify the modes common to several free decays.

    The records of all drops, delayed by 0, 1, 2, ... lags, are stacked into block Hankel matrices side by side. The
    span of their columns is that of the observability matrix, which a singular value decomposition separates from the
    noise; the shift from block row to block row is the transition matrix. An offset of a channel is constant along the
    rows of a drop, so taking each row's mean off removes it and leaves the span as it is, exactly.

    Parameters
    ----------
    records
        One array of shape (channel, time) for each drop, in free decay, of about equal noise in all channels; offsets
        may differ from drop to drop.
    rate
        Samples per second, the same in all records.
    order
        How many poles to look for; unless given as many as stand out from the noise, at most 14.
    lag, window
        Time between block rows and time that all of them span, s; shortened where the records are short.

    Returns
    -------
    tuple of Mode
        Decaying ones only, with shapes at the channels, in the order of undamped natural frequency.

    Raises
    ------
    InputError
        If the records differ in channels, are not numbers or are too short, or the order cannot be reached.

    References
    ----------
    J.-N. Juang and R. S. Pappa, J. Guid. Control Dyn. 8 (1985) 620; the order after M. Gavish and D. L. Donoho, IEEE
    Trans. Inf. Theory 60 (2014) 5040.
    """
    arrays = as_records(records, rate, "era")
    channels, shortest = arrays[0].shape[0], min(record.shape[1] for record in arrays)
    step = max(1, round(lag * rate))
    shifts = min(max(2, round(window * rate / step)), shortest // (2 * step))
    wanted = min(LARGEST_ORDER, channels * shifts) if order is None else order
    problems = Problems()
    if shifts < 1:
        found = f"{shortest} samples in the shortest record, {shortest / rate:.3g} s"
        problems.add("era: records", found, f"at least {2 * step} samples", "Give longer decays.")
    elif not 1 <= wanted <= channels * shifts:
        expected = f"1 to {channels * shifts} for {channels} channels and {shortest / rate:.3g} s"
        problems.add("era: order", f"{order}", expected, "Choose it in that range, or leave it out.")
    problems.raise_if_any()

    # Of each drop's Hankel matrix only R of its QR factorisation is kept: the same span, and nothing grows with time.
    factors, columns = [], 0
    for record in arrays:
        length = record.shape[1] - shifts * step
        hankel = np.vstack([record[:, i * step : i * step + length] for i in range(shifts + 1)])
        hankel -= hankel.mean(axis=1, keepdims=True)
        factors.append(np.asarray(np.linalg.qr(hankel.T, mode="r"), dtype=float).T)
        columns += length
    span, singular, _ = np.linalg.svd(np.hstack(factors), full_matrices=False)
    if order is None:
        wanted = min(wanted, _order(singular, columns))
    observability = span[:, :wanted]
    transition = np.linalg.lstsq(observability[:-channels], observability[channels:], rcond=None)[0]
    z, vectors = np.linalg.eig(transition)
    # Growing motion is noise, and so is a negative real z, which no sampled decay can give.
    decaying = (np.abs(z) < 1) & (np.abs(z) > 0) & ~((z.imag == 0) & (z.real < 0))
    poles = np.log(z[decaying].astype(complex)) * rate / step
    return modes_from(poles, (observability[:channels] @ vectors)[:, decaying])


def _order(singular: Real, columns: int) -> int:
    """Count the singular values that stand out from noise, as conjugate pairs."""
    size = singular.size
    ratio = min(size / columns, 1.0)
    hard = 0.56 * ratio**3 - 0.95 * ratio**2 + 1.82 * ratio + 1.43
    floor = np.finfo(float).eps * columns * singular[0]
    above = int((singular > max(hard * float(np.median(singular)), floor)).sum())
    return max(2, above + above % 2)
