"""Decays: the part of each drop in which the free-vibration model holds, and the faults that were met on the way."""

from sprung.preprocess.alignment import align
from sprung.preprocess.coupling import by_corner, coupled
from sprung.preprocess.decay import FreeDecay, FromFlight, rounding
from sprung.preprocess.events import DropObservation, Events, Mark
from sprung.preprocess.exclusion import leave_out
from sprung.preprocess.fallen import DropFeatures, FoundDrop, Place, on_wheels, tell_wheels, wheel_score
from sprung.preprocess.finding import Found, Refusal, drops_in, find_drops
from sprung.preprocess.first_motion import FirstMotion, moves_as_stated
from sprung.preprocess.flight import Flight, flights
from sprung.preprocess.prepare import Prepared, prepare
from sprung.preprocess.release import StaticBaseline, no_rest
from sprung.preprocess.slow_motion import SlowMotion, slower_drops
from sprung.preprocess.stated import as_seen

__all__ = [
    "DropFeatures",
    "DropObservation",
    "Events",
    "FirstMotion",
    "Flight",
    "Found",
    "FoundDrop",
    "FreeDecay",
    "FromFlight",
    "Mark",
    "Place",
    "Prepared",
    "Refusal",
    "SlowMotion",
    "StaticBaseline",
    "align",
    "as_seen",
    "by_corner",
    "coupled",
    "drops_in",
    "find_drops",
    "flights",
    "leave_out",
    "moves_as_stated",
    "no_rest",
    "on_wheels",
    "prepare",
    "rounding",
    "slower_drops",
    "tell_wheels",
    "wheel_score",
]
