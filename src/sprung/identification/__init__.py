"""From decays to parameters: the paper's added mass, structured least squares, and the joint likelihood fit."""

from sprung.identification.added_mass import added_mass
from sprung.identification.beyond import ascend_stepped, lost_without, prospects
from sprung.identification.characteristics import characteristics_of
from sprung.identification.climb import CONVERGED, NO_INFORMATION, RANK, told_directions
from sprung.identification.contact import ascend_from_contact, clear_of_splines
from sprung.identification.estimates import Correlation, Estimates, Scale, Unidentifiable, conclude, estimate_of
from sprung.identification.inflation import corrections, of_colour
from sprung.identification.joint import Fit, Inflater, describe, fit_jointly, inflation_of, residual_records
from sprung.identification.knowledge import Coordinates, Knowledge
from sprung.identification.likelihood import Likelihood, Place
from sprung.identification.modes import UNNAMED, ModeEstimate, mode_estimates
from sprung.identification.monomials import parameters_from_matrices
from sprung.identification.prediction import Prediction, predictions
from sprung.identification.profile import profiled
from sprung.identification.scores import force_scores
from sprung.identification.start import USUAL_ENGINE, USUAL_MOUNTING, Mounting, mountings_of
from sprung.identification.structured import StructuredFit, structured_least_squares
from sprung.identification.subspace import canonical_basis
from sprung.identification.summit import NEAR, STARTS, Summit, ascend, expected_gain, look_around
from sprung.identification.suspects import Suspect, suspects
from sprung.identification.timing import timed_by_decay, timed_by_release, told_alone

__all__ = [
    "CONVERGED",
    "NEAR",
    "NO_INFORMATION",
    "RANK",
    "STARTS",
    "UNNAMED",
    "USUAL_ENGINE",
    "USUAL_MOUNTING",
    "Coordinates",
    "Correlation",
    "Estimates",
    "Fit",
    "Inflater",
    "Knowledge",
    "Likelihood",
    "ModeEstimate",
    "Mounting",
    "Place",
    "Prediction",
    "Scale",
    "StructuredFit",
    "Summit",
    "Suspect",
    "Unidentifiable",
    "added_mass",
    "ascend",
    "ascend_from_contact",
    "ascend_stepped",
    "canonical_basis",
    "characteristics_of",
    "clear_of_splines",
    "conclude",
    "corrections",
    "describe",
    "estimate_of",
    "expected_gain",
    "fit_jointly",
    "force_scores",
    "inflation_of",
    "look_around",
    "lost_without",
    "mode_estimates",
    "mountings_of",
    "of_colour",
    "parameters_from_matrices",
    "predictions",
    "profiled",
    "prospects",
    "residual_records",
    "structured_least_squares",
    "suspects",
    "timed_by_decay",
    "timed_by_release",
    "told_alone",
    "told_directions",
]
