"""Statements of the mass of a load and of the wheelbase that count for little: what the recordings say without them.

The mass of a load shows beside masses of the vehicle that were weighed, as long as more than one of them tells the scale: of
two statements that contradict each other either one may be wrong. The wheelbase shows by the places of the sensors on the body.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
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
    """Let the mass of each load, and the wheelbase, count for little, and say what the recordings show instead."""
    campaign = base.campaign
    if sum(map(tells_scale, campaign.known)) > 1:
        loaded = {decay.load for decay in base.decays}
        for load in campaign.loads:
            if load.name in loaded and load.total_mass(campaign.layout) > 0:
                yield from _loosened(base, partial(_with_loose_mass, load=load), partial(_mass_fault, load=load))
    if campaign.wheelbase is not None:
        yield from _loosened(base, _with_loose_wheelbase, partial(_wheelbase_fault, stated=campaign.wheelbase.value))


def _loosened(
    base: CandidateFit, description: Description, fault: Callable[[CandidateFit], Fault]
) -> Iterator[Hypothesis]:
    correction = Correction(description=description)
    # A statement may be far off, and everything else with it: a few steps do not tell what it explains.
    candidate = base.refit(correction, base.fit)
    # A model that lacks something takes anything that it is free to take.
    if candidate.fit.overdispersion <= OVERDISPERSED:
        yield Hypothesis(fault(candidate), "corrected", correction, candidate.table, candidate, free=1)


def _mass_fault(candidate: CandidateFit, load: Load) -> Fault:
    campaign, parameters = candidate.campaign, candidate.fit.parameters
    mass = load.total_mass(campaign.layout)
    shown = sum(parameters[name] for name in campaign.load(load.name).uncertain_masses)
    what = (
        f"the recordings contradict its mass of {mass:g} kg beside what was weighed of the vehicle, and "
        f"show {shown:.4g} kg; corrected"
    )
    do = "Weigh the load again, and correct its mass in the campaign file."
    return Fault("known", f"load '{load.name}'", what, do)


def _wheelbase_fault(candidate: CandidateFit, stated: float) -> Fault:
    what = (
        f"the recordings contradict wheelbase = {stated:g} m; by the places of the sensors it is "
        f"{evaluate_in('wheelbase', candidate):.4g} m; corrected"
    )
    do = "Measure the wheelbase and the places of the sensors again, and correct what was wrong in the campaign file."
    return Fault("known", "vehicle.wheelbase", what, do)


def _with_loose_mass(campaign: Campaign, load: Load) -> Campaign:
    items = tuple(replace(item, mass_std=_LITTLE * item.mass) for item in load.items)
    added = None if load.added is None else replace(load.added, mass_std=_LITTLE * load.added.mass)
    loose = replace(load, items=items, added=added)
    return replace(campaign, loads=tuple(loose if one.name == load.name else one for one in campaign.loads))


def _with_loose_wheelbase(campaign: Campaign) -> Campaign:
    stated = campaign.wheelbase
    return campaign if stated is None else replace(campaign, wheelbase=KnownValue(stated.value, _LITTLE * stated.value))
