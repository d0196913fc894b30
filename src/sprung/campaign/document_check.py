"""Check of a campaign file by itself, without its recordings: quick enough to repeat while somebody writes the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sprung.display import shown
from sprung.errors import InputError, Problem, Problems

if TYPE_CHECKING:
    from sprung.campaign.campaign import Campaign
    from sprung.campaign.completeness import MissingEntry

# The models of the files are imported where a file is checked: whoever has a campaign needs none of them.


@shown
@dataclass(frozen=True, eq=False)
class CheckedDocument:
    """What a campaign file states, and what is wrong with it.

    Attributes
    ----------
    campaign
        Vehicle, sensors and loads as far as they could be understood, in SI, without drops; None where they cannot be.
    problems
        What makes the file unusable.
    missing
        What it does not say yet.
    """

    campaign: Campaign | None
    problems: tuple[Problem, ...]
    missing: tuple[MissingEntry, ...]


def check_document(document: Mapping[str, Any], path: Path) -> CheckedDocument:
    """Check the content of a campaign file; recordings are neither read nor required.

    Parameters
    ----------
    document
        What the file holds, as TOML gives it.
    path
        Of the file, which need not exist.

    Returns
    -------
    CheckedDocument

    Examples
    --------
    >>> checked = check_document({"vehicle": {"wheelbase": -2.5}}, Path("campaign.toml"))
    >>> print(checked.problems[-1])
    campaign.toml: vehicle.wheelbase: found -2.5; expected a positive number: front axle to rear axle in m. Correct it.
    """
    from sprung.campaign.checks import check  # noqa: PLC0415 (see above)
    from sprung.campaign.completeness import find_missing_entries  # noqa: PLC0415
    from sprung.campaign.file_reading import stated_campaign  # noqa: PLC0415
    from sprung.campaign.parsing import parse_document  # noqa: PLC0415
    from sprung.campaign.schema import CampaignFile  # noqa: PLC0415

    problems = Problems()
    try:
        parsed = parse_document(CampaignFile, document, path.name, problems)
    except InputError as error:
        return CheckedDocument(None, error.problems, ())
    check(parsed, problems)
    found = tuple(dict.fromkeys(problems))
    try:
        campaign = stated_campaign(parsed, path, parsed.file.sensor)
    except InputError:  # what cannot be is among the problems
        campaign = None
    return CheckedDocument(campaign, found, tuple(find_missing_entries(parsed)))
