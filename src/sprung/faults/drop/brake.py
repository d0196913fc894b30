"""A drop with the brake on: the suspension of one axle is another one than in all other drops."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sprung.errors import Fault
from sprung.estimation import NEAR, fit_linear
from sprung.faults.drop.deletion import DropDeletion
from sprung.faults.hypothesis import Hypothesis
from sprung.uncertainty import KnownValue

_AXLES = {"f": "front", "r": "rear"}


def brake(deletion: DropDeletion) -> Iterator[Hypothesis]:
    """Let the spring and damper rates of each axle be others in this drop."""
    for axle, name in _AXLES.items():
        what = f"the {name} suspension differs from that of all other drops, as with the brake on; the drop is left out"
        do = "Release the brakes, put the gear in neutral and record the drop again."
        fault = Fault("brake", deletion.name, what, do)
        yield deletion.left_out(fault, residual_with_free(deletion, (f"k_s{axle}", f"c_s{axle}")), 2)


def residual_with_free(deletion: DropDeletion, free: Sequence[str]) -> NDArray[np.float64]:
    """Return the residuals of the drop alone where some parameters may differ, (m/s²)², shape (channel,)."""
    values, sensors = deletion.candidate.fit.parameters, deletion.base.campaign.sensors
    known = {name: KnownValue(value) for name, value in values.items() if name not in free}
    fit = fit_linear([deletion.decay], deletion.candidate.models, sensors, known, start=values, enough=NEAR)
    residual: NDArray[np.float64] = fit.residual_sums[0]
    return residual
