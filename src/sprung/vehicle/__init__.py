"""The only room that knows the equations of motion: parameters, elements, matrices, loads, sensors, exact response."""

from sprung.vehicle.derived import DERIVED, quantity
from sprung.vehicle.drop import Event, Fall, Piece, drop_from_blocks
from sprung.vehicle.elements import LINEAR_EXTRAS, Element, Tracks, half_distances, seven_degrees_of_freedom
from sprung.vehicle.examples import SCHOOL_BUS, TABLE_1_CAR
from sprung.vehicle.ground import static_wheel_loads, tyre_rates
from sprung.vehicle.load import EMPTY, Added, Finite, Item, Load, NotNegative, Positive
from sprung.vehicle.model import LAWS, LinearModel, Matrices, Rows
from sprung.vehicle.parameters import EXTRA_PARAMETERS, PARAMETERS, Parameter, Vehicle, parameter_names
from sprung.vehicle.response import Motion, affine_response, free_decay, half_sine_bump
from sprung.vehicle.rows import COORDINATES, WHEELS, Row, Wheel
from sprung.vehicle.sensor import Sensor

__all__ = [
    "COORDINATES",
    "DERIVED",
    "EMPTY",
    "EXTRA_PARAMETERS",
    "LAWS",
    "LINEAR_EXTRAS",
    "PARAMETERS",
    "SCHOOL_BUS",
    "TABLE_1_CAR",
    "WHEELS",
    "Added",
    "Element",
    "Event",
    "Fall",
    "Finite",
    "Item",
    "LinearModel",
    "Load",
    "Matrices",
    "Motion",
    "NotNegative",
    "Parameter",
    "Piece",
    "Positive",
    "Row",
    "Rows",
    "Sensor",
    "Tracks",
    "Vehicle",
    "Wheel",
    "affine_response",
    "drop_from_blocks",
    "free_decay",
    "half_distances",
    "half_sine_bump",
    "parameter_names",
    "quantity",
    "seven_degrees_of_freedom",
    "static_wheel_loads",
    "tyre_rates",
]
