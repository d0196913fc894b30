"""Text of a drafted campaign file: keys in their usual order, findings as comments, placeholders for what is missing."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator

from sprung.campaign import SCHEMA_LINE, find_placeholders
from sprung.display import enumerated
from sprung.drafting.draft_campaign import DraftCampaign
from sprung.drafting.section_text import (
    added_totals,
    comment,
    drop_section,
    load_section,
    sensor_section,
    vehicle_section,
)
from sprung.vehicle import LAYOUTS

_HEAD = """\
# Drafted by `sprung new` from the recordings in this folder. Go through it from top to bottom: in place of every text that
# begins with TODO write what it asks for; `sprung check` lists those that are left.
# Lengths m, masses kg, times s, angles rad. x forward from the front axle, y left from the centreline, z up from the ground.
{of}schema = 1
"""

_SETTING = """\
# These are the recordings whose names state {setting}. Another setting is another vehicle, with a campaign file of its own;
# `sprung new --no-settings` drafts one file for all recordings.
"""

_LOADS = """\
# One [[load]] for each load that was on the vehicle in some of the drops; the load "empty" always exists, and a vehicle that
# was dropped only empty needs none. Weigh each piece, measure where its centre lies, and write:
#
# [[load]]
# name     = "sandbags"                # what the drops call it: load = "sandbags"
# items    = [ { mass = 235, position = [-1.2, 0.4, 1.1] },     # kg; m: forward of the front axle, left, above the ground
#              { mass = 20, on = "{wheel}" } ]  # a piece on a wheel: {wheels}
# or, when only totals are known, centred on the body, in place of items:
# added    = {added}
"""

_ADDED = {"mass": "470", "I_yy": "1057.5", "I_xx": "339.6"}


def campaign_text(draft: DraftCampaign) -> str:
    """Write a campaign file.

    Parameters
    ----------
    draft
        The draft.

    Returns
    -------
    str
        TOML, with a placeholder for everything that the recordings do not show.
    """
    sections = [
        SCHEMA_LINE + _HEAD.format(of=_SETTING.format(setting=draft.setting) if draft.setting else ""),
        vehicle_section(draft.name, draft.model),
        *(sensor_section(sensor, draft.model) for sensor in draft.sensors),
        _loads(draft),
        *(load_section(name, draft) for name in draft.loads),
        *(drop_section(drop, draft) for drop in draft.drops),
    ]
    others = [*_copies(draft), *_without_drop(draft), *_unread(draft), *_left_out(draft)]
    if others:
        sections.append("\n".join(others) + "\n")
    return "\n".join(sections)


def missing_in(text: str) -> tuple[tuple[str, str], ...]:
    """Return the placeholders of a campaign file: the place, and what to write there.

    Parameters
    ----------
    text
        TOML.
    """
    document = tomllib.loads(text)
    found = []
    for place, what in find_placeholders(document):
        where = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in place).lstrip(".")
        label = ""
        if len(place) > 2 and isinstance(place[1], int):
            entry = document[str(place[0])][place[1]]
            label = next((str(entry[key]) for key in ("channel", "name", "file") if key in entry), "")
        found.append((f"{where} ({label})" if label else where, what))
    return tuple(found)


def _loads(draft: DraftCampaign) -> str:
    """Return how a load is described."""
    wheels = LAYOUTS[draft.model].wheels
    either = enumerated(wheels, "or")
    piece = f'{{ mass = 20, on = "{wheels[0]}" }} ]'
    totals = ", ".join(f"{total} = {_ADDED[total]}" for total in added_totals(draft.model))
    return (
        _LOADS.replace('{ mass = 20, on = "{wheel}" } ]  ', f"{piece:<49}")
        .replace("{wheels}", either)
        .replace("{added}", f"{f'{{ {totals} }}':<51}# kg and kg m²")
    )


def _copies(draft: DraftCampaign) -> Iterator[str]:
    for name, original in draft.copies.items():
        yield comment(f"Left out: {name}: identical to {original}.")


def _without_drop(draft: DraftCampaign) -> Iterator[str]:
    for file in draft.files:
        if not file.drops:
            why = file.rejected[0].why if file.rejected else "it shows no motion"
            yield comment(f"No drop was found in {file.name}: {why}.")


def _unread(draft: DraftCampaign) -> Iterator[str]:
    for name, problems in draft.unreadable.items():
        yield comment(f"Not read: {name}: {problems[0].found}.")


def _left_out(draft: DraftCampaign) -> Iterator[str]:
    said: dict[tuple[str, str], None] = {}
    for file in draft.files:
        said |= dict.fromkeys(file.left_out.items())
    for channel, why in said:
        yield comment(f"No sensor: '{channel}': {why}.")
