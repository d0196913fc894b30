"""Drops that are said to have one load and swing like two: a load that nobody declared, or that is declared in other drops."""

from __future__ import annotations

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.preprocess import Prepared, extract_slow_motion, find_slower_drops


def undeclared_loads(campaign: Campaign, prepared: Prepared) -> dict[str, Fault]:
    """Find drops that move like another mass than those of the same wheels and the same load.

    Parameters
    ----------
    campaign
        The campaign.
    prepared
        Its recordings, prepared.

    Returns
    -------
    dict
        The fault by the name of each recording that cannot be used as it is declared: those that swing more slowly, and those
        of which nothing tells to which of the two they belong. Empty where all swing as one.
    """
    usable = {decay.file for decay in prepared.decays}
    body = [i for i, sensor in enumerate(campaign.sensors) if sensor.on == "body"]
    rows = [
        (seen.drop.load, seen.wheels, seen.recording.name, seen)
        for seen in prepared.observations
        if seen.release is not None and not seen.drop.is_driven and seen.recording.name in usable
    ]
    spoilt: dict[str, Fault] = {}
    for load in dict.fromkeys(load for load, *_ in rows):
        own = [(frozenset(wheels), name, seen) for label, wheels, name, seen in rows if label == load]
        if len(own) == len({kind for kind, *_ in own}):
            continue  # no two drops to compare
        motions = [
            extract_slow_motion(
                seen.recording.values[body], seen.recording.rate, seen.release or 0, seen.rest.level[body]
            )
            for _, _, seen in own
        ]
        slower = find_slower_drops([kind for kind, *_ in own], motions)
        if not slower:
            continue
        names = [
            name for name, is_slower in zip([name for _, name, _ in own], slower, strict=True) if is_slower is not False
        ]
        spoilt |= dict.fromkeys(names, _fault(load, names, len(own)))
    return spoilt


def _fault(load: str, names: list[str], count: int) -> Fault:
    what = (
        f"{', '.join(names)} ({len(names)} of {count} drops with load '{load}') move like another mass: the body swings more "
        "slowly in them than in the other drops of the same wheels. They are left out"
    )
    do = (
        "If something was on the vehicle, add a [[load]] with its mass and place to the campaign file and write its "
        "name as load = ... in these drops."
    )
    return Fault("undeclared-load", ", ".join(names), what, do)
