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
    named = {one.name: (drop, one) for drop, one in zip(campaign.drops, campaign.recordings, strict=True)}
    gone = [decay for decay in prepared.decays if decay.file in left_out]
    return prepared._replace(
        decays=tuple(decay for decay in prepared.decays if decay.file not in left_out),
        left_out=(*prepared.left_out, *((*named[one.file], (*one.faults, left_out[one.file])) for one in gone)),
    )
