"""Summary of a result in words and a few numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from sprung.results import Result
from sprung.tables import percent_text
from sprung.vehicle import VehicleModel, layout_of


class VerdictText(NamedTuple):
    """Meaning of a verdict.

    Attributes
    ----------
    symbol
        One letter.
    statement
        Whether the estimates may be used.
    explanation
        What the reasons of the verdict are, before their list.
    """

    symbol: str
    statement: str
    explanation: str


_VERDICTS = {
    "accept": VerdictText("✓", "The estimates may be used.", "Reasons:"),
    "doubtful": VerdictText(
        "!",
        "The estimates may be used with reservations.",
        "Read every reason before use:",
    ),
    "reject": VerdictText(
        "✕",
        "The estimates must not be used; none are reported.",
        "Reasons:",
    ),
}

_MODELS: Mapping[VehicleModel, str] = {
    "full": "seven degrees of freedom",
    "pitch-plane": "pitch plane, four degrees of freedom",
    "roll-plane": "roll plane, four degrees of freedom",
    "quarter": "quarter car, two degrees of freedom",
}
"""The linear model of a whole vehicle, and of each part of one."""


def verdict_text(result: Result) -> VerdictText:
    """Return the meaning of a verdict.

    Parameters
    ----------
    result
        Of an identification.

    Returns
    -------
    VerdictText
    """
    return _VERDICTS[result.verdict.state]


def test_record_of(result: Result) -> Iterator[tuple[str, str]]:
    """Yield the test record of the campaign file: names and texts.

    Parameters
    ----------
    result
        The result.
    """
    if result.tested_vehicle.identification is not None:
        yield "Vehicle identification", result.tested_vehicle.identification
    test = result.setup.test
    for name, text in (
        ("Date", test.date),
        ("Operator", test.operator),
        ("Place", test.place),
        ("Remarks", test.remarks),
    ):
        if text is not None:
            yield name, str(text)


def summary_of(result: Result) -> Iterator[tuple[str, str]]:
    """Yield the summary of a result: names and texts.

    Parameters
    ----------
    result
        The result.
    """
    used = [drop for drop in result.drops if drop.start is not None]
    loads = ", ".join(f"{count} {load}" for load, count in Counter(drop.load for drop in used).items())
    left = len(result.drops) - len(used)
    yield "Drops", f"{len(used)} fitted together ({loads})" + (f", {left} left out" if left else "")
    yield "Model", model_text(result)
    states = Counter(estimate.status for estimate in result.parameters.values())
    counts = [f"{states[name]} {name}" for name in ("estimated", "known", "unidentifiable") if states[name]]
    yield "Parameters", ", ".join(counts)
    least = max(
        (
            (estimate.percent, name)
            for name, estimate in result.parameters.items()
            if estimate.status == "estimated" and estimate.percent
        ),
        default=None,
    )
    if least is not None:
        yield "Largest uncertainty", f"{percent_text(least[0])} % ({least[1]})"
    if result.validation:
        residuals = [drop.residual for drop in result.validation.values()]
        yield "Residual", f"{min(residuals):.2f} to {max(residuals):.2f} times the noise"
    predicted = [drop.predicted_residual for drop in result.validation.values() if drop.predicted_residual is not None]
    if predicted:
        yield (
            "Residual of the prediction from the other drops",
            f"{min(predicted):.2f} to {max(predicted):.2f} times the noise",
        )


def model_text(result: Result) -> str:
    """Return the identified model in words: its degrees of freedom and model terms.

    Parameters
    ----------
    result
        The result.

    Returns
    -------
    str
    """
    extras = result.fit.model
    linear = _MODELS[layout_of(result.parameters).model]
    return linear + (f", with {', '.join(extras)}" if extras else "")


def symbol_parts(name: str) -> tuple[str, str]:
    """Return the letter and the index of a parameter's name: ``k`` and ``sf`` of ``k_sf``."""
    letter, _, index = name.partition("_")
    return letter, index.replace("_", " ")
