"""Identify the physical parameters of a two-axle road vehicle from drop tests.

Examples
--------
>>> import sprung
>>> campaign = sprung.read("campaign.toml")          # doctest: +SKIP
>>> result = sprung.identify(campaign)               # doctest: +SKIP
>>> result.parameters["k_sf"].value                  # doctest: +SKIP
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sprung import analysis as analysis
    from sprung import campaign as campaign
    from sprung import export as export
    from sprung import files as files
    from sprung import paper as paper
    from sprung import plot as plot
    from sprung import report as report
    from sprung import ride as ride
    from sprung import study as study
    from sprung.analysis import identify
    from sprung.campaign import Campaign, Drop, DropTest, read, schema_text, to_sep005, write
    from sprung.checking import check
    from sprung.drafting import draft, draft_campaigns
    from sprung.fleets import fleet
    from sprung.modal_survey import is_recordings, modes
    from sprung.results import Result, load
    from sprung.simulation import simulate
    from sprung.study import Comparison, compare, plan, validate
    from sprung.vehicle import Load, Sensor, Vehicle

    __version__: str

__all__ = [
    "Campaign",
    "Comparison",
    "Drop",
    "DropTest",
    "Load",
    "Result",
    "Sensor",
    "Vehicle",
    "check",
    "compare",
    "draft",
    "draft_campaigns",
    "fleet",
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

_HOME = {
    "Campaign": "campaign",
    "Comparison": "study",
    "Drop": "campaign",
    "DropTest": "campaign",
    "Load": "vehicle",
    "Result": "results",
    "Sensor": "vehicle",
    "Vehicle": "vehicle",
    "check": "checking",
    "compare": "study",
    "draft": "drafting",
    "draft_campaigns": "drafting",
    "fleet": "fleets",
    "identify": "analysis",
    "is_recordings": "modal_survey",
    "load": "results",
    "modes": "modal_survey",
    "plan": "study",
    "read": "campaign",
    "schema_text": "campaign",
    "simulate": "simulation",
    "to_sep005": "campaign",
    "validate": "study",
    "write": "campaign",
}
_ROOMS = ("analysis", "campaign", "export", "files", "paper", "plot", "report", "ride", "study")


def __getattr__(name: str) -> Any:
    # Public names load their rooms when they are first used, so that `sprung --help` need not wait for the numerics.
    if name in _HOME:
        value = getattr(importlib.import_module(f"sprung.{_HOME[name]}"), name)
    elif name in _ROOMS:
        value = importlib.import_module(f"sprung.{name}")
    elif name == "__version__":
        value = importlib.import_module("importlib.metadata").version("sprung")
    else:
        raise AttributeError(f"module 'sprung' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*__all__, *_ROOMS, "__version__"])
