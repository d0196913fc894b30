"""A recording whose clock runs at another rate than is stated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.faults.drop.deletion import DropDeletion
from sprung.faults.hypothesis import Hypothesis

Real = NDArray[np.float64]

_DEVIATIONS = np.linspace(-0.08, 0.08, 33)
"""Relative deviations of the rate that are tried."""

_NEGLIGIBLE = 0.002
"""Relative deviation below which the rate is not reported."""

_REFINEMENTS = 3


def clock(deletion: DropDeletion) -> Iterator[Hypothesis]:
    """Estimate the rate at which the drop agrees with the others."""
    counts = deletion.counts
    used = counts > 0
    deviation, steps = 0.0, _DEVIATIONS
    for _ in range(_REFINEMENTS):
        tried = deviation + steps
        costs = np.log(np.maximum(_residuals(deletion, tried.tolist())[:, used], 1e-300)) @ counts[used]
        deviation, steps = float(tried[np.argmin(costs)]), steps / (len(steps) / 4)
    if abs(deviation) <= _NEGLIGIBLE:
        return
    way = "fast" if deviation > 0 else "slow"
    what = f"the clock runs {100 * abs(deviation):.1f} % too {way}, compared with the other drops; the drop is left out"
    fault = Fault("clock", deletion.name, what, "Check the sampling rate of this recording.")
    yield deletion.left_out(fault, _residuals(deletion, [deviation])[0], 1)


def _residuals(deletion: DropDeletion, deviations: Sequence[float]) -> Real:
    decay = deletion.decay
    decays = [replace(decay, rate=decay.rate * (1 + deviation)) for deviation in deviations]
    return deletion.candidate.fit.residual_sums_of(decays)
