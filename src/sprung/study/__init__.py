"""Many identifications: results compared, the paper reproduced, the example of `sprung demo`."""

from sprung.study.comparison import ComparedResult, Comparison, Difference, QuantityComparison, ResultValue, compare
from sprung.study.demo import DEMO_VEHICLE, demo_campaign
from sprung.study.plan import plan
from sprung.study.scatter import ScatterEstimate
from sprung.study.significance import JointTest
from sprung.study.truth import TrueValue, true_values
from sprung.study.validate import Validation, validate

__all__ = [
    "DEMO_VEHICLE",
    "ComparedResult",
    "Comparison",
    "Difference",
    "JointTest",
    "QuantityComparison",
    "ResultValue",
    "ScatterEstimate",
    "TrueValue",
    "Validation",
    "compare",
    "demo_campaign",
    "plan",
    "true_values",
    "validate",
]
