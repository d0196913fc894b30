"""Does the model hold? Measured against fitted, residuals against noise, and the verdict."""

from sprung.validation.amplitude import ModeAmplitude, mode_amplitudes
from sprung.validation.bodies import MOTIONS, BodyMotion, body_motions
from sprung.validation.drops import DropValidation, validate_drops
from sprung.validation.residuals import Misfit, judge_residuals
from sprung.validation.sensors import Moments, SensorNoise, moments, sensor_noise
from sprung.validation.sliding import Trace
from sprung.validation.verdict import State, Verdict, judge
from sprung.validation.whiteness import Remainder, noise_of_sensors, remainders

__all__ = [
    "MOTIONS",
    "BodyMotion",
    "DropValidation",
    "Misfit",
    "ModeAmplitude",
    "Moments",
    "Remainder",
    "SensorNoise",
    "State",
    "Trace",
    "Verdict",
    "body_motions",
    "judge",
    "judge_residuals",
    "mode_amplitudes",
    "moments",
    "noise_of_sensors",
    "remainders",
    "sensor_noise",
    "validate_drops",
]
