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
from sprung.vehicle.elements import (
    EXTRAS,
    LINEAR_EXTRAS,
    REFINED,
    Element,
    LinearLaw,
    NonlinearElement,
    Tracks,
    ground_contact_elements,
    half_distances,
    nonlinear_elements,
    seven_degrees_of_freedom,
    stiffened_air_springs,
)
from sprung.vehicle.finite_rotation import body_sinking, second_order_readings
from sprung.vehicle.force_laws import ElementInput
from sprung.vehicle.heights import LEVEL, CarriedAt, Heights
from sprung.vehicle.kinematics import COORDINATES, WHEELS, WHEELS_AT, Row, Wheel, coordinates, heave, state_variables
from sprung.vehicle.load import EMPTY, Added, Finite, Item, Load, NotNegative, Positive
from sprung.vehicle.model import LINEAR_LAWS, LinearModel, Matrices, Rows, highest_derivatives, state_matrix
from sprung.vehicle.nonlinear import NonlinearForces, NonlinearModel
from sprung.vehicle.nuisances import (
    LOAD_MASS,
    SENSOR_UNKNOWNS,
    SensorQuantity,
    is_nuisance,
    is_of_sensor,
    parameter_of,
    sensor_unknown,
)
from sprung.vehicle.paper_vehicles import SCHOOL_BUS, TABLE_1_CAR
from sprung.vehicle.parameters import (
    EXTRA_PARAMETERS,
    NEUTRAL,
    PARAMETERS,
    Parameter,
    parameter_names,
    parameters_of_term,
    separate_track_names,
    with_separate_tracks,
)
from sprung.vehicle.readout import Readout
from sprung.vehicle.response import Motion, affine_response, free_decay
from sprung.vehicle.segments import integrate_near, segments_of
from sprung.vehicle.sensitivities import differentiate_motions
from sprung.vehicle.sensor import Sensor, uncertainties_of
from sprung.vehicle.stepping import Stepper, Trajectory
from sprung.vehicle.tyre_rates import differentiate_tyre_rates_at_rest, with_tyre_rates_at_rest
from sprung.vehicle.vehicle import Vehicle

__all__ = [
    "CHARACTERISTICS",
    "COORDINATES",
    "DERIVED",
    "EMPTY",
    "EXTRAS",
    "EXTRA_PARAMETERS",
    "FORCE_CURVES",
    "LEVEL",
    "LINEAR_EXTRAS",
    "LINEAR_LAWS",
    "LOAD_MASS",
    "MOTION_RATIOS",
    "NEUTRAL",
    "PARAMETERS",
    "REFINED",
    "SCHOOL_BUS",
    "SENSOR_UNKNOWNS",
    "TABLE_1_CAR",
    "UNKNOWN_KEY",
    "WHEELS",
    "WHEELS_AT",
    "WHEEL_LOADS",
    "Added",
    "CarriedAt",
    "Characteristic",
    "CurveElements",
    "Element",
    "ElementInput",
    "Finite",
    "Heights",
    "Item",
    "LinearLaw",
    "LinearModel",
    "Load",
    "Matrices",
    "Motion",
    "NonlinearElement",
    "NonlinearForces",
    "NonlinearModel",
    "NotNegative",
    "Parameter",
    "Positive",
    "Readout",
    "Row",
    "Rows",
    "Sensor",
    "SensorQuantity",
    "Stepper",
    "Tracks",
    "Trajectory",
    "Vehicle",
    "Wheel",
    "affine_response",
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
    "integrate_near",
    "is_nuisance",
    "is_of_sensor",
    "nonlinear_elements",
    "parameter_names",
    "parameter_of",
    "parameters_of_term",
    "parse_record",
    "problems_of_record",
    "second_order_readings",
    "segments_of",
    "sensor_unknown",
    "separate_track_names",
    "seven_degrees_of_freedom",
    "state_matrix",
    "state_variables",
    "stiffened_air_springs",
    "uncertainties_of",
    "wheel_loads",
    "with_separate_tracks",
    "with_tyre_rates_at_rest",
]
