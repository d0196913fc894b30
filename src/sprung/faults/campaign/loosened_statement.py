"""Statements of the mass of a load and of the wheelbase that count for little: what the recordings say without them.

The mass of a load shows beside masses of the vehicle that were weighed, as long as more than one of them tells the scale: of
two statements that contradict each other either one may be wrong. The wheelbase shows by the places of the sensors on the body.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.campaign.known_quantity import evaluate_in, tells_scale
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import Correction, Description
from sprung.faults.hypothesis import Hypothesis
from sprung.selection import OVERDISPERSED
from sprung.uncertainty import KnownValue
from sprung.vehicle import Load

_LITTLE = 0.3
"""Standard uncertainty of what counts for little, as a part of it."""


def loosened_statements(base: CandidateFit) -> Iterator[Hypothesis]:
    """Let the mass of each load, and the wheelbase, count for little."""
    campaign = base.campaign
    loose: dict[str, Description] = {}
    if sum(map(tells_scale, campaign.known)) > 1:
        loaded = {decay.load for decay in base.decays}
        for load in campaign.loads:
            if load.name in loaded and load.total_mass(campaign.layout) > 0:
                loose[f"load '{load.name}'"] = partial(_with_loose_mass, load=load)
    if campaign.wheelbase is not None:
        loose["vehicle.wheelbase"] = _with_loose_wheelbase
    for where, description in loose.items():
        hypothesis = _loosened(base, where, description)
        # A model that lacks something takes anything that it is free to take.
        if hypothesis.candidate.fit.overdispersion <= OVERDISPERSED:
            yield hypothesis


def with_found_value(base: CandidateFit, hypothesis: Hypothesis) -> Hypothesis:
    """Return a hypothesis about a loosened statement with what its fit says of it.

    Parameters
    ----------
    base
        The fit of the campaign as it is.
    hypothesis
        Once it is confirmed.
    """
    stated, found = base.campaign, hypothesis.candidate
    place = hypothesis.fault.where if hypothesis.fault.code == "known" else ""
    for load in stated.loads:
        if place == f"load '{load.name}'":
            loose = next(one for one in found.campaign.loads if one.name == load.name)
            mass = load.total_mass(stated.layout)
            own = dict(zip(found.fit.names, found.fit.values.tolist(), strict=True))
            shown = sum(own[name] for name in loose.uncertain_masses)
            what = (
                f"the recordings contradict its mass of {mass:g} kg beside what was weighed of the vehicle, and show "
                f"{shown:.4g} kg; corrected"
            )
            do = "Weigh the load again, and correct its mass in the campaign file."
            return replace(hypothesis, fault=Fault("known", place, what, do))
    if stated.wheelbase is None or place != "vehicle.wheelbase":
        return hypothesis
    shown = evaluate_in("wheelbase", found)
    what = (
        f"the recordings contradict wheelbase = {stated.wheelbase.value:g} m; by the places of the sensors it is "
        f"{shown:.4g} m; corrected"
    )
    do = "Measure the wheelbase and the places of the sensors again, and correct what was wrong in the campaign file."
    return replace(hypothesis, fault=Fault("known", place, what, do))


def _loosened(base: CandidateFit, where: str, description: Description) -> Hypothesis:
    correction = Correction(description=description)
    # A statement may be far off, and everything else with it: a few steps do not tell what it explains.
    candidate = base.refit(correction, base.fit)
    return Hypothesis(Fault("known", where, "", ""), "corrected", correction, candidate.table, candidate, free=1)


def _with_loose_mass(campaign: Campaign, load: Load) -> Campaign:
    items = tuple(replace(item, mass_std=_LITTLE * item.mass) for item in load.items)
    added = None if load.added is None else replace(load.added, mass_std=_LITTLE * load.added.mass)
    loose = replace(load, items=items, added=added)
    return replace(campaign, loads=tuple(loose if one.name == load.name else one for one in campaign.loads))


def _with_loose_wheelbase(campaign: Campaign) -> Campaign:
    stated = campaign.wheelbase
    return campaign if stated is None else replace(campaign, wheelbase=KnownValue(stated.value, _LITTLE * stated.value))
