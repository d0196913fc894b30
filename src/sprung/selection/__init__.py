"""Selection of the model: the table of model terms and the stepwise search."""

from sprung.selection.forced_terms import fit_forced_terms, select_gravity_leakage, select_nonlinear_terms
from sprung.selection.linear_terms import (
    fit_requested_terms,
    fit_term,
    score_linear_terms,
    select_linear_terms,
    select_roll_axis_height,
)
from sprung.selection.search import ModelSearch, SelectionStep
from sprung.selection.structure import ModelStructure, choose_structure
from sprung.selection.terms import ENGINE, fit_structure

__all__ = [
    "ENGINE",
    "ModelSearch",
    "ModelStructure",
    "SelectionStep",
    "choose_structure",
    "fit_forced_terms",
    "fit_requested_terms",
    "fit_structure",
    "fit_term",
    "score_linear_terms",
    "select_gravity_leakage",
    "select_linear_terms",
    "select_nonlinear_terms",
    "select_roll_axis_height",
]
