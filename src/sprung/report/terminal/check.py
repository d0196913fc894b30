"""The check of a campaign, for the terminal."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.campaign import MissingEntry
from sprung.checking import ChannelReport, Check, DropReport
from sprung.report.excitations import records_text
from sprung.report.terminal.layout import hanging_text, render_table, significant_figures
from sprung.report.terminal.result import fault_list
from sprung.tables import Table

_FEW = 3
"""Drops that are listed by name; of more their number is given."""


class MissingItem(NamedTuple):
    """A missing item of a campaign file, in one or several places.

    Attributes
    ----------
    item
        Its name.
    what
        What to write there.
    places
        Sensors, loads or drops that lack it.
    needed
        Whether an identification is impossible without it.
    """

    item: str
    what: str
    places: str
    needed: bool


def missing_items(missing: Sequence[MissingEntry]) -> list[MissingItem]:
    """Return missing items, with the places of equal ones merged.

    Parameters
    ----------
    missing
        Of a campaign.
    """
    by_item: defaultdict[str, list[MissingEntry]] = defaultdict(list)
    for entry in missing:
        by_item[entry.item].append(entry)
    items = []
    for item, entries in by_item.items():
        places = [match[1] for entry in entries if (match := re.search(r"\(([^()]*)\)$", entry.problem.where))]
        needed = any(entry.needed for entry in entries)
        items.append(MissingItem(item, entries[0].problem.expected, ", ".join(places), needed))
    return items


def check_view(check: Check, page: Path | None = None) -> RenderableType:
    """Return the view of a check; its last line is the number of usable drops.

    Parameters
    ----------
    check
        From `sprung.check`.
    page
        Path of its page.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    parts = [render_table(drops_table(check.drops))]
    if reasons := list(_reasons(check.drops)):
        parts += [Text(), _listed(f"Limits of the {records_text(check.drops)}", reasons)]
    if contradicted := [drop for drop in check.drops if drop.contradicted]:
        parts += [Text(), _listed("Wheels other than stated", map(_contradiction, contradicted))]
    if any(drop.channels for drop in check.drops):
        parts += [Text(), render_table(channels_table(check.drops))]
    if check.faults:
        parts += [Text(), fault_list(check.faults)]
    if check.missing:
        parts += [Text(), _listed("Missing", map(_missing_text, missing_items(check.missing)))]
    if page is not None:
        parts += [Text(), Text(f"Report: {page}", no_wrap=True, overflow="ignore")]
    return Group(*parts, Text(), Text(check.summary, style="bold"))


def _missing_text(missing: MissingItem) -> str:
    places = f" ({missing.places})" if missing.places else ""
    return f"{missing.item}{places}: {missing.what}" + ("" if missing.needed else "; recommended")


def drops_table(drops: Sequence[DropReport]) -> Table:
    """Return the table of the drops with their events.

    Parameters
    ----------
    drops
        Reports of the drops.
    """
    is_dropped = all(drop.excitation == "drop" for drop in drops)
    done = ("dropped", "release") if is_dropped else ("excitation", "moves")
    headers = ("recording", "load", *done, "landing", "lift-off", "from", "to", "length", "faults")
    rows = []
    for drop in drops:
        moments = [_moment(moment) for moment in (drop.release, drop.landing, drop.last_lift_off, drop.start, drop.end)]
        length = "" if drop.start is None or drop.end is None else f"{drop.end - drop.start:.2f}"
        if drop.start is None:
            moments[-1] = "left out"
        rows.append([drop.label, drop.load, drop.kind, *moments, length, ", ".join(drop.faults)])
    title = f"Drops: times in s on each recording's own clock; {records_text(drops, plural=False)} from ... to ..."
    spare = ("length", "faults", "load", "lift-off", "landing", done[1])
    return Table(title, headers, tuple(map(tuple, rows)), frozenset(headers[3:9]), spare)


def _moment(moment: float | None) -> str:
    return "-" if moment is None else f"{moment:.3f}"


def _reasons(drops: Sequence[DropReport]) -> Iterator[str]:
    """Yield every reason once, with its drops."""
    used = [drop for drop in drops if drop.start is not None]
    for side in ("start", "end"):
        reasons: defaultdict[str, list[str]] = defaultdict(list)
        for drop in used:
            if why := getattr(drop, f"why_{side}"):
                reasons[why].append(drop.label)
        for why, labels in reasons.items():
            yield f"{side}: {why} ({_drop_names(labels, len(used))})"
    rates: defaultdict[str, list[str]] = defaultdict(list)
    for drop in drops:
        if drop.rate is not None:
            rates[f"sampling rate {drop.rate:.6g} Hz"].append(drop.label)
    for rate, labels in rates.items():
        yield f"{rate} ({_drop_names(labels, len(drops))})"


def _drop_names(labels: Sequence[str], total: int) -> str:
    if len(labels) == total and total > 1:
        return "all drops"
    return ", ".join(labels) if len(labels) <= _FEW else f"{len(labels)} drops"


def _contradiction(drop: DropReport) -> str:
    seen = ", ".join(drop.wheels_seen or ()) or "no wheel"
    return f"{drop.label}: stated {', '.join(drop.wheels)}, detected {seen}"


def channels_table(drops: Sequence[DropReport]) -> Table:
    """Return the table of the channels over all drops.

    Parameters
    ----------
    drops
        Reports of the drops.
    """
    by_name: defaultdict[str, list[tuple[DropReport, ChannelReport]]] = defaultdict(list)
    for drop in drops:
        for channel in drop.channels:
            by_name[channel.name].append((drop, channel))
    rows = []
    for name, found in by_name.items():
        noise = [channel.noise for _, channel in found if channel.noise is not None]
        peaks = [channel.peak for _, channel in found if channel.peak is not None]
        without = [drop.label for drop, channel in found if drop.start is not None and not channel.used]
        median_noise, largest = (
            significant_figures(statistic(noise), 2) if noise else "-" for statistic in (median, max)
        )
        peak = significant_figures(max(peaks), 3) if peaks else "-"
        left_out = _drop_names(without, len(found)) if without else ""
        rows.append([name, found[0][1].on or "a wheel", found[0][1].unit, median_noise, largest, peak, left_out])
    headers = ["channel", "on", "unit", "noise", "largest", "peak", "left out of"]
    units = list(dict.fromkeys(row[2] for row in rows))
    if len(units) == 1:
        for row in (headers, *rows):
            del row[2]
    unit = f", {units[0]}" if len(units) == 1 else ""
    title = f"Channels{unit}: noise at rest (median, largest), largest peak after a release"
    spare = ("left out of", "on", "largest")
    return Table(title, tuple(headers), tuple(map(tuple, rows)), frozenset(headers[-4:-1]), spare)


def _listed(title: str, lines: Iterable[str]) -> RenderableType:
    return Group(Text(title, style="bold"), *(hanging_text("  - ", line) for line in lines))
