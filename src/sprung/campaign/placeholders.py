"""Gaps: what a campaign file does not say yet, marked so that the file is TOML all the same and every gap can be listed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sprung.campaign.schema_problems import Place

MARK = "TODO:"
"""What a text begins with that stands where something is still to be filled in."""


def placeholder(what: str) -> str:
    """Return the text that marks a missing value.

    Parameters
    ----------
    what
        Is to be written there.

    Returns
    -------
    str

    Examples
    --------
    >>> placeholder("m, front axle to rear axle")
    'TODO: m, front axle to rear axle'
    """
    return f"{MARK} {what}"


def find_placeholders(document: Any, place: Place = ()) -> Iterator[tuple[Place, str]]:
    """Yield every placeholder of a document, in its order.

    Parameters
    ----------
    document
        What a TOML file holds, or a part of it.
    place
        Of that part.

    Yields
    ------
    tuple
        Where it is, and what is to be written there.
    """
    if isinstance(document, str) and document.startswith(MARK):
        yield place, document.removeprefix(MARK).strip()
    elif isinstance(document, dict):
        for key, value in document.items():
            yield from find_placeholders(value, (*place, key))
    elif isinstance(document, list):
        for index, value in enumerate(document):
            yield from find_placeholders(value, (*place, index))
