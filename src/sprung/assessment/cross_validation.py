"""Drop by drop: how well the fitted vehicle explains each, and how well the vehicle fitted to all others predicts it."""

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
from sprung.vehicle import coordinates

Real = NDArray[np.float64]

_BEYOND_CHANCE = 4.0
"""Standard deviations by which a sum of squares must exceed what chance makes of it."""

_DISTANT = 6.0
"""Standard deviations by which a drop must be further from the others than chance would have it."""


@shown
@dataclass(frozen=True, slots=True)
class DropValidation:
    """How well the fitted vehicle does one drop.

    Attributes
    ----------
    vertical, pitch, roll
        Normalised error of the body's accelerations, dimensionless: rms of measured minus simulated over rms of measured;
        None where the sensors do not tell it, or the body hardly moved that way.
    fitted
        The same of all channels, each in units of its noise, dimensionless.
    residual
        What is left of all channels, over the sensors' noise at rest, dimensionless.
    predicted, predicted_residual
        The last two, dimensionless, with the vehicle fitted to all other drops, only the initial state being this one's;
        None where there are no others, the second also where the
        residual of the fit is below rounding, as without any noise.
    unexpected
        Error of the prediction beyond that of the fit and what chance makes of it, as a part of the signal; 0 where it is
        within chance.
    apart
        How far what this drop says of the vehicle is from what the others say: squared, in standard errors, in the mean of all
        directions in which both say anything; one where the model is right.
    whiteness
        What is left of each channel, by name.
    over_noise
        Root-mean-square of the body's vertical, pitch and roll acceleration over that of the sensors' noise, dimensionless, by
        name; None where the sensors do not tell it, or no motion beyond their noise is significant. Empty where an older sprung
        wrote it.
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
    """Validate a fit drop by drop.

    Parameters
    ----------
    summit
        Where the fit ended.
    fit
        How sure it is.
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
    weights, found = optimum.weights, {}
    # Coloured noise tells less; that drops disagree is what is to be seen here.
    coloured = fit.inflation if fit.inflated_by == "coloured residuals" else 1.0
    noise = estimate_noise_level(fit, decays)
    free = 2 * len(coordinates(fit.names))  # a drop's initial state takes up as many samples of noise
    of_drops = zip(decays, motions, predicted, fit.residual, describe_residuals(fit, decays, noise), strict=True)
    for decay, motion, foretold, residual, left in of_drops:
        values = np.nan_to_num(decay.values)
        energy = max(float(values.var(axis=1) @ weights) * decay.samples, np.finfo(float).tiny)
        samples = max(int(decay.usable.sum()) * (decay.samples - 1) - free, 1)
        errors = dict(zip(MOTIONS, motion.errors.tolist(), strict=True))
        squares, over_noise = float(residual @ weights), float(np.sqrt(residual @ noise**-2 / samples))
        found[decay.name] = DropValidation(
            **{name: None if np.isnan(error) else error for name, error in errors.items()},
            fitted=float(np.sqrt(squares / energy)),
            residual=over_noise,
            predicted=None if foretold is None else float(np.sqrt(foretold.squares / energy)),
            predicted_residual=None if foretold is None else _predicted_residual(over_noise, foretold),
            unexpected=0.0 if foretold is None else _unexpected(foretold, energy, coloured),
            apart=None if foretold is None else foretold.distance[0] / max(foretold.distance[1], 1),
            whiteness={channels[channel]: one for channel, one in left.items()},
            over_noise={
                name: None if np.isnan(ratio) else ratio
                for name, ratio in zip(MOTIONS, motion.over_noise.tolist(), strict=True)
            },
        )
    return found


def _predicted_residual(residual: float, foretold: Prediction) -> float | None:
    """Return the residual over the noise as predicted; None where that of the fit is below rounding."""
    return residual * float(np.sqrt(foretold.squares / foretold.fitted)) if foretold.fitted > 0 else None


def _unexpected(foretold: Prediction, energy: float, inflation: float) -> float:
    mean, deviation = foretold.by_chance
    distance, directions = foretold.distance
    more = foretold.squares - foretold.fitted - inflation * (mean + _BEYOND_CHANCE * deviation)
    if distance <= inflation * (directions + _DISTANT * np.sqrt(2 * directions)) or more <= 0:
        return 0.0
    return float(np.sqrt(more / energy))
