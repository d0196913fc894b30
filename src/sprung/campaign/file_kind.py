"""Which of its two kinds a TOML file is: a campaign file, or a vehicle file to simulate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sprung.campaign.schema import CampaignFile, VehicleFileSchema
from sprung.errors import closest_words

if TYPE_CHECKING:
    from collections.abc import Mapping

PARAMETERS_SECTION = "parameters"
"""Section that makes a file a vehicle file."""

VEHICLE_SECTIONS = frozenset(VehicleFileSchema.model_fields) - frozenset(CampaignFile.model_fields)
"""Sections that only a vehicle file has."""


def find_parameters_section(document: Mapping[str, Any]) -> str | None:
    """Return the name under which a document has the section ``[parameters]`` of a vehicle file.

    Parameters
    ----------
    document
        What a TOML file holds.

    Returns
    -------
    str or None
        Also a misspelt name; None where it is a campaign file.

    Examples
    --------
    >>> find_parameters_section({"vehicle": {}, "parameter": {}})
    'parameter'
    >>> find_parameters_section({"vehicle": {}, "drop": []})
    """
    if PARAMETERS_SECTION in document:
        return PARAMETERS_SECTION
    known = {field.alias or name for name, field in VehicleFileSchema.model_fields.items()}
    return next(
        (key for key in document if key not in known and closest_words(key, known) == [PARAMETERS_SECTION]), None
    )
