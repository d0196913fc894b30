"""How the clocks of several loggers stood in a drop."""

from __future__ import annotations

from dataclasses import dataclass

from sprung.display import shown


@shown
@dataclass(frozen=True)
class ClockReport:
    """How a logger's clock stood in a drop.

    Attributes
    ----------
    logger
        The logger's file.
    ahead, std
        What it showed when the first logger's clock showed zero, s, and the standard uncertainty of that.
    """

    logger: str
    ahead: float
    std: float
