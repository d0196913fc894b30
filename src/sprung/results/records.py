"""Parts of a result: the tested vehicle, the fit, and the trace of how the result was reached."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pydantic import ConfigDict

from sprung.display import shown
from sprung.estimation import Inflater
from sprung.selection import SelectionStep

EXACT_KEYS = ConfigDict(extra="forbid", arbitrary_types_allowed=True)
"""Configuration of records that are read from results.json: an unknown key is an error."""


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class TestedVehicle:
    """The vehicle that was tested.

    Attributes
    ----------
    name
        For people to read.
    identification
        Chassis, registration or test number, as the campaign file has it; None where it has none.
    """

    __pydantic_config__ = EXACT_KEYS

    name: str
    identification: str | None = None


@shown
@dataclass(frozen=True, slots=True)
class TraceStep:
    """One step of the analysis.

    Attributes
    ----------
    stage
        Name of the stage, such as ``select_terms``.
    what
        What was tried, accepted, corrected or rejected.
    why
        The reason: the test with its value and threshold.
    """

    __pydantic_config__ = EXACT_KEYS

    stage: str
    what: str
    why: str


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class SensorEstimate:
    """What was found of one sensor, beside what is stated of it with an uncertainty.

    Attributes
    ----------
    channel
        Of the sensor.
    quantity
        ``gain``, relative; ``x`` and ``y``, how much further forward and left than stated a body sensor sits, m, or seems to
        sit because it is tilted and above the axis of rotation; ``tilt_x`` and ``tilt_y``, how far its direction leans forward
        and left, rad; ``delay``, s.
    value, std
        Difference from what is stated, and its standard uncertainty with everything that is known, in the unit.
    stated_std
        Standard uncertainty before the identification: from the data sheet and the tape.
    unit
        SI.
    """

    __pydantic_config__ = EXACT_KEYS

    channel: str
    quantity: Literal["gain", "x", "y", "tilt_x", "tilt_y", "delay"]
    value: float
    std: float
    stated_std: float
    unit: str


@shown
@dataclass(frozen=True, slots=True, kw_only=True)
class FitReport:
    """Summary of the fit.

    Attributes
    ----------
    samples, drops
        Number of samples (over all channels) and of drops that were fitted.
    noise
        Estimated noise of each channel, m/s² root-mean-square.
    model
        Model terms beyond the paper's seven degrees of freedom.
    tracks
        Whether springs and dampers of an axle share their half-distance.
    why
        Reason for the model structure.
    axes
        Axes that the inertias refer to.
    since
        Whether drops were used from their release on, or from when the last tyre was down.
    path
        Model terms that were tried, with the log-likelihood that each gained.
    method
        Estimator.
    iterations, converged, starts, starts_agreeing
        Steps from the best start, whether the last step met the convergence criterion, number of optimised starts, and how many
        of them reached the same optimum. A direct start whose optimum leaves white noise is the only one.
    inflation
        Factor by which autocorrelated residuals, or drops that disagree, enlarged every variance; 1 for neither.
    inflated_by
        Which of the two enlarged the variances.
    most_coloured
        Channel with the largest residual autocorrelation, where that enlarged the variances.
    misfit
        Model error of each channel as a part of its signal; 0 where none is significant.
    loglikelihood
        Natural logarithm of the likelihood at its maximum, of all samples and of what was known with an uncertainty:
        -½ Σ (ln 2πσ² + r²/σ²) with the estimated noise σ of each channel and the residuals r.
    unknowns
        Number of quantities estimated from the samples: free parameters of the vehicle, the noise of each channel, the initial
        state of each drop, the offset of each channel in each drop, and clock offsets.
    """

    __pydantic_config__ = EXACT_KEYS

    samples: int
    drops: int
    noise: dict[str, float]
    model: tuple[str, ...]
    tracks: Literal["shared", "separate"]
    why: str
    axes: str
    since: Literal["release", "landing"]
    path: tuple[SelectionStep, ...]
    method: str
    iterations: int
    converged: bool
    starts: int
    starts_agreeing: int
    inflation: float
    inflated_by: Inflater
    most_coloured: str | None = None
    misfit: dict[str, float]
    loglikelihood: float
    unknowns: int

    @property
    def starts_text(self) -> str:
        """How many starts were optimised, and how many of them agree."""
        return "one start" if self.starts == 1 else f"{self.starts_agreeing} of {self.starts} starts agree"
