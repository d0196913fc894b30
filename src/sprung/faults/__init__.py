"""Faults of recordings and campaigns: isolated by comparing what each hypothesis predicts with what was recorded.

One hypothesis is one file: how it corrects the campaign, how it predicts the residuals, and its message. All of them
compete on the same samples in one currency, twice the log-likelihood, with model terms as well; only the most likely ones are
fitted, and none is accepted on suspicion: it has to explain the recordings, beyond chance, and no other one may do so about as
well.
"""

from sprung.faults.beside_terms import correct_beside_terms
from sprung.faults.candidate_fit import CandidateFit, decays_without_wheel_sensors
from sprung.faults.consistency import Consistency, consistency_of, largest_expected_gain, score_faults_of
from sprung.faults.drift import detect_drift
from sprung.faults.drop import CONTRADICTING
from sprung.faults.hypothesis import Hypothesis
from sprung.faults.isolate import isolate, largest_gain_by_steps
from sprung.faults.residual_table import is_explained, reference_noise, residual_table
from sprung.faults.statements.search import examine

__all__ = [
    "CONTRADICTING",
    "CandidateFit",
    "Consistency",
    "Hypothesis",
    "consistency_of",
    "correct_beside_terms",
    "decays_without_wheel_sensors",
    "detect_drift",
    "examine",
    "is_explained",
    "isolate",
    "largest_expected_gain",
    "largest_gain_by_steps",
    "reference_noise",
    "residual_table",
    "score_faults_of",
]
