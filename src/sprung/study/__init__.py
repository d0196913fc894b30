"""Many identifications: the paper reproduced, the example of `sprung demo`."""

from sprung.study.demo import demo_campaign
from sprung.study.misprints import Misprint
from sprung.study.paper import ModalValues, ModeRow, NoisePoint, PaperReproduction, ParameterRow, reproduce

__all__ = [
    "Misprint",
    "ModalValues",
    "ModeRow",
    "NoisePoint",
    "PaperReproduction",
    "ParameterRow",
    "demo_campaign",
    "reproduce",
]
