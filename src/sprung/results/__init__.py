"""The result of an identification: its records, tables and files."""

from sprung.results.amplitude import amplitude_document, plain_trace
from sprung.results.result import FitReport, Result, TestedVehicle
from sprung.results.saved import load
from sprung.results.series import Series, packed
from sprung.results.setup import PriorComparison, Setup, setup_of
from sprung.results.tables import (
    characteristics_tables,
    derived_table,
    meaning_of,
    modes_table,
    other_quantities,
    parameters_table,
    ratios_table,
)
from sprung.results.withholding import withhold_estimates

__all__ = [
    "FitReport",
    "PriorComparison",
    "Result",
    "Series",
    "Setup",
    "TestedVehicle",
    "amplitude_document",
    "characteristics_tables",
    "derived_table",
    "load",
    "meaning_of",
    "modes_table",
    "other_quantities",
    "packed",
    "parameters_table",
    "plain_trace",
    "ratios_table",
    "setup_of",
    "withhold_estimates",
]
