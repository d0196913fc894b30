"""The two ways of describing a load, by its pieces or by totals: what is not filled in of one gives way to the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from sprung.app.campaign_text import Change
from sprung.campaign import find_placeholders

_OTHER = {"items": "added", "added": "items"}


def superseded(document: Mapping[str, Any], changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the removal of every description of a load that changes made needless.

    Parameters
    ----------
    document
        The file after the changes.
    changes
        What was changed. What nobody has touched remains as its author wrote it.
    """
    stated: dict[tuple[int, str], bool] = {}
    for change in changes:
        match change.place:
            case ("load", int() as index, str() as key, *_) if key in _OTHER:
                stated[index, key] = stated.get((index, key), False) or change.value is not None
    for (index, key), is_stated in stated.items():
        load, other = document["load"][index], _OTHER[key]
        if load.get(key) == {}:
            yield Change(("load", index, key), None)  # totals of which none is left
        elif is_stated and other in load and _is_blank(load[other]):
            yield Change(("load", index, other), None)


def _is_blank(node: Any) -> bool:
    """Whether nothing is stated in a part of a file, or placeholders only."""
    if isinstance(node, dict | list):
        return all(map(_is_blank, node.values() if isinstance(node, dict) else node))
    return any(find_placeholders(node))
