"""What an identification began with: what was known, where sensors and loads were, which settings and files."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version

import numpy as np
from pydantic import ConfigDict

from sprung.campaign import Campaign, ModelChoice, SourceFile, TestRecord
from sprung.display import shown
from sprung.estimation import FitStatistics, estimate_of
from sprung.uncertainty import Estimate, KnownValue
from sprung.vehicle import DERIVED, Load, Sensor

_LIBRARIES = ("numpy", "scipy")
"""Whose versions may change the last digits of a result."""


@shown
@dataclass(frozen=True, slots=True)
class PriorComparison:
    """A quantity known before the recordings were looked at, and what they say of it.

    Attributes
    ----------
    value, std, unit
        As it was measured beforehand, SI; a std of 0 stands for exact.
    found
        What came out: for an exact quantity the same.
    missed
        By how many standard uncertainties the recordings, and everything else that is known, would rather have another
        value; None where they say nothing of it.
    """

    value: float
    std: float
    unit: str
    found: Estimate
    missed: float | None = None


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What an identification began with.

    Attributes
    ----------
    known
        By name: parameters and derived quantities, the wheelbase among them.
    heights
        By their keys in a campaign file: above the ground, m, as far as they were measured.
    sensors, loads
        As the campaign file describes them.
    model
        What the campaign file says about the model.
    options
        What was asked of `identify` beside it, by its name, in words.
    files
        The campaign file and the recordings, as they were read; empty where there were none.
    software
        Versions by name.
    test
        When, where and by whom the vehicle was tested, as far as the campaign file says it.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    known: dict[str, PriorComparison]
    heights: dict[str, float]
    sensors: tuple[Sensor, ...]
    loads: tuple[Load, ...]
    model: ModelChoice
    options: dict[str, str]
    files: tuple[SourceFile, ...] = ()
    software: dict[str, str]
    test: TestRecord = field(default_factory=TestRecord)


def setup_of(
    campaign: Campaign, fit: FitStatistics, known: Mapping[str, KnownValue], options: Mapping[str, object]
) -> Setup:
    """Put together what an identification began with.

    Parameters
    ----------
    campaign
        As it was fitted.
    fit
        The fit.
    known
        Everything known beforehand about the model's parameters.
    options
        What was asked for, by name; None for what was left open.
    """
    told = {name: one for name, one in known.items() if name in fit.names or name in DERIVED}
    heights = {key: value for key, value in campaign.heights.by_key.items() if value is not None}
    return Setup(
        known={name: _before(fit, known, name) for name in told},
        heights=heights,
        sensors=campaign.sensors,
        loads=campaign.loads,
        model=campaign.model,
        options={name: _in_words(value) for name, value in options.items()},
        files=campaign.files,
        software={
            "sprung": version("sprung"),
            "Python": platform.python_version(),
            **{name: version(name) for name in _LIBRARIES},
        },
        test=campaign.test,
    )


def _before(fit: FitStatistics, known: Mapping[str, KnownValue], name: str) -> PriorComparison:
    found = estimate_of(fit, known, name)
    missed = fit.contradictions.get(name)
    told = missed is not None and np.isfinite(missed)
    return PriorComparison(known[name].value, known[name].std, found.unit, found, missed if told else None)


def _in_words(value: object) -> str:
    match value:
        case None:
            return "left open"
        case bool():
            return "yes" if value else "no"
        case str():
            return value
        case Sequence():
            return ", ".join(map(str, value)) or "none"
        case _:
            return str(value)
