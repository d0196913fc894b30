"""Words for what excited the vehicle, and for the part of a recording that is fitted."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from sprung.checking import DropReport
from sprung.display import enumerated

_TESTS: Mapping[str, str] = {
    "drop": "drop tests",
    "push": "pushes",
    "pass": "passes over a bump",
    "pads": "tests on pads",
}
"""Plural of the tests with each excitation, in the order in which they are named."""

FREE, DRIVEN = "free decay", "forced response"
"""The part of a recording that is fitted: after the excitation, or under it."""


def excitations_text(drops: Iterable[DropReport]) -> str:
    """Return the tests of a campaign in words, such as ``drop tests and pushes``; ``drop tests`` without any.

    Parameters
    ----------
    drops
        Reports of the drops.
    """
    excitations = {drop.excitation for drop in drops} or {"drop"}
    return enumerated([text for excitation, text in _TESTS.items() if excitation in excitations])


def record_text(drop: DropReport) -> str:
    """Return what the fitted part of a recording is: ``free decay``, or ``forced response`` on pads.

    Parameters
    ----------
    drop
        Report of the drop.
    """
    return DRIVEN if drop.is_driven else FREE


def records_text(drops: Iterable[DropReport], plural: bool = True) -> str:
    """Return what the fitted parts of several recordings are; ``free decays`` without any.

    Parameters
    ----------
    drops
        Reports of the drops.
    plural
        Whether of all drops, and not of each.
    """
    found = {record_text(drop) for drop in drops} or {FREE}
    texts = [text for text in (FREE, DRIVEN) if text in found]
    return enumerated([f"{text}s" for text in texts]) if plural else " or ".join(texts)


def limits_text(drop: DropReport) -> str:
    """Return the limits of the part of a drop that is used, with reasons; empty where none is.

    Parameters
    ----------
    drop
        Report of the drop.

    Returns
    -------
    str
    """
    if drop.start is None or drop.end is None:
        return ""
    what = record_text(drop)
    return (
        f"{what[0].upper()}{what[1:]} from {drop.start:.3f} s ({drop.why_start}) to {drop.end:.3f} s ({drop.why_end})."
    )


def readings_text(drops: Iterable[DropReport]) -> str:
    """Return what the channels measure, and in which units, such as ``Accelerations in m/s²``.

    Parameters
    ----------
    drops
        Reports of the drops.
    """
    channels = [channel for drop in drops for channel in drop.channels]
    what = "Accelerations" if {channel.quantity for channel in channels} <= {"acceleration"} else "Readings"
    return f"{what} in {', '.join(dict.fromkeys(channel.unit for channel in channels)) or 'm/s²'}"
