"""Everything people look at; reads every result, and nothing below reads it."""

from sprung.report.check import check_view
from sprung.report.comparison import comparison_view
from sprung.report.draft import draft_view
from sprung.report.drawing import draw_check, write_check
from sprung.report.layout import text_of
from sprung.report.modal import modes_view
from sprung.report.paper import paper_view
from sprung.report.plan import plan_view
from sprung.report.terminal import result_view
from sprung.report.validation import draw_validation, validation_view, write_validation

__all__ = [
    "check_view",
    "comparison_view",
    "draft_view",
    "draw_check",
    "draw_validation",
    "modes_view",
    "paper_view",
    "plan_view",
    "result_view",
    "text_of",
    "validation_view",
    "write_check",
    "write_validation",
]
