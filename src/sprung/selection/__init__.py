"""Selection of the model: the table of model terms and the stepwise search."""

from sprung.selection.forced_terms import nonlinear, tilted, with_forces
from sprung.selection.linear_terms import carried, linear, wanting
from sprung.selection.search import ModelSearch, SelectionStep
from sprung.selection.structure import ModelStructure, choose_model
from sprung.selection.terms import ENGINE, fit_from

__all__ = [
    "ENGINE",
    "ModelSearch",
    "ModelStructure",
    "SelectionStep",
    "carried",
    "choose_model",
    "fit_from",
    "linear",
    "nonlinear",
    "tilted",
    "wanting",
    "with_forces",
]
