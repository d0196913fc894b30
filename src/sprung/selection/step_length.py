"""Length of the steps in time: they are short where their error shows beside the noise.

An optimum is moved by steps of usual length less than by the noise of usual sensors. Where sensors are better, a knee is sharp,
or friction turns round often, parameters would be fitted to their error.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sprung.selection.contact import final_tolerance
from sprung.selection.search import ModelSearch

_SHIFT = 0.75
"""Standard errors by which half as long steps may move a parameter. Friction turns round somewhere in a step: its error falls
slowly, and moves a part that is hardly known, the damping of a rubber mount say, by half of one."""

_HALVINGS = 3


def with_short_steps(search: ModelSearch) -> ModelSearch:
    """Halve the steps in time until that no longer moves the optimum, and fit the model with them.

    Parameters
    ----------
    search
        The model and its fit, at its optimum.

    Returns
    -------
    ModelSearch
        As given where no motion is stepped, or steps are short enough.
    """
    for _ in range(_HALVINGS if search.structure.is_time_stepped else 0):
        structure = replace(search.structure, step_part=search.structure.step_part / 2)
        there = search.refit(structure, most=1, enough=np.inf)  # an evaluation
        shift = there.fit.expected_shift
        if shift <= _largest_shift(search):
            break
        search = there.refit(structure, enough=final_tolerance(there))
        # The error of steps falls with their length at least: halved once more, they move half as much at the most.
        if shift / 2 <= _largest_shift(search):
            break
    return search


def _largest_shift(search: ModelSearch) -> float:
    """Return by how many standard errors of white residuals half as long steps may move a parameter."""
    return float(_SHIFT * np.sqrt(search.overdispersion))
