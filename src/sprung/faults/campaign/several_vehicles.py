"""Drops of two vehicles, which no model of one explains."""

from __future__ import annotations

from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import Correction
from sprung.faults.hypothesis import Hypothesis
from sprung.selection import Groups, ModelSearch, divide_drops


def several_vehicles(base: CandidateFit) -> Hypothesis | None:
    """Divide the drops between two vehicles that the linear model describes; None where that does not explain them.

    Parameters
    ----------
    base
        The fit of the campaign as it is.
    """
    groups = None if base.is_explained else divide_drops(ModelSearch(base.structure, base.fit, base.decays))
    return None if groups is None else of_two_vehicles(base, groups)


def of_two_vehicles(base: CandidateFit, groups: Groups) -> Hypothesis:
    """Return the hypothesis that two groups of drops are of two vehicles.

    Parameters
    ----------
    base
        The fit of the campaign as it is.
    groups
        The names of their recordings.
    """
    one, other = (", ".join(group) for group in groups)
    what = f"one vehicle explains {one}, another one {other}, and none explains all of them; nothing was changed"
    do = (
        "Look for recordings of another vehicle, load or test, for another tyre pressure or setting of the dampers, and for a "
        "brake that was on; make a campaign of each group."
    )
    fault = Fault("unlike-repeats", other, what, do)
    return Hypothesis(fault, "named", Correction(), base.table, base, is_refuting=True)
