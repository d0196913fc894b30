"""The verdict: whether the numbers may be used, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sprung.estimate import Estimate
from sprung.identification import Fit
from sprung.validation.residuals import Misfit

State = Literal["accept", "doubtful", "reject"]

EXPLAINED = 0.01
"""Model error, as a part of a channel's signal, below which the model explains the records."""

UNUSABLE = 0.04
"""Model error above which the numbers must not be used: parameters then err by ten times as much and more."""

COARSE = 0.25
"""Relative standard uncertainty above which a parameter is hardly determined."""

CONTRADICTION = 4.0
"""Standard uncertainties by which a known quantity may miss the recordings."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether the numbers may be used.

    Attributes
    ----------
    state
        ``accept``: the model explains the records and every parameter is determined; ``doubtful``: usable once the
        reasons are read; ``reject``: the numbers must not be used.
    reasons
        In sentences, the gravest first.
    """

    state: State
    reasons: tuple[str, ...]


def judge(fit: Fit, misfit: Misfit, parameters: Mapping[str, Estimate], channels: Sequence[str]) -> Verdict:
    """Come to a verdict.

    Parameters
    ----------
    fit
        The fit.
    misfit
        How far the model is from the records.
    parameters
        The estimates.
    channels
        Channel names.
    """
    reject: list[str] = []
    doubt: list[str] = []
    worst = int(np.argmax(misfit.relative))
    size = float(misfit.relative[worst])
    if size > EXPLAINED:
        ratio = misfit.ratio[worst]
        beyond = "" if np.isnan(ratio) else f", {ratio:.1f} times the noise at rest"
        text = (
            f"the linear model does not explain the records: in {channels[worst]} its error is {100 * size:.1f} % of the "
            f"signal{beyond}; dry friction, stops, asymmetric dampers or a wrong campaign file do this"
        )
        (reject if size > UNUSABLE else doubt).append(text)
    if not fit.converged:
        reject.append(
            f"the fit did not converge in {fit.iterations} steps: the records do not belong to this model, or the campaign "
            "file describes another vehicle, load or sensor placement"
        )
    for name, residual in fit.prior_residual.items():
        if abs(residual) > CONTRADICTION:
            doubt.append(
                f"the recordings contradict the known {name} by {abs(residual):.1f} of its standard uncertainties: "
                "check it, its uncertainty, and the loads"
            )
    undetermined = [name for name, estimate in parameters.items() if estimate.status == "unidentifiable"]
    if undetermined:
        doubt.append(f"these drops do not determine {', '.join(undetermined)}")
    for name, estimate in parameters.items():
        if estimate.percent is not None and estimate.percent > 100 * COARSE:
            doubt.append(f"{name} is only known to {estimate.percent:.0f} %")
    if reject:
        return Verdict("reject", (*reject, *doubt))
    if doubt:
        return Verdict("doubtful", tuple(doubt))
    explained = f"the model explains the records: its error is {_below(size)} of the signal in every channel"
    return Verdict("accept", (explained, "every parameter is determined"))


def _below(size: float) -> str:
    return f"below {max(100 * size, 0.1):.1f} %"
