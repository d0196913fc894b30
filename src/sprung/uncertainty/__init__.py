"""Quantities with their uncertainty: estimates, values known beforehand, covariance, rounding."""

from sprung.uncertainty.covariance import Covariance
from sprung.uncertainty.estimate import NORMAL_95, Estimate, IntervalFrom, Ratio, Status
from sprung.uncertainty.exactness import without_rounding_errors
from sprung.uncertainty.known_value import KnownValue
from sprung.uncertainty.named_values import NamedValues
from sprung.uncertainty.rounding import round_by_uncertainty

__all__ = [
    "NORMAL_95",
    "Covariance",
    "Estimate",
    "IntervalFrom",
    "KnownValue",
    "NamedValues",
    "Ratio",
    "Status",
    "round_by_uncertainty",
    "without_rounding_errors",
]
