"""Campaigns: what is stated of a vehicle and its drop tests, their recordings, and the files of both."""

from sprung.campaign.campaign import Campaign, ModelChoice, TestRecord
from sprung.campaign.campaign_source import CampaignSource, resolve_campaign
from sprung.campaign.completeness import MissingEntry
from sprung.campaign.document_check import CheckedDocument, check_document
from sprung.campaign.drop import (
    DEFAULT_HEIGHT,
    DROP_KINDS,
    Drop,
    DropTest,
    Excitation,
    drop_kind,
    excitation_of,
    unique_drop_names,
    unique_recording_names,
)
from sprung.campaign.excitation import Bump, Push
from sprung.campaign.excitation_checks import check_excitation
from sprung.campaign.gap_filling import MAX_MISSING, fill_short_gaps
from sprung.campaign.known_values import KnownValueLike, parse_known_values
from sprung.campaign.logger_files import find_logger_files
from sprung.campaign.logger_merging import merge_loggers
from sprung.campaign.placeholders import find_placeholders, placeholder
from sprung.campaign.plausibility import explain_implausible
from sprung.campaign.reading import CAMPAIGN_FILE, is_vehicle_file, read, read_document, read_vehicle
from sprung.campaign.recording import CLOCK_STD, LoggerClock, Recording
from sprung.campaign.schema_file import SCHEMA_FILE, SCHEMA_LINE, schema_text
from sprung.campaign.sep005 import to_sep005
from sprung.campaign.source_file import SourceFile
from sprung.campaign.statements import check_statements, require_plausible
from sprung.campaign.toml_document import parse_toml
from sprung.campaign.writing import campaign_files, write

__all__ = [
    "CAMPAIGN_FILE",
    "CLOCK_STD",
    "DEFAULT_HEIGHT",
    "DROP_KINDS",
    "MAX_MISSING",
    "SCHEMA_FILE",
    "SCHEMA_LINE",
    "Bump",
    "Campaign",
    "CampaignSource",
    "CheckedDocument",
    "Drop",
    "DropTest",
    "Excitation",
    "KnownValueLike",
    "LoggerClock",
    "MissingEntry",
    "ModelChoice",
    "Push",
    "Recording",
    "SourceFile",
    "TestRecord",
    "campaign_files",
    "check_document",
    "check_excitation",
    "check_statements",
    "drop_kind",
    "excitation_of",
    "explain_implausible",
    "fill_short_gaps",
    "find_logger_files",
    "find_placeholders",
    "is_vehicle_file",
    "merge_loggers",
    "parse_known_values",
    "parse_toml",
    "placeholder",
    "read",
    "read_document",
    "read_vehicle",
    "require_plausible",
    "resolve_campaign",
    "schema_text",
    "to_sep005",
    "unique_drop_names",
    "unique_recording_names",
    "write",
]
