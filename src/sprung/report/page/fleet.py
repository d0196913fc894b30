"""The page of a fleet: counts, alarms, and for each type its spread, both control charts and every parameter."""

from __future__ import annotations

from importlib.metadata import version
from typing import NamedTuple

from sprung.fleets import Fleet, FleetType
from sprung.report.drawing.picture import Picture
from sprung.report.page.environment import ENVIRONMENT
from sprung.report.pictures.fleets import fleet_pictures
from sprung.report.terminal.fleet import alarm_sentences, notes_of, spread_table, summary_of
from sprung.tables import Table

FLEET_FILE = "fleet.html"
"""The page's name."""

_LISTED = 200
"""Largest number of campaigns without a result, and of rejected ones, that the page lists."""


class TypePart(NamedTuple):
    """One type on the page.

    Attributes
    ----------
    anchor
        Target of links.
    own
        The type.
    alarms
        Sentences.
    table
        Spread and errors.
    overview, parameters
        Pictures: of the whole type, and one for each parameter.
    """

    anchor: str
    own: FleetType
    alarms: tuple[str, ...]
    table: Table
    overview: tuple[Picture, ...]
    parameters: tuple[Picture, ...]


def fleet_html(fleet: Fleet) -> str:
    """Return the page of a fleet.

    Parameters
    ----------
    fleet
        From `sprung.fleet`.

    Returns
    -------
    str
        Self-contained HTML; identical for identical fleets.
    """
    types = [_part(number, one) for number, one in enumerate(fleet.types, 1)]
    alarms = sum(len(one.chart.rig_alarms) + len(one.chart.vehicle_alarms) for one in fleet.types)
    failures = [(campaign, message.splitlines()) for campaign, message in fleet.failures.items()]
    rejected = list(fleet.rejected.items())
    return ENVIRONMENT.get_template("fleet.html").render(
        summary=summary_of(fleet),
        state="reject" if not fleet.counts.done else "doubtful" if alarms or failures or rejected else "accept",
        alarms=alarms,
        notes=list(notes_of(fleet)),
        types=types,
        failures=failures[:_LISTED],
        unlisted=max(len(failures) - _LISTED, 0),
        rejected=rejected[:_LISTED],
        unlisted_rejected=max(len(rejected) - _LISTED, 0),
        version=version("sprung"),
        macros=ENVIRONMENT.get_template("macros.html").module,
    )


def _part(number: int, one: FleetType) -> TypePart:
    pictures = fleet_pictures(one)
    return TypePart(
        anchor=f"type-{number}",
        own=one,
        alarms=tuple(alarm_sentences(one)),
        table=spread_table(one),
        overview=(pictures["rig"], pictures["vehicle"], pictures["spread"]),
        parameters=tuple(pictures[name] for name in one.estimates.names if name in pictures),
    )
