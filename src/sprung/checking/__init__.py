"""Judge recordings without identifying anything: which part of each drop can be used, and what is wrong or missing."""

from sprung.checking.check import ChannelReport, Check, DropReport, check, check_prepared
from sprung.checking.clock import ClockReport
from sprung.checking.recorded import PlottedRecording

__all__ = [
    "ChannelReport",
    "Check",
    "ClockReport",
    "DropReport",
    "PlottedRecording",
    "check",
    "check_prepared",
]
