"""Everything people look at; reads every result, and nothing below reads it."""

from sprung.report.layout import text_of
from sprung.report.paper import paper_view
from sprung.report.plan import plan_view
from sprung.report.terminal import check_view, modes_view, result_view

__all__ = ["check_view", "modes_view", "paper_view", "plan_view", "result_view", "text_of"]
