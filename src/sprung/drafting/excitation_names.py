"""Names of excitations: what excited the vehicle, by the words of a recording's name and of its folders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from sprung.drafting.layout_names import wheels_named_anywhere
from sprung.drafting.names import tokens
from sprung.drafting.records import DraftDrop

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


def with_named_excitation(drop: DraftDrop, *, alone: bool) -> DraftDrop:
    """Return what accelerometers show as a drop as the push or the pass that its name states.

    Wheels fall after a bump, too: the name knows better what made them, and which wheels were pushed or met the bump.

    Parameters
    ----------
    drop
        As the recordings show it.
    alone
        Whether it is the only one of its recording, which is then used as a whole.
    """
    named = excitation_named(drop.files[0])
    if named is None or named == "drop":
        return drop
    wheels = wheels_named_anywhere(drop.files[0])
    seen = f"the fall of {', '.join(drop.found.wheels)}" if drop.found.wheels else "a fall"
    notes = (f"a {named} by the name of the recording, in which the accelerations show {seen}", *drop.notes)
    return replace(drop, excitation=named, wheels=wheels, window=None if alone else drop.window, notes=notes)
