"""Corner frequencies of several high-passes, estimated from all channels together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sprung.faults.candidate_fit import CandidateFit
from sprung.faults.correction import state_corners
from sprung.faults.high_pass import NEGLIGIBLE, corner_fault, score_corners, stated_corner
from sprung.faults.hypothesis import Hypothesis

_ROUNDS = 8
"""Steps in which the corners converge."""

_LONGEST_STEP = 0.5
"""Hz by which a corner changes at once."""

_SIGNIFICANT = 4.0
"""Standard uncertainties by which a corner has to differ from the stated one."""

_CONVERGED = 1e-4
"""Change of the corners at which they have converged, Hz."""


def high_passes(base: CandidateFit) -> Iterator[Hypothesis]:
    """State the corners with which the recordings are most likely for all sensors that may be AC-coupled.

    Where all sensors have the same high-pass, none of them contradicts the others: the motion of each mode is changed alike
    in all of them. The transient of the high-pass after the fall determines the corner.
    """
    sensors = base.campaign.sensors
    candidate = base
    scores = score_corners(candidate.decays, candidate.fit, sensors)
    if scores is None or len(scores.channels) < 2:
        return
    which = [index for index, sensor in enumerate(sensors) if sensor.channel in scores.channels]
    stated = np.array([sensors[index].high_pass or 0.0 for index in which])
    corners = stated
    for _ in range(_ROUNDS):
        if scores is None or scores.raw_gain < 1:
            break
        step = np.clip(scores.step, -_LONGEST_STEP, _LONGEST_STEP)
        corners, previous = np.maximum(corners + step, 0.0), corners
        if np.abs(corners - previous).max() < _CONVERGED:
            break
        correction = state_corners(dict(zip(which, map(stated_corner, corners.tolist()), strict=True)))
        candidate = base.step(correction, candidate.fit)
        scores = score_corners(candidate.decays, candidate.fit, candidate.campaign.sensors)
    if scores is None:
        return
    stds = np.sqrt(np.diag(scores.covariance))
    differs = np.flatnonzero(np.abs(corners - stated) > np.maximum(_SIGNIFICANT * stds, NEGLIGIBLE)).tolist()
    if len(differs) < 2:
        return
    changed = {which[index]: stated_corner(float(corners[index])) for index in differs}
    correction = state_corners(changed)
    if len(differs) < len(which):
        candidate = base.step(correction, candidate.fit)
    fault = corner_fault(
        [sensors[which[index]] for index in differs], corners[differs].tolist(), stds[differs].tolist()
    )
    fault = replace(fault, what=f"{fault.what}; corrected")
    yield Hypothesis(fault, "corrected", correction, candidate.table, candidate, len(differs))
