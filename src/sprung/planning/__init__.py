"""What a test would tell before it is done: Cramér-Rao bounds of alternatives, and which of them to take next."""

from sprung.planning.bound import Bound, two_figures
from sprung.planning.done import campaign_of_fit, subject_of_fit
from sprung.planning.plan import NextStep, Plan, PlanRow, draw_up, draw_up_rejected, next_step
from sprung.planning.subject import PlannedDrop, PlannedTest, Subject

__all__ = [
    "Bound",
    "NextStep",
    "Plan",
    "PlanRow",
    "PlannedDrop",
    "PlannedTest",
    "Subject",
    "campaign_of_fit",
    "draw_up",
    "draw_up_rejected",
    "next_step",
    "subject_of_fit",
    "two_figures",
]
