"""Named values with covariance, intervals, and rounding by uncertainty."""

from sprung.estimate.estimate import NORMAL_95, Estimate, IntervalFrom, Ratio, Status
from sprung.estimate.known import Known
from sprung.estimate.rounding import round_by_uncertainty

__all__ = ["NORMAL_95", "Estimate", "IntervalFrom", "Known", "Ratio", "Status", "round_by_uncertainty"]
