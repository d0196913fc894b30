"""Memories that no friction can have: a fit that has ended with some goes on without them where that is likelier."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sprung.estimation.objective import ObjectiveAt
from sprung.estimation.problem import CLOSE_BY, EstimationProblem, Iterate, identifiable_equations
from sprung.estimation.time_stepping import TimeSteppingObjective
from sprung.optimisation import Maximum


def go_on_without_impossible_memories(
    problem: EstimationProblem,
    objective: TimeSteppingObjective,
    found: Maximum[Iterate],
    tolerance: float,
    most: int,
) -> Maximum[Iterate]:
    """Return the likelier one of a maximum and of that which is reached from there without impossible memories of friction.

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
    Only the drops concerned are followed anew, with the parameters held. What they then lose, and what all drops gain as the
    parameters follow, to the second order, tells whether it is worth while to go on.
    """
    at = found.point.at
    states = objective.without_impossible_memories(at.values, at.states)
    if states is None:
        return found
    drops = np.flatnonzero((states != at.states)[:, objective.state_size :].any(axis=1))
    concerned = objective.with_decays([objective.decays[drop] for drop in drops.tolist()])
    anew = concerned.with_states(states[drops]).at(at.values, at.weights).with_optimal_states()
    lost = (_cost(anew) - sum(_cost(at.of_drop(drop)) for drop in drops.tolist())) / problem.overdispersion
    if not np.isfinite(lost):
        return found
    changes = (
        (after - before[drops]) / problem.overdispersion for after, before in zip(anew.by_drop, at.by_drop, strict=True)
    )
    gradients, informations = problem.in_null_space(found.point, *changes)
    information, gradient, null_space = problem.system(found.point)
    equations = identifiable_equations(information + informations.sum(0), gradient + gradients.sum(0), null_space)
    if not equations.step()[1] > lost + tolerance:
        return found
    whole = at.states.copy()
    whole[drops] = anew.states
    again = replace(problem, objective=objective.with_states(whole)).maximise(
        found.point.u, None, tolerance, CLOSE_BY, most
    )
    steps = found.steps + again.steps
    return again._replace(steps=steps) if problem.cost(again.point) < problem.cost(found.point) else found


def _cost(at: ObjectiveAt) -> float:
    """Return twice the negative log-likelihood of all drops at given noise levels, up to a constant."""
    return float(at.residual_sums.sum(axis=0) @ at.weights) + at.penalty
