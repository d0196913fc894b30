"""Decays: the part of each drop in which the free-vibration model holds, and the faults that were met on the way."""

from sprung.prepare.decay import Decay
from sprung.prepare.events import Events, Mark, Seen
from sprung.prepare.fallen import (
    FoundDrop,
    Kind,
    Place,
    Readings,
    kind_of,
    on_wheels,
    tell_wheels,
    wheel_score,
)
from sprung.prepare.finding import Found, Refusal, drops_in, find_drops
from sprung.prepare.prepare import Prepared, prepare
from sprung.prepare.release import Rest, no_rest, resolution

__all__ = [
    "Decay",
    "Events",
    "Found",
    "FoundDrop",
    "Kind",
    "Mark",
    "Place",
    "Prepared",
    "Readings",
    "Refusal",
    "Rest",
    "Seen",
    "drops_in",
    "find_drops",
    "kind_of",
    "no_rest",
    "on_wheels",
    "prepare",
    "resolution",
    "tell_wheels",
    "wheel_score",
]
