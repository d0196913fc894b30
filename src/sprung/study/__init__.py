"""Studies with identifications: comparison, cross-validation, test planning, Monte Carlo, the example of `sprung demo`."""

from sprung.study.comparison import ComparedResult, Comparison, Difference, QuantityComparison, ResultValue
from sprung.study.cross_validation import Validation, validate
from sprung.study.demo import DEMO_VEHICLE, demo_campaign
from sprung.study.differences import compare
from sprung.study.monte_carlo import MonteCarlo, monte_carlo
from sprung.study.monte_carlo_summary import ParameterAccuracy, Share
from sprung.study.scatter import ScatterEstimate
from sprung.study.significance import JointTest
from sprung.study.test_planning import plan
from sprung.study.truth import TrueValue, true_values

__all__ = [
    "DEMO_VEHICLE",
    "ComparedResult",
    "Comparison",
    "Difference",
    "JointTest",
    "MonteCarlo",
    "ParameterAccuracy",
    "QuantityComparison",
    "ResultValue",
    "ScatterEstimate",
    "Share",
    "TrueValue",
    "Validation",
    "compare",
    "demo_campaign",
    "monte_carlo",
    "plan",
    "true_values",
    "validate",
]
