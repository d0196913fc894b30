"""The arguments that several public functions share: a campaign or its path, tracks and extras."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

from sprung.errors import Problems, did_you_mean
from sprung.vehicle import EXTRAS, Tracks


def model_options(
    tracks: Tracks | None, extras: str | Sequence[str] | None
) -> tuple[Tracks | None, tuple[str, ...] | None]:
    """Return tracks and extras as asked for, after a check of their spelling; one extra may be given by its name alone.

    Parameters
    ----------
    tracks, extras
        As for `identify`.

    Returns
    -------
    tuple
        Tracks, and the extras.

    Raises
    ------
    InputError
        If one of them is unknown.
    """
    problems = Problems()
    if tracks is not None and tracks not in get_args(Tracks):
        known = get_args(Tracks)
        do = did_you_mean(str(tracks), known, listed=True)
        problems.add("tracks", repr(tracks), " or ".join(map(repr, known)), do)
    chosen = (extras,) if isinstance(extras, str) else None if extras is None else tuple(extras)
    for extra in chosen or ():
        if extra not in EXTRAS:
            do = did_you_mean(str(extra), EXTRAS, listed=True)
            problems.add("extras", repr(extra), f"any of {', '.join(EXTRAS)}", do)
    problems.raise_if_any()
    return tracks, chosen
