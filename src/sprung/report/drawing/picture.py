"""What a picture shows, apart from how it is drawn: panels one above the other, with curves, points and lines in them.

A page draws it as SVG (`sprung.report.drawing.svg`), a notebook with matplotlib (`sprung.plot`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sprung.report.drawing.axis import Axis

Real = NDArray[np.float64]

_LIKE_ONE = 0.015
"""Part of an axis by which two lines may be apart and look like one."""

Role = Literal[
    "measured",
    "simulated",
    "left",
    "signal",
    "unused",
    "release",
    "landing",
    "fault",
    "mode",
    "first",
    "second",
    "quiet",
]
"""What something drawn stands for; its colour follows."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through points; it parts where a value is NaN.

    Attributes
    ----------
    x, y
        In the units of the axes, shape (point,).
    role
        What it stands for.
    label
        For the legend; empty for none.
    width
        Of the line, 1 for the usual.
    dashed
        Whether it is.
    """

    x: Real
    y: Real
    role: Role
    label: str = ""
    width: float = 1.0
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Points:
    """Single points, with bars where there are uncertainties.

    Attributes
    ----------
    x, y
        In the units of the axes, shape (point,).
    role
        What they stand for.
    label
        For the legend; empty for none.
    hollow
        Whether they are rings.
    bars
        Half-lengths of bars along y, in the unit of that axis, shape (point,); none without.
    size
        Radius, dimensionless: 1 for the usual.
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
    """A line across a panel, at some x, or at some y where it lies.

    Attributes
    ----------
    at
        Where, in the unit of the axis.
    role
        What it stands for.
    label
        Written at it in the first panel, or in the legend where it lies; empty for none.
    lying
        Whether it is at some y.
    dashed
        Whether it is.
    """

    at: float
    role: Role
    label: str = ""
    lying: bool = False
    dashed: bool = False


@dataclass(frozen=True)
class Band:
    """A stretch of x that is shaded: the decay.

    Attributes
    ----------
    low, high
        Its ends, in the unit of the axis.
    """

    low: float
    high: float


Mark: TypeAlias = Curve | Points | Rule | Band
"""Anything that is drawn into a panel."""


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes.

    Attributes
    ----------
    y
        Its vertical axis.
    marks
        What is drawn, the hindmost first.
    height
        Beside the other panels of the picture, dimensionless.
    note
        What is written into it, upper right.
    wrong
        What is written below the note, as a fault.
    name
        Written on its left, above the axis' label, as channels have.
    channel
        What it belongs to, where a reader may switch it off with others of the same; empty where not.
    """

    y: Axis
    marks: tuple[Mark, ...]
    height: float = 1.0
    note: str = ""
    wrong: str = ""
    name: str = ""
    channel: str = ""


@dataclass(frozen=True, eq=False)
class Picture:
    """Panels one above the other on one horizontal axis.

    Attributes
    ----------
    title
        What it shows, for its head.
    x
        The horizontal axis.
    panels
        The first on top.
    told
        What there is to see, in a sentence, for who cannot.
    zoomable
        Whether a page's script may zoom it, read it out and switch its channels off.
    """

    title: str
    x: Axis
    panels: tuple[Panel, ...]
    told: str = ""
    zoomable: bool = False

    @property
    def legend(self) -> Iterator[Curve | Points]:
        """What has a label, each once."""
        said: set[str] = set()
        for panel in self.panels:
            for mark in panel.marks:
                if isinstance(mark, Curve | Points) and mark.label and mark.label not in said:
                    said.add(mark.label)
                    yield mark


def labelled_together(rules: Sequence[Rule], axis: Axis) -> tuple[Rule, ...]:
    """Write the labels of lines that look like one at the first of them.

    Parameters
    ----------
    rules
        Lines at some x, each with a label.
    axis
        The horizontal one.
    """
    found: list[Rule] = []
    lead = 0
    for rule in sorted(rules, key=lambda one: one.at):
        if found and abs(float(axis.at(np.array(rule.at)) - axis.at(np.array(found[lead].at)))) < _LIKE_ONE:
            found[lead] = replace(found[lead], label=f"{found[lead].label}, {rule.label}")
            found.append(replace(rule, label=""))
        else:
            lead = len(found)
            found.append(rule)
    return tuple(found)
