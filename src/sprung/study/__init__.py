"""Many identifications: results compared, the paper reproduced, the example of `sprung demo`."""

from sprung.study.comparison import Compared, Comparison, Difference, Quantity, Told, compare
from sprung.study.demo import DEMO_VEHICLE, demo_campaign
from sprung.study.plan import plan
from sprung.study.scatter import Scatter
from sprung.study.significance import Joint
from sprung.study.truth import TrueValue, true_values
from sprung.study.validate import Validation, validate

__all__ = [
    "DEMO_VEHICLE",
    "Compared",
    "Comparison",
    "Difference",
    "Joint",
    "Quantity",
    "Scatter",
    "Told",
    "TrueValue",
    "Validation",
    "compare",
    "demo_campaign",
    "plan",
    "true_values",
    "validate",
]
