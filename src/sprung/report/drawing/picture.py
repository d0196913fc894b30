"""Pictures as data: panels one above the other, with curves, points, lines and bands.

A page draws them as SVG (`sprung.report.drawing.svg`), a notebook with matplotlib (`sprung.plot`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sprung.report.drawing.axis import Axis

Real = NDArray[np.float64]

_COINCIDENT = 0.015
"""Distance of two lines, as a part of the axis, below which their labels are merged."""

Role = Literal[
    "measured",
    "simulated",
    "residual",
    "signal",
    "unused",
    "release",
    "landing",
    "fault",
    "mode",
    "first",
    "second",
    "reference",
]
"""Meaning of a mark, which determines its colour."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through points, interrupted where a value is NaN.

    Attributes
    ----------
    x, y
        In the units of the axes, shape (point,).
    role
        Its meaning.
    label
        For the legend; empty for none.
    width
        Line width, dimensionless; 1 is the default.
    dashed
        Whether it is dashed.
    band
        Half-height of a shaded band about it, such as that of its 95 % intervals, in the unit of the axis, shape (point,); None
        without.
    """

    x: Real
    y: Real
    role: Role
    label: str = ""
    width: float = 1.0
    dashed: bool = False
    band: Real | None = None


@dataclass(frozen=True, eq=False)
class Points:
    """Single points, with error bars where there are uncertainties.

    Attributes
    ----------
    x, y
        In the units of the axes, shape (point,).
    role
        Their meaning.
    label
        For the legend; empty for none.
    hollow
        Whether they are rings.
    bars
        Half-lengths of error bars along y, in the unit of that axis, shape (point,); None without.
    size
        Radius, dimensionless; 1 is the default.
    """

    x: Real
    y: Real
    role: Role
    label: str = ""
    hollow: bool = False
    bars: Real | None = None
    size: float = 1.0


@dataclass(frozen=True)
class Rule:
    """A vertical or horizontal line across a panel.

    Attributes
    ----------
    at
        Position, in the unit of the axis.
    role
        Its meaning.
    label
        Above a vertical line in the first panel, in the legend for a horizontal one; empty for none.
    horizontal
        Whether it is horizontal.
    dashed
        Whether it is dashed.
    """

    at: float
    role: Role
    label: str = ""
    horizontal: bool = False
    dashed: bool = False


@dataclass(frozen=True)
class Band:
    """A shaded range of x, such as the free decay.

    Attributes
    ----------
    low, high
        Its ends, in the unit of the axis.
    """

    low: float
    high: float


Mark: TypeAlias = Curve | Points | Rule | Band
"""Any mark of a panel."""


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes.

    Attributes
    ----------
    y
        Its vertical axis.
    marks
        Drawn in this order.
    height
        Relative to the other panels of the picture, dimensionless.
    note
        Text in its upper right corner.
    warning
        Text below the note, in the colour of faults.
    name
        Left of it, above the label of the axis, for channels.
    channel
        Channel that it belongs to, where a reader may hide the panels of a channel; empty otherwise.
    """

    y: Axis
    marks: tuple[Mark, ...]
    height: float = 1.0
    note: str = ""
    warning: str = ""
    name: str = ""
    channel: str = ""


@dataclass(frozen=True, eq=False)
class Picture:
    """Panels one above the other on one horizontal axis.

    Attributes
    ----------
    title
        Above it.
    x
        The horizontal axis.
    panels
        The first on top.
    description
        Content in a sentence, for screen readers.
    zoomable
        Whether the script of the page offers zoom, cursor and channel selection.
    """

    title: str
    x: Axis
    panels: tuple[Panel, ...]
    description: str = ""
    zoomable: bool = False

    @property
    def legend(self) -> Iterator[Curve | Points]:
        """Curves and points with a label, each label once."""
        labels: set[str] = set()
        for panel in self.panels:
            for mark in panel.marks:
                if isinstance(mark, Curve | Points) and mark.label and mark.label not in labels:
                    labels.add(mark.label)
                    yield mark


def merge_labels(rules: Sequence[Rule], axis: Axis) -> tuple[Rule, ...]:
    """Return lines with the labels of coincident ones merged at the first of them.

    Parameters
    ----------
    rules
        Vertical lines, each with a label.
    axis
        The horizontal axis.
    """
    merged: list[Rule] = []
    lead = 0
    for rule in sorted(rules, key=lambda line: line.at):
        if merged and abs(float(axis.at(np.array(rule.at)) - axis.at(np.array(merged[lead].at)))) < _COINCIDENT:
            merged[lead] = replace(merged[lead], label=f"{merged[lead].label}, {rule.label}")
            merged.append(replace(rule, label=""))
        else:
            lead = len(merged)
            merged.append(rule)
    return tuple(merged)
