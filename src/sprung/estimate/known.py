"""What was measured beforehand: a value and how well it is known."""

from __future__ import annotations

from dataclasses import dataclass

from sprung.display import shown


@shown
@dataclass(frozen=True, slots=True)
class Known:
    """A quantity known beforehand.

    Attributes
    ----------
    value
        SI.
    std
        Standard uncertainty, SI; 0 means exact.
    """

    value: float
    std: float = 0.0

    @property
    def exact(self) -> bool:
        """Whether it carries no uncertainty."""
        return bool(self.std == 0.0)
