"""An item of a load that lies elsewhere than is stated."""

from __future__ import annotations

from collections.abc import Iterator

from sprung.errors import Fault
from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import Correction, move_load_item
from sprung.faults.fault_scores import FaultScore
from sprung.faults.hypothesis import Hypothesis

_ROUNDS = 4

_LONGEST_STEP = 1.0
"""m by which an item of a load is moved at once."""

_NEGLIGIBLE = 0.02
"""m."""

_DIRECTIONS = (("back", "forward"), ("to the right", "to the left"))


def load_position(base: CandidateFit) -> Iterator[Hypothesis]:
    """Move the item of a load for which that gains most; the place is only named, as mass and place are hardly told apart."""
    first = _best_score(base, None)
    if first is None:
        return
    score: FaultScore | None = first
    candidate, distance = base, 0.0
    for _ in range(_ROUNDS):
        if score is None or score.gain < 1:
            break
        distance += max(min(score.value, _LONGEST_STEP), -_LONGEST_STEP)
        candidate = base.step(_moved(first, distance), candidate.fit)
        score = _best_score(candidate, first)
    if abs(distance) < _NEGLIGIBLE:
        return
    size, direction = f"{100 * abs(distance):.0f} cm", _DIRECTIONS[first.axis][distance > 0]
    what = (
        f"item {first.item + 1} lies {size} further {direction} than is stated, as the fit shows; nothing was changed"
    )
    fault = Fault("load-position", f"load '{first.where}'", what, "Measure the place and the mass of the load again.")
    yield Hypothesis(fault, "named", Correction(), candidate.table, candidate, 1)


def _moved(score: FaultScore, distance: float) -> Correction:
    return move_load_item(score.where, score.item, score.axis, distance)


def _best_score(candidate: CandidateFit, like: FaultScore | None) -> FaultScore | None:
    """Return the largest score of a load's place, or that of the same item and axis as another one."""
    matching = (
        score for score in candidate.scores if score.kind == "load-position" and (like is None or score[:4] == like[:4])
    )
    return next(matching, None)
