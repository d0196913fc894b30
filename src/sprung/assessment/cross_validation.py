"""Cross-validation: how well the fit describes each drop, and how well the fit to all other drops predicts it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sprung.assessment.body_motion import MOTIONS, BodyMotion
from sprung.assessment.residuals import ResidualStatistics, describe_residuals, estimate_noise_level
from sprung.display import shown
from sprung.estimation import FitResult, FitStatistics, Prediction, predictions
from sprung.preprocess import FreeDecay
from sprung.vehicle import state_variables

Real = NDArray[np.float64]

_BEYOND_CHANCE = 4.0
"""Standard deviations by which a sum of squares must exceed what chance makes of it."""

_DISTANT = 6.0
"""Standard deviations by which a drop must be further from the others than chance would have it."""


@shown
@dataclass(frozen=True, slots=True)
class DropValidation:
    """Cross-validation of one drop.

    Attributes
    ----------
    vertical, pitch, roll
        Normalised error of the body's accelerations, dimensionless: rms of measured minus simulated over rms of measured;
        None where the sensors do not determine it, or the body hardly moved that way.
    fitted
        The same of all channels, each in units of its noise, dimensionless.
    residual
        Residual of all channels over the sensors' noise at rest, dimensionless.
    predicted, predicted_residual
        The last two, dimensionless, with the vehicle fitted to all other drops and the initial state of this one; None where
        there are no others, the second also where the residual of the fit is below rounding, as without any noise.
    unexpected
        Error of the prediction beyond that of the fit and of chance, as a part of the signal; 0 where it is within chance.
    apart
        Mean squared distance, in standard errors, between the estimate from this drop and that from the others, over all
        directions that both determine; one where the model is right.
    whiteness
        Statistics of the residuals of each channel, by name.
    over_noise
        Root-mean-square of the body's vertical, pitch and roll acceleration over that of the sensors' noise, dimensionless, by
        name; None where the sensors do not determine it, or no motion beyond their noise is significant.
    """

    vertical: float | None
    pitch: float | None
    roll: float | None
    fitted: float
    residual: float
    predicted: float | None
    predicted_residual: float | None
    unexpected: float
    apart: float | None
    whiteness: Mapping[str, ResidualStatistics] = field(default_factory=dict)
    over_noise: Mapping[str, float | None] = field(default_factory=dict)


def cross_validate_drops(
    optimum: FitResult,
    fit: FitStatistics,
    decays: Sequence[FreeDecay],
    channels: Sequence[str],
    motions: Sequence[BodyMotion],
) -> dict[str, DropValidation]:
    """Cross-validate a fit by leaving out one drop at a time.

    Parameters
    ----------
    optimum
        The fit.
    fit
        Its statistics.
    decays
        What was fitted.
    channels
        Channel names.
    motions
        From `body_motions`.

    Returns
    -------
    dict
        By the drop's name.
    """
    predicted: Sequence[Prediction | None] = predictions(optimum) if len(decays) > 1 else [None] * len(decays)
    weights, validations = optimum.weights, {}
    # Coloured noise is less informative; a disagreement of the drops is what is to be detected here, so that it does not count.
    coloured = fit.inflation if fit.inflated_by == "coloured residuals" else 1.0
    noise = estimate_noise_level(optimum)
    free = len(state_variables(fit.names))  # a drop's initial state takes up as many samples of noise
    observations = optimum.problem.objective.observations
    of_drops = zip(
        decays, motions, predicted, fit.residual, describe_residuals(fit, decays, noise), observations, strict=True
    )
    for decay, motion, prediction, residual, statistics, counts in of_drops:
        energy = max(float(np.nan_to_num(decay.energy) @ weights), np.finfo(float).tiny)
        # On pads the lines up to a frequency are fitted, and the motion of each pad takes up one number of each.
        taken = float(counts.max() * len(decay.pads)) if decay.pads else 0.0
        samples = max(float(counts.sum()) - int(decay.usable.sum()) - free - taken, 1.0)
        errors = dict(zip(MOTIONS, motion.errors.tolist(), strict=True))
        squares, over_noise = float(residual @ weights), float(np.sqrt(residual @ noise**-2 / samples))
        validations[decay.name] = DropValidation(
            **{name: None if np.isnan(error) else error for name, error in errors.items()},
            fitted=float(np.sqrt(squares / energy)),
            residual=over_noise,
            predicted=None if prediction is None else float(np.sqrt(prediction.squares / energy)),
            predicted_residual=None if prediction is None else _predicted_residual(over_noise, prediction),
            unexpected=0.0 if prediction is None else _unexpected(prediction, energy, coloured),
            apart=None if prediction is None else prediction.distance[0] / max(prediction.distance[1], 1),
            whiteness={channels[channel]: own for channel, own in statistics.items()},
            over_noise={
                name: None if np.isnan(ratio) else ratio
                for name, ratio in zip(MOTIONS, motion.over_noise.tolist(), strict=True)
            },
        )
    return validations


def _predicted_residual(residual: float, prediction: Prediction) -> float | None:
    """Return the residual over the noise as predicted; None where that of the fit is below rounding."""
    return residual * float(np.sqrt(prediction.squares / prediction.fitted)) if prediction.fitted > 0 else None


def _unexpected(prediction: Prediction, energy: float, inflation: float) -> float:
    mean, deviation = prediction.by_chance
    distance, directions = prediction.distance
    more = prediction.squares - prediction.fitted - inflation * (mean + _BEYOND_CHANCE * deviation)
    if distance <= inflation * (directions + _DISTANT * np.sqrt(2 * directions)) or more <= 0:
        return 0.0
    return float(np.sqrt(more / energy))
