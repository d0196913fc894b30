"""What the recordings of a campaign show and what is missing, for the terminal."""

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
from sprung.report.terminal.layout import figures, hanging, laid_out
from sprung.report.terminal.result import fault_list
from sprung.tables import Table

_FEW = 3
"""Drops that are named; of more the number is said."""


class MissingItem(NamedTuple):
    """Something that a campaign file does not say, in one or several places.

    Attributes
    ----------
    item
        What it is.
    what
        What is to be written there.
    places
        Of which sensors, loads or drops.
    needed
        Whether nothing can be identified without it.
    """

    item: str
    what: str
    places: str
    needed: bool


def missing_items(missing: Sequence[MissingEntry]) -> list[MissingItem]:
    """Collect what is missing alike in several places.

    Parameters
    ----------
    missing
        Of a campaign.
    """
    alike: defaultdict[str, list[MissingEntry]] = defaultdict(list)
    for one in missing:
        alike[one.item].append(one)
    found = []
    for item, ones in alike.items():
        places = [named[1] for one in ones if (named := re.search(r"\(([^()]*)\)$", one.problem.where))]
        found.append(MissingItem(item, ones[0].problem.expected, ", ".join(places), any(one.needed for one in ones)))
    return found


def check_view(check: Check, page: Path | None = None) -> RenderableType:
    """Show what the recordings of a campaign show and what is missing; in the last line how many drops are usable.

    Parameters
    ----------
    check
        From `sprung.check`.
    page
        Where its page was written.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    parts = [laid_out(drops_table(check.drops))]
    if reasons := list(_reasons(check.drops)):
        parts += [Text(), _listed("Limits of the decays", reasons)]
    if others := [drop for drop in check.drops if drop.contradicted]:
        parts += [Text(), _listed("Otherwise than stated", map(_otherwise, others))]
    if any(drop.channels for drop in check.drops):
        parts += [Text(), laid_out(channels_table(check.drops))]
    if check.faults:
        parts += [Text(), fault_list(check.faults)]
    if check.missing:
        parts += [Text(), _listed("Missing", map(_said, missing_items(check.missing)))]
    if page is not None:
        parts += [Text(), Text(f"Page: {page}", no_wrap=True, overflow="ignore")]
    return Group(*parts, Text(), Text(check.summary, style="bold"))


def _said(missing: MissingItem) -> str:
    places = f" ({missing.places})" if missing.places else ""
    return f"{missing.item}{places}: {missing.what}" + ("" if missing.needed else "; recommended")


def drops_table(drops: Sequence[DropReport]) -> Table:
    """Show what happened when in each drop.

    Parameters
    ----------
    drops
        What is said of them.
    """
    headers = ("recording", "load", "dropped", "release", "landing", "lift-off", "from", "to", "length", "faults")
    rows = []
    for drop in drops:
        moments = [_moment(moment) for moment in (drop.release, drop.landing, drop.last_lift_off, drop.start, drop.end)]
        length = "" if drop.start is None or drop.end is None else f"{drop.end - drop.start:.2f}"
        if drop.start is None:
            moments[-1] = "left out"
        rows.append([drop.label, drop.load, drop.kind, *moments, length, ", ".join(drop.faults)])
    title = "Drops, s on each recording's own clock; free decay from ... to"
    spare = ("length", "faults", "load", "lift-off", "landing", "release")
    return Table(title, headers, tuple(map(tuple, rows)), frozenset(headers[3:9]), spare)


def _moment(moment: float | None) -> str:
    return "-" if moment is None else f"{moment:.3f}"


def _reasons(drops: Sequence[DropReport]) -> Iterator[str]:
    """Say every reason once, and of which drops it is the one."""
    used = [drop for drop in drops if drop.start is not None]
    for side in ("start", "end"):
        reasons: defaultdict[str, list[str]] = defaultdict(list)
        for drop in used:
            if why := getattr(drop, f"why_{side}"):
                reasons[why].append(drop.label)
        for why, files in reasons.items():
            yield f"{'from' if side == 'start' else 'to'}: {why} ({_which(files, len(used))})"
    rates: defaultdict[str, list[str]] = defaultdict(list)
    for drop in drops:
        if drop.rate is not None:
            rates[f"{drop.rate:.6g} samples per second"].append(drop.label)
    for rate, files in rates.items():
        yield f"{rate} ({_which(files, len(drops))})"


def _which(files: Sequence[str], everything: int) -> str:
    if len(files) == everything and everything > 1:
        return "all drops"
    return ", ".join(files) if len(files) <= _FEW else f"{len(files)} drops"


def _otherwise(drop: DropReport) -> str:
    seen = ", ".join(drop.wheels_seen or ()) or "no wheel"
    return f"{drop.label}: {', '.join(drop.wheels)} stated to be dropped; the release shows {seen} to have fallen"


def channels_table(drops: Sequence[DropReport]) -> Table:
    """Show each channel over all drops.

    Parameters
    ----------
    drops
        What is said of them.
    """
    by_name: defaultdict[str, list[tuple[DropReport, ChannelReport]]] = defaultdict(list)
    for drop in drops:
        for channel in drop.channels:
            by_name[channel.name].append((drop, channel))
    rows = []
    for name, found in by_name.items():
        noise = [channel.noise for _, channel in found if channel.noise is not None]
        peaks = [channel.peak for _, channel in found if channel.peak is not None]
        out = [drop.label for drop, channel in found if drop.start is not None and not channel.used]
        usual, most = (figures(size(noise), 2) if noise else "-" for size in (median, max))
        peak = figures(max(peaks), 3) if peaks else "-"
        rows.append([name, found[0][1].on or "a wheel", usual, most, peak, _which(out, len(found)) if out else ""])
    headers = ("channel", "on", "noise", "largest", "peak", "left out of")
    title = "Channels, m/s²: noise at rest (median and largest), largest peak after a release"
    spare = ("left out of", "on", "largest")
    return Table(title, headers, tuple(map(tuple, rows)), frozenset(headers[2:5]), spare)


def _listed(title: str, lines: Iterable[str]) -> RenderableType:
    return Group(Text(title, style="bold"), *(hanging("  - ", line) for line in lines))
