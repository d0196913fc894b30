"""The only room that knows the equations of motion: parameters, elements, matrices, loads, sensors, exact response."""

from sprung.vehicle.characteristics import (
    CHARACTERISTICS,
    DERIVED,
    MOTION_RATIOS,
    WHEEL_LOADS,
    Characteristic,
    evaluate_quantity,
    wheel_loads,
)
from sprung.vehicle.checked_record import UNKNOWN_KEY, checked_record, parse_record, problems_of_record
from sprung.vehicle.curves import FORCE_CURVES, CurveElements
from sprung.vehicle.damper_curve import CurveParameters, CurveParts
from sprung.vehicle.elements import (
    EXTRAS,
    LINEAR_EXTRAS,
    REFINED,
    Element,
    linear_elements,
    stiffened_air_springs,
    travels,
)
from sprung.vehicle.finite_rotation import body_sinking, second_order_readings
from sprung.vehicle.force_laws import ElementInput, ForceLaw
from sprung.vehicle.heights import LEVEL, CarriedAt, Heights
from sprung.vehicle.kinematics import Row, body_point, coordinates, heave, state_variables
from sprung.vehicle.layout import (
    AXLES,
    COORDINATES,
    FULL,
    LAYOUTS,
    STATIONS,
    WHEELS,
    Layout,
    LinearLaw,
    Tracks,
    VehicleModel,
    Wheel,
    half_distances,
    inboard_shares,
    layout_of,
    parameter_name,
    wheelbase_of,
)
from sprung.vehicle.linearisation import (
    EquivalentElements,
    RandomTravel,
    linearise_harmonic,
    linearise_random,
)
from sprung.vehicle.load import EMPTY, Added, Finite, Item, Load, NotNegative, Positive
from sprung.vehicle.model import LINEAR_LAWS, LinearModel, Matrices, Rows, highest_derivatives, state_matrix
from sprung.vehicle.nonlinear import NonlinearForces, NonlinearModel
from sprung.vehicle.nonlinear_elements import NonlinearElement, ground_contact_elements, nonlinear_elements
from sprung.vehicle.nuisances import (
    LOAD_MASS,
    SENSOR_UNKNOWNS,
    SensorQuantity,
    is_nuisance,
    is_of_sensor,
    parameter_of,
    sensor_unknown,
)
from sprung.vehicle.pads import PadInputs
from sprung.vehicle.paper_vehicles import SCHOOL_BUS, TABLE_1_CAR
from sprung.vehicle.parameter_values import all_names
from sprung.vehicle.parameters import (
    NEUTRAL,
    PARAMETERS,
    Parameter,
    parameter_names,
    parameters_of_term,
    separate_track_names,
    terms_of,
    with_separate_tracks,
)
from sprung.vehicle.readout import Readout, sensor_rows
from sprung.vehicle.response import Motion, affine_response, after_rest, free_decay
from sprung.vehicle.segments import NearbyMotion, integrate_near, segments_of
from sprung.vehicle.sensitivities import differentiate_motions
from sprung.vehicle.sensor import PADS, Sensor, SensorPlace, uncertainties_of
from sprung.vehicle.stepping import StepDrive, Stepper, Trajectory
from sprung.vehicle.tyre_rates import differentiate_tyre_rates_at_rest, with_tyre_rates_at_rest
from sprung.vehicle.vehicle import Vehicle

__all__ = [
    "AXLES",
    "CHARACTERISTICS",
    "COORDINATES",
    "DERIVED",
    "EMPTY",
    "EXTRAS",
    "FORCE_CURVES",
    "FULL",
    "LAYOUTS",
    "LEVEL",
    "LINEAR_EXTRAS",
    "LINEAR_LAWS",
    "LOAD_MASS",
    "MOTION_RATIOS",
    "NEUTRAL",
    "PADS",
    "PARAMETERS",
    "REFINED",
    "SCHOOL_BUS",
    "SENSOR_UNKNOWNS",
    "STATIONS",
    "TABLE_1_CAR",
    "UNKNOWN_KEY",
    "WHEELS",
    "WHEEL_LOADS",
    "Added",
    "CarriedAt",
    "Characteristic",
    "CurveElements",
    "CurveParameters",
    "CurveParts",
    "Element",
    "ElementInput",
    "EquivalentElements",
    "Finite",
    "ForceLaw",
    "Heights",
    "Item",
    "Layout",
    "LinearLaw",
    "LinearModel",
    "Load",
    "Matrices",
    "Motion",
    "NearbyMotion",
    "NonlinearElement",
    "NonlinearForces",
    "NonlinearModel",
    "NotNegative",
    "PadInputs",
    "Parameter",
    "Positive",
    "RandomTravel",
    "Readout",
    "Row",
    "Rows",
    "Sensor",
    "SensorPlace",
    "SensorQuantity",
    "StepDrive",
    "Stepper",
    "Tracks",
    "Trajectory",
    "Vehicle",
    "VehicleModel",
    "Wheel",
    "affine_response",
    "after_rest",
    "all_names",
    "body_point",
    "body_sinking",
    "checked_record",
    "coordinates",
    "differentiate_motions",
    "differentiate_tyre_rates_at_rest",
    "evaluate_quantity",
    "free_decay",
    "ground_contact_elements",
    "half_distances",
    "heave",
    "highest_derivatives",
    "inboard_shares",
    "integrate_near",
    "is_nuisance",
    "is_of_sensor",
    "layout_of",
    "linear_elements",
    "linearise_harmonic",
    "linearise_random",
    "nonlinear_elements",
    "parameter_name",
    "parameter_names",
    "parameter_of",
    "parameters_of_term",
    "parse_record",
    "problems_of_record",
    "second_order_readings",
    "segments_of",
    "sensor_rows",
    "sensor_unknown",
    "separate_track_names",
    "state_matrix",
    "state_variables",
    "stiffened_air_springs",
    "terms_of",
    "travels",
    "uncertainties_of",
    "wheel_loads",
    "wheelbase_of",
    "with_separate_tracks",
    "with_tyre_rates_at_rest",
]
