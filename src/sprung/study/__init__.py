"""Many identifications: results compared, the paper reproduced, the example of `sprung demo`."""

from sprung.study.comparison import Compared, Comparison, Difference, Quantity, Told, compare
from sprung.study.demo import DEMO_VEHICLE, demo_campaign
from sprung.study.misprints import Misprint
from sprung.study.paper import ModalValues, ModeRow, NoisePoint, PaperReproduction, ParameterRow, reproduce
from sprung.study.scatter import Scatter
from sprung.study.significance import Joint
from sprung.study.truth import TrueValue, true_values

__all__ = [
    "DEMO_VEHICLE",
    "Compared",
    "Comparison",
    "Difference",
    "Joint",
    "Misprint",
    "ModalValues",
    "ModeRow",
    "NoisePoint",
    "PaperReproduction",
    "ParameterRow",
    "Quantity",
    "Scatter",
    "Told",
    "TrueValue",
    "compare",
    "demo_campaign",
    "reproduce",
    "true_values",
]
