"""From decays to parameters: the paper's added mass, structured least squares, and the joint likelihood fit."""

from sprung.identification.added_mass import added_mass
from sprung.identification.contact import fit_from_contact
from sprung.identification.estimates import Correlation, Estimates, Scale, Unidentifiable, conclude
from sprung.identification.inflation import of_colour
from sprung.identification.joint import Fit, fit_jointly
from sprung.identification.modes import ModeEstimate, mode_estimates
from sprung.identification.monomials import parameters_from_matrices
from sprung.identification.structured import StructuredFit, structured_least_squares

__all__ = [
    "Correlation",
    "Estimates",
    "Fit",
    "ModeEstimate",
    "Scale",
    "StructuredFit",
    "Unidentifiable",
    "added_mass",
    "conclude",
    "fit_from_contact",
    "fit_jointly",
    "mode_estimates",
    "of_colour",
    "parameters_from_matrices",
    "structured_least_squares",
]
