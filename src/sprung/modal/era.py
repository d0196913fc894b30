"""Eigensystem realisation from the free decays of several drops at once."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from sprung.modal.identification_task import IdentificationTask
from sprung.modal.mode_set import ModeSet


def eigensystem_realisation(records: Sequence[ArrayLike], rate: float, order: int | None = None) -> ModeSet:
    """Identify the modes common to several free decays.

    The records of all drops, delayed by 0, 1, 2, ... lags, are stacked into block Hankel matrices side by side. The
    span of their columns is that of the observability matrix, which a singular value decomposition separates from the
    noise; the shift from block row to block row is the transition matrix. An offset of a channel is constant along the
    rows of a drop, so taking each row's mean off removes it and leaves the span as it is, exactly.

    Parameters
    ----------
    records
        One array of shape (channel, time) for each drop, in free decay; offsets may differ from drop to drop.
    rate
        Samples per second, the same in all records.
    order
        Number of poles; unless given, of those above the noise.

    Returns
    -------
    ModeSet
        Exact without noise, repeated and real poles too.

    Raises
    ------
    InputError
        If the records differ in channels, are not numbers or are too short, or the order cannot be reached.

    References
    ----------
    J.-N. Juang and R. S. Pappa, J. Guid. Control Dyn. 8 (1985) 620.
    """
    task = IdentificationTask.of(records, rate, order, "era")
    return task.modes(task.subspace.poles(task.order))
