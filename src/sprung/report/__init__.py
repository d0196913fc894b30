"""Everything people look at; reads every result, and nothing below reads it."""

from sprung.report.drawing.palette import LIGHT
from sprung.report.drawing.picture import Band, Curve, Mark, Panel, Picture, Points, Rule
from sprung.report.drawing.svg import svg_of
from sprung.report.drawings import draw_check, draw_validation
from sprung.report.folder import (
    REPORT_FILES,
    RESULT_FILES,
    Saved,
    add_report,
    save_result,
    write_check,
    write_report,
    write_validation,
)
from sprung.report.page.check_page import CHECK_FILE, check_page
from sprung.report.page.pdf import pdf_of
from sprung.report.page.result_page import drawn_page, page_of
from sprung.report.pictures.amplitudes import amplitude_pictures
from sprung.report.pictures.channels import channels_picture
from sprung.report.pictures.decays import LoadDecays, decays_by_load
from sprung.report.pictures.motions import motion_picture
from sprung.report.pictures.parameters import parameters_picture
from sprung.report.pictures.recordings import near_picture, whole_picture
from sprung.report.pictures.spectra import spectra_picture
from sprung.report.pictures.stability import stability_picture
from sprung.report.pictures.wire_car import BODY_EDGES, STRUTS, wire_car
from sprung.report.sketch.shapes import Disc, Drawing, Stroke, Words
from sprung.report.sketch.sheet import blank_sketch, sketch_sheet
from sprung.report.sketch.sketch import VehicleSketch, vehicle_sketch
from sprung.report.sketch.svg import drawing_svg
from sprung.report.terminal.check import check_view
from sprung.report.terminal.comparison import comparison_view
from sprung.report.terminal.draft import draft_view
from sprung.report.terminal.layout import text_of
from sprung.report.terminal.modal import modes_view
from sprung.report.terminal.paper import paper_view
from sprung.report.terminal.plan import plan_view
from sprung.report.terminal.result import result_view
from sprung.report.terminal.truth import truth_view
from sprung.report.terminal.validation import validation_view

__all__ = [
    "BODY_EDGES",
    "CHECK_FILE",
    "LIGHT",
    "REPORT_FILES",
    "RESULT_FILES",
    "STRUTS",
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
    "Saved",
    "Stroke",
    "VehicleSketch",
    "Words",
    "add_report",
    "amplitude_pictures",
    "blank_sketch",
    "channels_picture",
    "check_page",
    "check_view",
    "comparison_view",
    "decays_by_load",
    "draft_view",
    "draw_check",
    "draw_validation",
    "drawing_svg",
    "drawn_page",
    "modes_view",
    "motion_picture",
    "near_picture",
    "page_of",
    "paper_view",
    "parameters_picture",
    "pdf_of",
    "plan_view",
    "result_view",
    "save_result",
    "sketch_sheet",
    "spectra_picture",
    "stability_picture",
    "svg_of",
    "text_of",
    "truth_view",
    "validation_view",
    "vehicle_sketch",
    "whole_picture",
    "wire_car",
    "write_check",
    "write_report",
    "write_validation",
]
