"""The draft of a campaign file, for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from sprung.drafting import DraftCampaign, DraftSensor
from sprung.report.terminal.layout import hanging_text, render_rows

_LISTED = 5
"""Other events that are listed one by one."""


def draft_view(draft: DraftCampaign, *others: DraftCampaign) -> RenderableType:
    """Return the view of a draft: detected drops, sensors, and missing items; of several, one for each setting.

    Parameters
    ----------
    draft
        From `sprung.draft`.
    others
        The drafts of further settings of the vehicle, from `sprung.draft_campaigns`.

    Returns
    -------
    RenderableType
        For `text_of`.
    """
    drafts = (draft, *others)
    parts: list[RenderableType] = []
    if others:
        parts = [_settings(drafts), Text("sprung new --no-settings drafts one campaign for all recordings."), Text()]
    for own in drafts:
        parts += [_drops(own), Text()]
    parts += [_sensors(draft), Text()]
    unused = dict.fromkeys(text for own in drafts for text in _others(own))
    if unused:
        parts += [Text("Not used", style="bold"), *(hanging_text("  - ", text) for text in unused), Text()]
    missing = dict.fromkeys(item for own in drafts for item in own.missing)
    if missing:
        parts += [Text("Missing, to be completed" + (" in each file" if others else ""), style="bold")]
        parts += [hanging_text("  - ", Text.assemble((f"{where}: ", "yellow"), what)) for where, what in missing]
    return Group(*parts)


def _settings(drafts: Sequence[DraftCampaign]) -> RenderableType:
    headers = ("setting", "drops", "loads", "campaign file")
    rows = [
        [str(draft.setting), str(len(draft.drops)), " ".join(draft.loads) or "-", str(draft.path)] for draft in drafts
    ]
    title = f"{len(drafts)} settings of the vehicle by the names of the recordings: a campaign for each"
    return render_rows(title, headers, rows, headers[1:2], headers[2:])


def _drops(draft: DraftCampaign) -> RenderableType:
    headers = ("recording", "release s", "until s", "length s", "load", "wheels", "drop")
    rows = [
        [
            " + ".join(drop.files),
            f"{drop.found.release:.3f}",
            f"{drop.found.end:.2f}",
            f"{drop.found.end - drop.found.landing:.2f}",
            drop.load or "?",
            " ".join(drop.wheels) or "?",
            drop.kind or drop.excitation or "?",
        ]
        for drop in draft.drops
    ]
    count = f"{len(rows)} drop{'s' * (len(rows) != 1)}"
    return render_rows(f"{draft.name}: {count} detected", headers, rows, headers[1:4], ("until s", "length s", "drop"))


def _sensors(draft: DraftCampaign) -> RenderableType:
    others = any(sensor.quantity != "acceleration" for sensor in draft.sensors)
    headers = ("channel", *["measures"] * others, "on", "unit", "points", "coupling", "clips at")
    rows = [
        [
            sensor.channel,
            *[_measured(sensor)] * others,
            _place(sensor, draft),
            sensor.unit or "?",
            sensor.direction,
            sensor.coupling,
            "" if sensor.full_scale is None else f"{sensor.full_scale:.4g}",
        ]
        for sensor in draft.sensors
    ]
    return render_rows("Sensors", headers, rows, ("clips at",), ("coupling", "clips at"))


def _measured(sensor: DraftSensor) -> str:
    if sensor.is_travel:
        return f"travel to {sensor.relative_to or '?'}"
    return f"{sensor.axis or '?'} rate" if sensor.quantity == "angular-rate" else sensor.quantity


def _place(sensor: DraftSensor, draft: DraftCampaign) -> str:
    is_open = sensor.on in ("wheel", "pad") and draft.model != "quarter"
    return f"{sensor.on} ?" if is_open else sensor.on or "?"


def _others(draft: DraftCampaign) -> Iterator[str]:
    """Yield everything that is not part of the draft, with the reason."""
    yield from (f"{name}: identical to {original}" for name, original in draft.copies.items())
    for file in draft.files:
        if not file.drops and not file.rejected:
            yield f"{file.name}: no drop, no motion"
        for event in file.rejected[:_LISTED]:
            yield f"{file.name}: event at {event.time:.3f} s is no drop: {event.why}"
        if file.events > min(len(file.rejected), _LISTED):
            yield f"{file.name}: {file.events - min(len(file.rejected), _LISTED)} other events are no drops"
    left_out = {item for file in draft.files for item in file.left_out.items()}
    yield from (f"'{channel}' is not a sensor: {why}" for channel, why in sorted(left_out))
    for name, problems in draft.unreadable.items():
        yield f"{name} cannot be read: found {problems[0].found}; expected {problems[0].expected}. {problems[0].do}"
