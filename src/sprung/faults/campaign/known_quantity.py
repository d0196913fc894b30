"""A quantity stated as known that the recordings contradict."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from sprung.campaign import Campaign
from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import Correction
from sprung.faults.hypothesis import Hypothesis
from sprung.uncertainty import KnownValue
from sprung.vehicle import DERIVED, PARAMETERS

_LOAD_INCLUDED = 0.02
"""Relative distance from the mass of the vehicle with a load, within which a mass is taken to include the load."""


def known_quantities(base: CandidateFit) -> Iterator[Hypothesis]:
    """Exchange the masses of the axles, and leave out each known quantity."""
    known = base.campaign.known
    front, rear = (known.get(name) for name in ("front_axle_mass", "rear_axle_mass"))
    if front is not None and rear is not None:
        what = (
            f"the masses of the axles are exchanged: {rear.value:g} kg in front and {front.value:g} kg behind fit the "
            "recordings; corrected"
        )
        where = "known.front_axle_mass, known.rear_axle_mass"
        fault = Fault("known", where, what, "Exchange the two in the campaign file.")
        yield _stating(base, fault, {**known, "front_axle_mass": rear, "rear_axle_mass": front})
    for name, stated in known.items():
        if name in PARAMETERS and name not in base.structure.names:
            continue  # of a term that the model has not yet
        rest = {key: value for key, value in known.items() if key != name}
        hypothesis = _stating(base, Fault("known", f"known.{name}", "", ""), rest)
        yield replace(hypothesis, fault=_contradicted(name, stated, hypothesis.candidate))


def _stating(base: CandidateFit, fault: Fault, known: Mapping[str, KnownValue]) -> Hypothesis:
    def described(campaign: Campaign) -> Campaign:
        return replace(campaign, known=known)

    correction = Correction(description=described)
    candidate = base.step(correction, base.fit)
    return Hypothesis(fault, "corrected", correction, candidate.table, candidate)


def _contradicted(name: str, stated: KnownValue, candidate: CandidateFit) -> Fault:
    parameters = candidate.fit.parameters
    estimate = DERIVED[name].value(parameters) if name in DERIVED else parameters[name]
    unit = PARAMETERS[name].unit if name in PARAMETERS else "kg"
    what = f"the recordings contradict {name} = {stated.value:g} {unit}; without it they give {estimate:.4g} {unit}"
    loads = [
        load.name
        for load in candidate.campaign.loads
        if (mass := load.total_mass(candidate.campaign.layout))
        and abs(stated.value - mass - estimate) < _LOAD_INCLUDED * estimate
    ]
    if name.endswith("_mass") and loads:
        what += f", and the difference is the mass of load '{loads[0]}', which it must not include"
    do = f"Correct {name} under [known] in the campaign file, or state its uncertainty, {{ value = ..., std = ... }}."
    return Fault("known", f"known.{name}", f"{what}. It was not used", do)
