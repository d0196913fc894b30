"""A campaign given as it is, or as the path of its file or folder."""

from __future__ import annotations

import os
from typing import TypeAlias

from sprung.campaign.campaign import Campaign
from sprung.campaign.reading import read
from sprung.campaign.statements import require_plausible
from sprung.progress import Progress, silent

CampaignSource: TypeAlias = Campaign | str | os.PathLike[str]
"""A campaign, or the path of a campaign file or of its folder."""


def resolve_campaign(source: CampaignSource, progress: Progress = silent) -> Campaign:
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
