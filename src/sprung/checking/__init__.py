"""Check of recordings without an identification: which part of each drop can be used, faults, and what is missing."""

from sprung.checking.check import check, check_prepared
from sprung.checking.recorded import PlottedRecording
from sprung.checking.reports import ChannelReport, Check, ClockReport, DropReport

__all__ = [
    "ChannelReport",
    "Check",
    "ClockReport",
    "DropReport",
    "PlottedRecording",
    "check",
    "check_prepared",
]
