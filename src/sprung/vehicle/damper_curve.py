"""The curve of a damper: a force law that is linear between knots, or rounded there by hyperbolas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from sprung.vehicle.force_laws import ForceLaw, bent_law
from sprung.vehicle.kinks import Kinks

Array = NDArray[np.float64]


class CurveParts(NamedTuple):
    """What the curve of a damper has besides its knots, each a parameter of its own.

    Attributes
    ----------
    has_ratio
        Whether rebound has another rate than compression.
    has_rebound_knee
        Whether rebound has a knee of its own: other velocities of knots, and another slope behind the first.
    is_rounded
        Whether the knots are rounded.
    """

    has_ratio: bool = False
    has_rebound_knee: bool = False
    is_rounded: bool = False


_KNOTS_ALONE = CurveParts()
"""A curve of straight lines between knots that are alike in compression and rebound."""

_ONE = np.ones(1)
"""Of any shape: a ratio that changes nothing."""

Value = TypeVar("Value")
"""Of a parameter: a number, an array, or its name in another language."""


@dataclass(frozen=True, slots=True)
class CurveParameters(Generic[Value]):
    """The parameters of the curve of a damper by their meaning, as numbers, arrays or names.

    Attributes
    ----------
    damping
        In compression before the first knot, N s/m.
    ratio
        Rebound over compression.
    velocity_ratio, slope_ratio
        Likewise of the knots' velocities, and of the slope after the first over that before it.
    rounding
        Half the width over which knots are rounded, m/s; None where they are not.
    velocities, ratios
        Of each knot its velocity, m/s, and the slope after it over that before it.
    """

    damping: Value
    ratio: Value
    velocity_ratio: Value
    slope_ratio: Value
    rounding: Value | None
    velocities: Sequence[Value]
    ratios: Sequence[Value]

    @classmethod
    def of(cls, parts: CurveParts, parameters: Sequence[Value], neutral: Value) -> CurveParameters[Value]:
        """Sort the parameters of a law.

        Parameters
        ----------
        parts
            What the curve has besides knots.
        parameters
            In the order of `damper_curve`.
        neutral
            One, for what it has not.

        Returns
        -------
        CurveParameters
        """
        damping, *further = parameters
        ratio = further.pop(0) if parts.has_ratio else neutral
        shift, bend = (further.pop(0), further.pop(0)) if parts.has_rebound_knee else (neutral, neutral)
        rounding = further.pop(0) if parts.is_rounded else None
        return cls(damping, ratio, shift, bend, rounding, further[::2], further[1::2])


def damper_curve(parts: CurveParts = _KNOTS_ALONE) -> ForceLaw:
    """Return the law of what the knots of a damper's curve add to the force of a damper of constant rate.

    The force is continuous and passes through zero; it is linear between the knots. Its parameters are the damping c before
    the first knot in compression, N s/m; of `parts` those that it has, in their order: the rebound ratio r; of rebound over
    compression the velocity of the knots, and the slope after the first over that before it; half the width w over which
    hyperbolas round the knots, m/s; and for each knot its velocity, m/s, and the slope after it over that before it. Positive
    ratios of knots in ascending order make the curve monotone.

    Parameters
    ----------
    parts
        What it has besides knots.
    """
    return bent_law("damper-curve", partial(_kinks, parts))


def _kinks(parts: CurveParts, parameters: Array) -> Kinks:
    """Return the knots of both sides: each takes a part off the slope behind it."""
    own, none = CurveParameters.of(parts, list(parameters), _ONE), np.zeros_like(parameters[0])
    knots: list[tuple[Array, ...]] = []
    for sign in (1.0, -1.0):
        ratio, shift, bend = (own.ratio, own.velocity_ratio, own.slope_ratio) if sign > 0 else (_ONE, _ONE, _ONE)
        slope, width = own.damping * ratio, none if own.rounding is None else own.rounding * shift
        for number, (velocity, left) in enumerate(zip(own.velocities, own.ratios, strict=True)):
            behind = slope * left * (_ONE if number else bend)
            knots.append((none, none + sign, velocity * shift, sign * (behind - slope), none + width, none))
            slope = behind
    return Kinks(*(np.stack(part) for part in zip(*knots, strict=True)))
