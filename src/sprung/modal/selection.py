"""From the poles of a computation to modes: how many are looked for, and which of too many are kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sprung.errors import Problems
from sprung.modal.decays import Decays
from sprung.modal.identified import ModeSet, RejectedPole
from sprung.modal.likelihood import Poles, Stand
from sprung.modal.records import as_records
from sprung.modal.subspace import Span
from sprung.modal.thinning import Thinned
from sprung.vibration import make_modes

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_NOTHING = 1e-20
"""Part of a channel's energy below which a pole explains nothing of it but rounding."""

MOST_POLES = 40
"""Poles that the likelihood looks for at the most, unless somebody asks for more."""

FIRST_POLES = 8
"""Poles to look for at first, or twice the channels where there are more."""


@dataclass(frozen=True, eq=False)
class Task:
    """What a method is to find, and in what.

    Attributes
    ----------
    decays
        The records.
    span
        Of the same, thinned out.
    order
        How many poles.
    method
        Whose task it is, for messages.
    """

    decays: Decays
    span: Span
    order: int
    method: str

    @classmethod
    def of(cls, records: Sequence[ArrayLike], rate: float, order: int | None, method: str) -> Task:
        """Take up records.

        Parameters
        ----------
        records, rate
            As the methods take them.
        order
            How many poles to look for; None for as many as stand out from noise, but no more than twice the channels: what is
            not quite linear lets more stand out than there are.
        method
            Whose task it is.

        Raises
        ------
        InputError
            If the records cannot be used.
        """
        arrays = as_records(records, rate, method)
        decays = Decays.of(arrays, rate)
        span = Span.of(arrays, decays.spectrum)
        wanted = min(span.standing_out, max(FIRST_POLES, 2 * decays.channels)) if order is None else order
        task = cls(decays, span, wanted, method)
        task.allow(span.most, given=order is not None)
        return task

    @property
    def thinned(self) -> Thinned:
        """The records, thinned out."""
        return self.span.thinned

    def allow(self, most: int, given: bool = True) -> None:
        """Refuse an order beyond the most that the records allow.

        Raises
        ------
        InputError
            With the numbers.
        """
        problems = Problems()
        if given and not 1 <= self.order <= most:
            said = f"1 to {most} for {self.decays.channels} channels and {self.decays.seconds.min():.3g} s"
            problems.add(f"{self.method}: order", f"{self.order}", said, "Choose it in that range, or leave it out.")
        elif self.order < 1:
            problems.add(
                f"{self.method}: records",
                "nothing that stands out from noise",
                "a free decay",
                "Look at the recordings.",
            )
        problems.raise_if_any()

    def modes(self, poles: Poles) -> ModeSet:
        """Keep of poles as many as wanted, those that explain most of the records, and give the reasons for the others."""
        if not poles.count:
            return ModeSet((), (), self.method)
        weights = 1 / np.maximum(self.decays.energy.sum(axis=0), 1e-300)
        shares = Stand.at(self.decays, poles, weights).shares.max(axis=0)
        rate, room = self.decays.rate, self.order
        kept, rejected = [], []
        for j in np.argsort(-shares).tolist():
            size = 2 if poles.exponent[j].imag else 1
            if size <= room and shares[j] > _NOTHING:
                kept.append(j)
                room -= size
            else:
                said = f"{self.order} poles explain more: of no channel is it more than {100 * shares[j]:.2g} %"
                rejected.append(RejectedPole(complex(poles.exponent[j]) * rate, said))
        both = np.concatenate([poles.exponent[kept], poles.exponent[kept].conj()]) * rate
        shapes = np.concatenate([poles.shapes[:, kept], poles.shapes[:, kept].conj()], axis=1)
        once = np.concatenate([np.ones(len(kept), dtype=np.bool_), poles.exponent[kept].imag != 0])
        return ModeSet(make_modes(both[once], shapes[:, once]), tuple(rejected), self.method)


def refuse_without_decay(poles: Poles, method: str) -> None:
    """Refuse records whose span holds nothing that decays.

    Raises
    ------
    InputError
        If there are no poles to begin with.
    """
    problems = Problems()
    if not poles.count:
        problems.add(f"{method}: records", "nothing that decays", "a free decay", "Look at the recordings.")
    problems.raise_if_any()
