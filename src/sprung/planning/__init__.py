"""Test planning (optimal experiment design): Cramér-Rao bounds of alternative tests, and the cheapest sufficient step."""

from sprung.planning.completed import completed_test, setup_from_fit
from sprung.planning.cramer_rao import CramerRaoBound, two_figures
from sprung.planning.detectability import TermCandidate, TermDetectability, detect_terms
from sprung.planning.plan import NextStep, Plan, PlanRow, next_step, tabulate_alternatives, tabulate_rejected
from sprung.planning.setup import MeasurementSetup, PlannedDrop, PlannedTest

__all__ = [
    "CramerRaoBound",
    "MeasurementSetup",
    "NextStep",
    "Plan",
    "PlanRow",
    "PlannedDrop",
    "PlannedTest",
    "TermCandidate",
    "TermDetectability",
    "completed_test",
    "detect_terms",
    "next_step",
    "setup_from_fit",
    "tabulate_alternatives",
    "tabulate_rejected",
    "two_figures",
]
