"""What is evidently wrong beside nonlinear terms: the one sensor, or the few drops, that stand out from all others."""

from __future__ import annotations

from dataclasses import replace

from sprung.selection.search import ModelSearch
from sprung.selection.sensor_errors import FAR, find_sensor_error, furthest_from_stated
from sprung.selection.unlike_drops import find_unlike_drops


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
    fault = find_sensor_error(search) or find_unlike_drops(search)
    return search if fault is None else replace(search, fault=fault)
