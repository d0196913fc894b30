"""What was measured beforehand: a value and its standard uncertainty."""

from __future__ import annotations

from dataclasses import dataclass

from sprung.display import shown


@shown
@dataclass(frozen=True, slots=True)
class KnownValue:
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
    def is_exact(self) -> bool:
        """Whether the value carries no uncertainty."""
        return self.std == 0
