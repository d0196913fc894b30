"""The sketch of the vehicle: plan view and side view, drawn from a campaign or a result."""

from sprung.report.sketch.shapes import Disc, Drawing, Shape, Stroke, Words
from sprung.report.sketch.sheet import blank_sketch, sketch_sheet
from sprung.report.sketch.sketch import VehicleSketch, vehicle_sketch
from sprung.report.sketch.svg import drawing_svg

__all__ = [
    "Disc",
    "Drawing",
    "Shape",
    "Stroke",
    "VehicleSketch",
    "Words",
    "blank_sketch",
    "drawing_svg",
    "sketch_sheet",
    "vehicle_sketch",
]
