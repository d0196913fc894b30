"""Many identifications: results compared, the paper reproduced, the example of `sprung demo`."""

from sprung.study.comparison import Compared, Comparison, Difference, Quantity, Told, compare
from sprung.study.demo import demo_campaign
from sprung.study.misprints import Misprint
from sprung.study.paper import ModalValues, ModeRow, NoisePoint, PaperReproduction, ParameterRow, reproduce
from sprung.study.scatter import Scatter
from sprung.study.significance import Joint

__all__ = [
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
    "compare",
    "demo_campaign",
    "reproduce",
]
