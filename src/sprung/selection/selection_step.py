"""One step of the search for the model, as it is told to the user."""

from __future__ import annotations

from dataclasses import dataclass

from sprung.display import shown


@shown
@dataclass(frozen=True)
class SelectionStep:
    """One step of the search for the model.

    Attributes
    ----------
    extra
        The model term that was tried.
    gain
        In twice the log-likelihood, divided by the overdispersion: expected from a score test where the term was not fitted,
        lost without it (Wald test) where several were fitted at once.
    asked
        Gain required of it.
    fitted
        Whether it was fitted, or only scored.
    taken
        Whether it stayed in the model.
    against
        Why it did not, where it gained enough.
    """

    extra: str
    gain: float
    asked: float
    fitted: bool
    taken: bool
    against: str = ""
    joint: bool = False
    """Whether it was fitted together with the term of the step before it."""

    @property
    def text(self) -> str:
        """The step in words."""
        reason = f", but {self.against}" if self.against else ""
        return f"{self.extra} (Δ2lnL = {max(self.gain, 0.0):.0f}, required {self.asked:.0f}{reason})"
