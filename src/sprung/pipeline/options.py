"""The arguments that several public functions share: a campaign or its path, tracks and extras."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TypeAlias, get_args

from sprung.errors import Problems, did_you_mean
from sprung.progress import Progress, silent
from sprung.recording import Campaign, read, require_plausible
from sprung.vehicle import EXTRAS, Tracks

CampaignSource: TypeAlias = Campaign | str | os.PathLike[str]
"""A campaign, or the path of a campaign file or of its folder."""


def campaign_from(source: CampaignSource, progress: Progress = silent) -> Campaign:
    """Return the campaign itself, or the one read from a path.

    Parameters
    ----------
    source
        A campaign, its file, or its folder.
    progress
        Called with each step of reading that begins.

    Returns
    -------
    Campaign

    Raises
    ------
    InputError
        If the file or its recordings cannot be used, or the campaign is not complete or states what cannot be.
    TypeError
        If it is neither.
    """
    if isinstance(source, Campaign):
        source.require_complete()
        require_plausible(source)
        return source
    if isinstance(source, str | os.PathLike):
        return read(source, progress=progress)
    raise TypeError(f"a campaign, or the path of one, is needed, not {type(source).__name__}")


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
        problems.add("tracks", repr(tracks), " or ".join(map(repr, known)), did_you_mean(str(tracks), known))
    chosen = (extras,) if isinstance(extras, str) else None if extras is None else tuple(extras)
    for extra in chosen or ():
        if extra not in EXTRAS:
            problems.add("extras", repr(extra), f"any of {', '.join(EXTRAS)}", did_you_mean(str(extra), EXTRAS))
    problems.raise_if_any()
    return tracks, chosen
