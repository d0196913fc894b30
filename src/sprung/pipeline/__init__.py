"""The one composition, its result, and the other walks: checking recordings, modes alone, what to measure next."""

from sprung.pipeline.check import ChannelReport, Check, DropReport, check
from sprung.pipeline.drafting import Draft, draft
from sprung.pipeline.identify import identify
from sprung.pipeline.modes import FoundMode, LoadModes, modes
from sprung.pipeline.plan import plan, plan_campaign, plan_file
from sprung.pipeline.recordings import is_recordings, modes_of_recordings
from sprung.pipeline.result import FitReport, Result, Series
from sprung.pipeline.saved import load
from sprung.pipeline.validate import Validation, validate

__all__ = [
    "ChannelReport",
    "Check",
    "Draft",
    "DropReport",
    "FitReport",
    "FoundMode",
    "LoadModes",
    "Result",
    "Series",
    "Validation",
    "check",
    "draft",
    "identify",
    "is_recordings",
    "load",
    "modes",
    "modes_of_recordings",
    "plan",
    "plan_campaign",
    "plan_file",
    "validate",
]
