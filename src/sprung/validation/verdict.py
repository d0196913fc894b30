"""The verdict: whether the numbers may be used, and why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
"""Standard uncertainties by which a known quantity may miss what the recordings say."""


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


def judge(
    fit: Fit,
    misfit: Misfit,
    parameters: Mapping[str, Estimate],
    channels: Sequence[str],
    accused: Sequence[str] = (),
) -> Verdict:
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
    accused
        What is probably wrong with the campaign file or an instrument.
    """
    worst = int(np.argmax(misfit.relative))
    size = float(misfit.relative[worst])
    unexplained = list(_unexplained(size, float(misfit.ratio[worst]), channels[worst]))
    reject = [*(unexplained if size > UNUSABLE else ()), *_no_fit(fit, parameters)]
    doubt = [
        *accused,
        *(unexplained if size <= UNUSABLE else ()),
        *_contradictions(fit),
        *_undetermined(parameters),
    ]
    if reject:
        return Verdict("reject", (*reject, *doubt))
    if doubt:
        return Verdict("doubtful", tuple(doubt))
    explained = f"the model explains the records: its error is {_below(size)} of the signal in every channel"
    return Verdict("accept", (explained, "every parameter is determined"))


def _unexplained(size: float, ratio: float, channel: str) -> Iterator[str]:
    if size > EXPLAINED:
        beyond = "" if np.isnan(ratio) else f", {ratio:.1f} times the noise at rest"
        yield (
            f"the linear model does not explain the records: in {channel} its error is {100 * size:.1f} % of the "
            f"signal{beyond}; dry friction, stops, asymmetric dampers or a wrong campaign file do this"
        )


def _no_fit(fit: Fit, parameters: Mapping[str, Estimate]) -> Iterator[str]:
    if not fit.converged:
        yield (
            f"the fit did not converge in {fit.iterations} steps: the records do not belong to this model, or the campaign "
            "file describes another vehicle, load or sensor placement"
        )
    if not any(estimate.status == "estimated" for estimate in parameters.values()) and any(
        estimate.status == "unidentifiable" for estimate in parameters.values()
    ):
        yield "nothing is determined: these recordings do not show a vehicle vibrating freely"


def _contradictions(fit: Fit) -> Iterator[str]:
    for name, size in fit.contradictions.items():
        if abs(size) > CONTRADICTION:
            yield (
                f"the recordings contradict the known {name} by {abs(size):.1f} standard uncertainties: check it, its "
                "unit and uncertainty, and the loads"
            )


def _undetermined(parameters: Mapping[str, Estimate]) -> Iterator[str]:
    names = [name for name, estimate in parameters.items() if estimate.status == "unidentifiable"]
    if names:
        yield f"these drops do not determine {', '.join(names)}"
    for name, estimate in parameters.items():
        if estimate.percent is not None and estimate.percent > 100 * COARSE:
            yield f"{name} is only known to {estimate.percent:.0f} %"


def _below(size: float) -> str:
    return f"below {max(100 * size, 0.1):.1f} %"
