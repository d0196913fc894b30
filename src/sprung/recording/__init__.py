"""Recordings and campaigns: the records, their files, and one reader per file format behind one registry."""

from sprung.recording.campaign import Campaign, Drop, ModelChoice
from sprung.recording.reading import VehicleFile, read, read_vehicle
from sprung.recording.recording import Recording
from sprung.recording.whole import write_whole
from sprung.recording.writing import write

__all__ = [
    "Campaign",
    "Drop",
    "ModelChoice",
    "Recording",
    "VehicleFile",
    "read",
    "read_vehicle",
    "write",
    "write_whole",
]
