"""The identified vehicle for other programs: state space, CommonRoad, Modelica, MuJoCo, FMU, draws, tables."""

from sprung.export.commonroad_parameters import commonroad
from sprung.export.equivalent_linear import EquivalentElement, Linearisation
from sprung.export.file import ExportedFile
from sprung.export.formats import FORMATS, ExportOptions, export
from sprung.export.functional_mockup import fmu
from sprung.export.linear_system import StateSpace, state_space
from sprung.export.markup import latex, markdown
from sprung.export.modelica_text import modelica
from sprung.export.mujoco_model import mjcf
from sprung.export.outputs import Signal
from sprung.export.parameter_draws import USUAL_NUMBER, Draws, draws

__all__ = [
    "FORMATS",
    "USUAL_NUMBER",
    "Draws",
    "EquivalentElement",
    "ExportOptions",
    "ExportedFile",
    "Linearisation",
    "Signal",
    "StateSpace",
    "commonroad",
    "draws",
    "export",
    "fmu",
    "latex",
    "markdown",
    "mjcf",
    "modelica",
    "state_space",
]
