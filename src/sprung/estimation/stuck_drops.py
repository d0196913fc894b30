"""Drops whose initial states are stuck: a fit that has ended with some goes on from other states of theirs that are likelier.

The force with which a friction holds when a decay begins is an unknown of its drop. On the way to the optimum it may become
several times what the friction can hold: as it fades, its pull explains some of what other parameters do not explain yet, and
no small step leads back from there. And where frictions turn round or knees are passed the likelihood of a drop has kinks, at
one of which its initial state may stay while all other drops are explained.
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
"""How many times a fit goes on, at the most: some drops are set free once others are."""

_HEATS = (4, 3), (4, 1)
"""Steps of initial states that all starts of a drop take, and how many of them go on; then of those until the best shows."""

_WORSE, _MOST_STUCK = 1.3, 1 / 3
"""Squares that a drop leaves, over those of the median one, from which it is stuck; and the part of all drops that may be so:
where more of them are worse, it is the model."""

_SCATTER = (0.05, 0.3, 0.3) * 2
"""From where the initial state of a stuck drop is looked for anew, beside where it is: each number by so much of the standard
deviation that it has over all drops. Of 16 starts 5 and 11 led away from a kink; of 12 with 0.3, 11 led away from another one,
6 of them to a likelier state within 4 steps."""


def go_on_with_likelier_states(
    problem: EstimationProblem,
    objective: TimeSteppingObjective,
    found: Maximum[Iterate],
    tolerance: float,
    most: int,
) -> Maximum[Iterate]:
    """Return the likelier one of a maximum and of that which is reached from there with other initial states of stuck drops.

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
        states = _likelier_states(objective, found, tolerance * problem.overdispersion)
        if states is None:
            break
        again = replace(problem, objective=objective.with_states(states)).maximise(
            found.point.u, None, tolerance, CLOSE_BY, most
        )
        if not problem.cost(again.point) < problem.cost(found.point):
            break
        found = again._replace(steps=found.steps + again.steps)
    return found


def _likelier_states(objective: TimeSteppingObjective, found: Maximum[Iterate], least: float) -> Real | None:
    """Return initial states of all drops, with others of stuck ones that gain by them; None where none gains enough."""
    at = found.point.at
    possible = objective.with_possible_memories(at.states)
    starts = [(drop, possible[drop]) for drop in np.flatnonzero((possible != at.states).any(axis=1)).tolist()]
    # Where a fit was stopped on the way, a drop that is worse than others may only need more steps.
    stuck = _stuck_drops(objective, at) if found.converged else []
    starts += [(drop, start) for drop in stuck for start in _scattered(objective, at.states, drop)]
    if not starts:
        return None
    for steps, best in _HEATS:
        drops, states = zip(*starts, strict=True)
        concerned = objective.with_decays([objective.decays[drop] for drop in drops]).with_states(np.array(states))
        anew = concerned.at(at.values, at.weights).with_optimal_states(steps)
        costs = [_cost(anew.of_drop(own)) for own in range(len(drops))]
        ranked = {drop: sorted((cost, own) for own, cost in enumerate(costs) if drops[own] == drop) for drop in drops}
        starts = [(drop, anew.states[own]) for drop, own_costs in ranked.items() for _, own in own_costs[:best]]
    whole = at.states.copy()
    for drop, state in starts:
        if _cost(at.of_drop(drop)) - ranked[drop][0][0] > least:
            whole[drop] = state
    return whole if (whole != at.states).any() else None


def _stuck_drops(objective: TimeSteppingObjective, at: ObjectiveAt) -> list[int]:
    """Return the drops, by their positions, of which much more is left than of most others."""
    left = (at.residual_sums @ at.weights) / objective.samples
    worse = np.flatnonzero(left > _WORSE * np.median(left))
    return worse.tolist() if worse.size <= _MOST_STUCK * len(left) else []


def _scattered(objective: TimeSteppingObjective, states: Real, drop: int) -> Real:
    """Return initial states near that of a drop, with memories of sliding at the most, shape (start, state + memory)."""
    random = np.random.default_rng(drop)
    scatter = np.outer(_SCATTER, states.std(axis=0)) * random.standard_normal((len(_SCATTER), states.shape[1]))
    motion, memories = np.split(states[drop] + scatter, [objective.state_size], axis=1)
    return np.hstack([motion, np.clip(memories, -1.0, 1.0)])


def _cost(at: ObjectiveAt) -> float:
    """Return twice the negative log-likelihood of all drops at given noise levels, up to a constant."""
    return float(at.residual_sums.sum(axis=0) @ at.weights) + at.penalty
