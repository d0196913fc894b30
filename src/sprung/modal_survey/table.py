"""The table of modes that were identified without a vehicle model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sprung.tables import Table, with_std

if TYPE_CHECKING:
    from sprung.modal_survey.identified import IdentifiedMode


def found_modes_table(load: str, method: str, drops: int, modes: Sequence[IdentifiedMode]) -> Table:
    """Show modes that were found without a vehicle model.

    Parameters
    ----------
    load
        Its name.
    method, drops
        By which they were found, in how many drops.
    modes
        The modes.

    Returns
    -------
    Table
    """
    headers = ("mode", "f_n Hz", "± Hz", "f_d Hz", "damping", "±", "MPC")
    title = f"Modes, {load} ({method}, {drops} drop{'s' * (drops > 1)})"
    return Table(title, headers, tuple(map(_found, modes)), frozenset(headers[1:]), ("MPC", "f_d Hz"))


def _found(mode: IdentifiedMode) -> tuple[str, ...]:
    if mode.status == "unresolved":
        return (mode.name, f"~{mode.frequency:.2g}", "-", "-", "-", "-", "-")
    return (
        mode.name,
        *_told(mode.frequency, mode.frequency_std),
        f"{mode.damped_frequency:.4f}",
        *_told(mode.damping_ratio, mode.damping_ratio_std),
        f"{mode.collinearity:.2f}",
    )


def _told(value: float, std: float | None) -> tuple[str, str]:
    """Round by the uncertainty; a method that tells none gets four digits."""
    return (f"{value:.4f}", "-") if std is None else with_std(value, std)
