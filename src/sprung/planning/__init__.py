"""What a test would tell before it is done: Cramér-Rao bounds of alternatives, and which of them to take next."""

from sprung.planning.completed import completed_test, setup_from_fit
from sprung.planning.cramer_rao import Bound, two_figures
from sprung.planning.plan import NextStep, Plan, PlanRow, next_step, tabulate_alternatives, tabulate_rejected
from sprung.planning.setup import MeasurementSetup, PlannedDrop, PlannedTest

__all__ = [
    "Bound",
    "MeasurementSetup",
    "NextStep",
    "Plan",
    "PlanRow",
    "PlannedDrop",
    "PlannedTest",
    "completed_test",
    "next_step",
    "setup_from_fit",
    "tabulate_alternatives",
    "tabulate_rejected",
    "two_figures",
]
