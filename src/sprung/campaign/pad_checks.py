"""What drops on pads and the sensors of pads must say together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sprung.vehicle import LAYOUTS, PADS

if TYPE_CHECKING:
    from sprung.campaign.parsing import ParsedFile
    from sprung.campaign.schema import CampaignFile
    from sprung.errors import Problems


def check_pads(parsed: ParsedFile[CampaignFile], problems: Problems) -> None:
    """Check that every pad that moves has a sensor, and that pads with sensors move in some drop.

    Parameters
    ----------
    parsed
        What was understood of the file.
    problems
        Takes up what is wrong.
    """
    file = parsed.file
    if not parsed.complete("sensor") or not parsed.complete("drop") or ("vehicle", "model") in parsed.lost:
        return
    layout = LAYOUTS[file.vehicle.model]
    pads = {wheel: pad for pad, wheel in PADS.items()}
    measured = {sensor.pad for sensor in file.sensor if sensor.pad is not None}
    driven = [drop.excitation == "pads" for drop in file.drop]
    for index, drop, is_driven in zip(parsed.numbered("drop"), file.drop, driven, strict=True):
        lacking = [wheel for wheel in drop.on_wheels_of(layout).wheels if wheel not in measured]
        if not is_driven or not lacking or not file.sensor:
            continue
        found = f"no displacement and no force of the pad under {', '.join(lacking)}"
        do = f'Add a [[sensor]] with on = "{pads[lacking[0]]}" and quantity = "displacement" or "force"'
        do += ", or state the wheels whose pads moved." if measured else "."
        problems.add(parsed.where("drop", index, "excitation"), found, "a sensor of every pad that moves", do)
    still = [sensor.channel for sensor in file.sensor if sensor.pad is not None]
    if still and file.drop and not any(driven):
        expected, do = 'a drop with excitation = "pads"', "State it for the drops on pads, or remove these sensors."
        problems.add(parsed.where("sensor"), f"{', '.join(still)} on pads that do not move", expected, do)
