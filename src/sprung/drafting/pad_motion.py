"""Motion of pads under the tyres: a recording in which they move needs no release."""

from __future__ import annotations

from collections.abc import Sequence

from sprung.drafting.quantity_names import is_pad_named
from sprung.drafting.release_detection import Averages
from sprung.preprocess import find_moving_pads


def moving_pads(averages: Averages, channels: Sequence[str]) -> tuple[str, ...]:
    """Return the channels of pads that move in a recording.

    Parameters
    ----------
    averages
        Of all its displacements, m.
    channels
        Their names.

    Returns
    -------
    tuple of str
    """
    moves = find_moving_pads(averages.values).tolist()
    return tuple(name for name, moving in zip(channels, moves, strict=True) if is_pad_named(name) and moving)
