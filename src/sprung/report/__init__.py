"""Everything people look at; reads every result, and nothing below reads it."""

from sprung.report.paper import paper_view
from sprung.report.terminal import check_view, modes_view, result_view, show, table, verdict_view

__all__ = ["check_view", "modes_view", "paper_view", "result_view", "show", "table", "verdict_view"]
