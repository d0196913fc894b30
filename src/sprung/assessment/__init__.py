"""Does the model hold? Measured against fitted, residuals against noise, and the verdict."""

from sprung.assessment.amplitude import ModeAmplitude, mode_amplitudes
from sprung.assessment.bodies import MOTIONS, BodyMotion, body_motions
from sprung.assessment.drops import DropValidation, validate_drops
from sprung.assessment.residuals import Misfit, judge_residuals
from sprung.assessment.sensors import Moments, SensorNoise, moments, sensor_noise
from sprung.assessment.sliding import AmplitudeCurve
from sprung.assessment.verdict import State, Verdict, judge
from sprung.assessment.whiteness import Remainder, noise_of_sensors, remainders

__all__ = [
    "MOTIONS",
    "AmplitudeCurve",
    "BodyMotion",
    "DropValidation",
    "Misfit",
    "ModeAmplitude",
    "Moments",
    "Remainder",
    "SensorNoise",
    "State",
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
