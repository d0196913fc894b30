"""What a result comes to, in words and in few numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from sprung.results import Result
from sprung.tables import percent_text


class VerdictWords(NamedTuple):
    """A verdict for who has to act on it."""

    sign: str
    head: str
    meaning: str


_WORDS = {
    "accept": VerdictWords("✓", "The numbers may be used.", "No reason against their use was found."),
    "doubtful": VerdictWords(
        "!",
        "The numbers may be used once these reasons are read.",
        "Not all of them can be relied on without that.",
    ),
    "reject": VerdictWords(
        "✕",
        "The numbers must not be used.",
        "The recordings do not support what was fitted to them, for these reasons.",
    ),
}


def verdict_words(result: Result) -> VerdictWords:
    """Say what a verdict means.

    Parameters
    ----------
    result
        With its verdict.
    """
    return _WORDS[result.verdict.state]


def record_of(result: Result) -> Iterator[tuple[str, str]]:
    """Return what the campaign file says of the test and the vehicle, for the record: names and texts.

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


def facts_of(result: Result) -> Iterator[tuple[str, str]]:
    """Give what one wants to know first, each with its name.

    Parameters
    ----------
    result
        The result.
    """
    used = [drop for drop in result.drops if drop.start is not None]
    loads = ", ".join(f"{count} {load}" for load, count in Counter(drop.load for drop in used).items())
    left = len(result.drops) - len(used)
    yield "Drops", f"{len(used)} fitted together ({loads})" + (f", {left} left out" if left else "")
    yield "Model", _model(result)
    states = Counter(found.status for found in result.parameters.values())
    told = [f"{states[name]} {name}" for name in ("estimated", "known", "unidentifiable") if states[name]]
    yield "Parameters", ", ".join(told)
    least = max(
        (
            (found.percent, name)
            for name, found in result.parameters.items()
            if found.status == "estimated" and found.percent
        ),
        default=None,
    )
    if least is not None:
        yield "Least certain", f"{least[1]}, to {percent_text(least[0])} %"
    if result.validation:
        left_over = [drop.residual for drop in result.validation.values()]
        yield "Residual", f"{min(left_over):.2f} to {max(left_over):.2f} times the noise"
    predicted = [drop.predicted_residual for drop in result.validation.values() if drop.predicted_residual is not None]
    if predicted:
        yield (
            "Residual as predicted by the other drops",
            f"{min(predicted):.2f} to {max(predicted):.2f} times the noise",
        )


def _model(result: Result) -> str:
    extras = result.fit.model
    return "seven degrees of freedom" + (f", with {', '.join(extras)}" if extras else "")


def symbol(name: str) -> tuple[str, str]:
    """Part a parameter's name into its letter and what stands below it: ``k_sf`` into ``k`` and ``sf``."""
    letter, _, below = name.partition("_")
    return letter, below.replace("_", " ")
