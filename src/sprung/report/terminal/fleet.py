"""A fleet, for the terminal; the table is that of the page too."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.display import count_text
from sprung.fleets import ALL_VEHICLES, Deviation, Fleet, FleetType, ParameterSpread
from sprung.report.terminal.layout import hanging_text, render_table
from sprung.report.terminal.result import COLOURS
from sprung.tables import Table, percent_text, unit_text
from sprung.uncertainty import round_by_uncertainty

_ALTERNATIVES = 2
"""Largest number of further explanations of a drift that are listed."""

_NUMBER = re.compile(r"\d+(\.\d+)?")

_LISTED = 20
"""Largest number of failures or vehicles that the terminal lists."""


def fleet_view(fleet: Fleet) -> RenderableType:
    """Return the view of a fleet: counts, alarms, spread and errors of every type.

    Parameters
    ----------
    fleet
        From `sprung.fleet`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    parts: list[RenderableType] = [Text(summary_of(fleet), style="bold")]
    parts += [hanging_text("  - ", note) for note in notes_of(fleet)]
    for outcomes in (fleet.failures, fleet.rejected):
        kind = "rejected: " if outcomes is fleet.rejected else ""
        for campaign, text in list(outcomes.items())[:_LISTED]:
            parts.append(hanging_text("  - ", f"{kind}{campaign}: {_first_problem(text)}"))
        if len(outcomes) > _LISTED:
            parts.append(hanging_text("  - ", f"{kind}and {len(outcomes) - _LISTED} more: see fleet.json"))
    for one in fleet.types:
        parts += [Text(), render_table(spread_table(one))]
        parts += [hanging_text("  - ", sentence) for sentence in alarm_sentences(one)]
    return Group(*parts)


def _first_problem(message: str) -> str:
    """Return the first line of a message, and how many more there are."""
    first, *others = message.splitlines() or [""]
    return f"{first} ({count_text(len(others), 'more problem')}: see fleet.html)" if others else first


def summary_of(fleet: Fleet) -> str:
    """Return the counts of a fleet in one sentence."""
    counts = fleet.counts
    verdicts = ", ".join(f"{fleet.verdicts[name]} {name}" for name in COLOURS if fleet.verdicts.get(name))
    there = counts.done + counts.failed - fleet.computed
    identified = count_text(counts.done, "campaign")
    text = f"{identified} identified{f' ({verdicts})' if verdicts else ''}, {counts.failed} failed"
    return f"{text}; {there} of them in an earlier run." if there else f"{text}."


def notes_of(fleet: Fleet) -> Iterator[str]:
    """Yield what is to be said of the campaigns and of types with too few vehicles."""
    if fleet.gone:
        earlier = count_text(len(fleet.gone), "campaign")
        yield f"{earlier} of an earlier run not among the given ones, the first {fleet.gone[0]}: kept and included"
    yield from _doubts(fleet.doubtful)
    for one in fleet.types:
        if not one.estimates.has_scale:
            yield (
                f"{one.name}: no vehicle was weighed or tested with a known load, so that no absolute mass, inertia or rate is "
                "determined. Their ratios to the total mass of each vehicle are compared (k_sf/total_mass). To determine the "
                "scale of all, state total_mass under [known] of at least one vehicle"
            )
        if one.estimates.undetermined:
            names = ", ".join(one.estimates.undetermined)
            yield f"{one.name}: left out, because no vehicle's test determines them: {names}"
    for name, parts in fleet.parts.items():
        counts = ", ".join(f"{part} ({count})" for part, count in parts.items())
        yield (
            f"{name}: different parts of a vehicle ([vehicle] model) are compared apart, as the same name means another "
            f"quantity in each: {counts}"
        )
    if fleet.small_types:
        names = ", ".join(f"{name} ({count})" for name, count in list(fleet.small_types.items())[:_LISTED])
        more = f" and {len(fleet.small_types) - _LISTED} more" if len(fleet.small_types) > _LISTED else ""
        yield f"too few vehicles of one type to compare: {names}{more}"
        if not all(name.startswith(ALL_VEHICLES) for name in fleet.small_types):
            yield (
                "to compare them, give the vehicles of a type one [vehicle] name and each its own identification, or compare "
                "all: --one-type"
            )


def _doubts(doubtful: Mapping[str, str]) -> Iterator[str]:
    """Yield the reasons of doubtful verdicts; those that differ only by their numbers are one, the most frequent first."""
    groups: defaultdict[str, list[str]] = defaultdict(list)
    for campaign, reason in doubtful.items():
        groups[_NUMBER.sub("#", reason)].append(campaign)
    for campaigns in sorted(groups.values(), key=len, reverse=True)[:_LISTED]:
        first = campaigns[0]
        those = first if len(campaigns) == 1 else f"{count_text(len(campaigns), 'campaign')}, the first {first}"
        yield f"doubtful: {those}: {doubtful[first]}"
    if len(groups) > _LISTED:
        yield f"doubtful: {count_text(len(groups) - _LISTED, 'more reason')}: see fleet.json"


def spread_table(one: FleetType) -> Table:
    """Return the table of a type: mean, spread between vehicles, errors of their tests, limits."""
    rows = [(name, *_spread_cells(spread)) for name, spread in one.parameters.items()]
    headers = ("", "mean", "±", "unit", "spread %", "± %", "own error %", "with the others %", "95 % limits")
    return Table(
        f"{one.name}: {count_text(one.estimates.count, 'vehicle')}",
        headers,
        tuple(rows),
        frozenset(headers[1:3] + headers[4:]),
        ("95 % limits", "± %", "±", "unit"),
    )


def _spread_cells(spread: ParameterSpread) -> tuple[str, ...]:
    mean, mean_std = round_by_uncertainty(spread.mean, spread.mean_std)
    unit = unit_text(spread.unit)
    if spread.exact:
        return (mean, "exact", unit, *["-"] * 5)
    digits = len(mean.partition(".")[2])
    low, high = (f"{limit:.{digits}f}" for limit in spread.limits)
    return (
        mean,
        mean_std,
        unit,
        percent_text(spread.spread),
        percent_text(spread.spread_std),
        "-" if spread.error is None else percent_text(spread.error),
        percent_text(spread.hierarchical_error),
        f"{low} to {high}",
    )


def alarm_sentences(one: FleetType) -> Iterator[str]:
    """Yield the alarms of a type, one sentence each, and how often they are false."""
    for alarm in one.chart.rig_alarms:
        what = " or ".join(map(_text, (alarm.deviation, *alarm.alternatives[:_ALTERNATIVES])))
        yield (
            f"rig: {what} in all vehicles since number {alarm.since} ({alarm.since_label}), detected at "
            f"number {alarm.number} ({alarm.label})"
        )
    for vehicle in one.chart.vehicle_alarms:
        what = ", ".join(map(_text, vehicle.deviations))
        yield f"vehicle {vehicle.label} (number {vehicle.number}) deviates: {what}"
    if not one.chart.rig_alarms and not one.chart.vehicle_alarms:
        yield "no alarm: no vehicle deviates, and the rig does not drift"
    yield (
        f"each chart raises one false alarm in {one.chart.run_length:.0f} vehicles on average; "
        f"{'correlations between parameters are' if one.population.correlated else 'no correlation between parameters is'} "
        "supported by the data"
    )


def _text(deviation: Deviation) -> str:
    std = deviation.percent_std
    return f"{deviation.name} {deviation.percent:+.1f} ± {std:.1f} %"
