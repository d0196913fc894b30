"""Does the model hold? Measured against fitted, residuals against noise, and the verdict."""

from sprung.validation.residuals import Misfit, judge_residuals
from sprung.validation.verdict import State, Verdict, judge

__all__ = ["Misfit", "State", "Verdict", "judge", "judge_residuals"]
