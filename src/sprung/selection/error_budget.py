"""Thresholds of every hypothesis, model term or fault, from the share of sound campaigns that may be changed wrongly.

A hypothesis with k parameters that is false gains chi-square with k degrees of freedom in twice the log-likelihood (Wilks, Ann.
Math. Stat. 9 (1938) 60). Every hypothesis that is tried gets an equal part of the permitted share (Bonferroni). The Bayesian
information criterion (Schwarz, Ann. Stat. 6 (1978) 461) asks for more where there are many samples, and the larger of the two
counts. Overdispersion multiplies both: the records then contain as much less information.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.stats import chi2

FALSE_ALARM_SHARE = 0.001
"""Share of sound campaigns that may be changed wrongly by all hypotheses together: at most one percent is permitted; with a
tenth of that, 500 sound campaigns show on average half a false alarm if every hypothesis used up its part, and the
information criterion asks for more than most do."""

MODEL_ERROR = 0.2
"""Variance beyond the sensors' noise at rest, as a part of it, from which the model has errors that its terms have to explain.
The variance of 100 samples at rest has a standard error of 0.14 of itself; eight channels are averaged."""

MISFIT_LEFT_AT_FIRST, MISFIT_LEFT = 0.7, 0.1
"""Part of the linear vehicle's model error that a nonlinear one may leave in the beginnings of the decays after its first steps
and at its end: a term that leaves more is not the missing one, or not the only one, and its estimates are of no use."""

MISFIT_LEFT_BESIDE = 0.3
"""The same of a nonlinear term that may lack only what refines it: friction that grows with the load, a second knee."""

MISFIT_LEFT_BY_ALL = 0.05
"""The same of a linear term that resembles many a fault: it may leave geometry of second order, say, that is tried later."""

MISFIT_LEFT_TO_OTHERS = 0.5
"""The same of such a term before further ones are looked for beside it: one that leaves most of a misfit is not what makes it.
That one shows when it is tried itself, and this one beside it again."""

HARDLY_EXPLAINED = 0.5
"""Model error, as a part of a channel's signal, from which no further term is all that is missing there: the channel shows what
the vehicle does not do."""

LEAST_SHARE = 0.05
"""Part of what is left to explain that a term has to explain: less than that is feigned by whatever else is wrong."""

UNEXPLAINED = 0.02
"""Model error, as a part of a channel's signal, from which a vehicle with every usual term is fitted: what is slow is tried
only where the model so far is of no use."""

OVERDISPERSED = 2.0
"""Overdispersion from which what is left is model error and not noise."""


@lru_cache(maxsize=256)
def _significance(parameters: int, hypotheses: int) -> float:
    return float(chi2.isf(FALSE_ALARM_SHARE / hypotheses, parameters))


def required_gain(parameters: int, hypotheses: int, samples: float, overdispersion: float = 1.0) -> float:
    """Return the gain in twice the log-likelihood that a hypothesis needs to be accepted.

    Parameters
    ----------
    parameters
        How many parameters the hypothesis estimates; 0 is counted as 1.
    hypotheses
        How many hypotheses are tried on the campaign.
    samples
        Number of samples fitted, all channels together.
    overdispersion
        Factor on every variance, dimensionless, at least 1.

    Returns
    -------
    float
        Dimensionless.

    Examples
    --------
    >>> round(required_gain(2, 12, 1e3), 1), round(required_gain(2, 12, 50e3), 1)
    (18.8, 21.6)
    """
    count = max(parameters, 1)
    criterion = count * float(np.log(max(samples, 1.0)))
    return max(_significance(count, max(hypotheses, 1)), criterion) * max(overdispersion, 1.0)
