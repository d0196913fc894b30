"""Assessment of a fit: residuals against noise, cross-validation of left-out drops, and the verdict."""

from sprung.assessment.amplitude import ModeAmplitude, follow_modes
from sprung.assessment.body_motion import MOTIONS, BodyMotion, body_motions, motions_of
from sprung.assessment.cross_validation import DropValidation, cross_validate_drops
from sprung.assessment.mode_tracking import AmplitudeCurve
from sprung.assessment.model_error import estimate_model_error
from sprung.assessment.residuals import ResidualStatistics, describe_residuals, estimate_noise_level
from sprung.assessment.verdict import EXPLAINED, State, Verdict, decide_verdict

__all__ = [
    "EXPLAINED",
    "MOTIONS",
    "AmplitudeCurve",
    "BodyMotion",
    "DropValidation",
    "ModeAmplitude",
    "ResidualStatistics",
    "State",
    "Verdict",
    "body_motions",
    "cross_validate_drops",
    "decide_verdict",
    "describe_residuals",
    "estimate_model_error",
    "estimate_noise_level",
    "follow_modes",
    "motions_of",
]
