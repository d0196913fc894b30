"""Find the physical parameters of a two-axle road vehicle from drop tests.

Examples
--------
>>> import sprung
>>> campaign = sprung.read("campaign.toml")          # doctest: +SKIP
>>> result = sprung.identify(campaign)               # doctest: +SKIP
>>> result.parameters["k_sf"].value                  # doctest: +SKIP
"""

from __future__ import annotations

import importlib
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sprung import pipeline as pipeline
    from sprung import plot as plot
    from sprung import recording as recording
    from sprung import report as report
    from sprung import study as study
    from sprung.pipeline import (
        Result,
        check,
        draft,
        identify,
        is_recordings,
        load,
        modes,
        plan,
        validate,
    )
    from sprung.recording import Campaign, Drop, read, schema_text, to_sep005, write
    from sprung.simulation import simulate
    from sprung.study import Comparison, compare
    from sprung.vehicle import Load, Sensor, Vehicle

__all__ = [
    "Campaign",
    "Comparison",
    "Drop",
    "Load",
    "Result",
    "Sensor",
    "Vehicle",
    "check",
    "compare",
    "draft",
    "identify",
    "is_recordings",
    "load",
    "modes",
    "plan",
    "read",
    "schema_text",
    "simulate",
    "to_sep005",
    "validate",
    "write",
]

__version__ = version("sprung")

_HOME = {
    "Campaign": "recording",
    "Comparison": "study",
    "Drop": "recording",
    "Load": "vehicle",
    "Result": "pipeline",
    "Sensor": "vehicle",
    "Vehicle": "vehicle",
    "check": "pipeline",
    "compare": "study",
    "draft": "pipeline",
    "identify": "pipeline",
    "is_recordings": "pipeline",
    "load": "pipeline",
    "modes": "pipeline",
    "plan": "pipeline",
    "read": "recording",
    "schema_text": "recording",
    "simulate": "simulation",
    "to_sep005": "recording",
    "validate": "pipeline",
    "write": "recording",
}
_ROOMS = ("pipeline", "plot", "recording", "report", "study")


def __getattr__(name: str) -> Any:
    # Public names load their rooms when they are first used, so that `sprung --help` need not wait for the numerics.
    if name in _HOME:
        value = getattr(importlib.import_module(f"sprung.{_HOME[name]}"), name)
    elif name in _ROOMS:
        value = importlib.import_module(f"sprung.{name}")
    else:
        raise AttributeError(f"module 'sprung' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*__all__, *_ROOMS, "__version__"])
