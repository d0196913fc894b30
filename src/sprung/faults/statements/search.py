"""The search for mistakes in the campaign file that the recordings show before anything is fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sprung.campaign import Campaign
from sprung.errors import Fault, InputError, Problem
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.consistency import SIGNIFICANT
from sprung.faults.statements.cause import CommonCause
from sprung.faults.statements.exchanged_axes import exchanged_axes
from sprung.faults.statements.exchanged_sides import exchanged_sides
from sprung.faults.statements.mirrored_positions import mirrored_positions
from sprung.faults.statements.misplaced_channels import exchanged_channels, wrong_wheels
from sprung.faults.statements.other_origin import other_origin
from sprung.faults.statements.undeclared_load import undeclared_loads
from sprung.faults.statements.upside_down import upside_down
from sprung.preprocess import (
    Dropped,
    Prepared,
    begins_upward,
    count_disagreeing_drops,
    is_body_slower,
    is_first_motion_consistent,
    merge_dropped_wheels,
    prepare,
    redetect_dropped_wheels,
)
from sprung.progress import Progress, silent
from sprung.selection import ModelStructure

_HYPOTHESES = (mirrored_positions, upside_down, other_origin, exchanged_axes, exchanged_sides)
"""In the order in which they are believed where the recordings cannot tell them apart."""

_OF_ONE_WHEEL = (exchanged_channels, wrong_wheels)
"""Those about one channel or two: with them wheels have to fall and stand as stated more often, clearly in every drop, and the
body has to be slower than the wheels."""

_FEWEST = 3
"""Sensors on the body that show how it turns."""

_SEVERAL = 2
"""Drops from which it is no chance that sensors of a wheel contradict each other, or show nothing clear."""


def examine(campaign: Campaign, progress: Progress = silent) -> tuple[Campaign, Prepared, dict[str, Fault]]:
    """Hold what a campaign states against what its recordings show before anything is fitted.

    Parameters
    ----------
    campaign
        As it was read.
    progress
        Called with each step that begins.

    Returns
    -------
    campaign
        With a common cause corrected and named, where there is one.
    prepared
        Its recordings, prepared.
    undeclared
        By the name of a recording why its drop cannot be used as it is declared: it moves like another mass.

    Raises
    ------
    InputError
        If several mistakes explain the recordings that lead to different vehicles, and nothing tells which it is.
    """
    prepared = prepare(campaign, progress)
    corrected = with_common_cause_corrected(campaign, prepared)
    if corrected is not campaign:
        prepared = prepare(corrected, progress)
    return corrected, prepared, undeclared_loads(corrected, prepared)


def with_common_cause_corrected(campaign: Campaign, prepared: Prepared) -> Campaign:
    """Correct the one mistake that explains why bodies and wheels do not move first where the campaign says.

    Parameters
    ----------
    campaign
        As it was read.
    prepared
        Its recordings, prepared.

    Returns
    -------
    Campaign
        The same object where the first motion is as stated, or where no single mistake explains it.

    Raises
    ------
    InputError
        If several mistakes explain it that lead to different vehicles, and the recordings cannot tell which it is.
    """
    wheelbase, stated = _wheelbase(campaign), _dropped(prepared)
    if wheelbase is None:
        return campaign
    is_contradicted = _consistent(campaign, prepared, stated, wheelbase) is False
    if not is_contradicted and _count_unclear(campaign, stated) < _SEVERAL:
        return campaign
    if is_contradicted and _one_drop_explains(campaign, prepared, wheelbase):
        return campaign
    found: dict[int, list[CommonCause]] = {}
    before = _confirmed(campaign, stated)
    for hypotheses in (*_HYPOTHESES, *_OF_ONE_WHEEL):
        for fault, changed in hypotheses(campaign, wheelbase):
            again = prepared if changed.recordings == campaign.recordings else prepare(changed)
            dropped = redetect_dropped_wheels(changed, again)
            confirmed = _confirmed(changed, dropped)
            is_shown = hypotheses in _HYPOTHESES or (
                confirmed > before and _count_unclear(changed, dropped) == 0 and is_body_slower(changed, again)
            )
            if is_shown and _consistent(changed, again, dropped, wheelbase):
                found.setdefault(confirmed, []).append((fault, changed))
    # What shows nothing clear contradicts nothing, either: the more wheels are confirmed the better.
    most = max(found, default=0)
    if not found or (not is_contradicted and most <= before):
        return campaign
    fault, changed = found[most][0] if len(found[most]) == 1 else _most_likely(campaign, found[most])
    return replace(changed, faults=(*changed.faults, fault))


def _confirmed(campaign: Campaign, dropped: Sequence[Dropped]) -> int:
    """Return how often a wheel clearly fell or stood as the campaign states."""
    pairs = zip(campaign.drops, dropped, strict=True)
    return sum(falls == (wheel in drop.wheels) for drop, shown in pairs for wheel, falls in shown.items())


def _count_unclear(campaign: Campaign, dropped: Sequence[Dropped]) -> int:
    """Return in how many drops in which a wheel should fall its sensor does not show clearly whether it does, at the most."""
    wheels = {sensor.wheel for sensor in campaign.sensors if sensor.wheel is not None and sensor.reads_gravity}
    pairs = [(set(drop.wheels), shown) for drop, shown in zip(campaign.drops, dropped, strict=True) if shown]
    unclear = [sum(wheel in stated and wheel not in shown for stated, shown in pairs) for wheel in wheels]
    return max(unclear, default=0)


def _wheelbase(campaign: Campaign) -> float | None:
    """Return the wheelbase, or else about how far the sensors are apart along the vehicle; None where too few have places."""
    places = [one.position for one in campaign.sensors if one.on == "body"]
    x = [place[0] for place in places if place is not None]
    if len(x) < _FEWEST or len(x) < len(places) or any(one.on is None for one in campaign.sensors):
        return None
    return campaign.wheelbase.value if campaign.wheelbase is not None else (max(x) - min(x)) or None


def _dropped(prepared: Prepared) -> list[Dropped]:
    """Return which wheels lost their blocks in each drop, by the places with which the recordings were prepared."""
    return [observation.dropped for observation in prepared.observations]


def _consistent(campaign: Campaign, prepared: Prepared, dropped: Sequence[Dropped], wheelbase: float) -> bool | None:
    """Whether body, wheels and drops agree on the dropped wheels; None if they are not significant."""
    if begins_upward(campaign, prepared) or count_disagreeing_drops(campaign, prepared) >= _SEVERAL:
        return False
    seen = [merge_dropped_wheels(*pair) for pair in zip(campaign.drops, dropped, strict=True)]
    if any(set(drop.wheels) != set(wheels) for drop, wheels in zip(campaign.drops, seen, strict=True)):
        return False
    return is_first_motion_consistent(campaign, prepared, seen, wheelbase)


def _one_drop_explains(campaign: Campaign, prepared: Prepared, wheelbase: float) -> bool:
    """Whether all is consistent if one drop has the observed wheels: fewer statements than those of several sensors.

    Such a drop is named and corrected on its own. A mistake with several sensors that agree among themselves is supposed only
    where several drops show it.
    """
    dropped = _dropped(prepared)
    seen = [merge_dropped_wheels(*pair) for pair in zip(campaign.drops, dropped, strict=True)]
    pairs = list(zip(campaign.drops, seen, strict=True))
    if sum(set(drop.wheels) != set(wheels) for drop, wheels in pairs) != 1:
        return False
    drops = tuple(replace(drop, wheels=tuple(wheels)) for drop, wheels in pairs)
    return _consistent(replace(campaign, drops=drops), prepared, dropped, wheelbase) is not False


def _most_likely(campaign: Campaign, explaining: Sequence[CommonCause]) -> CommonCause:
    """Fit the campaign with each correction, and take the one with which the recordings are most likely."""
    fitted = []
    for fault, changed in explaining:
        base = CandidateFit.of(ModelStructure.decided(changed, "shared", ()), prepare(changed).decays)
        samples = max(float(base.table.counts.sum()), 1.0)
        fitted.append((base.table.cost / samples, samples, base.fit.overdispersion, fault, changed))
    best, samples, overdispersion, fault, changed = min(fitted, key=lambda each: each[0])
    # Of what the recordings cannot tell apart, left and right of a vehicle that is alike on both sides is the same vehicle.
    alike = [each[3:] for each in fitted if (each[0] - best) * samples < SIGNIFICANT * overdispersion]
    if len(alike) == 1:
        return fault, changed
    (first, changed), *others = alike
    if all("left" in other.do for other, _ in alike):
        also = "; or ".join(f"{other.do[0].lower()}{other.do[1:].rstrip('.')}" for other, _ in others)
        return replace(first, do=f"{first.do.rstrip('.')}; or {also}: the recordings cannot tell these apart."), changed
    raise InputError([_undecided(campaign, [other for other, _ in alike])])


def _undecided(campaign: Campaign, faults: Sequence[Fault]) -> Problem:
    where = "campaign" if campaign.path is None else campaign.path.name
    found = "; or ".join(f"{fault.where}: {fault.what.rpartition('. ')[0] or fault.what}" for fault in faults)
    expected = (
        "places and wheels that agree with the first motion after the releases, which cannot tell which of these it is"
    )
    return Problem(where, found, expected, " Or: ".join(fault.do for fault in faults))
