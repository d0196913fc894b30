"""The sketch of the vehicle: plan view and side view of a campaign or a result."""

from sprung.report.sketch.shapes import Disc, Drawing, Shape, Stroke, TextShape
from sprung.report.sketch.sheet import blank_sketch, sketch_sheet
from sprung.report.sketch.sketch import VehicleSketch, vehicle_sketch
from sprung.report.sketch.svg import sketch_svg

__all__ = [
    "Disc",
    "Drawing",
    "Shape",
    "Stroke",
    "TextShape",
    "VehicleSketch",
    "blank_sketch",
    "sketch_sheet",
    "sketch_svg",
    "vehicle_sketch",
]
