"""The one composition, its result, and the other walks: checking recordings, modes alone, what to measure next."""

from sprung.pipeline.check import ChannelReport, Check, DropReport, check
from sprung.pipeline.displays import (
    characteristics_tables,
    derived_table,
    meaning_of,
    modes_table,
    other_quantities,
    parameters_table,
    ratios_table,
)
from sprung.pipeline.drafting import Draft, draft
from sprung.pipeline.found import FoundMode, LoadModes
from sprung.pipeline.identify import Identification, identify, identify_campaign, with_amplitudes
from sprung.pipeline.modes import ModesByLoad, modes
from sprung.pipeline.plan import plan
from sprung.pipeline.recordings import is_recordings
from sprung.pipeline.result import FitReport, Result
from sprung.pipeline.saved import load
from sprung.pipeline.series import Recorded, Series
from sprung.pipeline.setup import Before, Setup
from sprung.pipeline.validate import Validation, validate

__all__ = [
    "Before",
    "ChannelReport",
    "Check",
    "Draft",
    "DropReport",
    "FitReport",
    "FoundMode",
    "Identification",
    "LoadModes",
    "ModesByLoad",
    "Recorded",
    "Result",
    "Series",
    "Setup",
    "Validation",
    "characteristics_tables",
    "check",
    "derived_table",
    "draft",
    "identify",
    "identify_campaign",
    "is_recordings",
    "load",
    "meaning_of",
    "modes",
    "modes_table",
    "other_quantities",
    "parameters_table",
    "plan",
    "ratios_table",
    "validate",
    "with_amplitudes",
]
