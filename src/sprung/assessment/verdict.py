"""The verdict: whether the numbers may be used, and why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sprung.assessment.cross_validation import DropValidation
from sprung.display import shown
from sprung.estimation import FitStatistics
from sprung.tables import escaped
from sprung.uncertainty import Estimate

Real = NDArray[np.float64]

State = Literal["accept", "doubtful", "reject"]
"""State of a `Verdict`."""

EXPLAINED = 0.01
"""Model error, as a part of a channel's signal, below which the model explains the records."""

UNUSABLE = 0.04
"""Model error above which the numbers must not be used: parameters then err by ten times as much and more."""

COARSE = 0.25
"""Relative standard uncertainty above which a parameter is hardly determined."""

CONTRADICTION = 4.0
"""Standard uncertainties by which a known quantity may miss what the recordings say."""


BEYOND_DOUBT = 10.0
"""The same where the model does not explain the recordings either: then its parameters are of no use."""

SLIGHTEST = 0.0005
"""Error of a prediction, as a part of a drop's signal, that is not reported."""

ALONE, _FAR, _FEW = 10.0, 25.0, 3
"""How many times further from the others than these are a drop must be to stand alone, how far at least (five standard errors
in every direction), and among how many others that shows."""

_PREDICTED = 1.5
"""Residual over the noise up to which the others determine everything that a drop shows."""

_SEVERAL = 3
"""Drops that contradict the others from which they are no single mishaps any more."""

_NO_DROPS: Mapping[str, DropValidation] = MappingProxyType({})


@shown
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

    def _repr_html_(self) -> str:
        """Show it in a notebook."""
        reasons = "".join(f"<li>{escaped(reason)}</li>\n" for reason in self.reasons)
        return f"<p>Verdict: <strong>{self.state}</strong></p>\n<ul>\n{reasons}</ul>\n"


def decide_verdict(
    fit: FitStatistics,
    model_error: tuple[Real, Real],
    parameters: Mapping[str, Estimate],
    channels: Sequence[str],
    suspected: Sequence[str] = (),
    drops: Mapping[str, DropValidation] = _NO_DROPS,
    contradicting: int = 0,
    refuting: Sequence[str] = (),
) -> Verdict:
    """Decide whether the estimates may be used.

    Parameters
    ----------
    fit
        The fit.
    model_error
        Model error over signal and residual over noise of each channel, from `estimate_model_error`.
    parameters
        The estimates.
    channels
        Channel names.
    suspected
        Faults of the campaign file or an instrument that are probable, in words.
    drops
        Cross-validation of each drop, by its name.
    contradicting
        Drops that were left out because they contradict the others.
    refuting
        What shows that no vehicle recorded all drops, in words.

    Returns
    -------
    Verdict
    """
    if refuting:  # then what the fit to all drops says is of no vehicle
        return Verdict("reject", tuple(refuting))
    relative, over_noise = model_error
    worst = int(np.argmax(relative))
    size = float(relative[worst])
    unexplained = list(_unexplained(size, float(over_noise[worst]), channels[worst]))
    contradicted = max(map(abs, fit.contradictions.values()), default=0.0) > BEYOND_DOUBT
    is_explained = size <= EXPLAINED
    is_unusable = size > UNUSABLE or (not is_explained and contradicted)
    unconverged = list(_unconverged(fit, is_explained))
    reject = [
        *(unexplained if is_unusable else ()),
        *(() if is_explained else unconverged),
        *_nothing_determined(parameters),
        *_several_vehicles(contradicting, len(drops)),
    ]
    doubt = [
        *suspected,
        *(() if is_unusable else unexplained),
        *(unconverged if is_explained else ()),
        *_contradictions(fit),
        *_unpredicted(drops),
    ]
    if reject:  # what else a fit says that does not hold, such as how well it determines a parameter, is no reason
        return Verdict("reject", (*reject, *doubt))
    doubt += _undetermined(fit, parameters)
    if doubt:
        return Verdict("doubtful", tuple(doubt))
    explained = f"the model explains the records: its error is {_below(size)} of the signal in every channel"
    return Verdict("accept", (explained, *_predicted(drops), "every parameter is determined"))


def _unexplained(size: float, ratio: float, channel: str) -> Iterator[str]:
    if size > EXPLAINED:
        ratio_text = "" if np.isnan(ratio) else f", {ratio:.1f} times the noise at rest"
        # How much larger than the signal an error is that has no bounds says nothing.
        size_text = f"{100 * size:.1f} % of the signal{ratio_text}" if size < 1 else "larger than the signal"
        yield (
            f"the model does not explain the records: in {channel} its error is {size_text}; "
            "dry friction, stops, asymmetric dampers or a wrong campaign file do this"
        )


def _unconverged(fit: FitStatistics, is_explained: bool) -> Iterator[str]:
    if fit.converged:
        return
    steps = f"the fit did not converge in {fit.iterations} steps"
    if is_explained:
        yield (
            f"{steps}, though it explains the records: where they hardly tell parameters apart, estimates may be farther off "
            "than their uncertainties say; known masses or further drops help"
        )
    else:
        yield (
            f"{steps}: the records do not belong to this model, or the campaign file describes another vehicle, load or sensor "
            "placement"
        )


def _nothing_determined(parameters: Mapping[str, Estimate]) -> Iterator[str]:
    statuses = {estimate.status for estimate in parameters.values()}
    if "estimated" not in statuses and "unidentifiable" in statuses:
        yield "nothing is determined: these recordings do not show a vehicle vibrating freely"


def _several_vehicles(contradicting: int, used: int) -> Iterator[str]:
    """Yield that too many drops had to be left out for those that remain to be believed."""
    if contradicting > max(used / 2, _SEVERAL - 1):
        yield (
            f"{contradicting} of {contradicting + used} drops contradict the others: no vehicle recorded all of them; look for "
            "recordings of another vehicle, load or test among them"
        )


def _contradictions(fit: FitStatistics) -> Iterator[str]:
    for name, size in fit.contradictions.items():
        if abs(size) > CONTRADICTION:
            yield (
                f"the recordings contradict the known {name} by {abs(size):.1f} standard uncertainties: check it, its "
                "unit and uncertainty, and the loads"
            )


def _unpredicted(drops: Mapping[str, DropValidation]) -> Iterator[str]:
    apart = {name: drop.apart for name, drop in drops.items() if drop.apart is not None}
    usual = {name: median(far for other, far in apart.items() if other != name) for name in apart if len(apart) > _FEW}
    alone = {name for name in usual if apart[name] > max(ALONE * usual[name], _FAR)}
    missed = {
        name: drop.unexpected
        for name, drop in drops.items()
        if drop.unexpected > (SLIGHTEST if name in alone else EXPLAINED)
    }
    if not missed:
        return
    worst = max(missed, key=missed.__getitem__)
    error, residual = drops[worst].predicted or 0.0, drops[worst].predicted_residual or 0.0
    size = f"{100 * error:.1f} % of its signal, {residual:.1f} times the noise"
    if 2 * len(missed) > len(drops):
        yield f"the drops do not predict each other: the fit to the others misses {worst} by {size}"
        return
    rest = sorted(missed.keys() - {worst})
    also = f", nor do they predict {', '.join(rest)}" if rest else ""
    yield (
        f"the other drops do not predict {worst}: the fit to them misses it by {size}{also}; something was "
        "different in it (load, tyre pressure, brake), or the model lacks a property of the vehicle"
    )


def _predicted(drops: Mapping[str, DropValidation]) -> Iterator[str]:
    found = [(drop.predicted, drop.predicted_residual) for drop in drops.values()]
    errors = [(error, residual) for error, residual in found if error is not None and residual is not None]
    if errors:
        error, residual = (max(each) for each in zip(*errors, strict=True))
        at_worst = f"to {100 * error:.1f} % of its signal, {residual:.2f} times the noise, at worst"
        # Two drops of different kinds say little of each other, which is no merit of the model.
        how = "" if residual < _PREDICTED else " within what these leave open"
        yield f"each drop is predicted by the others{how}, {at_worst}"


def _undetermined(fit: FitStatistics, parameters: Mapping[str, Estimate]) -> Iterator[str]:
    names = [name for name, estimate in parameters.items() if estimate.status == "unidentifiable"]
    if names:
        yield f"these drops do not determine {', '.join(names)}"
    for name, estimate in parameters.items():
        if estimate.std is not None and estimate.std > COARSE * fit.size(name):
            yield f"{name} is only known to {100 * estimate.std / fit.size(name):.0f} %"


def _below(size: float) -> str:
    return f"below {max(100 * size, 0.1):.1f} %"
