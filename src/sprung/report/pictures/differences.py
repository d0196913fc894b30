"""Differences of parameters between results, in percent, with their 95 % intervals."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sprung.report.drawing.axis import Axis, axis_limits
from sprung.report.drawing.picture import Mark, Panel, Picture, Points, Role, Rule
from sprung.study import Comparison, Difference
from sprung.uncertainty import NORMAL_95

_ROLES: tuple[tuple[bool, Role, str], ...] = (
    (False, "simulated", "not significant"),
    (True, "fault", "likely or certain"),
)


def differences_picture(comparison: Comparison) -> Picture | None:
    """Return the picture of the differences of all parameters from the first result.

    Parameters
    ----------
    comparison
        Of two or more results.

    Returns
    -------
    Picture or None
        Percent, a panel for each result but the first; None where nothing can be compared.
    """
    shown = {
        name: row.differences
        for name, row in comparison.parameters.items()
        if any(_interval(difference) is not None for difference in row.differences)
    }
    if not shown:
        return None
    reference, *others = comparison.results
    ticks = tuple((float(place), name.removesuffix(" / total mass")) for place, name in enumerate(shown))
    x = Axis("parameter", -0.6, len(shown) - 0.4, ticks=ticks)
    panels = tuple(
        _panel(other.name, reference.name, [differences[number] for differences in shown.values()])
        for number, other in enumerate(others)
    )
    text = "; ".join(f"{other.name}: {_significant(comparison, i)}" for i, other in enumerate(others))
    kind = " over total mass" if comparison.per_total_mass else ""
    title = f"Parameters{kind}: difference from {reference.name}"
    return Picture(title, x, panels, f"Differences with 95 % intervals. Significant: {text}.")


def _panel(name: str, reference: str, differences: list[Difference]) -> Panel:
    marks: list[Mark] = [Rule(0.0, "reference", horizontal=True)]
    ends = [np.zeros(1)]
    for significant, role, label in _ROLES:
        found = [
            (place, *interval)
            for place, difference in enumerate(differences)
            if (interval := _interval(difference)) is not None
            and (difference.finding in {"likely", "certain"}) == significant
        ]
        if found:
            places, percent, half = np.array(found, dtype=float).T
            marks.append(Points(places, percent, role, label, bars=half))
            ends += [percent - half, percent + half]
    return Panel(Axis("%", *axis_limits(*ends)), tuple(marks), height=1.5, note=f"{name} minus {reference}")


def _interval(difference: Difference) -> tuple[float, float] | None:
    """Return a difference and half of its 95 % interval in percent; None where it is not comparable or was known."""
    if not difference.percent or not difference.value or not difference.std:
        return None
    return difference.percent, NORMAL_95 * abs(difference.percent * difference.std / difference.value)


def _significant(comparison: Comparison, number: int) -> str:
    return ", ".join(_names(comparison, number)) or "none"


def _names(comparison: Comparison, number: int) -> Iterator[str]:
    for name, row in comparison.parameters.items():
        difference = row.differences[number]
        if difference.finding in {"likely", "certain"} and difference.percent is not None:
            yield f"{name} {difference.percent:+.3g} %"
