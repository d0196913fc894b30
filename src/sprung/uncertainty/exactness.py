"""Estimates that are exact but for rounding: they follow from quantities that were known exactly."""

from __future__ import annotations

import sys
from collections.abc import Mapping

from sprung.uncertainty.estimate import Estimate

_ROUNDING = sys.float_info.epsilon**0.5
"""Relative uncertainty, in units of the largest one, that is a rounding error: its variance is one of double precision."""


def without_rounding_errors(
    estimates: Mapping[str, Estimate], among: Mapping[str, Estimate] | None = None
) -> dict[str, Estimate]:
    """Return estimates of which those are known whose uncertainty is no more than the rounding error of the largest one.

    Parameters
    ----------
    estimates
        By name.
    among
        Estimates of one fit, from whose covariance matrix all follow; these ones themselves where None.

    Returns
    -------
    dict of str to Estimate
        In the same order.

    Examples
    --------
    >>> share = Estimate(0.5787, 1.3e-11, (0.5787, 0.5787), "1", "estimated", "curvature")
    >>> rate = Estimate(22000.0, 130.0, (21745.0, 22255.0), "N/m", "estimated", "curvature")
    >>> [found.status for found in without_rounding_errors({"share": share, "rate": rate}).values()]
    ['known', 'estimated']
    """
    reference = estimates if among is None else among
    largest = max((found.percent or 0.0 for found in reference.values()), default=0.0)
    return {name: _known_if_below(found, _ROUNDING * largest) for name, found in estimates.items()}


def _known_if_below(found: Estimate, percent: float) -> Estimate:
    if found.status != "estimated" or found.value is None or found.percent is None or found.percent > percent:
        return found
    return Estimate(found.value, 0.0, (found.value, found.value), found.unit, "known")
