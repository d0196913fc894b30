"""Names of excitations: what excited the vehicle, by the words of a recording's name and of its folders."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from sprung.drafting.names import tokens

UnpaddedExcitation = Literal["drop", "push", "pass"]
"""What excites a vehicle without pads."""

_NAMED: Mapping[UnpaddedExcitation, frozenset[str]] = {
    "push": frozenset(
        ("push", "pushed", "pull", "pulled", "quick", "snap", "gedrückt", "gezogen", "anstossen", "wippen", "loslassen")
    ),
    "drop": frozenset(("drop", "dropped", "block", "blocks", "fall", "abwurf", "fallversuch", "klotz", "klötze")),
    "pass": frozenset(("pass", "bump", "hump", "cleat", "schwelle", "überfahrt", "ueberfahrt")),
}  # fmt: skip


def excitation_named(path: str) -> UnpaddedExcitation | None:
    """Return what a recording's name, or its folders, state as the excitation; None where they state none, or several.

    Parameters
    ----------
    path
        Relative to the campaign's folder.

    Examples
    --------
    >>> excitation_named("push/front 1.csv"), excitation_named("Überfahrt 3.csv"), excitation_named("empty.csv")
    ('push', 'pass', None)
    """
    words = tokens(path)
    named = [kind for kind, names in _NAMED.items() if any(word in names for word in words)]
    return named[0] if len(named) == 1 else None
