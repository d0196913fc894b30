"""The only room that knows the equations of motion: parameters, elements, matrices, loads, sensors, exact response."""

from sprung.vehicle.characteristics import CHARACTERISTICS, WHEEL_LOADS, Characteristic, characteristic, wheel_loads
from sprung.vehicle.derived import DERIVED, quantity
from sprung.vehicle.drop import Event, Fall, LinearSegment, drop_from_blocks
from sprung.vehicle.elements import (
    EXTRAS,
    LINEAR_EXTRAS,
    Element,
    Force,
    Law,
    Tracks,
    ground_forces,
    half_distances,
    nonlinear_elements,
    seven_degrees_of_freedom,
)
from sprung.vehicle.examples import SCHOOL_BUS, TABLE_1_CAR
from sprung.vehicle.ground import static_wheel_loads, tyre_rates
from sprung.vehicle.heights import LEVEL, CarriedAt, Heights
from sprung.vehicle.laws import ElementInput
from sprung.vehicle.load import EMPTY, Added, Finite, Item, Load, NotNegative, Positive
from sprung.vehicle.model import LAWS, LinearModel, Matrices, Rows
from sprung.vehicle.nonlinear import Forces, NonlinearModel
from sprung.vehicle.nonlinear_simulation import Block, decays_with_forces, drops_with_forces
from sprung.vehicle.parameters import (
    EXTRA_PARAMETERS,
    LOAD_MASS,
    NEUTRAL,
    PARAMETERS,
    Parameter,
    brought_by,
    parameter_names,
    separate_names,
    separated,
)
from sprung.vehicle.record import UNKNOWN_KEY, problems_of_record, record, record_of
from sprung.vehicle.response import Motion, affine_response, free_decay, half_sine_bump
from sprung.vehicle.rows import COORDINATES, WHEELS, WHEELS_AT, Row, Wheel, coordinates
from sprung.vehicle.sensor import Sensor
from sprung.vehicle.stepping import Sensitivities, Stepper, Trajectory
from sprung.vehicle.vehicle import Vehicle

__all__ = [
    "CHARACTERISTICS",
    "COORDINATES",
    "DERIVED",
    "EMPTY",
    "EXTRAS",
    "EXTRA_PARAMETERS",
    "LAWS",
    "LEVEL",
    "LINEAR_EXTRAS",
    "LOAD_MASS",
    "NEUTRAL",
    "PARAMETERS",
    "SCHOOL_BUS",
    "TABLE_1_CAR",
    "UNKNOWN_KEY",
    "WHEELS",
    "WHEELS_AT",
    "WHEEL_LOADS",
    "Added",
    "Block",
    "CarriedAt",
    "Characteristic",
    "Element",
    "ElementInput",
    "Event",
    "Fall",
    "Finite",
    "Force",
    "Forces",
    "Heights",
    "Item",
    "Law",
    "LinearModel",
    "LinearSegment",
    "Load",
    "Matrices",
    "Motion",
    "NonlinearModel",
    "NotNegative",
    "Parameter",
    "Positive",
    "Row",
    "Rows",
    "Sensitivities",
    "Sensor",
    "Stepper",
    "Tracks",
    "Trajectory",
    "Vehicle",
    "Wheel",
    "affine_response",
    "brought_by",
    "characteristic",
    "coordinates",
    "decays_with_forces",
    "drop_from_blocks",
    "drops_with_forces",
    "free_decay",
    "ground_forces",
    "half_distances",
    "half_sine_bump",
    "nonlinear_elements",
    "parameter_names",
    "problems_of_record",
    "quantity",
    "record",
    "record_of",
    "separate_names",
    "separated",
    "seven_degrees_of_freedom",
    "static_wheel_loads",
    "tyre_rates",
    "wheel_loads",
]
