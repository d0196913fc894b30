"""What a file format hands over: columns of numbers, their names and units, and a clock."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sprung.units import acceleration_factor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sprung.errors import Problem

_BRACKETS = re.compile(r"^(?P<name>.*\S)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))$", re.DOTALL)


def split_unit(text: str) -> tuple[str, str | None]:
    """Split the unit off a column's name.

    Parameters
    ----------
    text
        As the file has it: ``body_fl [g]``, ``body_fl (m/s^2)`` or plainly ``body_fl``.

    Returns
    -------
    name
        What stands before the brackets.
    unit
        What stands in them; None without brackets. Round brackets are taken as a unit only where they hold one of
        acceleration: ``body (left)`` is a name.

    Examples
    --------
    >>> split_unit("body_fl [g]"), split_unit("body (left)")
    (('body_fl', 'g'), ('body (left)', None))
    """
    match = _BRACKETS.match(text.strip())
    if match is None:
        return text.strip(), None
    if match["square"] is not None:
        return match["name"], match["square"].strip()
    try:
        acceleration_factor(match["round"])
    except ValueError:
        return text.strip(), None
    return match["name"], match["round"].strip()


@dataclass(frozen=True, eq=False)
class Table:
    """The columns of one file, as the file has them.

    Attributes
    ----------
    channels
        Names of the columns other than time, without their units.
    units
        What the file says each channel is measured in; None where it says nothing.
    values
        Shape (channel, time), in those units; NaN where the file holds no number.
    clock
        Time of every sample on the file's clock, s, shape (time,); or one number, the samples per second of a format
        that keeps no times, whose clock then starts at 0.
    lines
        Line of the file in which each sample stands, shape (time,); None for formats that have no lines.
    spoilt
        By channel: what stands there that is no number. A problem only where somebody needs the channel.
    notes
        What the format had to do to read the file, in words.
    """

    channels: tuple[str, ...]
    units: tuple[str | None, ...]
    values: NDArray[np.float64]
    clock: NDArray[np.float64] | float
    lines: NDArray[np.int64] | None = None
    spoilt: Mapping[str, Problem] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of every sample, s; shape (time,)."""
        if isinstance(self.clock, np.ndarray):
            return self.clock
        return np.arange(self.values.shape[1]) / self.clock

    def place(self, sample: int) -> str:
        """Say where in the file a sample stands: ``line 57``."""
        return f"sample {sample + 1}" if self.lines is None else f"line {self.lines[sample]}"
