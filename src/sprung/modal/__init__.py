"""Modes from decays: poles, shapes and names, without a vehicle model."""

from sprung.modal.amplitude import ModeTrace, follow_modes
from sprung.modal.confirmation import confirmed
from sprung.modal.criteria import complexity
from sprung.modal.era import eigensystem_realisation
from sprung.modal.identified import Modes, Rejected
from sprung.modal.maximum_likelihood import cramer_rao_bound, maximum_likelihood
from sprung.modal.methods import APPROXIMATE, DEFAULT, METHODS, Method, identify_modes
from sprung.modal.modes import Mode, Spread, leading_entry, modes_from, similarity
from sprung.modal.naming import MODE_NAMES, in_coordinates, modes_of, name_by_sensors, name_modes, paper_name
from sprung.modal.peaks import fft_frequencies
from sprung.modal.stabilisation import Criteria, Diagram, stabilisation_diagram
from sprung.modal.sums import BLOCK, blocks, correlate, gram, waves
from sprung.modal.svm import StateVariables, state_matrix, state_variable_method

__all__ = [
    "APPROXIMATE",
    "BLOCK",
    "DEFAULT",
    "METHODS",
    "MODE_NAMES",
    "Criteria",
    "Diagram",
    "Method",
    "Mode",
    "ModeTrace",
    "Modes",
    "Rejected",
    "Spread",
    "StateVariables",
    "blocks",
    "complexity",
    "confirmed",
    "correlate",
    "cramer_rao_bound",
    "eigensystem_realisation",
    "fft_frequencies",
    "follow_modes",
    "gram",
    "identify_modes",
    "in_coordinates",
    "leading_entry",
    "maximum_likelihood",
    "modes_from",
    "modes_of",
    "name_by_sensors",
    "name_modes",
    "paper_name",
    "similarity",
    "stabilisation_diagram",
    "state_matrix",
    "state_variable_method",
    "waves",
]
