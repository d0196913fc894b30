"""A picture drawn into matplotlib axes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator

from sprung.errors import InputError, Problem, did_you_mean
from sprung.report import LIGHT, Band, Curve, Mark, Panel, Picture, Points, Rule

_WIDTH, _HEIGHT = 7.0, 1.5
"""inches: of a figure, and of a panel of height 1."""

_AROUND = 0.9
"""inches above and below the panels."""


def drawn(picture: Picture, axes: Iterable[Axes] | None = None) -> tuple[Axes, ...]:
    """Draw a picture.

    Parameters
    ----------
    picture
        What it shows.
    axes
        One for each of its panels; a figure of its own unless given.

    Returns
    -------
    tuple of Axes

    Raises
    ------
    InputError
        If there are not as many axes as panels.
    """
    own = _own_axes(picture) if axes is None else tuple(axes)
    if len(own) != len(picture.panels):
        wanted = f"{len(picture.panels)} axes, one for each panel"
        raise InputError(
            [Problem("axes", f"{len(own)} axes", wanted, "Give as many, or none for a figure of its own.")]
        )
    for number, (panel, one) in enumerate(zip(picture.panels, own, strict=True)):
        _draw(picture, panel, one, first=number == 0, last=number == len(own) - 1)
    return own


def chosen(wanted: str, among: Sequence[str], what: str) -> str:
    """Make sure that there is something of a name.

    Parameters
    ----------
    wanted
        The name.
    among
        Names that there are.
    what
        What they are names of.

    Raises
    ------
    InputError
        If it is none of them.
    """
    if wanted not in among:
        raise InputError([Problem(what, f"'{wanted}'", f"the name of a {what}", did_you_mean(wanted, among))])
    return wanted


def _own_axes(picture: Picture) -> tuple[Axes, ...]:
    heights = [panel.height for panel in picture.panels]
    figure, grid = plt.subplots(
        len(heights),
        1,
        figsize=(_WIDTH, _HEIGHT * sum(heights) + _AROUND),
        sharex=True,
        squeeze=False,
        height_ratios=heights,
        layout="constrained",
    )
    figure.suptitle(picture.title, fontsize=10, fontweight="bold", x=0.01, ha="left").set_parse_math(False)
    return tuple(grid[:, 0])


def _draw(picture: Picture, panel: Panel, axes: Axes, first: bool, last: bool) -> None:
    for mark in panel.marks:
        _mark(mark, axes, labelled=first)
    x, y = picture.x, panel.y
    axes.set_xscale("log" if x.log else "linear")
    axes.set_yscale("log" if y.log else "linear")
    axes.set(xlim=(x.high, x.low) if x.falling else (x.low, x.high), ylim=(y.low, y.high))
    for axis, marked in ((axes.xaxis, x.marked), (axes.yaxis, y.marked)):
        axis.set_major_locator(FixedLocator([value for value, _ in marked]))
        axis.set_major_formatter(FixedFormatter([text for _, text in marked]))
        axis.set_minor_locator(NullLocator())
    axes.tick_params(length=2, labelsize=7.5, color=LIGHT["quiet"], labelcolor=LIGHT["subdued"])
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set(color=LIGHT["quiet"], linewidth=0.8)
    turned: dict[str, Any] = {"rotation": 0, "ha": "right", "va": "center"} if panel.name else {}
    axes.set_ylabel(panel.name or y.label, fontsize=8, color=LIGHT["text"], parse_math=False, **turned)
    if last:
        axes.set_xlabel(x.label, fontsize=8, color=LIGHT["text"])
    axes.tick_params(labelbottom=last)
    said = ((panel.note, "subdued"), (panel.wrong, "fault"))
    for line, (text, colour) in enumerate(one for one in said if one[0]):
        look: dict[str, Any] = {"ha": "right", "va": "top", "fontsize": 7, "color": LIGHT[colour]}
        axes.annotate(text, (1, 1), (-3, -3 - 9 * line), "axes fraction", "offset points", **look).set_parse_math(False)
    if first and axes.get_legend_handles_labels()[1]:
        # Above the panel, unless the labels of lines stand there.
        above: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0, 1), "borderaxespad": 0.2, "ncols": 3}
        inside = any(isinstance(mark, Rule) and mark.label and not mark.lying for mark in panel.marks)
        axes.legend(frameon=False, fontsize=7, **({"loc": "best"} if inside else above))


def _mark(mark: Mark, axes: Axes, labelled: bool) -> None:
    match mark:
        case Curve():
            look: dict[str, Any] = {
                "color": LIGHT[mark.role],
                "lw": 1.1 * mark.width,
                "ls": "--" if mark.dashed else "-",
            }
            axes.plot(mark.x, mark.y, label=mark.label or None, **look)
        case Points():
            colour = LIGHT[mark.role]
            look = {"ms": 3.2 * mark.size, "marker": "o", "mec": colour, "mfc": "white" if mark.hollow else colour}
            axes.errorbar(
                mark.x, mark.y, mark.bars, color=colour, lw=0, elinewidth=0.8, label=mark.label or None, **look
            )
        case Rule():
            look = {"color": LIGHT[mark.role], "lw": 0.8, "ls": "--" if mark.dashed else "-", "zorder": 1}
            (axes.axhline if mark.lying else axes.axvline)(mark.at, **look)
            if mark.label and labelled and not mark.lying:
                # Above the panel and slanted: several that are close stay readable.
                slanted: dict[str, Any] = {"rotation": 55, "rotation_mode": "anchor", "ha": "left", "fontsize": 6.5}
                place = axes.get_xaxis_transform()
                axes.text(
                    mark.at, 1.03, mark.label, transform=place, color=LIGHT[mark.role], parse_math=False, **slanted
                )
        case Band():
            axes.axvspan(mark.low, mark.high, color=LIGHT["band"], lw=0, zorder=0)


def single(axes: Axes | None) -> Axes:
    """Give axes to draw into: those that were given, or those of a figure of its own.

    Parameters
    ----------
    axes
        What was given.
    """
    return plt.subplots(figsize=(5.5, 4.5), layout="constrained")[1] if axes is None else axes


def matrix(names: Sequence[str], values: Sequence[Sequence[float]], axes: Axes) -> None:
    """Draw a matrix of correlations.

    Parameters
    ----------
    names
        Of its rows and columns.
    values
        Between -1 and 1.
    axes
        Where to.
    """
    shown = np.array(values, dtype=float).reshape(len(names), len(names))
    image = axes.imshow(shown, cmap="RdBu", vmin=-1, vmax=1)
    axes.set_xticks(range(len(names)), names, rotation=90, fontsize=7, parse_math=False)
    axes.set_yticks(range(len(names)), names, fontsize=7, parse_math=False)
    axes.figure.colorbar(image, ax=axes, label="correlation")
