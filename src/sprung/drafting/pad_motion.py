"""Motion of pads under the tyres: a recording in which they move needs no release."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sprung.drafting.quantity_names import is_pad_named
from sprung.drafting.release_detection import Averages, noise_of

_PART = 0.02
"""Part of the largest motion of any displacement in a recording by which a pad moves at least."""

_LEAST = 2e-4
"""m by which a pad moves at least."""

_NOISE = 12.0
"""Standard deviations of its noise by which a pad moves at least."""


def moving_pads(averages: Averages, channels: Sequence[str]) -> tuple[str, ...]:
    """Return the channels of pads that move in a recording.

    Parameters
    ----------
    averages
        Of all its displacements, m.
    channels
        Their names.

    Returns
    -------
    tuple of str
    """
    if averages.values.shape[1] < 3:
        return ()
    sizes = np.ptp(averages.values, axis=1)
    least = np.maximum(max(_LEAST, _PART * float(sizes.max(initial=0.0))), _NOISE * noise_of(averages.values)[:, 0])
    return tuple(
        name for name, size, limit in zip(channels, sizes, least, strict=True) if is_pad_named(name) and size > limit
    )
