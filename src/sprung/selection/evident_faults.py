"""What is evidently wrong beside nonlinear terms: the one sensor, or the few drops, that stand out from all others."""

from __future__ import annotations

from dataclasses import replace

from sprung.selection.contact import without_landings
from sprung.selection.error_budget import MISFIT_LEFT_BESIDE
from sprung.selection.ordinary_vehicle import ITERATIONS
from sprung.selection.scoring import most_promising
from sprung.selection.search import ModelSearch
from sprung.selection.sensor_errors import FAR, find_sensor_error, furthest_from_stated
from sprung.selection.terms import TERMS
from sprung.selection.unlike_drops import UnlikeDrops, find_unlike_drops, outstanding_drops

_TRIED = 2
"""Terms that may explain why drops stand out: the best by their scores."""


def with_evident_fault(search: ModelSearch) -> ModelSearch:
    """Return the search with what is evidently wrong with a sensor or with drops, if that explains what its model leaves.

    Parameters
    ----------
    search
        A nonlinear model and its fit, of the decays or of their beginnings.

    Returns
    -------
    ModelSearch
        As given where faults are not looked for, where the model lacks nothing, and where nothing stands out.
    """
    if not search.seeks_faults or search.structure.low_pass is not None:
        return search
    # What a sensor has been pulled far for leaves nothing to explain.
    if not search.lacks_something and abs(furthest_from_stated(search)[0]) <= FAR:
        return search
    fault = find_sensor_error(search) or _unexplained_drops(search)
    return search if fault is None else replace(search, fault=fault)


def _unexplained_drops(search: ModelSearch) -> UnlikeDrops | None:
    """Return the drops that are unlike all others, if no further term makes them like these, or explains most of the misfit.

    Drops that are the only ones to roll stand out where what is missing shows in roll alone.
    """
    unlike = find_unlike_drops(search)
    # A vehicle that lacked something may have let a decay begin before its last wheel is down: then only noise is left later.
    if unlike is None or not without_landings(search).is_overdispersed:
        return None
    promising = most_promising(search, search.open_terms(tuple(TERMS)), _TRIED)
    for term in (term for term, promised in promising.items() if promised > 1):
        tried = search.refit(search.with_terms([term]), ITERATIONS, beginning_only=True)
        if not outstanding_drops(tried) or not search.leaves_misfit(tried.fit, MISFIT_LEFT_BESIDE):
            return None
    return unlike
