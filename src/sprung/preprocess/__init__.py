"""Preprocessing: recordings are corrected, release and landing are detected, free decays extracted, faults reported."""

from sprung.preprocess.alignment import align_loggers
from sprung.preprocess.decay import FlightLikelihood, FreeDecay, quantisation_variance
from sprung.preprocess.dropped_wheels import Dropped, merge_dropped_wheels
from sprung.preprocess.events import DropObservation, Events, MarkedSamples
from sprung.preprocess.fall import BLOW, IMPACT, WHEEL_SPEED, detect_dropped_channels, measure_fall
from sprung.preprocess.first_motion import (
    begins_upward,
    count_disagreeing_drops,
    is_body_slower,
    is_first_motion_consistent,
    redetect_dropped_wheels,
)
from sprung.preprocess.flight import find_flights
from sprung.preprocess.high_pass import differentiate_by_cutoff, is_ac_coupled
from sprung.preprocess.landing import find_steepest_rise
from sprung.preprocess.pads import find_moving_pads
from sprung.preprocess.prepare import Prepared, exclude_drops, prepare
from sprung.preprocess.release import Release, detect_release, unknown_release
from sprung.preprocess.sensor_noise import Moments, SensorNoise, estimate_sensor_noise, pool_moments
from sprung.preprocess.slow_motion import extract_slow_motion, find_slower_drops

__all__ = [
    "BLOW",
    "IMPACT",
    "WHEEL_SPEED",
    "DropObservation",
    "Dropped",
    "Events",
    "FlightLikelihood",
    "FreeDecay",
    "MarkedSamples",
    "Moments",
    "Prepared",
    "Release",
    "SensorNoise",
    "align_loggers",
    "begins_upward",
    "count_disagreeing_drops",
    "detect_dropped_channels",
    "detect_release",
    "differentiate_by_cutoff",
    "estimate_sensor_noise",
    "exclude_drops",
    "extract_slow_motion",
    "find_flights",
    "find_moving_pads",
    "find_slower_drops",
    "find_steepest_rise",
    "is_ac_coupled",
    "is_body_slower",
    "is_first_motion_consistent",
    "measure_fall",
    "merge_dropped_wheels",
    "pool_moments",
    "prepare",
    "quantisation_variance",
    "redetect_dropped_wheels",
    "unknown_release",
]
