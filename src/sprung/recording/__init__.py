"""Recordings and campaigns: the records, their files, and one reader per file format behind one registry."""

from sprung.recording.beforehand import Given, known_quantities
from sprung.recording.campaign import (
    KINDS,
    Campaign,
    Drop,
    ModelChoice,
    TestRecord,
    drop_names,
    kind_of,
    recording_names,
)
from sprung.recording.completeness import Missing
from sprung.recording.formats import Table, read_table, to_sep005
from sprung.recording.formats.resampled import SLOWEST
from sprung.recording.gaps import gap, gaps_in
from sprung.recording.in_memory import check_statements, require_plausible
from sprung.recording.loggers import files_named_after
from sprung.recording.mending import MOST_MISSING, filled
from sprung.recording.merging import merged
from sprung.recording.ownership import overwriting_problems
from sprung.recording.plausibility import implausible
from sprung.recording.published import SCHEMA_FILE, SCHEMA_LINE, schema_text
from sprung.recording.reading import FILE, VehicleFile, read, read_document, read_vehicle
from sprung.recording.recording import ROUGHLY, LoggerClock, Recording
from sprung.recording.sources import SourceFile
from sprung.recording.whole import write_whole
from sprung.recording.writing import campaign_files, write

__all__ = [
    "FILE",
    "KINDS",
    "MOST_MISSING",
    "ROUGHLY",
    "SCHEMA_FILE",
    "SCHEMA_LINE",
    "SLOWEST",
    "Campaign",
    "Drop",
    "Given",
    "LoggerClock",
    "Missing",
    "ModelChoice",
    "Recording",
    "SourceFile",
    "Table",
    "TestRecord",
    "VehicleFile",
    "campaign_files",
    "check_statements",
    "drop_names",
    "files_named_after",
    "filled",
    "gap",
    "gaps_in",
    "implausible",
    "kind_of",
    "known_quantities",
    "merged",
    "overwriting_problems",
    "read",
    "read_document",
    "read_table",
    "read_vehicle",
    "recording_names",
    "require_plausible",
    "schema_text",
    "to_sep005",
    "write",
    "write_whole",
]
