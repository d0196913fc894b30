"""The result of an identification: records, tables and files."""

from sprung.results.amplitude import amplitude_document, curve_document
from sprung.results.dampers import DamperPoints, damper_points
from sprung.results.motion import FittedMotion, fitted_motion
from sprung.results.records import FitReport, SensorEstimate, TestedVehicle, TraceStep
from sprung.results.result import Result
from sprung.results.saved import load
from sprung.results.series import Series, npz_bytes
from sprung.results.setup import PriorComparison, Setup, setup_of
from sprung.results.tables import (
    TRACE_TITLE,
    characteristics_tables,
    damper_tables,
    derived_table,
    meaning_of,
    modes_table,
    other_quantities,
    parameters_table,
    ratios_table,
    sensors_table,
    trace_table,
)
from sprung.results.withholding import withhold_estimates

__all__ = [
    "TRACE_TITLE",
    "DamperPoints",
    "FitReport",
    "FittedMotion",
    "PriorComparison",
    "Result",
    "SensorEstimate",
    "Series",
    "Setup",
    "TestedVehicle",
    "TraceStep",
    "amplitude_document",
    "characteristics_tables",
    "curve_document",
    "damper_points",
    "damper_tables",
    "derived_table",
    "fitted_motion",
    "load",
    "meaning_of",
    "modes_table",
    "npz_bytes",
    "other_quantities",
    "parameters_table",
    "ratios_table",
    "sensors_table",
    "setup_of",
    "trace_table",
    "withhold_estimates",
]
