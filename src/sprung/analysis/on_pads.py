"""What cannot be done with records of a vehicle on pads: they are fitted in the frequency domain, and not stepped in time."""

from __future__ import annotations

from sprung.analysis.analysis import Analysis
from sprung.errors import Problems
from sprung.selection import choose_structure

NOT_STEPPED = "records on pads are not followed step by step"
"""Why nothing nonlinear is tried with them."""


def has_pads(run: Analysis) -> bool:
    """Return whether pads drove the vehicle in any of the records that are used."""
    return any(decay.pads for decay in run.prepared.decays)


def require_linear_terms(run: Analysis) -> None:
    """Raise an `InputError` where nonlinear terms are requested for records on pads.

    Parameters
    ----------
    run
        With its decays.
    """
    if not has_pads(run):
        return
    requested = choose_structure(run.campaign, run.options.tracks, run.options.terms)
    nonlinear = [term for term in requested.terms if term not in requested.linear_terms]
    problems = Problems()
    if nonlinear:
        do = "Leave them out, or identify the drops without the records on pads."
        where = "campaign" if run.campaign.path is None else f"{run.campaign.path.name}: [model]"
        found = f"extras {', '.join(nonlinear)}, and drops on pads"
        problems.add(where, found, "linear terms where pads drive the vehicle", do)
    problems.raise_if_any()
