"""Checks of the records that are passed to a method."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import Problems

Real = NDArray[np.float64]


def check_records(records: Sequence[ArrayLike], rate: float, where: str) -> list[Real]:
    """Return records as arrays, after checking that they can be used together.

    Parameters
    ----------
    records
        Shape (channel, time) each.
    rate
        Samples per second.
    where
        For the message.

    Returns
    -------
    list of ndarray

    Raises
    ------
    InputError
        With everything that is wrong.
    """
    arrays = [np.asarray(record, dtype=float) for record in records]
    problems = Problems()
    if not arrays:
        problems.add(f"{where}: records", "none", "at least one", "Give the decays of one load.")
    if not rate > 0:
        problems.add(f"{where}: rate", f"{rate}", "samples per second, positive", "Correct it.")
    for i, record in enumerate(arrays):
        place = f"{where}: records[{i}]"
        if record.ndim != 2:
            problems.add(place, f"an array of shape {record.shape}", "shape (channel, time)", "Put channels in rows.")
        elif record.shape[0] != np.shape(arrays[0])[0]:
            found, expected = f"{record.shape[0]} channels", f"{np.shape(arrays[0])[0]} as in the first record"
            problems.add(place, found, expected, "Give the same channels of every drop.")
        elif not np.isfinite(record).all():
            bad = int((~np.isfinite(record)).sum())
            problems.add(place, f"{bad} samples that are not numbers", "numbers", "Leave those samples out.")
    problems.raise_if_any()
    return arrays
