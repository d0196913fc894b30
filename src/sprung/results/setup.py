"""Input of an identification: what was known, sensors and loads, settings, files and versions."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import version

import numpy as np
from pydantic import ConfigDict

from sprung.campaign import Campaign, ModelChoice, SourceFile, TestRecord
from sprung.display import shown
from sprung.estimation import FitStatistics, estimate_of
from sprung.uncertainty import Estimate, KnownValue
from sprung.units import si_symbol
from sprung.vehicle import DERIVED, Load, Sensor

_LIBRARIES = ("numpy", "scipy")
"""Libraries whose versions may change the last digits of a result."""


@shown
@dataclass(frozen=True, slots=True)
class PriorComparison:
    """A quantity that was known before the identification, and its estimate.

    Attributes
    ----------
    value, std, unit
        Value known beforehand and its standard uncertainty, SI; a std of 0 stands for exact.
    found
        Estimate; for an exact quantity the value itself.
    missed
        Difference between the value known beforehand and the value that the recordings, with everything else that is known,
        give, in standard uncertainties: of an exact quantity, which the fit holds, the value that it would have if it were
        free. None where they do not determine it, or the result is rejected.
    """

    value: float
    std: float
    unit: str
    found: Estimate
    missed: float | None = None


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """Input of an identification.

    Attributes
    ----------
    known
        By name: parameters and derived quantities, the wheelbase among them.
    heights
        By their keys in a campaign file: above the ground, m, as far as they were measured.
    motion_ratio
        Travel of springs and dampers per travel of their wheels, dimensionless, as far as the campaign file states it.
    sensors, loads
        As the campaign file describes them.
    model
        What the campaign file says about the model.
    options
        Options given to `identify`, by name, in words.
    files
        The campaign file and the recordings, as they were read; empty for a campaign made in memory.
    software
        Versions by name.
    test
        When, where and by whom the vehicle was tested, as far as the campaign file states it.
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
    motion_ratio: dict[str, KnownValue] = field(default_factory=dict)

    @property
    def units(self) -> dict[str, str]:
        """SI unit of the readings of each channel, as it is printed."""
        return {sensor.channel: si_symbol(sensor.quantity) for sensor in self.sensors}

    def describe_noise(self, noise: Mapping[str, float]) -> tuple[str, str]:
        """Return what the noise of channels is counted in, and each channel with its noise.

        Parameters
        ----------
        noise
            SI root-mean-square, by channel.
        """
        units = dict.fromkeys(self.units.values())
        shared = f"{next(iter(units))} " if len(units) == 1 else ""
        behind = {channel: "" if shared else f" {unit}" for channel, unit in self.units.items()}
        return f"noise, {shared}rms", ", ".join(f"{name} {level:.3g}{behind[name]}" for name, level in noise.items())


def setup_of(
    campaign: Campaign, fit: FitStatistics, known: Mapping[str, KnownValue], options: Mapping[str, object]
) -> Setup:
    """Return the input of an identification, with what was known beside its estimates.

    Parameters
    ----------
    campaign
        As it was fitted.
    fit
        The fit.
    known
        Everything that was known beforehand about the parameters of the model.
    options
        Options of `identify` by name; None for those left open.

    Returns
    -------
    Setup
    """
    heights = {key: value for key, value in campaign.heights.by_key.items() if value is not None}
    return Setup(
        known={name: _compared(fit, known, name) for name in known if name in fit.names or name in DERIVED},
        heights=heights,
        sensors=campaign.sensors,
        loads=campaign.loads,
        model=campaign.model,
        options={name: _in_words(value) for name, value in options.items()},
        files=campaign.files,
        software=dict(software_versions()),
        test=campaign.test,
        motion_ratio=dict(campaign.motion_ratio),
    )


@cache  # they are read from files, and are those of a process
def software_versions() -> Mapping[str, str]:
    """Return the versions that a result depends on, by name."""
    return {
        "sprung": version("sprung"),
        "Python": platform.python_version(),
        **{name: version(name) for name in _LIBRARIES},
    }


def _compared(fit: FitStatistics, known: Mapping[str, KnownValue], name: str) -> PriorComparison:
    found = estimate_of(fit, known, name)
    missed = fit.contradictions.get(name)
    missed = missed if missed is not None and np.isfinite(missed) else None
    return PriorComparison(known[name].value, known[name].std, found.unit, found, missed)


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
