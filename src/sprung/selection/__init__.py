"""Selection of the model: the table of model terms, the error budget and the stepwise search."""

from sprung.selection.backward_elimination import (
    leave_out_refused,
    leave_out_undetermined,
    leave_out_unneeded,
    needed_terms,
)
from sprung.selection.contact import begin_no_later, final_tolerance, from_contact, is_likelier
from sprung.selection.description import TermDescription, describe_terms
from sprung.selection.error_budget import FALSE_ALARM_SHARE, OVERDISPERSED, required_gain
from sprung.selection.finite_rotation import REQUIRED_OF_ROTATION, select_finite_rotation
from sprung.selection.flexible_body import fit_flexible_bodies, select_flexible_body
from sprung.selection.from_ordinary_vehicle import fit_usual_linear_terms, or_with_usual_linear_terms
from sprung.selection.further_terms import select_further_terms
from sprung.selection.linear_terms import ENGINE, FLEXIBLE_BODIES, SEPARATE_TRACKS, STARTED_LATER
from sprung.selection.low_pass import confirm_low_pass, corner_of, select_low_pass
from sprung.selection.model_term import ModelTerm
from sprung.selection.nonlinear import select_nonlinear_terms
from sprung.selection.ordinary_vehicle import is_ordinary, may_be_astray, or_from_ordinary_vehicle
from sprung.selection.scoring import WORTH_A_FIT, score_terms
from sprung.selection.search import ModelSearch
from sprung.selection.selection_step import SelectionStep
from sprung.selection.sensor_errors import (
    FAR,
    SensorError,
    find_sensor_error,
    furthest_from_stated,
    sensor_error_of_fit,
)
from sprung.selection.several_vehicles import Groups, divide_drops
from sprung.selection.starts import fit_structure
from sprung.selection.step_length import with_short_steps
from sprung.selection.stepwise import select_linear_terms, try_term
from sprung.selection.structure import ModelStructure, choose_structure
from sprung.selection.term_fits import (
    fit_forced_terms,
    fit_requested_terms,
    fit_term,
    select_gravity_leakage,
    select_roll_axis_height,
    with_neutral_terms,
)
from sprung.selection.terms import TERMS
from sprung.selection.unlike_drops import UnlikeDrops

__all__ = [
    "ENGINE",
    "FALSE_ALARM_SHARE",
    "FAR",
    "FLEXIBLE_BODIES",
    "OVERDISPERSED",
    "REQUIRED_OF_ROTATION",
    "SEPARATE_TRACKS",
    "STARTED_LATER",
    "TERMS",
    "WORTH_A_FIT",
    "Groups",
    "ModelSearch",
    "ModelStructure",
    "ModelTerm",
    "SelectionStep",
    "SensorError",
    "TermDescription",
    "UnlikeDrops",
    "begin_no_later",
    "choose_structure",
    "confirm_low_pass",
    "corner_of",
    "describe_terms",
    "divide_drops",
    "final_tolerance",
    "find_sensor_error",
    "fit_flexible_bodies",
    "fit_forced_terms",
    "fit_requested_terms",
    "fit_structure",
    "fit_term",
    "fit_usual_linear_terms",
    "from_contact",
    "furthest_from_stated",
    "is_likelier",
    "is_ordinary",
    "leave_out_refused",
    "leave_out_undetermined",
    "leave_out_unneeded",
    "may_be_astray",
    "needed_terms",
    "or_from_ordinary_vehicle",
    "or_with_usual_linear_terms",
    "required_gain",
    "score_terms",
    "select_finite_rotation",
    "select_flexible_body",
    "select_further_terms",
    "select_gravity_leakage",
    "select_linear_terms",
    "select_low_pass",
    "select_nonlinear_terms",
    "select_roll_axis_height",
    "sensor_error_of_fit",
    "try_term",
    "with_neutral_terms",
    "with_short_steps",
]
