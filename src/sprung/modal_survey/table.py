"""The table of modes that were identified without a vehicle model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sprung.tables import Table, with_std

if TYPE_CHECKING:
    from sprung.modal_survey.load_modes import IdentifiedMode


def identified_modes_table(load: str, method: str, drops: int, modes: Sequence[IdentifiedMode]) -> Table:
    """Return the table of modes that were identified without a vehicle model.

    Parameters
    ----------
    load
        Name of the load.
    method, drops
        Name of the method, and number of drops.
    modes
        The modes.

    Returns
    -------
    Table
    """
    headers = ("mode", "f_n Hz", "± Hz", "f_d Hz", "damping", "±", "MPC")
    title = f"Modes, {load} ({method}, {drops} drop{'s' * (drops > 1)})"
    return Table(title, headers, tuple(map(_cells, modes)), frozenset(headers[1:]), ("MPC", "f_d Hz"))


def _cells(mode: IdentifiedMode) -> tuple[str, ...]:
    if mode.status == "unresolved":
        return (mode.name, f"~{mode.frequency:.2g}", "-", "-", "-", "-", "-")
    return (
        mode.name,
        *_rounded(mode.frequency, mode.frequency_std),
        f"{mode.damped_frequency:.4f}",
        *_rounded(mode.damping_ratio, mode.damping_ratio_std),
        f"{mode.collinearity:.2f}",
    )


def _rounded(value: float, std: float | None) -> tuple[str, str]:
    """Return value and uncertainty as text; four decimals where the method gives no uncertainty."""
    return (f"{value:.4f}", "-") if std is None else with_std(value, std)
