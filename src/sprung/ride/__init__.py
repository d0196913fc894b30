"""Ride and inspection numbers of an identified vehicle: transmissibility, roads, comfort, suspension testers, quarter cars."""

from sprung.ride.distribution import ParameterDistribution
from sprung.ride.options import USUAL_ROADS, USUAL_SPEED, Place, RideOptions
from sprung.ride.records import RideNumbers, RoadNumbers, Transmissibility
from sprung.ride.ride_numbers import ride_numbers
from sprung.ride.road import ROAD_CLASSES, Road, Tracks, coherence_of_tracks
from sprung.ride.tables import ride_tables
from sprung.ride.weighting import Weighting, frequency_weighting

__all__ = [
    "ROAD_CLASSES",
    "USUAL_ROADS",
    "USUAL_SPEED",
    "ParameterDistribution",
    "Place",
    "RideNumbers",
    "RideOptions",
    "Road",
    "RoadNumbers",
    "Tracks",
    "Transmissibility",
    "Weighting",
    "coherence_of_tracks",
    "frequency_weighting",
    "ride_numbers",
    "ride_tables",
]
