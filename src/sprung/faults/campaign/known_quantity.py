"""Quantities stated as known that the recordings contradict.

Free vibrations show ratios of masses and rates, but no scale of them: of two statements that contradict each other either one
may be wrong. An error that has no number of its own, two exchanged masses, is likelier than one that may have any size.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace

from sprung.campaign import Campaign
from sprung.display import enumerated
from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import Correction
from sprung.faults.hypothesis import Hypothesis
from sprung.uncertainty import KnownValue
from sprung.vehicle import DERIVED, PARAMETERS, evaluate_quantity

_PLACE = "known."


def known_quantities(base: CandidateFit) -> Iterator[Hypothesis]:
    """Exchange the masses of the axles, take each load out of the total mass, and leave out each known quantity."""
    known = base.campaign.known
    front, rear = (known.get(name) for name in ("front_axle_mass", "rear_axle_mass"))
    if front is not None and rear is not None:
        what = (
            f"the masses of the axles are exchanged: {rear.value:g} kg in front and {front.value:g} kg behind fit the "
            "recordings; corrected"
        )
        where = f"{_PLACE}front_axle_mass, {_PLACE}rear_axle_mass"
        fault = Fault("known", where, what, "Exchange the two in the campaign file.")
        yield _stating(base, fault, {**known, "front_axle_mass": rear, "rear_axle_mass": front})
    yield from _with_a_load_in_it(base)
    for name in known:
        if name in PARAMETERS and name not in base.structure.names:
            continue  # of a term that the model has not yet
        yield _without(base, [name])


def _with_a_load_in_it(base: CandidateFit) -> Iterator[Hypothesis]:
    known = base.campaign.known
    total = known.get("total_mass")
    if total is None:
        return
    for load in base.campaign.loads:
        mass = load.total_mass(base.campaign.layout)
        if not 0 < mass < total.value:
            continue
        what = (
            f"the recordings contradict total_mass = {total.value:g} kg, and the difference is the mass of load '{load.name}', "
            "which it must not include; corrected"
        )
        do = "Correct total_mass under [known] in the campaign file: it is the mass of the empty vehicle."
        fault = Fault("known", f"{_PLACE}total_mass", what, do)
        empty = replace(total, value=total.value - mass)
        yield _stating(base, fault, {**known, "total_mass": empty})


def none_of(base: CandidateFit, rivals: Collection[Hypothesis]) -> Hypothesis | None:
    """Leave out all known quantities of which any one may be wrong.

    Parameters
    ----------
    base
        The fit of the campaign as it is.
    rivals
        What explains the recordings equally well.

    Returns
    -------
    Hypothesis or None
        None where something else is among them.
    """
    places = dict.fromkeys(place for one in rivals for place in one.fault.where.split(", "))
    if not all(place.startswith(_PLACE) for place in places):
        return None
    return _without(base, [place.removeprefix(_PLACE) for place in places])


def restated(base: CandidateFit, hypothesis: Hypothesis) -> Hypothesis:
    """Return a hypothesis about known quantities with what its fit says of them.

    Parameters
    ----------
    base
        The fit of the campaign as it is.
    hypothesis
        Once it is confirmed.
    """
    known = base.campaign.known
    missing = [name for name in known if name not in hypothesis.candidate.campaign.known]
    if not missing:
        return hypothesis
    fault = _contradicted({name: known[name] for name in missing}, hypothesis.candidate)
    doubt = _resting_on_load(missing[0], known[missing[0]], hypothesis.candidate) if len(missing) == 1 else None
    return replace(hypothesis, fault=fault, doubt=doubt)


def _without(base: CandidateFit, names: Collection[str]) -> Hypothesis:
    known = base.campaign.known
    rest = {name: value for name, value in known.items() if name not in names}
    fault = Fault("known", ", ".join(f"{_PLACE}{name}" for name in names), "", "")
    return replace(_stating(base, fault, rest), free=len(names))


def _stating(base: CandidateFit, fault: Fault, known: Mapping[str, KnownValue]) -> Hypothesis:
    def described(campaign: Campaign) -> Campaign:
        return replace(campaign, known=known)

    correction = Correction(description=described)
    # A statement may be far off: one step does not tell what it explains.
    candidate = base.refine(correction, base.fit)
    return Hypothesis(fault, "corrected", correction, candidate.table, candidate)


def _contradicted(stated: Mapping[str, KnownValue], candidate: CandidateFit) -> Fault:
    places = ", ".join(f"{_PLACE}{name}" for name in stated)
    values = [f"{name} = {value.value:g} {_unit(name)}" for name, value in stated.items()]
    states = "or state its uncertainty, { value = ..., std = ... }."
    if len(stated) > 1:
        what = (
            f"{enumerated(values)} contradict each other, and the recordings do not tell which of them is wrong; none of them "
            "was used, so that nothing may be left to tell masses and rates"
        )
        return Fault("known", places, what, f"Correct the wrong one under [known] in the campaign file, {states}")
    (name,) = stated
    found = f"{evaluate_in(name, candidate):.4g} {_unit(name)}"
    what = f"the recordings contradict {values[0]}; without it they give {found}. It was not used"
    return Fault("known", places, what, f"Correct {name} under [known] in the campaign file, {states}")


def _resting_on_load(name: str, stated: KnownValue, candidate: CandidateFit) -> Fault | None:
    """Return what else may be wrong where only loads are left to tell masses and rates; None where something else is."""
    campaign = candidate.campaign
    loads = {drop.load: campaign.load(drop.load).total_mass(campaign.layout) for drop in campaign.drops}
    loaded = [load for load, mass in loads.items() if mass > 0]
    if not loaded or not tells_scale(name) or any(map(tells_scale, campaign.known)):
        return None
    listed = ", ".join(f"load '{load}'" for load in loaded)
    ratio = stated.value / evaluate_in(name, candidate)
    what = (
        f"masses and rates rest on its mass alone, as {name} = {stated.value:g} {_unit(name)} contradicts it: if {name} is "
        f"right and the mass of the load is wrong, all masses and rates are {ratio:.3g} times as large"
    )
    return Fault(
        "known", listed, what, "Weigh the load and the vehicle again, and correct what was wrong in the campaign file."
    )


def tells_scale(name: str) -> bool:
    """Return whether a known quantity tells the scale of masses and rates: it is one of them.

    Parameters
    ----------
    name
        Of the quantity.
    """
    return PARAMETERS[name].scales if name in PARAMETERS else name.endswith("_mass")


def evaluate_in(name: str, candidate: CandidateFit) -> float:
    """Evaluate a quantity in a fit, SI.

    Parameters
    ----------
    name
        Of the quantity.
    candidate
        The fit.
    """
    return evaluate_quantity(name, candidate.fit.names, candidate.fit.values)[0]


def _unit(name: str) -> str:
    return (PARAMETERS[name] if name in PARAMETERS else DERIVED[name]).unit
