"""Channels of other quantities than acceleration: displacement, velocity, angular rate, force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sprung.drafting.quantity_names import quantity_named, reason_against_name
from sprung.units import Quantity, quantity_of_unit, si_factor

Real = NDArray[np.float64]


@dataclass(frozen=True)
class OtherChannel:
    """A channel that measures no acceleration.

    Attributes
    ----------
    name
        The channel's.
    quantity
        What it measures.
    unit
        Its unit, as the file states it; None where it states none.
    notes
        Findings and conclusions, in words.
    """

    name: str
    quantity: Quantity
    unit: str | None
    notes: tuple[str, ...] = ()

    @property
    def factor(self) -> float:
        """Factor from a reading to SI; 1 where the unit is not known."""
        return 1.0 if self.unit is None else si_factor(self.unit, self.quantity)


def classify_other_channel(name: str, stated_unit: str | None, samples: Real) -> OtherChannel | str | None:
    """Classify a channel by its unit, or where the file states none by its name.

    Parameters
    ----------
    name
        The channel's.
    stated_unit
        Unit that the file states; None where it states none.
    samples
        Stretches of its readings, shape (stretch, time).

    Returns
    -------
    OtherChannel, str or None
        In words, why it is of no use; None where it may be an accelerometer, or what it measures is not known.
    """
    by_unit = None if stated_unit is None else quantity_of_unit(stated_unit)
    quantity = quantity_named(name) if stated_unit is None else by_unit
    if quantity in (None, "acceleration"):
        return None
    if not np.isfinite(samples).any():
        return "it holds no numbers"
    if np.nanmax(samples) == np.nanmin(samples):
        return f"it reads {float(np.nanmax(samples)):.6g} throughout"
    reason = reason_against_name(name, quantity, stated_unit)
    if reason is not None:
        return reason
    why = f"by its unit {stated_unit}" if by_unit is not None else "by its name; its file states no unit"
    return OtherChannel(name, quantity, stated_unit, (f"{quantity.replace('-', ' ')} {why}",))
