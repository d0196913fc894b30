"""Named values with covariance, intervals, and rounding by uncertainty."""

from sprung.estimate.covariance import Covariance
from sprung.estimate.estimate import NORMAL_95, Estimate, IntervalFrom, Ratio, Status
from sprung.estimate.known import Known
from sprung.estimate.named import Named
from sprung.estimate.rounding import round_by_uncertainty

__all__ = [
    "NORMAL_95",
    "Covariance",
    "Estimate",
    "IntervalFrom",
    "Known",
    "Named",
    "Ratio",
    "Status",
    "round_by_uncertainty",
]
