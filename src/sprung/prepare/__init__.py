"""Decays: the part of each drop in which the free-vibration model holds, and the faults that were met on the way."""

from sprung.prepare.alignment import align
from sprung.prepare.coupling import by_corner, coupled
from sprung.prepare.decay import Decay, FromFlight, rounding
from sprung.prepare.events import Events, Mark, Seen
from sprung.prepare.fallen import (
    FoundDrop,
    Place,
    Readings,
    on_wheels,
    tell_wheels,
    wheel_score,
)
from sprung.prepare.finding import Found, Refusal, drops_in, find_drops
from sprung.prepare.first_motion import FirstMotion, moves_as_stated
from sprung.prepare.flight import Flight, flights
from sprung.prepare.prepare import Prepared, prepare
from sprung.prepare.release import Rest, no_rest
from sprung.prepare.slow_motion import SlowMotion, slower_drops
from sprung.prepare.stated import as_seen

__all__ = [
    "Decay",
    "Events",
    "FirstMotion",
    "Flight",
    "Found",
    "FoundDrop",
    "FromFlight",
    "Mark",
    "Place",
    "Prepared",
    "Readings",
    "Refusal",
    "Rest",
    "Seen",
    "SlowMotion",
    "align",
    "as_seen",
    "by_corner",
    "coupled",
    "drops_in",
    "find_drops",
    "flights",
    "moves_as_stated",
    "no_rest",
    "on_wheels",
    "prepare",
    "rounding",
    "slower_drops",
    "tell_wheels",
    "wheel_score",
]
