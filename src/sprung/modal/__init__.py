"""Modes from decays: poles, shapes and names, without a vehicle model."""

from sprung.modal.era import eigensystem_realisation
from sprung.modal.methods import METHODS, Method, identify_modes
from sprung.modal.modes import Mode, modes_from, similarity
from sprung.modal.naming import MODE_NAMES, in_coordinates, modes_of, name_by_sensors, name_modes
from sprung.modal.sums import BLOCK, blocks, correlate, gram, waves
from sprung.modal.svm import StateVariables, state_matrix, state_variable_method

__all__ = [
    "BLOCK",
    "METHODS",
    "MODE_NAMES",
    "Method",
    "Mode",
    "StateVariables",
    "blocks",
    "correlate",
    "eigensystem_realisation",
    "gram",
    "identify_modes",
    "in_coordinates",
    "modes_from",
    "modes_of",
    "name_by_sensors",
    "name_modes",
    "similarity",
    "state_matrix",
    "state_variable_method",
    "waves",
]
