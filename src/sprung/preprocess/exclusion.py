"""Drops that are left out of what was prepared, each with its reason."""

from __future__ import annotations

from collections.abc import Mapping

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.preprocess.prepare import Prepared


def exclude_drops(campaign: Campaign, prepared: Prepared, left_out: Mapping[str, Fault]) -> Prepared:
    """Leave drops out of what was prepared.

    Parameters
    ----------
    campaign
        The campaign.
    prepared
        Its recordings, prepared.
    left_out
        By the names of the recordings why.

    Returns
    -------
    Prepared
    """
    drops = {drop.recording.name: drop for drop in campaign.drops}
    gone = [decay for decay in prepared.decays if decay.file in left_out]
    return prepared._replace(
        decays=tuple(decay for decay in prepared.decays if decay.file not in left_out),
        left_out=(
            *prepared.left_out,
            *((drops[decay.file], (*decay.faults, left_out[decay.file])) for decay in gone),
        ),
    )
