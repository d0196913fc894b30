"""The page of `sprung check`: usable drops, missing items, the sketch, and every drop with its recording and faults."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from importlib.metadata import version
from typing import NamedTuple

from sprung.checking import Check, DropReport, PlottedRecording
from sprung.errors import Fault, merge_faults
from sprung.report.drawing.picture import Picture
from sprung.report.excitations import excitations_text, limits_text, readings_text, records_text
from sprung.report.page.environment import ENVIRONMENT
from sprung.report.pictures.recordings import landing_picture, recording_picture
from sprung.report.sketch.sketch import vehicle_sketch
from sprung.report.terminal.check import channels_table, drops_table, missing_items

CHECK_FILE = "check.html"
"""The page's name."""


class DropPart(NamedTuple):
    """One drop on the page.

    Attributes
    ----------
    anchor
        Target of links.
    report
        From the check.
    limits
        Start and end of the free decay or the forced response, with reasons.
    contradiction
        The wheels that fell, where the campaign states others.
    faults
        Channel, empty for all of them, and fault.
    pictures
        Of its recording.
    """

    anchor: str
    report: DropReport
    limits: str
    contradiction: str
    faults: tuple[tuple[str, Fault], ...]
    pictures: tuple[Picture, ...]

    @property
    def is_good(self) -> bool:
        """Whether it is usable and without faults."""
        return self.report.start is not None and not self.faults and not self.contradiction

    @property
    def state(self) -> str:
        """Its state, in two words."""
        if self.report.start is None:
            return "left out"
        return "usable" if self.is_good else "usable, with faults"


def check_html(check: Check) -> str:
    """Return the page of a check.

    Parameters
    ----------
    check
        From `sprung.check`.

    Returns
    -------
    str
        Self-contained HTML; identical for identical recordings.
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
        tests=excitations_text(check.drops),
        readings=readings_text(check.drops),
        record=records_text(check.drops, plural=False),
        macros=ENVIRONMENT.get_template("macros.html").module,
    )


def _facts(check: Check) -> Iterator[tuple[str, str]]:
    """Yield the summary: names and texts."""
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
    yield "Faults", str(len(merge_faults(check.faults))) if check.faults else "none"


def _drops(check: Check) -> Iterator[DropPart]:
    recordings: list[PlottedRecording | None] = [*check.recorded, *([None] * (len(check.drops) - len(check.recorded)))]
    for number, (drop, recorded) in enumerate(zip(check.drops, recordings, strict=True), 1):
        pictures = [] if recorded is None else [recording_picture(drop, recorded), landing_picture(drop, recorded)]
        yield DropPart(
            anchor=f"drop-{number}",
            report=drop,
            limits=limits_text(drop),
            contradiction=_contradiction(drop),
            faults=tuple((_channel(fault, drop), fault) for fault in merge_faults(check.faults_of(drop))),
            pictures=tuple(picture for picture in pictures if picture is not None),
        )


def _contradiction(drop: DropReport) -> str:
    if not drop.contradicted or "wheels" in drop.faults:  # the fault states it
        return ""
    seen = ", ".join(drop.wheels_seen or ()) or "no wheel"
    return f"Stated: drop of {', '.join(drop.wheels)}. Detected: drop of {seen}."


def _channel(fault: Fault, drop: DropReport) -> str:
    """Return the channel of a fault of a drop."""
    return re.sub(rf"^{re.escape(drop.file)}(: )?", "", fault.where)
