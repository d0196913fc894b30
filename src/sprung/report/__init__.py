"""Everything people look at; reads every result, and nothing below reads it."""

from sprung.report.drawing.legend import LETTER, stack_labels
from sprung.report.drawing.palette import LIGHT
from sprung.report.drawing.picture import Band, Curve, Mark, Panel, Picture, Points, Rule
from sprung.report.drawing.svg import picture_frame, picture_svg
from sprung.report.drawings import draw_check, draw_validation
from sprung.report.excitations import limits_text
from sprung.report.folder import (
    REPORT_FILES,
    RESULT_FILES,
    SavedResult,
    add_report,
    save_result,
    write_check,
    write_fleet,
    write_report,
    write_validation,
)
from sprung.report.page.animation import mode_caption
from sprung.report.page.check import CHECK_FILE, check_html
from sprung.report.page.fleet import FLEET_FILE, fleet_html
from sprung.report.page.pdf import pdf_of
from sprung.report.page.report import render_report, report_html
from sprung.report.page.style import page_style
from sprung.report.page.summary import VerdictText, verdict_text
from sprung.report.pictures.amplitudes import amplitude_pictures
from sprung.report.pictures.channels import channels_picture
from sprung.report.pictures.curves import curve_pictures
from sprung.report.pictures.damper_clouds import damper_cloud_pictures
from sprung.report.pictures.decays import LoadDecays, decays_by_load
from sprung.report.pictures.differences import differences_picture
from sprung.report.pictures.fleets import fleet_pictures
from sprung.report.pictures.motions import motion_picture
from sprung.report.pictures.parameters import parameters_picture
from sprung.report.pictures.recordings import landing_picture, recording_picture
from sprung.report.pictures.spectra import spectra_picture
from sprung.report.pictures.stability import stability_picture
from sprung.report.pictures.transmissibility import transmissibility_picture
from sprung.report.pictures.wire_frame import SolidFrame, solid_frame, wire_frame
from sprung.report.sketch.shapes import Disc, Drawing, Stroke, TextShape
from sprung.report.sketch.sheet import blank_sketch, sketch_sheet
from sprung.report.sketch.sketch import VehicleSketch, vehicle_sketch
from sprung.report.sketch.svg import sketch_svg
from sprung.report.terminal.check import check_view
from sprung.report.terminal.comparison import comparison_view
from sprung.report.terminal.draft import draft_view
from sprung.report.terminal.fleet import fleet_view
from sprung.report.terminal.layout import text_of
from sprung.report.terminal.modal import modes_view
from sprung.report.terminal.monte_carlo import monte_carlo_view
from sprung.report.terminal.paper import paper_view
from sprung.report.terminal.plan import plan_view
from sprung.report.terminal.result import result_view
from sprung.report.terminal.ride import ride_view
from sprung.report.terminal.truth import truth_view
from sprung.report.terminal.validation import validation_view

__all__ = [
    "CHECK_FILE",
    "FLEET_FILE",
    "LETTER",
    "LIGHT",
    "REPORT_FILES",
    "RESULT_FILES",
    "Band",
    "Curve",
    "Disc",
    "Drawing",
    "LoadDecays",
    "Mark",
    "Panel",
    "Picture",
    "Points",
    "Rule",
    "SavedResult",
    "SolidFrame",
    "Stroke",
    "TextShape",
    "VehicleSketch",
    "VerdictText",
    "add_report",
    "amplitude_pictures",
    "blank_sketch",
    "channels_picture",
    "check_html",
    "check_view",
    "comparison_view",
    "curve_pictures",
    "damper_cloud_pictures",
    "decays_by_load",
    "differences_picture",
    "draft_view",
    "draw_check",
    "draw_validation",
    "fleet_html",
    "fleet_pictures",
    "fleet_view",
    "landing_picture",
    "limits_text",
    "mode_caption",
    "modes_view",
    "monte_carlo_view",
    "motion_picture",
    "page_style",
    "paper_view",
    "parameters_picture",
    "pdf_of",
    "picture_frame",
    "picture_svg",
    "plan_view",
    "recording_picture",
    "render_report",
    "report_html",
    "result_view",
    "ride_view",
    "save_result",
    "sketch_sheet",
    "sketch_svg",
    "solid_frame",
    "spectra_picture",
    "stability_picture",
    "stack_labels",
    "text_of",
    "transmissibility_picture",
    "truth_view",
    "validation_view",
    "vehicle_sketch",
    "verdict_text",
    "wire_frame",
    "write_check",
    "write_fleet",
    "write_report",
    "write_validation",
]
