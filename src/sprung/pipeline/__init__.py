"""The one composition, its result, and the other walks: checking recordings, modes alone, what to measure next."""

from sprung.pipeline.check import Check, DropReport, check
from sprung.pipeline.identify import identify
from sprung.pipeline.modes import modes
from sprung.pipeline.plan import plan, plan_campaign, plan_file
from sprung.pipeline.result import FitReport, Result, Series, load

__all__ = [
    "Check",
    "DropReport",
    "FitReport",
    "Result",
    "Series",
    "check",
    "identify",
    "load",
    "modes",
    "plan",
    "plan_campaign",
    "plan_file",
]
