"""Result of a modal identification: the modes, and the poles that were rejected."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import NDArray

from sprung.display import shown
from sprung.vibration import Mode

Real = NDArray[np.float64]


@shown
@dataclass(frozen=True, eq=False)
class RejectedPole:
    """A pole that is not accepted as a mode.

    Attributes
    ----------
    pole
        1/s.
    reason
        Reason, with the numbers.
    """

    pole: complex
    reason: str


@shown
@dataclass(frozen=True, eq=False)
class ModeSet(Sequence[Mode]):
    """Modes common to several free decays, a sequence in the order of undamped natural frequency.

    Attributes
    ----------
    modes
        The modes.
    rejected
        Poles that are not accepted as modes.
    method
        By which they were found.
    """

    modes: tuple[Mode, ...]
    rejected: tuple[RejectedPole, ...] = ()
    method: str = ""

    @overload
    def __getitem__(self, index: int) -> Mode: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Mode, ...]: ...
    def __getitem__(self, index: int | slice) -> Mode | tuple[Mode, ...]:
        """Return one mode, or several."""
        return self.modes[index]

    def __len__(self) -> int:
        """Count the modes."""
        return len(self.modes)

    def __iter__(self) -> Iterator[Mode]:
        """Iterate over the modes."""
        return iter(self.modes)
