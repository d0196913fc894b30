"""The paper's method and its tables, reproduced: State Variable Method, added mass, least squares."""

from sprung.paper.added_mass import added_mass
from sprung.paper.misprints import Misprint
from sprung.paper.reproduction import ModalValues, ModeRow, NoisePoint, PaperReproduction, ParameterRow, reproduce
from sprung.paper.structured import StructuredFit, structured_least_squares

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
