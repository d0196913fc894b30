"""What may be the matter with more than one channel or drop: labels of loads, places of loads, a body that twists."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.faults.bench import Bench, CandidateFit
from sprung.faults.changes import load_moved, nothing, relabelled
from sprung.faults.hypotheses import Hypothesis
from sprung.faults.of_channels import scores

Real = NDArray[np.float64]

_ROUNDS = 4

_FARTHEST = 1.0
"""m by which an item of a load is moved at once."""

_LOAD_MATTERS = 0.02
"""m."""

_SHAPE = 0.7
"""Part of what is left of the body's channels that has the shape of a twist, from which it is one."""

_MOVING = 0.05
"""Part of a twist, squared, that a sensor has to show for it to count."""

_WAYS = (("back", "forward"), ("to the right", "to the left"))

_DO = "Correct load = ... of these drops in the campaign file."


def exchanged_loads(bench: Bench) -> Iterator[Hypothesis]:
    """Exchange the labels of all drops, and those of the drops that would rather have another one."""
    here = {decay.file: decay.load for decay in bench.decays}
    loads = sorted(set(here.values()))
    if len(loads) < 2:
        return
    if len(loads) == 2:
        other = dict(zip(loads, loads[::-1], strict=True))
        change = relabelled({file: other[load] for file, load in here.items()})
        trial = bench.fit(change(bench.campaign))
        what = f"all drops '{loads[0]}' are taken for '{loads[1]}' and the other way round; that was put right"
        fault = Fault("load-exchanged", f"all drops, {loads[0]} and {loads[1]}", what, _DO)
        yield Hypothesis(fault, "repaired", change, trial.tally, trial)
    labels, trial = here, bench.base
    for _ in range(_ROUNDS):
        better = _better_labels(bench, trial, loads)
        if better == labels or len(set(better.values())) < 2:
            break
        labels = better
        trial = bench.fit(relabelled(labels)(bench.campaign))
    moved = {file: load for file, load in labels.items() if load != here[file]}
    if moved and len(moved) < len(here):
        what = "they move as if their loads were exchanged; that was put right"
        fault = Fault("load-exchanged", ", ".join(moved), what, _DO)
        yield Hypothesis(fault, "repaired", relabelled(moved), trial.tally, trial)


def _better_labels(bench: Bench, trial: CandidateFit, loads: list[str]) -> dict[str, str]:
    """Give each drop the load with which this vehicle explains it best."""
    decays, weights = bench.decays, trial.optimum.weights
    costs = [
        trial.optimum.residual_sums_of([replace(decay, load=load) for decay in decays]) @ weights for load in loads
    ]
    return {decay.file: loads[int(best)] for decay, best in zip(decays, np.argmin(costs, axis=0), strict=True)}


def misplaced_loads(bench: Bench) -> Iterator[Hypothesis]:
    """Move the item of a load that the records would most like to be elsewhere."""
    trial, by = bench.base, 0.0
    first = next((one for one in scores(trial) if one.kind == "load-position"), None)
    step = first
    for _ in range(_ROUNDS):
        if first is None or step is None or step.gain < 1:
            break
        by += float(np.clip(step.value, -_FARTHEST, _FARTHEST))
        trial = bench.fit(load_moved(first.where, first.item, first.axis, by)(bench.campaign), trial.optimum.parameters)
        step = next((one for one in scores(trial) if one[:1] == first[:1] and one[1:4] == first[1:4]), None)
    if first is None or abs(by) < _LOAD_MATTERS:
        return
    size, way = f"{100 * abs(by):.0f} cm", _WAYS[first.axis][by > 0]
    what = (
        f"its item {first.item + 1} seems to lie {size} further {way} than the campaign file says; nothing was changed"
    )
    fault = Fault("load-position", f"load '{first.where}'", what, "Measure the load's place again, and its mass.")
    yield Hypothesis(fault, "named", nothing, trial.tally, trial, 1)


def twist(bench: Bench) -> Fault | None:
    """Tell whether the body twists.

    Parameters
    ----------
    bench
        The campaign.

    Returns
    -------
    Fault or None
        A fault where the wheels are explained, no sensor of the body is, and what is left of these has the shape of a body
        that twists about its length. With four and more of them that is what no rigid body can do.
    """
    base, sensors = bench.base, bench.campaign.sensors
    body = [i for i, one in enumerate(sensors) if one.on == "body" and base.tally.counts[:, i].any()]
    wheels = [i for i in range(len(sensors)) if i not in body]
    if len(body) < 3:
        return None
    places = np.array([sensors[i].position for i in body], dtype=float)
    wheelbase = bench.campaign.wheelbase
    middle = float(places[:, 0].mean()) if wheelbase is None else -wheelbase.value / 2
    shape = (places[:, 0] - middle) * places[:, 1]
    shape /= max(float(np.linalg.norm(shape)), np.finfo(float).tiny)
    explained = base.tally.explained_in(bench.noise)
    moving = np.array(body)[shape**2 > _MOVING]
    if not explained[wheels].all() or explained[moving].any():
        return None
    excess = -np.diag(bench.noise.level[body] ** 2 * base.tally.counts[:, body].sum(axis=0))
    for record in base.optimum.residuals:
        left = np.nan_to_num(record[body])
        excess += left @ left.T
    part = float(shape @ excess @ shape) / max(float(np.trace(excess)), np.finfo(float).tiny)
    if part < _SHAPE:
        return None
    what = (
        f"{100 * min(part, 1.0):.0f} % of what the model leaves unexplained of the body's channels is a twist, which no rigid "
        "body shows; nothing was changed"
    )
    return Fault("twist", "body", what, "Put the body's sensors where it is stiff, or close up what lets it twist.")
