"""The page of `sprung check`: what is usable and what is missing, the sketch, every drop with its recording and its faults."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from importlib.metadata import version
from typing import NamedTuple

from markupsafe import Markup

from sprung.checking import Check, DropReport, PlottedRecording
from sprung.errors import Fault
from sprung.report.drawing.palette import DARK, LIGHT
from sprung.report.drawing.picture import Picture
from sprung.report.drawing.style import role_rules
from sprung.report.drawing.svg import svg_of
from sprung.report.page.environment import ENVIRONMENT
from sprung.report.pictures.recordings import near_picture, whole_picture
from sprung.report.sketch.shapes import Drawing
from sprung.report.sketch.sketch import vehicle_sketch
from sprung.report.sketch.svg import drawing_svg
from sprung.report.terminal.check import channels_table, drops_table, missing_items

CHECK_FILE = "check.html"
"""The page's name."""


class DropPart(NamedTuple):
    """One drop on the page.

    Attributes
    ----------
    anchor
        By which links find it.
    report
        What is said of it.
    limits
        Which part of it is used, and why.
    contradiction
        Which wheels fell, where it was not those that the campaign says.
    faults
        What is wrong with it: the channel, empty for all of them, and the fault.
    pictures
        Its recording.
    """

    anchor: str
    report: DropReport
    limits: str
    contradiction: str
    faults: tuple[tuple[str, Fault], ...]
    pictures: tuple[Picture, ...]

    @property
    def is_good(self) -> bool:
        """Whether it can be used and nothing is wrong with it."""
        return self.report.start is not None and not self.faults and not self.contradiction

    @property
    def state(self) -> str:
        """What it is worth, in two words."""
        if self.report.start is None:
            return "left out"
        return "usable" if self.is_good else "usable, with faults"


def check_page(check: Check) -> str:
    """Write the page of a check.

    Parameters
    ----------
    check
        From `sprung.check`.

    Returns
    -------
    str
        HTML that needs nothing but itself; the same for the same recordings.
    """
    drops = list(_drops(check))
    clean = check.usable and not check.missing and not check.common_faults and all(drop.is_good for drop in drops)
    return ENVIRONMENT.get_template("check.html").render(
        check=check,
        name="Recordings" if check.campaign is None else check.campaign.name,
        version=version("sprung"),
        state="accept" if clean else "doubtful" if check.usable else "reject",
        facts=list(_facts(check)),
        missing=missing_items(check.missing),
        sketch=None if check.campaign is None else vehicle_sketch(check.campaign),
        overview=drops_table(check.drops),
        channels=channels_table(check.drops),
        drops=drops,
        light=LIGHT,
        dark=DARK,
        roles=Markup("\n".join(role_rules())),  # noqa: S704 (made here)
        macros=ENVIRONMENT.get_template("macros.html").module,
        draw=_draw,
        draw_sketch=_draw_sketch,
    )


def _draw(picture: Picture) -> Markup:
    return Markup(svg_of(picture))  # noqa: S704 (it escapes its words)


def _draw_sketch(drawing: Drawing) -> Markup:
    return Markup(drawing_svg(drawing))  # noqa: S704 (it escapes its words)


def _facts(check: Check) -> Iterator[tuple[str, str]]:
    """Give what one wants to know first, each with its name."""
    loads = Counter(drop.load or "load not stated" for drop in check.drops if drop.start is not None)
    if loads:
        yield "Usable drops", ", ".join(f"{count} {load}" for load, count in loads.items())
    channels = {channel.name: channel.on for drop in check.drops for channel in drop.channels}
    if channels:
        body = sum(on == "body" for on in channels.values())
        yield "Channels", f"{body} on the body, {len(channels) - body} on wheels"
    rates = sorted({drop.rate for drop in check.drops if drop.rate is not None})
    if rates:
        yield "Sampling", ", ".join(f"{rate:.6g} Hz" for rate in rates)
    yield "Faults", str(len(check.faults)) if check.faults else "none"


def _drops(check: Check) -> Iterator[DropPart]:
    recordings: list[PlottedRecording | None] = [*check.recorded, *([None] * (len(check.drops) - len(check.recorded)))]
    for number, (drop, recorded) in enumerate(zip(check.drops, recordings, strict=True), 1):
        found = [] if recorded is None else [whole_picture(drop, recorded), near_picture(drop, recorded)]
        yield DropPart(
            anchor=f"drop-{number}",
            report=drop,
            limits=_limits(drop),
            contradiction=_contradiction(drop),
            faults=tuple((_channel(fault, drop), fault) for fault in check.faults_of(drop)),
            pictures=tuple(picture for picture in found if picture is not None),
        )


def _limits(drop: DropReport) -> str:
    if drop.start is None or drop.end is None:
        return ""
    return f"Decay from {drop.start:.3f} s: {drop.why_start}; to {drop.end:.3f} s: {drop.why_end}."


def _contradiction(drop: DropReport) -> str:
    if not drop.contradicted or "wheels" in drop.faults:  # the fault says it already
        return ""
    seen = ", ".join(drop.wheels_seen or ()) or "no wheel"
    return f"The campaign says that {', '.join(drop.wheels)} fell; the release shows that {seen} fell."


def _channel(fault: Fault, drop: DropReport) -> str:
    """Name the channel that a fault of a drop belongs to."""
    return re.sub(rf"^{re.escape(drop.file)}(: )?", "", fault.where)
