"""Modes from decays: poles, shapes and names, without a vehicle model."""

from sprung.modal.amplitude import AmplitudeDependence, amplitude_dependence
from sprung.modal.confirmation import confirm_modes
from sprung.modal.criteria import modal_phase_collinearity
from sprung.modal.era import eigensystem_realisation
from sprung.modal.maximum_likelihood import cramer_rao_bound, maximum_likelihood
from sprung.modal.methods import APPROXIMATE, DEFAULT_METHOD, METHODS, Method, identify_modes
from sprung.modal.mode_set import ModeSet, RejectedPole
from sprung.modal.peaks import find_spectral_peaks
from sprung.modal.stabilisation import StabilisationDiagram, StabilityCriteria, stabilisation_diagram
from sprung.modal.svm import StateVariableFit, state_matrix, state_variable_method

__all__ = [
    "APPROXIMATE",
    "DEFAULT_METHOD",
    "METHODS",
    "AmplitudeDependence",
    "Method",
    "ModeSet",
    "RejectedPole",
    "StabilisationDiagram",
    "StabilityCriteria",
    "StateVariableFit",
    "amplitude_dependence",
    "confirm_modes",
    "cramer_rao_bound",
    "eigensystem_realisation",
    "find_spectral_peaks",
    "identify_modes",
    "maximum_likelihood",
    "modal_phase_collinearity",
    "stabilisation_diagram",
    "state_matrix",
    "state_variable_method",
]
