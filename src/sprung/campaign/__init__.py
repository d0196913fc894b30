"""Recordings and campaigns: the records, their files, and one reader per file format behind one registry."""

from sprung.campaign.beforehand import Given, known_quantities
from sprung.campaign.campaign import Campaign, ModelChoice, TestRecord
from sprung.campaign.completeness import Missing
from sprung.campaign.drop import KINDS, Drop, DropTest, drop_names, kind_of, recording_names
from sprung.campaign.gaps import gap, gaps_in
from sprung.campaign.in_memory import check_statements, require_plausible
from sprung.campaign.loggers import files_named_after
from sprung.campaign.merging import merged
from sprung.campaign.plausibility import implausible
from sprung.campaign.published import SCHEMA_FILE, SCHEMA_LINE, schema_text
from sprung.campaign.reading import FILE, VehicleFile, read, read_document, read_vehicle
from sprung.campaign.recording import CLOCK_STD, LoggerClock, Recording
from sprung.campaign.sep005 import to_sep005
from sprung.campaign.source import CampaignSource, campaign_from
from sprung.campaign.sources import SourceFile
from sprung.campaign.writing import campaign_files, write

__all__ = [
    "CLOCK_STD",
    "FILE",
    "KINDS",
    "SCHEMA_FILE",
    "SCHEMA_LINE",
    "Campaign",
    "CampaignSource",
    "Drop",
    "DropTest",
    "Given",
    "LoggerClock",
    "Missing",
    "ModelChoice",
    "Recording",
    "SourceFile",
    "TestRecord",
    "VehicleFile",
    "campaign_files",
    "campaign_from",
    "check_statements",
    "drop_names",
    "files_named_after",
    "gap",
    "gaps_in",
    "implausible",
    "kind_of",
    "known_quantities",
    "merged",
    "read",
    "read_document",
    "read_vehicle",
    "recording_names",
    "require_plausible",
    "schema_text",
    "to_sep005",
    "write",
]
