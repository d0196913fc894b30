"""Pictures of the report in matplotlib axes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator

from sprung.errors import InputError, Problem, did_you_mean
from sprung.report import LETTER, LIGHT, Band, Curve, Mark, Panel, Picture, Points, Rule, stack_labels

_WIDTH, _HEIGHT = 7.0, 1.5
"""Width of a figure, and height of a panel of relative height 1, inches."""

_LABEL, _LETTER, _LINE = 6.5, 3.6, 9.0
"""Labels of vertical lines: size, mean width of a letter and line spacing, points."""

_MARGINS = 0.9
"""Height above and below the panels, inches."""


def draw(picture: Picture, axes: Iterable[Axes] | None = None) -> tuple[Axes, ...]:
    """Draw a picture.

    Parameters
    ----------
    picture
        Any.
    axes
        One for each of its panels; a new figure unless given.

    Returns
    -------
    tuple of Axes

    Raises
    ------
    InputError
        If there are not as many axes as panels.
    """
    drawn = _new_axes(picture) if axes is None else tuple(axes)
    if len(drawn) != len(picture.panels):
        expected = f"{len(picture.panels)} axes, one for each panel"
        raise InputError([Problem("axes", f"{len(drawn)} axes", expected, "Give as many, or none for a new figure.")])
    for i, (panel, ax) in enumerate(zip(picture.panels, drawn, strict=True)):
        _draw_panel(picture, panel, ax, first=i == 0, last=i == len(drawn) - 1)
    return drawn


def check_name(name: str, names: Sequence[str], what: str) -> str:
    """Return a name that exists.

    Parameters
    ----------
    name
        As given by the user.
    names
        Names that exist.
    what
        Kind of the named objects.

    Raises
    ------
    InputError
        If it is none of them.
    """
    if name not in names:
        raise InputError([Problem(what, f"'{name}'", f"the name of a {what}", did_you_mean(name, names))])
    return name


def _new_axes(picture: Picture) -> tuple[Axes, ...]:
    heights = [panel.height for panel in picture.panels]
    labels = _labelled(picture.panels[0])
    levels = [level for _, _, level in stack_labels(labels, picture.x, 72 * _WIDTH * LETTER / _LETTER)]
    above = _LINE / 72 * (1 + max(levels, default=-1))
    figure, grid = plt.subplots(
        len(heights),
        1,
        figsize=(_WIDTH, _HEIGHT * sum(heights) + _MARGINS + above),
        sharex=True,
        squeeze=False,
        height_ratios=heights,
        layout="constrained",
    )
    figure.suptitle(picture.title, fontsize=10, fontweight="bold", x=0.01, ha="left").set_parse_math(False)
    return tuple(grid[:, 0])


def _draw_panel(picture: Picture, panel: Panel, axes: Axes, first: bool, last: bool) -> None:
    for mark in panel.marks:
        _draw_mark(mark, axes)
    x, y = picture.x, panel.y
    axes.set_xscale("log" if x.log else "linear")
    axes.set_yscale("log" if y.log else "linear")
    axes.set(xlim=(x.high, x.low) if x.descending else (x.low, x.high), ylim=(y.low, y.high))
    for axis, ticks in ((axes.xaxis, x.all_ticks), (axes.yaxis, y.all_ticks)):
        axis.set_major_locator(FixedLocator([value for value, _ in ticks]))
        axis.set_major_formatter(FixedFormatter([text for _, text in ticks]))
        axis.set_minor_locator(NullLocator())
    axes.tick_params(length=2, labelsize=7.5, color=LIGHT["reference"], labelcolor=LIGHT["subdued"])
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set(color=LIGHT["reference"], linewidth=0.8)
    rotated: dict[str, Any] = {"rotation": 0, "ha": "right", "va": "center"} if panel.name else {}
    axes.set_ylabel(panel.name or y.label, fontsize=8, color=LIGHT["text"], parse_math=False, **rotated)
    if last:
        axes.set_xlabel(x.label, fontsize=8, color=LIGHT["text"])
    axes.tick_params(labelbottom=last)
    notes = ((panel.note, "subdued"), (panel.warning, "fault"))
    for line, (text, colour) in enumerate(note for note in notes if note[0]):
        look: dict[str, Any] = {"ha": "right", "va": "top", "fontsize": 7, "color": LIGHT[colour]}
        axes.annotate(text, (1, 1), (-3, -3 - 9 * line), "axes fraction", "offset points", **look).set_parse_math(False)
    labels = _labelled(panel) if first else []
    _label_rules(labels, picture, axes)
    if first and axes.get_legend_handles_labels()[1]:
        # Above the panel, unless the labels of vertical lines are there.
        above: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0, 1), "borderaxespad": 0.2, "ncols": 3}
        inside = bool(labels)
        axes.legend(frameon=False, fontsize=7, **({"loc": "best"} if inside else above))


def _labelled(panel: Panel) -> list[Rule]:
    """Return the vertical lines of a panel that have a label."""
    return [mark for mark in panel.marks if isinstance(mark, Rule) and mark.label and not mark.horizontal]


def _label_rules(labels: list[Rule], picture: Picture, axes: Axes) -> None:
    """Write the labels of vertical lines above the panel, stacked so that none overlap, as in the report."""
    points = axes.get_window_extent().width * 72 / axes.figure.dpi
    for mark, middle, level in stack_labels(labels, picture.x, points * LETTER / _LETTER):
        look: dict[str, Any] = {"fontsize": _LABEL, "color": LIGHT[mark.role], "ha": "center", "va": "bottom"}
        height = 2 + _LINE * level
        if level:
            line = {"arrowstyle": "-", "color": LIGHT[mark.role], "lw": 0.5, "shrinkA": 0, "shrinkB": 0}
            axes.annotate("", (mark.at, 1), (0, height), axes.get_xaxis_transform(), "offset points", line, zorder=1)
        text = axes.annotate(mark.label, (middle, 1), (0, height), "axes fraction", "offset points", zorder=2, **look)
        text.set_parse_math(False)
        # A label is in front of the lines of those above it.
        text.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 0.4})


def _draw_mark(mark: Mark, axes: Axes) -> None:
    match mark:
        case Curve():
            look: dict[str, Any] = {
                "color": LIGHT[mark.role],
                "lw": 1.1 * mark.width,
                "ls": "--" if mark.dashed else "-",
            }
            axes.plot(mark.x, mark.y, label=mark.label or None, **look)
            if mark.band is not None:
                axes.fill_between(
                    mark.x, mark.y - mark.band, mark.y + mark.band, color=LIGHT[mark.role], alpha=0.2, lw=0
                )
        case Points():
            colour = LIGHT[mark.role]
            look = {"ms": 3.2 * mark.size, "marker": "o", "mec": colour, "mfc": "white" if mark.hollow else colour}
            axes.errorbar(
                mark.x, mark.y, mark.bars, color=colour, lw=0, elinewidth=0.8, label=mark.label or None, **look
            )
        case Rule():
            look = {"color": LIGHT[mark.role], "lw": 0.8, "ls": "--" if mark.dashed else "-", "zorder": 1}
            (axes.axhline if mark.horizontal else axes.axvline)(mark.at, **look)
        case Band():
            axes.axvspan(mark.low, mark.high, color=LIGHT["band"], lw=0, zorder=0)


def axes_or_new(axes: Axes | None) -> Axes:
    """Return the given axes, or those of a new figure.

    Parameters
    ----------
    axes
        As given by the user.
    """
    return plt.subplots(figsize=(5.5, 4.5), layout="constrained")[1] if axes is None else axes


def draw_matrix(names: Sequence[str], values: Sequence[Sequence[float]], axes: Axes) -> None:
    """Draw a correlation matrix.

    Parameters
    ----------
    names
        Of its rows and columns.
    values
        Between -1 and 1.
    axes
        Into which it is drawn.
    """
    shown = np.array(values, dtype=float).reshape(len(names), len(names))
    image = axes.imshow(shown, cmap="RdBu", vmin=-1, vmax=1)
    axes.set_xticks(range(len(names)), names, rotation=90, fontsize=7, parse_math=False)
    axes.set_yticks(range(len(names)), names, fontsize=7, parse_math=False)
    axes.figure.colorbar(image, ax=axes, label="correlation")
