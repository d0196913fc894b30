"""Memories that no friction can have: a fit that has ended with some goes on with those of sliding, where that is likelier.

The force with which a friction holds when a decay begins is an unknown of its drop. On the way to the optimum it may become
several times what the friction can hold: as it fades, its pull explains some of what other parameters do not explain yet, and
no small step leads back from there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.estimation.objective import ObjectiveAt
from sprung.estimation.problem import CLOSE_BY, EstimationProblem, Iterate
from sprung.estimation.time_stepping import TimeSteppingObjective
from sprung.optimisation import Maximum

Real = NDArray[np.float64]

_ROUNDS = 3
"""How many times a fit goes on, at the most: the memories of some drops become possible once those of others are."""

_STEPS = 8
"""Steps of initial states after which a drop that is likelier with possible memories shows it."""


def go_on_with_possible_memories(
    problem: EstimationProblem,
    objective: TimeSteppingObjective,
    found: Maximum[Iterate],
    tolerance: float,
    most: int,
) -> Maximum[Iterate]:
    """Return the likelier one of a maximum and of that which is reached from there with memories that friction can have.

    Parameters
    ----------
    problem
        What is maximised.
    objective
        Of the problem.
    found
        Where it has ended.
    tolerance
        Expected gain in log-likelihood at which to stop.
    most
        Steps at the most.

    Returns
    -------
    Maximum

    Notes
    -----
    Only the drops concerned are followed anew, with the parameters held: those that are likelier so are kept.
    """
    for _ in range(_ROUNDS):
        states = _likelier_states(objective, found.point, tolerance * problem.overdispersion)
        if states is None:
            break
        again = replace(problem, objective=objective.with_states(states)).maximise(
            found.point.u, None, tolerance, CLOSE_BY, most
        )
        if not problem.cost(again.point) < problem.cost(found.point):
            break
        found = again._replace(steps=found.steps + again.steps)
    return found


def _likelier_states(objective: TimeSteppingObjective, point: Iterate, least: float) -> Real | None:
    """Return initial states with memories that friction can have in drops that gain by it; None where none gains enough."""
    at = point.at
    states = objective.with_possible_memories(at.states)
    drops = np.flatnonzero((states != at.states).any(axis=1))
    if not drops.size:
        return None
    concerned = objective.with_decays([objective.decays[drop] for drop in drops.tolist()]).with_states(states[drops])
    anew = concerned.at(at.values, at.weights).with_optimal_states(_STEPS)
    gains = [_cost(at.of_drop(drop)) - _cost(anew.of_drop(own)) for own, drop in enumerate(drops.tolist())]
    likelier = np.array(gains) > least
    if not likelier.any():
        return None
    whole = at.states.copy()
    whole[drops[likelier]] = anew.states[likelier]
    return whole


def _cost(at: ObjectiveAt) -> float:
    """Return twice the negative log-likelihood of all drops at given noise levels, up to a constant."""
    return float(at.residual_sums.sum(axis=0) @ at.weights) + at.penalty
