"""Decays: the part of each drop in which the free-vibration model holds, and the faults that were met on the way."""

from sprung.preprocess.alignment import align_loggers
from sprung.preprocess.decay import FlightLikelihood, FreeDecay, quantisation_variance
from sprung.preprocess.drop_features import (
    BLOW,
    IMPACT,
    RING,
    RING_TO,
    SPEED,
    DropFeatures,
    detect_dropped_channels,
    look_at,
)
from sprung.preprocess.dropped_wheels import merge_dropped_wheels
from sprung.preprocess.events import DropObservation, Events, MarkedSamples
from sprung.preprocess.exclusion import exclude_drops
from sprung.preprocess.first_motion import FirstMotion, is_first_motion_consistent
from sprung.preprocess.flight import Flight, find_flights
from sprung.preprocess.high_pass import differentiate_by_cutoff, is_ac_coupled
from sprung.preprocess.prepare import Prepared, prepare
from sprung.preprocess.release import Release, StaticBaseline, detect_release, unknown_baseline
from sprung.preprocess.sensor_noise import estimate_sensor_noise, pool_moments
from sprung.preprocess.slow_motion import SlowMotion, find_slower_drops

__all__ = [
    "BLOW",
    "IMPACT",
    "RING",
    "RING_TO",
    "SPEED",
    "DropFeatures",
    "DropObservation",
    "Events",
    "FirstMotion",
    "Flight",
    "FlightLikelihood",
    "FreeDecay",
    "MarkedSamples",
    "Prepared",
    "Release",
    "SlowMotion",
    "StaticBaseline",
    "align_loggers",
    "detect_dropped_channels",
    "detect_release",
    "differentiate_by_cutoff",
    "estimate_sensor_noise",
    "exclude_drops",
    "find_flights",
    "find_slower_drops",
    "is_ac_coupled",
    "is_first_motion_consistent",
    "look_at",
    "merge_dropped_wheels",
    "pool_moments",
    "prepare",
    "quantisation_variance",
    "unknown_baseline",
]
