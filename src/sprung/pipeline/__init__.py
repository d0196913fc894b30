"""The one composition, its result, and the shorter walks: checking recordings, modes without a vehicle model."""

from sprung.pipeline.check import Check, DropReport, check
from sprung.pipeline.identify import identify
from sprung.pipeline.modes import modes
from sprung.pipeline.result import FitReport, Result, Series, load

__all__ = ["Check", "DropReport", "FitReport", "Result", "Series", "check", "identify", "load", "modes"]
