"""Maximum likelihood estimation of a vehicle's parameters from free decays: problem, fit, tests, covariance."""

from sprung.estimation.characteristics import characteristics_of, estimate_quantity, rates_at_motion_ratios
from sprung.estimation.closed_form import ClosedFormObjective
from sprung.estimation.closed_form_likelihood import ClosedFormAt
from sprung.estimation.contact import clear_of_splines, fit_from_contact, fit_from_start
from sprung.estimation.curves import CurvePoint, ForceCurve, force_curves
from sprung.estimation.elimination import eliminate
from sprung.estimation.estimates import (
    Correlation,
    Scale,
    Unidentifiable,
    correlation_of,
    estimate_of,
    scale_of,
    to_estimates,
    unidentifiable_combinations,
)
from sprung.estimation.fit_result import FitResult, Inflater
from sprung.estimation.identifiability import NO_INFORMATION, RANK, identifiable_subspace
from sprung.estimation.linear_fit import NEAR, STARTS, escape_local_optimum, fit_linear, weigh_statements
from sprung.estimation.linear_scores import score_linear_term, score_linear_terms
from sprung.estimation.low_pass import HIGHEST_CORNER, LowPass, SampledLowPass, unexplained_squares
from sprung.estimation.modes import UNNAMED, ModeEstimate, mode_estimates
from sprung.estimation.monomials import parameters_from_matrices, shape_of
from sprung.estimation.nonlinear_fit import CONVERGED_IN_STEPS, beginning_of, fit_nonlinear, score_stepped_terms
from sprung.estimation.nonlinear_scores import score_nonlinear_terms
from sprung.estimation.overdispersion import autocorrelation_inflation
from sprung.estimation.prediction import Prediction, predictions
from sprung.estimation.priors import Coordinates, PriorsAndConstraints, UsualValue
from sprung.estimation.problem import CONVERGED, MOST_STEPS
from sprung.estimation.profile import profiled
from sprung.estimation.score_test import ScoreTest, lift_priors, per_total_mass, score_added, wald_test
from sprung.estimation.starts import (
    USUAL_ENGINE,
    USUAL_ENGINE_FREQUENCY,
    USUAL_MOUNT,
    USUAL_RELAXATION,
    VehicleSize,
    engine_mountings,
    usual_engine,
    usual_rubber,
    usual_vehicle,
)
from sprung.estimation.statements import readout_of, statements_of
from sprung.estimation.statistics import FitStatistics, consider_held, fit_jointly, uncertainty_of
from sprung.estimation.subspace import canonical_basis

__all__ = [
    "CONVERGED",
    "CONVERGED_IN_STEPS",
    "HIGHEST_CORNER",
    "MOST_STEPS",
    "NEAR",
    "NO_INFORMATION",
    "RANK",
    "STARTS",
    "UNNAMED",
    "USUAL_ENGINE",
    "USUAL_ENGINE_FREQUENCY",
    "USUAL_MOUNT",
    "USUAL_RELAXATION",
    "ClosedFormAt",
    "ClosedFormObjective",
    "Coordinates",
    "Correlation",
    "CurvePoint",
    "FitResult",
    "FitStatistics",
    "ForceCurve",
    "Inflater",
    "LowPass",
    "ModeEstimate",
    "Prediction",
    "PriorsAndConstraints",
    "SampledLowPass",
    "Scale",
    "ScoreTest",
    "Unidentifiable",
    "UsualValue",
    "VehicleSize",
    "autocorrelation_inflation",
    "beginning_of",
    "canonical_basis",
    "characteristics_of",
    "clear_of_splines",
    "consider_held",
    "correlation_of",
    "eliminate",
    "engine_mountings",
    "escape_local_optimum",
    "estimate_of",
    "estimate_quantity",
    "fit_from_contact",
    "fit_from_start",
    "fit_jointly",
    "fit_linear",
    "fit_nonlinear",
    "force_curves",
    "identifiable_subspace",
    "lift_priors",
    "mode_estimates",
    "parameters_from_matrices",
    "per_total_mass",
    "predictions",
    "profiled",
    "rates_at_motion_ratios",
    "readout_of",
    "scale_of",
    "score_added",
    "score_linear_term",
    "score_linear_terms",
    "score_nonlinear_terms",
    "score_stepped_terms",
    "shape_of",
    "statements_of",
    "to_estimates",
    "uncertainty_of",
    "unexplained_squares",
    "unidentifiable_combinations",
    "usual_engine",
    "usual_rubber",
    "usual_vehicle",
    "wald_test",
    "weigh_statements",
]
