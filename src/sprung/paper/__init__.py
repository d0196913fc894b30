"""The paper: its method, its printed tables, its misprints, and their reproduction."""

from sprung.paper.added_mass import added_mass
from sprung.paper.constrained_fit import StructuredFit
from sprung.paper.misprints import Misprint
from sprung.paper.reproduction import reproduce
from sprung.paper.structured import structured_least_squares
from sprung.paper.tables import ModalValues, ModeRow, NoisePoint, PaperReproduction, ParameterRow

__all__ = [
    "Misprint",
    "ModalValues",
    "ModeRow",
    "NoisePoint",
    "PaperReproduction",
    "ParameterRow",
    "StructuredFit",
    "added_mass",
    "reproduce",
    "structured_least_squares",
]
