"""Model terms in words: one sentence that states what a vehicle has besides springs and dampers, and how sure that is."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.estimation import FitStatistics, estimate_quantity
from sprung.uncertainty import Estimate
from sprung.vehicle import layout_of

Real = NDArray[np.float64]

Values = Mapping[str, float]
"""Parameters by name, SI."""

_AXLES = {"f": "front", "r": "rear", "": ""}

_SIGNIFICANT = 2.0
"""Standard errors from its neutral value within which a quantity is not there."""

_FIGURES = 4
"""Significant figures of a value, at the most: a sentence is read aloud."""

_STEP = 1e-4
"""Step of a difference quotient in standard errors: its own error is of the order of its square."""


@dataclass(frozen=True)
class TermDescription:
    """How a sentence states a model term.

    Attributes
    ----------
    text
        With {0}, {1} ... for the quantities, and {axle} for front or rear where the term has a size for each axle.
    quantities
        Each a function of the parameters and of the index of the axle, and its unit. The first one decides whether the
        term is there.
    again
        Text of the rear axle where the front axle is stated before; empty where the term belongs to the whole vehicle.
    neutral
        Value of the first quantity, in its unit, where the term is absent; None where there is no such value.
    """

    text: str
    quantities: tuple[tuple[Callable[[Values, str], float], str], ...]
    again: str = ""
    neutral: float | None = 0.0

    def phrase(self, fit: FitStatistics) -> str:
        """Return the term in words with its quantities and their standard errors; empty where it is not significant.

        Parameters
        ----------
        fit
            Uncertainty of the fit.
        """
        parts: list[str] = []
        for axle in layout_of(fit.names).axles if self.again else [""]:
            found = [_estimate(fit, quantity, axle, unit) for quantity, unit in self.quantities]
            if self._is_there(found[0]):
                text = self.again if parts else self.text
                said = " ".join(text.format(*map(_in_words, found), axle=_AXLES[axle]).split())
                parts.append(said if axle else said.replace("a anti", "an anti"))
        return " and ".join(parts)

    def _is_there(self, found: Estimate) -> bool:
        if found.value is None or found.std is None:
            return False
        return self.neutral is None or abs(found.value - self.neutral) > _SIGNIFICANT * found.std


def describe_terms(descriptions: Sequence[TermDescription], fit: FitStatistics) -> str:
    """Return one sentence that states the model terms with their sizes.

    Parameters
    ----------
    descriptions
        Of the terms of the model.
    fit
        Uncertainty of the fit.

    Returns
    -------
    str
        Empty where there is nothing besides springs and dampers.
    """
    phrases = [phrase for description in descriptions if (phrase := description.phrase(fit))]
    if not phrases:
        return ""
    return f"Besides springs and dampers the recordings show {'; '.join(phrases)} (± one standard error)."


def _estimate(fit: FitStatistics, quantity: Callable[[Values, str], float], axle: str, unit: str) -> Estimate:
    """Estimate a quantity of an axle; its gradient by central differences, as it need not be analytic."""
    stds = np.sqrt(np.diag(fit.covariance))

    def at(values: Real) -> float:
        return quantity(dict(zip(fit.names, values.tolist(), strict=True)), axle)

    def slope(position: int) -> float:
        step = _STEP * stds[position] * np.eye(len(stds))[position]
        return (at(fit.values + step) - at(fit.values - step)) / float(2 * step[position])

    gradient = np.array([slope(position) if std > 0 else 0.0 for position, std in enumerate(stds)])
    return estimate_quantity(fit, at(fit.values), gradient, unit, signed=True)


def _in_words(found: Estimate) -> str:
    """Return a value with the first figure of its standard error, which is rounded up where the value has too many figures."""
    if found.value is None or found.std is None:
        return "an undetermined size"
    unit = "" if found.unit == "1" else f" {found.unit}"
    if not found.std or not found.value:
        return f"{found.value:.{_FIGURES}g}{unit}"
    place = -math.floor(math.log10(found.std))
    place -= round(found.std, place) >= 10.0 ** (1 - place)  # 0.0097 is 0.01
    finest = _FIGURES - 1 - math.floor(math.log10(abs(found.value)))
    std = round(found.std, place) if place <= finest else math.ceil(found.std * 10.0**finest) / 10.0**finest
    place = min(place, finest)
    return f"{round(found.value, place):.{max(place, 0)}f} ± {std:.{max(place, 0)}f}{unit}"
